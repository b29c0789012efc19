//! VQF: D. Laidig and T. Seel, *VQF: Highly accurate IMU orientation estimation with bias estimation and magnetic
//! disturbance rejection*, Information Fusion 91, 2023; the crate `vqf-rs`.
//!
//! It works with z up: fed Forward-Left-Up, it answers to East-North-Up, without a magnetometer to axes that start at
//! heading 0. It takes every sensor at its own rate and finds its start by itself, from the first readings.

use super::{Filter, FilterKind, flip};
use crate::geometry::{Attitude, Axes, Body, Vector};
use glam::DQuat;
use vqf_rs::VQF;

pub(super) static KIND: FilterKind = FilterKind {
    name: "vqf",
    about: "VQF (Laidig and Seel 2023): gyro bias estimation, rejection of magnetic disturbances; f64",
    takes_start: false,
    make: |setup| {
        let filter = VQF::new(setup.gyro_s, Some(setup.accel_s), Some(setup.mag_s), None);
        Box::new(Vqf { filter, has_mag: setup.has_mag })
    },
};

struct Vqf {
    filter: VQF,
    has_mag: bool,
}

impl Filter for Vqf {
    fn gyro(&mut self, dt: f64, rate: Vector<Body>) {
        self.filter.update_gyr_with_ts(flip(rate.v), dt);
    }

    fn accel(&mut self, force: Vector<Body>) {
        self.filter.update_acc(flip(force.v));
    }

    fn mag(&mut self, field: Vector<Body>) {
        self.filter.update_mag(flip(field.v));
    }

    fn attitude(&self) -> Attitude {
        let q = if self.has_mag { self.filter.quat_9d() } else { self.filter.quat_6d() };
        let q = DQuat::from_xyzw(q.1, q.2, q.3, q.0).normalize();
        match self.has_mag {
            true => Axes::EnuFlu.attitude_in(q),
            // A half turn about x on either side.
            false => Attitude::from_quat(DQuat::from_xyzw(q.x, -q.y, -q.z, q.w)),
        }
    }
}
