//! `mpu6050` 0.1 (embedded-hal 0.2): an MPU-6050.

use ::mpu6050::Mpu6050;
use ::mpu6050::device::{AccelRange, GyroRange};
use ratetable_protocols::chip::{Channel, mpu::Mpu};

use super::emulated::turning;
use super::flaw::{Flaw, Flawed};
use super::hal::{Delay, Hal};
use super::{ACCEL, Bench, GYRO, TDK, Verdict, agrees, agrees_everywhere, notices, something, told};

fn check(bench: &impl Bench) -> Verdict {
    let mut mpu = Mpu6050::new(Hal(bench.bus()));
    mpu.init(&mut Delay(bench)).map_err(told("start"))?;
    let ranges = [
        (GyroRange::D250, AccelRange::G2),
        (GyroRange::D500, AccelRange::G4),
        (GyroRange::D1000, AccelRange::G8),
        (GyroRange::D2000, AccelRange::G16),
    ];
    for (range, (gyro, accel)) in ranges.into_iter().enumerate() {
        mpu.set_gyro_range(gyro).map_err(told("gyro"))?;
        mpu.set_accel_range(accel).map_err(told("accel"))?;
        let sensed = bench.show(something(GYRO[range], ACCEL[range]));
        bench.next();
        let read = mpu.get_gyro().map_err(told("read gyro"))?;
        let read = [read.x, read.y, read.z].map(|it| f64::from(it).to_degrees());
        agrees("gyro", read, sensed.gyro_dps, GYRO[range])?;
        let read = mpu.get_acc().map_err(told("read accel"))?;
        agrees("accel", [read.x, read.y, read.z].map(f64::from), sensed.accel_g, ACCEL[range])?;
        let read = f64::from(mpu.get_temp().map_err(told("read temperature"))?);
        agrees("temperature", [read; 3], [sensed.celsius; 3], 340.0)?;
        bench.is_set(Channel::Gyro, (8000, 1), range as u8, "DLPF 0")?;
    }
    Ok(())
}

#[test]
fn an_mpu6050_reads_as_its_driver_scales_it() {
    agrees_everywhere!(check, TDK, Mpu::mpu6050(0x68), turning("MPU-6050"));
}

#[test]
fn flaws_of_an_mpu6050_are_noticed() {
    let chip = || Mpu::mpu6050(0x68);
    let scale = Flaw::Scale { bank: 0, register: 0x1b, bits: 0x08 };
    notices!(check, TDK, Flawed::new(chip(), 0x68, scale), "gyro x");
    notices!(check, TDK, Flawed::new(chip(), 0x68, Flaw::Swapped(0x3b..0x41)), "accel x");
    notices!(check, TDK, Mpu::mpu9250(0x68, [128; 3]), "InvalidChipId(113)");
}
