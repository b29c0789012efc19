//! Estimates that come back: compared with the truth, and kept.

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
    /// The alignment to remove first.
    pub align: Align,
    /// Scene time from which estimates count.
    pub settle: SimTime,
}

/// Places and judges the estimates of all links.
pub(super) struct Heard {
    plan: Arc<Plan>,
    shared: Arc<Shared>,
    speed: Speed,
    /// Whether stream time waits for the other side.
    lockstep: bool,
    /// The newest estimate of all, and its error.
    pub newest: Option<(Attitude, Off)>,
}

/// The verdict on the estimates.
#[derive(Debug, Default)]
pub(super) struct Judgement {
    pub figures: Option<Figures>,
    /// Each estimate as received, with the scene time at which it held, as far as known.
    pub estimates: Vec<(SimTime, Attitude)>,
}

impl Heard {
    pub(super) fn new(plan: Arc<Plan>, shared: Arc<Shared>, speed: Speed, lockstep: bool) -> Heard {
        Heard { plan, shared, speed, lockstep, newest: None }
    }

    /// Scene time at `now`, ns on the run's clock; `None` before the scene.
    pub(super) fn scene_time(&self, now: i64) -> Option<SimTime> {
        self.shared.scene_time(self.stream_time(now))
    }

    /// Whether the time at which an estimate held can be known. At full speed an arrival time says nothing: seconds
    /// of the stream may still be in the buffers.
    pub(super) fn is_timed(&self, estimate: &Estimate) -> bool {
        self.speed != Speed::Max || self.lockstep || matches!(estimate.stamp, Stamp::Sample(_))
    }

    /// How far an estimate at `now`, ns, is off the vehicle at rest before the scene; `None` once that is over.
    pub(super) fn off_rest(&self, estimate: &Estimate, now: i64) -> Option<Off> {
        let at_rest = self.scene_time(now).is_none();
        let truth = || self.plan.trajectory.at(SimTime::ZERO).attitude;
        at_rest.then(|| Off::between(truth(), estimate.attitude))
    }

    /// Places an estimate that arrived at `now` (ns on the run's clock) in scene time. `None` for an estimate from
    /// the rest before the scene.
    pub(super) fn take_in(&mut self, Estimate { stamp, attitude }: Estimate, now: i64) -> Option<Timed> {
        let arrived = self.stream_time(now);
        // Until its delay is known, an estimate counts as held when it arrives.
        let t = self.shared.scene_time(if let Stamp::Sample(t) = stamp { t } else { arrived })?;
        let arrival = self.shared.scene_time(arrived)?;
        let stamp = match stamp {
            Stamp::Sample(_) => score::HeldAt::Sample(t),
            Stamp::Own(ns) => score::HeldAt::Own(ns),
            Stamp::Arrival => score::HeldAt::Arrival,
        };
        self.newest = Some((attitude, Off::between(self.plan.trajectory.at(t).attitude, attitude)));
        Some(Timed { arrival, stamp, attitude })
    }

    /// Judges the estimates of one link, of a scene that played up to `played`.
    pub(super) fn judge(&self, said: &[Timed], judging: Judging, played: SimTime) -> Judgement {
        let truth = |t: SimTime| Some(self.plan.trajectory.at(t.max(SimTime::ZERO)).attitude);
        let Judging { align, settle } = judging;
        let options = score::Options { align, settle, until: played, ..score::Options::default() };
        // Without motion nothing relates the two clocks, so an estimate counts as held when it arrives.
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
            // The delay is in scene time; the report gives real time, which an unpaced run does not have.
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
