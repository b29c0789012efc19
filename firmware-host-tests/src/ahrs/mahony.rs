//! INAV's estimator, and Betaflight's: a complementary filter on the rotation matrix (Mahony, Hamel, Pflimlin 2008), as a quaternion.

use std::ops::Range;

use crate::quaternion::{IDENTITY, about, conj, mul, rotate};

/// The integral term rests above this rate, rad/s: 20 deg/s.
const SPIN_LIMIT: f64 = 20.0 * std::f64::consts::PI / 180.0;

/// Standard gravity, m/s²: forces far from it are not taken for the vertical.
const G: f64 = 9.80665;

/// The filter: `ω' = ω + K·(k_acc·e_acc + k_mag·e_mag) + b`, `ḃ = k_i·K·(e_acc + e_mag)`, where `e_acc` turns the
/// estimate's vertical to the measured one and `e_mag`, about the vertical alone, its north.
#[derive(Debug, Clone)]
pub struct Mahony {
    q: [f64; 4],
    bias: [f64; 3],
    k_acc: f64,
    k_mag: f64,
    k_i: f64,
    /// What is taken for the vertical, g.
    forces: Range<f64>,
    /// K, by which all gains are multiplied.
    pub gain: f64,
}

impl Mahony {
    /// With INAV's defaults: `ahrs_dcm_kp` and `ahrs_dcm_kp_mag` 2000, `ahrs_dcm_ki` 50, each in ten-thousandths.
    pub fn inav() -> Self {
        Self { q: IDENTITY, bias: [0.0; 3], k_acc: 0.2, k_mag: 0.2, k_i: 0.005, forces: 0.5..1.5, gain: 1.0 }
    }

    /// With Betaflight's defaults: `imu_dcm_kp` 2500 in ten-thousandths, `imu_dcm_ki` 0, no magnetometer.
    pub fn betaflight() -> Self {
        Self { k_acc: 0.25, k_mag: 0.0, k_i: 0.0, forces: 0.9..1.1, ..Self::inav() }
    }

    /// Body (FRD) to nav (NED).
    pub fn attitude(&self) -> [f64; 4] {
        self.q
    }

    /// Takes an attitude for its own.
    pub fn set(&mut self, q: [f64; 4]) {
        self.q = q;
    }

    /// One step of `dt_s`: rate in rad/s, force in m/s², field in any unit with its horizontal part to true north; a
    /// vector of zero is none. All in body axes.
    pub fn step(&mut self, dt_s: f64, rate: [f64; 3], force: [f64; 3], field: [f64; 3]) {
        let up = rotate(conj(self.q), [0.0, 0.0, -1.0]);
        let strength = norm(force);
        let level = if self.forces.contains(&(strength / G)) {
            cross(force.map(|f| f / strength), up)
        } else {
            [0.0; 3]
        };
        let [north, east, _] = rotate(self.q, field);
        let horizontal = north.hypot(east);
        let turn = if horizontal > 0.0 { -east / horizontal } else { 0.0 };
        let turn = rotate(conj(self.q), [0.0, 0.0, turn]);
        if norm(rate) < SPIN_LIMIT {
            for i in 0..3 {
                self.bias[i] += self.k_i * self.gain * (level[i] + turn[i]) * dt_s;
            }
        }
        let (acc, mag) = (self.gain * self.k_acc, self.gain * self.k_mag);
        let rate: [f64; 3] = std::array::from_fn(|i| rate[i] + acc * level[i] + mag * turn[i] + self.bias[i]);
        let speed = norm(rate);
        if speed > 0.0 {
            let q = mul(self.q, about(rate.map(|w| w / speed), speed * dt_s));
            let length = q.iter().map(|c| c * c).sum::<f64>().sqrt();
            self.q = q.map(|c| c / length);
        }
    }
}

fn norm(v: [f64; 3]) -> f64 {
    v.iter().map(|c| c * c).sum::<f64>().sqrt()
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quaternion::{angle_between, from_euler};

    /// How far off it is, in deg, after so many seconds at rest in some attitude with a gyro bias.
    fn error_after(seconds: f64, gain: f64, k_i: f64, bias: f64) -> f64 {
        let truth = from_euler(0.4, -0.3, 2.0);
        let mut filter = Mahony { gain, k_i, ..Mahony::inav() };
        let (force, field) = (rotate(conj(truth), [0.0, 0.0, -G]), rotate(conj(truth), [1.0, 0.0, 1.7]));
        for _ in 0..(seconds * 1000.0) as u32 {
            filter.step(0.001, [bias, -bias, bias], force, field);
        }
        angle_between(filter.attitude(), truth).to_degrees()
    }

    #[test]
    fn it_turns_to_the_vertical_and_to_north_at_the_rate_of_its_gains() {
        assert!(error_after(20.0, 10.0, 0.0, 0.0) < 0.01);
        let slow = error_after(20.0, 1.0, 0.0, 0.0);
        assert!((0.5..20.0).contains(&slow), "{slow}: four time constants of 5 s, and more from far off");
    }

    #[test]
    fn a_bias_of_the_gyro_is_learnt() {
        let proportional = (0.01_f64 * 2_f64.sqrt() / 0.2).to_degrees();
        let learnt = error_after(400.0, 1.0, 0.005, 0.01);
        assert!(learnt < 0.02 * proportional, "{learnt} of {proportional}");
    }

    #[test]
    fn it_integrates_the_rate_about_the_bodys_axes() {
        let mut filter = Mahony::inav();
        filter.set(from_euler(0.0, 0.0, 1.0));
        for _ in 0..1000 {
            filter.step(0.001, [0.5, 0.0, 0.0], [0.0; 3], [0.0; 3]);
        }
        assert!(angle_between(filter.attitude(), from_euler(0.5, 0.0, 1.0)) < 1e-9);
    }
}
