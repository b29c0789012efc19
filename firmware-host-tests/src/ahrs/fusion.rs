//! x-io's Fusion as an [`Ahrs`].

use fusion_ahrs::{AhrsSettings, Convention, Quaternion};

use super::{Ahrs, Periods, to_true_north};
use crate::quaternion::from_accel_mag;

/// Standard gravity, m/s²: one g.
const G: f64 = 9.80665;

/// Fusion: one update at each gyro reading, with the newest of the others held.
///
/// Starts from the attitude of the first accelerometer and magnetometer readings.
pub struct Fusion {
    filter: fusion_ahrs::Ahrs,
    declination_rad: f64,
    accel: Option<[f64; 3]>,
    mag: Option<[f64; 3]>,
    aligned: bool,
}

impl Fusion {
    /// A filter in NED for a gyro of this period; `declination_rad` turns magnetic to true north.
    pub fn new(periods: Periods, declination_rad: f64) -> Self {
        let settings = AhrsSettings {
            convention: Convention::Ned,
            // It counts its startup of 3 s in samples.
            sample_rate: (1.0 / periods.gyro_s) as f32,
            ..AhrsSettings::default()
        };
        Self {
            filter: fusion_ahrs::Ahrs::with_settings(settings),
            declination_rad,
            accel: None,
            mag: None,
            aligned: false,
        }
    }

    /// Takes the attitude from the first two vectors.
    fn align(&mut self) {
        if let (false, Some(accel), Some(mag)) = (self.aligned, self.accel, self.mag)
            && let Some(q) = from_accel_mag(accel, mag)
        {
            let [w, x, y, z] = q.map(|c| c as f32);
            self.filter.set_quaternion(Quaternion::new(w, x, y, z));
            self.aligned = true;
        }
    }
}

impl Ahrs for Fusion {
    fn gyro(&mut self, dt_s: f64, rate: [f64; 3]) {
        if dt_s <= 0.0 {
            return;
        }
        self.filter.set_sample_period(dt_s as f32);
        let rate = rate.map(|w| w.to_degrees() as f32);
        let accel = self.accel.map_or([0.0; 3], |force| force.map(|f| (f / G) as f32));
        match self.mag {
            Some(field) => self.filter.update(rate, accel, field.map(|m| m as f32)),
            None => self.filter.update_no_magnetometer(rate, accel),
        }
    }

    fn accel(&mut self, force: [f64; 3]) {
        self.accel = Some(force);
        self.align();
    }

    fn mag(&mut self, field: [f64; 3]) {
        self.mag = Some(field);
        self.align();
    }

    fn attitude(&self) -> [f64; 4] {
        let q = self.filter.quaternion();
        let q = [q.w, q.x, q.y, q.z].map(f64::from);
        let norm = q.iter().map(|c| c * c).sum::<f64>().sqrt();
        let q = q.map(|c| c / norm);
        match self.mag {
            Some(_) => to_true_north(q, self.declination_rad),
            None => q,
        }
    }
}
