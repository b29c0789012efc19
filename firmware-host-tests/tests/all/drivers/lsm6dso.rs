//! `lsm6dso` 0.2 (embedded-hal 1.0): an LSM6DSO.

use ::lsm6dso::{AccelerometerOutput, AccelerometerScale, GyroscopeFullScale, GyroscopeOutput, Lsm6dso};
use ratetable_protocols::chip::{Channel, lsm6dso};

use super::bench::{Part, Wanted};
use super::emulated::turning;
use super::flaw::{Flaw, Flawed};
use super::hal::Hal;
use super::{Bench, Verdict, agrees, agrees_everywhere, equal, notices, something, told};

/// Counts a deg/s by range, ±125 deg/s first, and counts a g, ±2 g first (DS12140 table 2).
const GYRO: [f64; 5] = [1000.0 / 4.375, 1000.0 / 8.75, 1000.0 / 17.5, 1000.0 / 35.0, 1000.0 / 70.0];
const ACCEL: [f64; 4] = [1000.0 / 0.061, 1000.0 / 0.122, 1000.0 / 0.244, 1000.0 / 0.488];
const PART: Part = Part { gyro: &GYRO, accel: &ACCEL, mag: 0.0 };

const G: f64 = 9.80665;

fn check(bench: &impl Bench) -> Verdict {
    let mut lsm = Lsm6dso::new(Hal(bench.bus()), 0x6a);
    lsm.check().map_err(told("identity"))?;
    lsm.set_gyroscope_output(GyroscopeOutput::Rate104).map_err(told("gyro rate"))?;
    lsm.set_accelerometer_output(AccelerometerOutput::Rate208).map_err(told("accel rate"))?;
    let gyros = [
        GyroscopeFullScale::Dps125,
        GyroscopeFullScale::Dps250,
        GyroscopeFullScale::Dps500,
        GyroscopeFullScale::Dps1000,
        GyroscopeFullScale::Dps2000,
    ];
    let accels =
        [AccelerometerScale::G02, AccelerometerScale::G04, AccelerometerScale::G08, AccelerometerScale::G16];
    for (range, gyro) in gyros.into_iter().enumerate() {
        let accel = range % accels.len();
        lsm.set_gyroscope_scale(gyro).map_err(told("gyro"))?;
        lsm.set_accelerometer_scale(accels[accel]).map_err(told("accel"))?;
        let sensed = bench.show(something(GYRO[range], ACCEL[accel]));
        bench.next();
        equal("gyro ready", lsm.gyro_data_available().map_err(told("status"))?, true)?;
        equal("accel ready", lsm.accel_data_available().map_err(told("status"))?, true)?;
        let read = lsm.read_all().map_err(told("read"))?;
        let gyro = [read.gyro_x, read.gyro_y, read.gyro_z].map(|it| f64::from(it).to_degrees());
        agrees("gyro", gyro, sensed.gyro_dps, GYRO[range])?;
        let acc = [read.accel_x, read.accel_y, read.accel_z].map(|it| f64::from(it) / G);
        agrees("accel", acc, sensed.accel_g, ACCEL[accel])?;
        agrees("temperature", [f64::from(read.temp); 3], [sensed.celsius; 3], 256.0)?;
        bench.comes_to("gyro ready after reading", false, || {
            lsm.read_all().map_err(told("read"))?;
            lsm.gyro_data_available().map_err(told("status"))
        })?;
        bench.is_set_as(Wanted { channel: Channel::Gyro, rate: Some((104, 1)), range, filter: None })?;
    }
    Ok(())
}

#[test]
fn an_lsm6dso_reads_as_its_driver_scales_it() {
    agrees_everywhere!(check, PART, lsm6dso::Lsm6dso::new(0x6a), turning("LSM6DSO"));
}

#[test]
fn flaws_of_an_lsm6dso_are_noticed() {
    let flawed = |flaw| Flawed::new(lsm6dso::Lsm6dso::new(0x6a), 0x6a, flaw).fifo(0x7e);
    notices!(check, PART, flawed(Flaw::Scale { bank: 0, register: 0x11, bits: 0x04 }), "gyro x");
    notices!(check, PART, flawed(Flaw::Scale { bank: 0, register: 0x10, bits: 0x08 }), "accel x");
    notices!(check, PART, flawed(Flaw::Swapped(0x22..0x2e)), "gyro x");
    notices!(check, PART, flawed(Flaw::Stuck { register: 0x1e, bits: 0x02 }), "gyro ready after reading");
}
