//! `bmi160` 1.1 (embedded-hal 1.0): a BMI160.

use ::bmi160::{
    AccelerometerPowerMode, AccelerometerRange, Bmi160, GyroscopePowerMode, GyroscopeRange, SensorSelector,
    SlaveAddr,
};
use ratetable_protocols::chip::{Channel, bmi160};

use super::bench::{Part, Wanted};
use super::emulated::turning;
use super::flaw::{Flaw, Flawed};
use super::hal::Hal;
use super::{ACCEL, Bench, Verdict, agrees, agrees_everywhere, equal, notices, something, told};

/// Counts a deg/s by range, ±125 deg/s first (BST-BMI160-DS000, table 2).
const GYRO: [f64; 5] = [262.4, 131.2, 65.6, 32.8, 16.4];
const PART: Part = Part { gyro: &GYRO, accel: &ACCEL, mag: 0.0 };

fn check(bench: &impl Bench) -> Verdict {
    let mut bmi = Bmi160::new_with_i2c(Hal(bench.bus()), SlaveAddr::Alternative(true));
    equal("identity", bmi.chip_id().map_err(told("identity"))?, 0xd1)?;
    bmi.set_accel_power_mode(AccelerometerPowerMode::Normal).map_err(told("accel mode"))?;
    bmi.set_gyro_power_mode(GyroscopePowerMode::Normal).map_err(told("gyro mode"))?;
    bench.wait(100_000_000);
    let modes = bmi.power_mode().map_err(told("modes"))?;
    equal("modes", (modes.accel, modes.gyro), (AccelerometerPowerMode::Normal, GyroscopePowerMode::Normal))?;
    let gyros = [
        GyroscopeRange::Scale125,
        GyroscopeRange::Scale250,
        GyroscopeRange::Scale500,
        GyroscopeRange::Scale1000,
        GyroscopeRange::Scale2000,
    ];
    let accels = [AccelerometerRange::G2, AccelerometerRange::G4, AccelerometerRange::G8];
    for (range, gyro) in gyros.into_iter().enumerate() {
        let accel = range % accels.len();
        bmi.set_gyro_range(gyro).map_err(told("gyro"))?;
        bmi.set_accel_range(accels[accel]).map_err(told("accel"))?;
        let sensed = bench.show(something(GYRO[range], ACCEL[accel]));
        bench.next();
        let status = bmi.status().map_err(told("status"))?;
        equal("ready", (status.gyro_data_ready, status.accel_data_ready), (true, true))?;
        let read = bmi.data_scaled(SensorSelector::new().gyro().accel()).map_err(told("read"))?;
        let (Some(gyro), Some(acc)) = (read.gyro, read.accel) else { return Err("no data".into()) };
        agrees("gyro", [gyro.x, gyro.y, gyro.z].map(f64::from), sensed.gyro_dps, GYRO[range])?;
        agrees("accel", [acc.x, acc.y, acc.z].map(f64::from), sensed.accel_g, ACCEL[accel])?;
        bench.comes_to("ready after reading", (false, false), || {
            bmi.data(SensorSelector::new().gyro().accel()).map_err(told("read"))?;
            let status = bmi.status().map_err(told("status"))?;
            Ok((status.gyro_data_ready, status.accel_data_ready))
        })?;
        bench.is_set_as(Wanted { channel: Channel::Gyro, rate: Some((100, 1)), range, filter: None })?;
    }
    Ok(())
}

#[test]
fn a_bmi160_reads_as_its_driver_scales_it() {
    agrees_everywhere!(check, PART, bmi160::Bmi160::new(0x69), turning("BMI160").at(0x69));
}

#[test]
fn flaws_of_a_bmi160_are_noticed() {
    let flawed = |flaw| Flawed::new(bmi160::Bmi160::new(0x69), 0x69, flaw).fifo(0x24);
    notices!(check, PART, flawed(Flaw::Scale { bank: 0, register: 0x43, bits: 0x01 }), "gyro x");
    notices!(check, PART, flawed(Flaw::Swapped(0x0c..0x18)), "gyro x");
    notices!(check, PART, flawed(Flaw::Stuck { register: 0x1b, bits: 0xc0 }), "ready after reading");
}
