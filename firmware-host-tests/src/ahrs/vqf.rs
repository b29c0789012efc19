//! VQF as an [`Ahrs`].

use std::f64::consts::FRAC_1_SQRT_2;

use vqf_rs::VQF;

use super::{Ahrs, Periods, to_true_north};
use crate::quaternion::mul;

/// Takes forward-left-up to forward-right-down, north-west-up to north-east-down, and back.
const HALF_TURN_X: [f64; 4] = [0.0, 1.0, 0.0, 0.0];

/// Takes east-north-up to north-east-down.
const NED_FROM_ENU: [f64; 4] = [0.0, FRAC_1_SQRT_2, FRAC_1_SQRT_2, 0.0];

/// VQF: separate updates for each sensor at its own rate, with gyro bias estimation.
///
/// VQF works with z up, so it is fed forward-left-up vectors. Its filters are tuned to each
/// sensor's period; the gyro is integrated over the true intervals.
///
/// A constant rate below 2 deg/s about the vertical looks to it like a gyro bias at rest, and is
/// estimated away: that is how its bias estimation works.
pub struct Vqf {
    filter: VQF,
    declination_rad: f64,
    has_mag: bool,
}

impl Vqf {
    /// A filter for readings so far apart; `declination_rad` turns magnetic to true north.
    pub fn new(periods: Periods, declination_rad: f64) -> Self {
        let Periods { gyro_s, accel_s, mag_s } = periods;
        Self { filter: VQF::new(gyro_s, Some(accel_s), Some(mag_s), None), declination_rad, has_mag: false }
    }
}

impl Ahrs for Vqf {
    fn gyro(&mut self, dt_s: f64, rate: [f64; 3]) {
        self.filter.update_gyr_with_ts(flu(rate), dt_s);
    }

    fn accel(&mut self, force: [f64; 3]) {
        self.filter.update_acc(flu(force));
    }

    fn mag(&mut self, field: [f64; 3]) {
        self.filter.update_mag(flu(field));
        self.has_mag = true;
    }

    fn attitude(&self) -> [f64; 4] {
        if self.has_mag {
            let q = self.filter.quat_9d();
            let enu_from_body = mul([q.0, q.1, q.2, q.3], HALF_TURN_X);
            to_true_north(mul(NED_FROM_ENU, enu_from_body), self.declination_rad)
        } else {
            let q = self.filter.quat_6d();
            mul(HALF_TURN_X, mul([q.0, q.1, q.2, q.3], HALF_TURN_X))
        }
    }
}

/// Forward-right-down as forward-left-up.
fn flu([x, y, z]: [f64; 3]) -> [f64; 3] {
    [x, -y, -z]
}
