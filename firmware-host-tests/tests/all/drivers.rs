//! Published drivers, unmodified, against the emulated chips: each sets its chip up, reads, scales, and must agree with what
//! the sensing elements were given, within one count: with the chip in memory, behind a bridge in memory, and over a pty
//! with the emulator playing a scene. The same function must notice a chip with a flaw.

mod bench;
mod bmi088;
mod bmi160;
mod bmi2;
mod bus;
mod emulated;
mod flaw;
mod hal;
mod icm20948_async;
mod icm20948_rs;
mod icm426xx;
mod lsm6dso;
mod mpu6050;
mod mpu6050_dmp;
mod mpu9250;
mod page;
mod played_back;

use bench::{Bench, Part, Sensed};

/// Counts a deg/s of an MPU-60x0, MPU-9250 and ICM-20948 by range (PS-MPU-6000A, PS-MPU-9250A, DS-000189 p. 11).
const GYRO: [f64; 4] = [131.0, 65.5, 32.8, 16.4];
/// Counts a g, of every TDK chip here.
const ACCEL: [f64; 4] = [16384.0, 8192.0, 4096.0, 2048.0];
/// Counts a µT of AKM's magnetometers at 16 bits.
const MAG: f64 = 1.0 / 0.15;

const TDK: Part = Part { gyro: &GYRO, accel: &ACCEL, mag: MAG };

/// What a check came to: the first disagreement in words.
type Verdict = Result<(), String>;

/// Says what went wrong, for `?`.
fn told<E: std::fmt::Debug>(what: &'static str) -> impl FnOnce(E) -> String {
    move |error| format!("{what}: {error:?}")
}

/// That three readings are these, within one count of `per_unit` counts a unit.
fn agrees(what: &str, read: [f64; 3], truth: [f64; 3], per_unit: f64) -> Verdict {
    for (axis, (read, truth)) in ["x", "y", "z"].into_iter().zip(read.into_iter().zip(truth)) {
        let counts = (read - truth) * per_unit;
        if counts.is_nan() || counts.abs() > 1.0 {
            return Err(format!("{what} {axis}: read {read}, is {truth}: {counts:.2} counts"));
        }
    }
    Ok(())
}

/// That two things are equal.
fn equal<T: PartialEq + std::fmt::Debug>(what: &str, read: T, truth: T) -> Verdict {
    if read == truth { Ok(()) } else { Err(format!("{what}: {read:?}, is {truth:?}")) }
}

/// Something to sense that is whole counts at these sensitivities; few enough that a driver's rounding of the sheet's
/// sensitivity, up to 0.1 %, stays below one count. Gravity is along z.
fn something(gyro: f64, accel: f64) -> Sensed {
    Sensed {
        gyro_dps: [700.0 / gyro, -300.0 / gyro, 5.0 / gyro],
        accel_g: [-400.0 / accel, 123.0 / accel, 1.0],
        mag_ut: [100.0 * 0.15, -250.0 * 0.15, 300.0 * 0.15],
        celsius: 30.0,
    }
}

/// Runs a check with a chip in memory, with the same chip behind an emulated bridge, and over a pty with that chip of the
/// emulator, which plays a scene.
macro_rules! agrees_everywhere {
    ($check:path, $part:expr, $chip:expr, $shown:expr) => {
        for (place, verdict) in [
            ("in memory", $check(&$crate::drivers::bench::Memory::new(&$part, Box::new($chip)))),
            ("behind a bridge", $check(&$crate::drivers::bench::Bridged::new(&$part, Box::new($chip)))),
            ("on a pty", $crate::drivers::emulated::judge(&$part, $shown, |bench| $check(bench))),
        ] {
            if let Err(disagreement) = verdict {
                panic!("{place}: {disagreement}");
            }
        }
    };
}

/// That a check notices a flawed chip, and which disagreement it tells.
macro_rules! notices {
    ($check:path, $part:expr, $chip:expr, $told:expr) => {
        match $check(&$crate::drivers::bench::Memory::new(&$part, Box::new($chip))) {
            Ok(()) => panic!("not noticed: {}", stringify!($chip)),
            Err(told) => assert!(told.contains($told), "{told}"),
        }
    };
}

pub(crate) use {agrees_everywhere, notices};
