//! `bmi2` 0.1 (embedded-hal 1.0): a BMI270, with the upload that it needs.

use ::bmi2::types::{AccRange, Burst, GyrRange, GyrRangeVal, OisRange, PwrCtrl};
use ::bmi2::{Bmi2, I2cAddr, config};
use ratetable_protocols::chip::{Channel, bmi270::Bmi270};

use super::bench::{Part, Wanted};
use super::emulated::turning;
use super::flaw::{Flaw, Flawed};
use super::hal::{Delay, Hal};
use super::{ACCEL, Bench, Verdict, agrees, agrees_everywhere, equal, notices, something, told};

/// Counts a deg/s by range, ±125 deg/s first (BST-BMI270-DS000, table 3).
const GYRO: [f64; 5] = [262.144, 131.072, 65.536, 32.768, 16.384];
const PART: Part = Part { gyro: &GYRO, accel: &ACCEL, mag: 0.0 };

fn check(bench: &impl Bench) -> Verdict {
    let mut bmi =
        Bmi2::<_, _, 512>::new_i2c(Hal(bench.bus()), Delay(bench), I2cAddr::Default, Burst::new(255));
    equal("identity", bmi.get_chip_id().map_err(told("identity"))?, 0x24)?;
    bmi.init(&config::BMI270_CONFIG_FILE).map_err(told("start"))?;
    bmi.set_pwr_ctrl(PwrCtrl { aux_en: false, gyr_en: true, acc_en: true, temp_en: true })
        .map_err(told("power"))?;
    let gyros = [
        GyrRangeVal::Range125,
        GyrRangeVal::Range250,
        GyrRangeVal::Range500,
        GyrRangeVal::Range1000,
        GyrRangeVal::Range2000,
    ];
    for (range, gyro) in gyros.into_iter().enumerate() {
        let (accel, accel_range) = match range % 4 {
            0 => (0, AccRange::Range2g),
            1 => (1, AccRange::Range4g),
            2 => (2, AccRange::Range8g),
            _ => (3, AccRange::Range16g),
        };
        bmi.set_gyr_range(GyrRange { range: gyro, ois_range: OisRange::Range250 }).map_err(told("gyro"))?;
        bmi.set_acc_range(accel_range).map_err(told("accel"))?;
        let sensed = bench.show(something(GYRO[range], ACCEL[accel]));
        bench.next();
        let status = bmi.get_status().map_err(told("status"))?;
        equal("ready", (status.gyr_data_ready, status.acc_data_ready), (true, true))?;
        let read = bmi.get_data().map_err(told("read"))?;
        let counts = |it: ::bmi2::types::AxisData, per_unit: f64| {
            [it.x, it.y, it.z].map(|it| f64::from(it) / per_unit)
        };
        agrees("gyro", counts(read.gyr, GYRO[range]), sensed.gyro_dps, GYRO[range])?;
        agrees("accel", counts(read.acc, ACCEL[accel]), sensed.accel_g, ACCEL[accel])?;
        bench.comes_to("ready after reading", (false, false), || {
            bmi.get_data().map_err(told("read"))?;
            let status = bmi.get_status().map_err(told("status"))?;
            Ok((status.gyr_data_ready, status.acc_data_ready))
        })?;
        bench.is_set_as(Wanted { channel: Channel::Gyro, rate: None, range, filter: None })?;
        bench.is_set_as(Wanted { channel: Channel::Accel, rate: None, range: accel, filter: None })?;
    }
    Ok(())
}

#[test]
fn a_bmi270_takes_its_upload_and_reads_as_its_driver_expects() {
    agrees_everywhere!(check, PART, Bmi270::new(0x68), turning("BMI270"));
}

#[test]
fn flaws_of_a_bmi270_are_noticed() {
    let flawed = |flaw| Flawed::new(Bmi270::new(0x68), 0x68, flaw).fifo(0x5e);
    notices!(check, PART, flawed(Flaw::Scale { bank: 0, register: 0x43, bits: 0x01 }), "gyro x");
    notices!(check, PART, flawed(Flaw::Swapped(0x0c..0x18)), "gyro x");
    notices!(check, PART, flawed(Flaw::Stuck { register: 0x03, bits: 0xc0 }), "ready after reading");
}
