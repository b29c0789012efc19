//! The two classics, as the crate `ahrs` has them.
//!
//! Madgwick: S. Madgwick, A. Harrison, R. Vaidyanathan, ICORR 2011, gain β = 0.1. Mahony: R. Mahony, T. Hamel, J.-M.
//! Pflimlin, IEEE TAC 53(5), 2008, gains 0.5 and 0: it estimates no gyro bias. Both work in North-West-Up on
//! Forward-Left-Up vectors, take all three sensors at once and an even interval.

use super::held::Held;
use super::{Filter, FilterKind, Setup, flip};
use crate::geometry::{Attitude, Body, Vector};
use ahrs::{Ahrs, Madgwick, Mahony};
use glam::DQuat;
use nalgebra::{Quaternion, UnitQuaternion, Vector3};

pub(super) static MADGWICK: FilterKind = FilterKind {
    name: "madgwick",
    about: "Madgwick 2011: gradient descent, gain 0.1; no gyro bias",
    takes_start: true,
    make: |setup| boxed(Madgwick::new_with_quat(setup.gyro_s, 0.1, start(setup)), setup),
};

pub(super) static MAHONY: FilterKind = FilterKind {
    name: "mahony",
    about: "Mahony 2008: complementary on SO(3), gains 0.5 and 0; no gyro bias",
    takes_start: true,
    make: |setup| boxed(Mahony::new_with_quat(setup.gyro_s, 0.5, 0.0, start(setup)), setup),
};

fn boxed<F: Ahrs<f64> + 'static>(filter: F, setup: &Setup) -> Box<dyn Filter> {
    Box::new(AllAtOnce { filter, q: start(setup), accel: Held::default(), mag: Held::default() })
}

/// A half turn about x on either side: North-East-Down to North-West-Up.
fn start(setup: &Setup) -> UnitQuaternion<f64> {
    let q = setup.start.q;
    UnitQuaternion::from_quaternion(Quaternion::new(q.w, q.x, -q.y, -q.z))
}

struct AllAtOnce<F> {
    filter: F,
    q: UnitQuaternion<f64>,
    accel: Held,
    mag: Held,
}

impl<F: Ahrs<f64>> Filter for AllAtOnce<F> {
    fn gyro(&mut self, dt: f64, rate: Vector<Body>) {
        self.accel.carry(dt, rate);
        self.mag.carry(dt, rate);
        if dt <= 0.0 {
            return;
        }
        let vector = |v| Vector3::from(flip(v));
        let rate = vector(rate.v);
        // A vector of length 0 corrects nothing.
        let corrected = match (self.accel.now(), self.mag.now()) {
            (Some(force), Some(field)) => self.filter.update(&rate, &vector(force), &vector(field)).ok(),
            (Some(force), None) => self.filter.update_imu(&rate, &vector(force)).ok(),
            _ => None,
        };
        let corrected = corrected.copied();
        self.q = corrected.unwrap_or_else(|| *self.filter.update_gyro(&rate));
    }

    fn accel(&mut self, force: Vector<Body>) {
        self.accel.put(force);
    }

    fn mag(&mut self, field: Vector<Body>) {
        self.mag.put(field);
    }

    fn attitude(&self) -> Attitude {
        let q = self.q.quaternion();
        Attitude::from_quat(DQuat::from_xyzw(q.i, -q.j, -q.k, q.w).normalize())
    }
}
