//! Attitude estimators behind one interface.

mod fusion;
mod mahony;
mod vqf;

use std::fmt;
use std::str::FromStr;

pub use fusion::Fusion;
pub use mahony::Mahony;
pub use vqf::Vqf;

use crate::quaternion;

/// An attitude estimator that is told of each sensor's readings as they come.
///
/// All vectors are in body axes (FRD). Where several sensors have a reading of one instant they
/// are given in the order gyro, accelerometer, magnetometer.
pub trait Ahrs {
    /// A gyro reading, rad/s, `dt_s` seconds after the one before (0 for the first).
    fn gyro(&mut self, dt_s: f64, rate: [f64; 3]);

    /// An accelerometer reading: specific force, m/s².
    fn accel(&mut self, force: [f64; 3]);

    /// A magnetometer reading, µT.
    fn mag(&mut self, field: [f64; 3]);

    /// The attitude `w, x, y, z`: takes body (FRD) to nav (NED), unit norm.
    ///
    /// North is true north once a magnetometer reading has come (the declination is the
    /// estimator's parameter); before that, heading is relative to where it started.
    fn attitude(&self) -> [f64; 4];
}

/// How far apart a sensor's readings are, s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Periods {
    /// Gyro.
    pub gyro_s: f64,
    /// Accelerometer.
    pub accel_s: f64,
    /// Magnetometer.
    pub mag_s: f64,
}

impl Default for Periods {
    /// 100 Hz each.
    fn default() -> Self {
        Self { gyro_s: 0.01, accel_s: 0.01, mag_s: 0.01 }
    }
}

/// Which estimator.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Kind {
    /// VQF (Laidig and Seel 2023), in `f64`.
    #[default]
    Vqf,
    /// x-io's Fusion (revised Madgwick), in `f32`.
    Fusion,
}

impl Kind {
    /// A fresh estimator. `declination_rad` is added to magnetic heading to give true heading
    /// (positive where the field points east of true north).
    pub fn build(self, periods: Periods, declination_rad: f64) -> Box<dyn Ahrs + Send> {
        match self {
            Self::Vqf => Box::new(Vqf::new(periods, declination_rad)),
            Self::Fusion => Box::new(Fusion::new(periods, declination_rad)),
        }
    }
}

impl FromStr for Kind {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        match name {
            "vqf" => Ok(Self::Vqf),
            "fusion" => Ok(Self::Fusion),
            other => Err(format!("no estimator `{other}`: vqf or fusion")),
        }
    }
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Vqf => "vqf",
            Self::Fusion => "fusion",
        })
    }
}

/// A heading from magnetic north as one from true north.
fn to_true_north(q: [f64; 4], declination_rad: f64) -> [f64; 4] {
    quaternion::mul(quaternion::about([0.0, 0.0, 1.0], declination_rad), q)
}
