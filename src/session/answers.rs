//! Estimates that come back: set against the truth, kept.

use super::{Shared, Speed};
use crate::geometry::Attitude;
use crate::scene::Plan;
use crate::score::{self, Align, AttitudeError, Figures, Timed};
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

/// How the estimates of a run are judged.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Judging {
    /// What is taken out of them first.
    pub align: Align,
    /// Scene time from which on they count.
    pub settle: SimTime,
}

/// Estimates of all links.
pub(super) struct Heard {
    plan: Arc<Plan>,
    shared: Arc<Shared>,
    speed: Speed,
    /// Whether stream time waits for the other side.
    lockstep: bool,
    /// By link, in the order in which they arrived.
    links: Vec<Vec<Timed>>,
    pub newest: Option<Off>,
}

/// What the estimates amount to.
#[derive(Debug, Default)]
pub(super) struct Judgement {
    pub figures: Option<Figures>,
    /// Each estimate, as it was said, with the scene time at which it held as far as that is known.
    pub estimates: Vec<(SimTime, Attitude)>,
}

impl Heard {
    pub(super) fn new(plan: Arc<Plan>, shared: Arc<Shared>, speed: Speed, lockstep: bool) -> Heard {
        Heard { plan, shared, speed, lockstep, links: Vec::new(), newest: None }
    }

    /// Whether it can be told when an estimate held. As fast as the other side reads, an arrival says nothing: some
    /// seconds of the stream may be on their way.
    pub(super) fn is_timed(&self, estimate: &Estimate) -> bool {
        self.speed != Speed::Max || self.lockstep || matches!(estimate.stamp, Stamp::Sample(_))
    }

    /// Keeps an estimate that arrived on a link at `now` (ns on the run's clock); one of the rest before the scene
    /// counts for nothing.
    pub(super) fn take_in(&mut self, link: usize, Estimate { stamp, attitude }: Estimate, now: i64) {
        let arrived = self.stream_time(now);
        let (Some(t), Some(arrival)) = (
            // Until its delay is known an estimate is taken to hold when it arrives.
            self.shared.scene_time(if let Stamp::Sample(t) = stamp { t } else { arrived }),
            self.shared.scene_time(arrived),
        ) else {
            return;
        };
        let stamp = match stamp {
            Stamp::Sample(_) => score::Stamp::Sample(t),
            Stamp::Own(ns) => score::Stamp::Own(ns),
            Stamp::Arrival => score::Stamp::Arrival,
        };
        self.newest = Some(Off::between(self.plan.trajectory.at(t).attitude, attitude));
        if self.links.len() <= link {
            self.links.resize_with(link + 1, Vec::new);
        }
        self.links[link].push(Timed { arrival, stamp, attitude });
    }

    /// Whether there is any.
    pub(super) fn is_empty(&self) -> bool {
        self.links.iter().all(Vec::is_empty)
    }

    /// When the newest arrived, in scene time.
    #[cfg(test)]
    pub(super) fn newest_arrival(&self) -> Option<SimTime> {
        self.links.iter().filter_map(|link| Some(link.last()?.arrival)).max()
    }

    /// Judges the estimates of the link that said most, of a scene that was played up to `played`.
    pub(super) fn judge(&self, judging: Judging, played: SimTime) -> Judgement {
        let Some(said) = self.links.iter().rev().max_by_key(|link| link.len()) else {
            return Judgement::default();
        };
        let truth = |t: SimTime| Some(self.plan.trajectory.at(t.max(SimTime::ZERO)).attitude);
        let Judging { align, settle } = judging;
        let options = score::Options { align, settle, until: played, ..score::Options::default() };
        // Where nothing moves that tells one clock from the other, an estimate holds when it arrives.
        let arrived =
            || said.iter().map(|it| Timed { stamp: score::Stamp::Arrival, ..*it }).collect::<Vec<_>>();
        let judged = score::judge(&truth, said, &options);
        let judged = judged.or_else(|_| score::judge(&truth, &arrived(), &options)).ok();
        let (mut figures, held) = match judged {
            Some(judged) => (Some(judged.figures), judged.held),
            None => (None, said.iter().map(|it| it.arrival).collect()),
        };
        let estimates = held.into_iter().zip(said).map(|(t, it)| (t, it.attitude)).collect();
        if let Some(figures) = &mut figures {
            // What was told in scene time is told in real time, which nobody keeps where nothing is paced.
            figures.delay_ms = match self.speed {
                Speed::Times(times) => figures.delay_ms.map(|ms| ms / times),
                Speed::Max => None,
            };
        }
        Judgement { figures, estimates }
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
    fn at_full_speed_only_what_names_its_sample_or_keeps_step_is_judged() {
        let plan =
            Arc::new(Plan::parse("duration = \"1 s\"\n[gyro]\nrate = \"1 Hz\"\n", "s", "s", &[]).unwrap());
        let heard = |speed, lockstep| Heard::new(plan.clone(), Arc::default(), speed, lockstep);
        let estimate = |stamp| Estimate { stamp, attitude: Attitude::IDENTITY };
        for stamp in [Stamp::Arrival, Stamp::Own(1)] {
            assert!(!heard(Speed::Max, false).is_timed(&estimate(stamp)));
            assert!(heard(Speed::Max, true).is_timed(&estimate(stamp)));
            assert!(heard(Speed::Times(20.0), false).is_timed(&estimate(stamp)));
        }
        assert!(heard(Speed::Max, false).is_timed(&estimate(Stamp::Sample(SimTime::ZERO))));
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
