//! Fusion of x-io Technologies, the revised Madgwick filter (S. Madgwick, PhD thesis, Bristol 2014, chapter 7); the
//! crate `fusion-ahrs`, in `f32`.
//!
//! It works in North-East-Down here, but takes deg/s and g, and all three sensors at once. Its gain is 0.5: the
//! start-up, in which it comes down from 10, is left out.

use super::held::Held;
use super::{Filter, FilterKind, Setup};
use crate::geometry::{Attitude, Body, Vector};
use fusion_ahrs::{Ahrs, AhrsSettings, Convention, Quaternion};
use glam::{DQuat, DVec3};

/// Standard gravity, m/s².
const G: f64 = 9.80665;

pub(super) static KIND: FilterKind = FilterKind {
    name: "fusion",
    about: "x-io Fusion (revised Madgwick): rejection of accelerations; f32",
    takes_start: true,
    make,
};

fn make(setup: &Setup) -> Box<dyn Filter> {
    let settings = AhrsSettings {
        convention: Convention::Ned,
        sample_rate: (1.0 / setup.gyro_s) as f32,
        ..AhrsSettings::default()
    };
    let mut filter = Ahrs::with_settings(settings);
    let q = setup.start.q;
    filter.set_quaternion(Quaternion::new(q.w as f32, q.x as f32, q.y as f32, q.z as f32));
    // Its start-up looks for the attitude that it has been given, and without a magnetometer holds heading at 0.
    filter.skip_startup();
    Box::new(Fusion { filter, accel: Held::default(), mag: Held::default() })
}

struct Fusion {
    filter: Ahrs,
    accel: Held,
    mag: Held,
}

impl Filter for Fusion {
    fn gyro(&mut self, dt: f64, rate: Vector<Body>) {
        self.accel.carry(dt, rate);
        self.mag.carry(dt, rate);
        if dt <= 0.0 {
            return;
        }
        self.filter.set_sample_period(dt as f32);
        let single = |v: DVec3| v.to_array().map(|c| c as f32);
        let rate = rate.v.to_array().map(|w| w.to_degrees() as f32);
        let accel = single(self.accel.now().unwrap_or_default() / G);
        match self.mag.now() {
            Some(field) => self.filter.update(rate, accel, single(field)),
            None => self.filter.update_no_magnetometer(rate, accel),
        }
    }

    fn accel(&mut self, force: Vector<Body>) {
        self.accel.put(force);
    }

    fn mag(&mut self, field: Vector<Body>) {
        self.mag.put(field);
    }

    fn attitude(&self) -> Attitude {
        let q = self.filter.quaternion();
        let [w, x, y, z] = [q.w, q.x, q.y, q.z].map(f64::from);
        Attitude::from_quat(DQuat::from_xyzw(x, y, z, w).normalize())
    }
}
