//! Estimates that come back: set against the truth, kept.

use super::{Shared, Speed};
use crate::geometry::Attitude;
use crate::scene::Plan;
use crate::score::{AttitudeError, Score, Scorer};
use crate::time::SimTime;
use crate::wire::dialogue::{Estimate, Stamp};
use glam::DVec3;
use std::sync::Arc;
use std::sync::atomic::Ordering;

/// How far an estimate is off, degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Off {
    /// The whole rotation.
    pub total_deg: f64,
    /// About the body's x axis, once the heading is right.
    pub roll_deg: f64,
    /// About the body's y axis, once the heading is right.
    pub pitch_deg: f64,
    /// About the vertical, positive where the estimate is turned too far clockwise.
    pub heading_deg: f64,
}

impl Off {
    /// The error `e = q_estimate ⊗ q_truth*` (nav axes) is a turn about the vertical after a tilt; the tilt's rotation
    /// vector, seen from the true body, has the errors of roll and pitch as components.
    pub(super) fn between(truth: Attitude, estimate: Attitude) -> Off {
        let error = AttitudeError::between(truth, estimate);
        let heading = crate::geometry::exp(DVec3::Z * error.heading);
        let tilt = crate::geometry::log(heading.conjugate() * (estimate.q * truth.q.conjugate()));
        let tilt = crate::geometry::rotate(truth.q.conjugate(), tilt);
        Off {
            total_deg: error.total.to_degrees(),
            roll_deg: tilt.x.to_degrees(),
            pitch_deg: tilt.y.to_degrees(),
            heading_deg: error.heading.to_degrees(),
        }
    }
}

/// Estimates of all links together.
pub(super) struct Heard {
    plan: Arc<Plan>,
    shared: Arc<Shared>,
    speed: Speed,
    /// Whether stream time waits for the other side.
    lockstep: bool,
    scorer: Scorer,
    pub estimates: Vec<(SimTime, Attitude)>,
    pub newest: Option<Off>,
}

impl Heard {
    pub(super) fn new(plan: Arc<Plan>, shared: Arc<Shared>, speed: Speed, lockstep: bool) -> Heard {
        Heard {
            plan,
            shared,
            speed,
            lockstep,
            scorer: Scorer::default(),
            estimates: Vec::new(),
            newest: None,
        }
    }

    /// Judges an estimate that arrived at `now` (ns on the run's clock); one of the rest before the scene counts for
    /// nothing.
    pub(super) fn take_in(&mut self, Estimate { stamp, attitude }: Estimate, now: i64) {
        let stream = match stamp {
            Stamp::Sample(t) => t,
            // Until its delay is known an estimate is taken to hold when it arrives.
            Stamp::Own(_) | Stamp::Arrival => self.stream_time(now),
        };
        let Some(t) = self.shared.scene_time(stream) else { return };
        let truth = self.plan.trajectory.at(t).attitude;
        let delay = matches!(stamp, Stamp::Sample(_)).then(|| self.delay_ms(now, stream)).flatten();
        self.scorer.add(AttitudeError::between(truth, attitude), delay);
        self.newest = Some(Off::between(truth, attitude));
        self.estimates.push((t, attitude));
    }

    /// What they amount to, or `None` without one.
    pub(super) fn score(&self, estimator: &str) -> Option<Score> {
        self.scorer.score(estimator)
    }

    /// Stream time at `now`.
    fn stream_time(&self, now: i64) -> SimTime {
        let start = self.shared.start_ns.load(Ordering::Relaxed);
        match self.speed {
            Speed::Times(times) if start >= 0 && !self.lockstep => {
                SimTime(((now - start) as f64 * times) as i64)
            }
            _ => SimTime(self.shared.stream_ns.load(Ordering::Relaxed)),
        }
    }

    /// From when the sample was due to now, in real time.
    fn delay_ms(&self, now: i64, t: SimTime) -> Option<f64> {
        let stretched_at = self.shared.stretched_at_ns.load(Ordering::Relaxed);
        let start = self.shared.start_ns.load(Ordering::Relaxed);
        if t.0 < stretched_at {
            // Due by an earlier start than this one.
            return None;
        }
        match self.speed {
            Speed::Times(times) if start >= 0 => Some((now - start) as f64 / 1e6 - t.0 as f64 / 1e6 / times),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Euler, exp};
    use proptest::prelude::*;

    proptest! {
        /// Errors that are put in one after another come out each in its own place, whatever the attitude.
        #[test]
        fn roll_pitch_and_heading_errors_are_told_apart(
            roll in -3.0..3.0f64, pitch in -1.5..1.5f64, yaw in -3.0..3.0f64,
            tilt in -0.2..0.2f64, way in -3.0..3.0f64, turn in -3.0..3.0f64,
        ) {
            let truth = Euler { roll, pitch, yaw }.to_quat();
            let axis = DVec3::new(libm::cos(way), libm::sin(way), 0.0);
            let estimate = exp(DVec3::Z * turn) * exp(axis * tilt) * truth;
            let off = Off::between(Attitude::from_quat(truth), Attitude::from_quat(estimate));
            let body = crate::geometry::rotate(truth.conjugate(), axis * tilt);
            prop_assert!((off.heading_deg - turn.to_degrees()).abs() < 1e-9);
            prop_assert!((off.roll_deg - body.x.to_degrees()).abs() < 1e-6);
            prop_assert!((off.pitch_deg - body.y.to_degrees()).abs() < 1e-6);
        }
    }

    #[test]
    fn near_level_the_errors_are_differences_of_angles() {
        let at = |roll: f64, pitch: f64, yaw: f64| {
            let angles = [roll, pitch, yaw].map(f64::to_radians);
            Attitude::from_quat(Euler { roll: angles[0], pitch: angles[1], yaw: angles[2] }.to_quat())
        };
        let off = Off::between(at(2.0, -1.0, 80.0), at(2.5, -1.2, 83.0));
        for (value, expected) in [(off.roll_deg, 0.5), (off.pitch_deg, -0.2), (off.heading_deg, 3.0)] {
            assert!((value - expected).abs() < 0.01, "{off:?}");
        }
    }
}
