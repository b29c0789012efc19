//! `bmi088` 0.2 (embedded-hal 1.0): both halves of a BMI088. Over I²C the driver's functions are not written (each panics
//! as unimplemented), so that it is tested over SPI, on which the accelerometer sends one byte before its data.

use ::bmi088::Builder;
use ratetable_protocols::chip::{Channel, bmi088::Bmi088};

use super::bench::{Part, Wanted};
use super::emulated::turning;
use super::flaw::{Flaw, Flawed};
use super::hal::{Delay, Spi};
use super::{Bench, Verdict, agrees, agrees_everywhere, notices, something, told};

/// Counts a deg/s by range, ±125 deg/s first, and counts a g, ±3 g first (BST-BMI088-DS001, tables 2 and 3).
const GYRO: [f64; 5] = [262.144, 131.072, 65.536, 32.768, 16.384];
const ACCEL: [f64; 4] = [10920.0, 5460.0, 2730.0, 1365.0];
const PART: Part = Part { gyro: &GYRO, accel: &ACCEL, mag: 0.0 };

fn check(bench: &impl Bench) -> Verdict {
    let mut accel = Builder::new_accel_spi(Spi(bench.bus(), 0x18, 1));
    let mut gyro = Builder::new_gyro_spi(Spi(bench.bus(), 0x68, 0));
    accel.setup(&mut Delay(bench)).map_err(told("accel"))?;
    gyro.setup(&mut Delay(bench)).map_err(told("gyro"))?;
    for (dps, range) in [(2000, 4), (1000, 3)] {
        gyro.set_range(dps).map_err(told("gyro range"))?;
        // The driver cannot set the accelerometer's range: ±6 g after a reset.
        let sensed = bench.show(something(GYRO[range], ACCEL[1]));
        bench.next();
        let read = gyro.get_gyro().map_err(told("read gyro"))?.map(|it| f64::from(it) / GYRO[range]);
        agrees("gyro", read, sensed.gyro_dps, GYRO[range])?;
        let read = accel.get_accel().map_err(told("read accel"))?.map(|it| f64::from(it) / ACCEL[1]);
        agrees("accel", read, sensed.accel_g, ACCEL[1])?;
        // Asked for 1000 Hz the driver sets 2000 Hz with 230 Hz, and the other way round.
        bench.is_set_as(Wanted { channel: Channel::Gyro, rate: Some((2000, 1)), range, filter: None })?;
    }
    Ok(())
}

#[test]
fn a_bmi088_reads_as_its_driver_expects() {
    agrees_everywhere!(check, PART, Bmi088::new(0x18, 0x68), turning("BMI088"));
}

#[test]
fn flaws_of_a_bmi088_are_noticed() {
    let chip = || Bmi088::new(0x18, 0x68);
    let scale = Flaw::Scale { bank: 0, register: 0x0f, bits: 0x02 };
    notices!(check, PART, Flawed::new(chip(), 0x68, scale), "gyro x");
    notices!(check, PART, Flawed::new(chip(), 0x68, Flaw::Swapped(0x02..0x08)), "gyro x");
    notices!(check, PART, Flawed::new(chip(), 0x18, Flaw::Swapped(0x12..0x18)), "accel x");
}
