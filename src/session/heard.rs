//! Estimates that come back: set against the truth, kept.

use super::off::Off;
use super::{Shared, Speed};
use crate::geometry::Attitude;
use crate::scene::Plan;
use crate::score::{self, Align, Figures, Timed};
use crate::time::SimTime;
use crate::wire::dialogue::{Estimate, Stamp};
use std::sync::Arc;
use std::sync::atomic::Ordering;

/// How the estimates of a run are judged.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Judging {
    /// What is taken out of them first.
    pub align: Align,
    /// Scene time from which on they count.
    pub settle: SimTime,
}

/// What is made of the estimates of all links.
pub(super) struct Heard {
    plan: Arc<Plan>,
    shared: Arc<Shared>,
    speed: Speed,
    /// Whether stream time waits for the other side.
    lockstep: bool,
    /// How far the newest of all is off.
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
        Heard { plan, shared, speed, lockstep, newest: None }
    }

    /// Whether it can be told when an estimate held. As fast as the other side reads, an arrival says nothing: some
    /// seconds of the stream may be on their way.
    pub(super) fn is_timed(&self, estimate: &Estimate) -> bool {
        self.speed != Speed::Max || self.lockstep || matches!(estimate.stamp, Stamp::Sample(_))
    }

    /// Places an estimate that arrived at `now` (ns on the run's clock) in scene time; one of the rest before the scene
    /// counts for nothing.
    pub(super) fn take_in(&mut self, Estimate { stamp, attitude }: Estimate, now: i64) -> Option<Timed> {
        let arrived = self.stream_time(now);
        // Until its delay is known an estimate is taken to hold when it arrives.
        let t = self.shared.scene_time(if let Stamp::Sample(t) = stamp { t } else { arrived })?;
        let arrival = self.shared.scene_time(arrived)?;
        let stamp = match stamp {
            Stamp::Sample(_) => score::HeldAt::Sample(t),
            Stamp::Own(ns) => score::HeldAt::Own(ns),
            Stamp::Arrival => score::HeldAt::Arrival,
        };
        self.newest = Some(Off::between(self.plan.trajectory.at(t).attitude, attitude));
        Some(Timed { arrival, stamp, attitude })
    }

    /// Judges the estimates of one link, of a scene that was played up to `played`.
    pub(super) fn judge(&self, said: &[Timed], judging: Judging, played: SimTime) -> Judgement {
        let truth = |t: SimTime| Some(self.plan.trajectory.at(t.max(SimTime::ZERO)).attitude);
        let Judging { align, settle } = judging;
        let options = score::Options { align, settle, until: played, ..score::Options::default() };
        // Where nothing moves that tells one clock from the other, an estimate holds when it arrives.
        let arrived =
            || said.iter().map(|it| Timed { stamp: score::HeldAt::Arrival, ..*it }).collect::<Vec<_>>();
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
            _ => self.shared.sent(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
}
