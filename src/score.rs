//! Estimated attitude against the truth.
//!
//! The error is split as the field does (Laidig & Seel, VQF, 2022): *inclination*, the part that gravity shows, and
//! *heading*, the turn about the vertical that is left. In nav axes the error `e = q_estimate ⊗ q_truth*` has
//! heading `2·atan2(e_z, e_w)` and inclination `2·atan2(√(e_x² + e_y²), √(e_w² + e_z²))`.

use crate::geometry::Attitude;
use serde::Serialize;
use std::f64::consts::{PI, TAU};

/// One estimate's error, rad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AttitudeError {
    /// The whole rotation, in [0, π].
    pub total: f64,
    /// The part that tilts, in [0, π].
    pub inclination: f64,
    /// The part about the vertical, in [−π, π], positive where the estimate is turned too far clockwise.
    pub heading: f64,
}

impl AttitudeError {
    /// Of an estimate against the truth at the same time.
    pub fn between(truth: Attitude, estimate: Attitude) -> AttitudeError {
        let e = estimate.q * truth.q.conjugate();
        let heading = 2.0 * libm::atan2(e.z, e.w);
        AttitudeError {
            total: truth.angle_to(estimate),
            inclination: 2.0 * libm::atan2(libm::hypot(e.x, e.y), libm::hypot(e.w, e.z)),
            heading: heading
                - TAU * libm::round(heading / TAU).clamp(-1.0, 1.0) * f64::from(heading.abs() > PI),
        }
    }
}

/// Adds up the errors of a run's estimates.
#[derive(Clone, Debug, Default)]
pub struct Scorer {
    count: u64,
    squares: [f64; 3],
    max: f64,
    delays_ms: Vec<f32>,
}

/// What a run's estimates amount to; degrees and milliseconds.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Score {
    /// Whose estimate it is.
    pub estimator: String,
    /// How many estimates were judged.
    pub samples: u64,
    /// Root mean square of the whole error.
    pub rms_deg: f64,
    /// The largest whole error.
    pub max_deg: f64,
    /// Root mean square of the tilt.
    pub inclination_rms_deg: f64,
    /// Root mean square of the turn about the vertical.
    pub heading_rms_deg: f64,
    /// Median time from a sample's due time to the answer that rests on it.
    pub delay_ms: Option<f64>,
}

/// Delays kept for their median; a longer run thins them out.
const DELAYS: usize = 1 << 16;

impl Scorer {
    /// Judges one estimate; `delay_ms` is how long after the sample was due its answer came, where known.
    pub fn add(&mut self, error: AttitudeError, delay_ms: Option<f64>) {
        self.count += 1;
        self.max = self.max.max(error.total);
        for (sum, part) in self.squares.iter_mut().zip([error.total, error.inclination, error.heading]) {
            *sum += part * part;
        }
        if let Some(delay) = delay_ms {
            if self.delays_ms.len() >= DELAYS {
                let mut keep = false;
                self.delays_ms.retain(|_| {
                    keep = !keep;
                    keep
                });
            }
            self.delays_ms.push(delay as f32);
        }
    }

    /// The score so far, or `None` without an estimate.
    pub fn score(&self, estimator: &str) -> Option<Score> {
        if self.count == 0 {
            return None;
        }
        let [total, inclination, heading] =
            self.squares.map(|sum| libm::sqrt(sum / self.count as f64).to_degrees());
        let mut delays = self.delays_ms.clone();
        delays.sort_unstable_by(f32::total_cmp);
        Some(Score {
            estimator: estimator.to_string(),
            samples: self.count,
            rms_deg: total,
            max_deg: self.max.to_degrees(),
            inclination_rms_deg: inclination,
            heading_rms_deg: heading,
            delay_ms: delays.get(delays.len() / 2).map(|&delay| f64::from(delay)),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Euler, exp};
    use glam::DVec3;
    use proptest::prelude::*;

    fn attitude(roll: f64, pitch: f64, yaw: f64) -> Attitude {
        Attitude::from_quat(Euler { roll, pitch, yaw }.to_quat())
    }

    proptest! {
        #[test]
        fn a_turn_about_the_vertical_is_heading_and_nothing_else(
            roll in -3.0..3.0f64, pitch in -1.5..1.5f64, yaw in -3.0..3.0f64, turn in -3.1..3.1f64,
        ) {
            let truth = attitude(roll, pitch, yaw);
            let estimate = Attitude::from_quat(exp(DVec3::Z * turn) * truth.q);
            for estimate in [estimate, Attitude::from_quat(-estimate.q)] {
                let error = AttitudeError::between(truth, estimate);
                prop_assert!((error.heading - turn).abs() < 1e-12 && error.inclination < 1e-7, "{error:?}");
                prop_assert!((error.total - turn.abs()).abs() < 1e-12);
            }
        }

        #[test]
        fn a_tilt_is_inclination_and_nothing_else(
            yaw in -3.0..3.0f64, tilt in 0.0..3.0f64, way in -3.0..3.0f64,
        ) {
            let truth = attitude(0.3, -0.2, yaw);
            let axis = DVec3::new(libm::cos(way), libm::sin(way), 0.0);
            let error = AttitudeError::between(truth, Attitude::from_quat(exp(axis * tilt) * truth.q));
            prop_assert!((error.inclination - tilt).abs() < 1e-12 && error.heading.abs() < 1e-12, "{error:?}");
        }
    }

    #[test]
    fn a_score_gives_back_a_known_error_and_delay() {
        let mut scorer = Scorer::default();
        assert_eq!(scorer.score("x"), None);
        for i in 0..1000 {
            let truth = attitude(0.0, 0.1, f64::from(i) * 0.01);
            let turn = if i % 2 == 0 { 3f64 } else { -3.0 };
            let estimate = Attitude::from_quat(exp(DVec3::Z * turn.to_radians()) * truth.q);
            scorer.add(AttitudeError::between(truth, estimate), Some(2.0 + f64::from(i % 3)));
        }
        let score = scorer.score("x").unwrap();
        assert!((score.heading_rms_deg - 3.0).abs() < 1e-9 && (score.max_deg - 3.0).abs() < 1e-9);
        assert!(score.inclination_rms_deg < 1e-6);
        assert_eq!((score.samples, score.delay_ms), (1000, Some(3.0)));
    }
}
