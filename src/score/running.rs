//! Adding up errors while a run goes on.

use super::AttitudeError;
use serde::Serialize;

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
    use crate::geometry::{Attitude, Euler, exp};
    use glam::DVec3;

    fn attitude(roll: f64, pitch: f64, yaw: f64) -> Attitude {
        Attitude::from_quat(Euler { roll, pitch, yaw }.to_quat())
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
