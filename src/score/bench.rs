//! The truth, and errors of estimates against it at a time shift.

use super::align::Frames;
use super::delay::{self, Fit};
use super::figures::{Errors, Tally};
use super::given::{Clock, Options, Row, Truth};
use super::sampled::Sampled;
use super::series::Series;
use super::{Align, AttitudeError};
use crate::geometry::{Attitude, Euler};
use crate::time::SimTime;
use glam::DQuat;
use std::f64::consts::TAU;
use std::ops::Range;

/// The range of the delay search, ns.
pub(super) const DELAYS: Range<i64> = -500_000_000..2_000_000_000;
/// Its step: a motion of 60 Hz still has its dip between two steps.
pub(super) const STEP: i64 = 4_000_000;
/// The number of estimates to determine a constant rotation.
const ALIGNED: usize = 100_000;

/// The truth and the options.
pub(super) struct Bench<'a> {
    pub truth: Truth<'a>,
    pub options: Options,
    pub grid: Sampled,
}

impl Bench<'_> {
    /// A bench for estimates between the first and the last of these times. Only with `search` can it find a delay.
    pub fn new<'a>(truth: Truth<'a>, series: &Series, options: Options, search: bool) -> Option<Bench<'a>> {
        let times = series.times();
        let (first, last) = (*times.iter().min()?, *times.iter().max()?);
        let (mut from, mut until) = (options.from.0.saturating_sub(options.rest.0), options.until.0);
        if options.clock == Clock::Truth {
            from = from.max(first.saturating_sub(DELAYS.end));
            until = until.min(last.saturating_sub(DELAYS.start));
        }
        let mut bench = Bench { truth, options, grid: Sampled::new(truth, 0, -1) };
        if search {
            bench.grid = Sampled::new(&|t| bench.around(t.0).map(Attitude::from_quat), from, until);
        }
        Some(bench)
    }

    /// The truth at a time, including the rest before the scene.
    pub fn around(&self, t: i64) -> Option<DQuat> {
        let Options { from, until, rest, .. } = self.options;
        let t = SimTime(t);
        let known = from.0.saturating_sub(rest.0) <= t.0 && t <= until;
        if known { (self.truth)(t.max(from)).map(|truth| truth.q) } else { None }
    }

    /// The truth at a time where estimates count.
    fn at(&self, t: i64) -> Option<DQuat> {
        let Options { from, until, settle, .. } = self.options;
        let t = SimTime(t);
        if from + settle <= t && t <= until { (self.truth)(t).map(|truth| truth.q) } else { None }
    }

    /// The delay of a series on the truth's clock, searched in steps of `step` ns.
    pub fn delay(&self, series: &Series, step: i64) -> Option<Fit> {
        delay::within(&self.grid, &|t| self.around(t), series, DELAYS, step)
    }

    /// Pairs of estimate and truth for a series whose clock is `ahead`, where the truth is known.
    fn pairs<'s>(
        &'s self,
        series: &'s Series,
        ahead: i64,
    ) -> impl Iterator<Item = (SimTime, DQuat, DQuat)> + Clone + 's {
        series.rows().filter_map(move |(t, q)| {
            let held = t.saturating_sub(ahead);
            Some((SimTime(held), q, self.at(held)?))
        })
    }

    /// The root mean square of the total error, rad; `None` if no estimate has a truth.
    pub fn rms(&self, series: &Series, ahead: i64) -> Option<f64> {
        let frames = self.frames(series, ahead, self.options.align);
        let (mut sum, mut count) = (0.0, 0u64);
        for (_, q, truth) in self.pairs(series, ahead) {
            let angle = crate::geometry::angle_between(frames.undone(q), truth);
            sum += angle * angle;
            count += 1;
        }
        (count > 0).then(|| libm::sqrt(sum / count as f64))
    }

    /// The constant rotations of a series.
    pub fn frames(&self, series: &Series, ahead: i64, align: Align) -> Frames {
        if align == Align::None {
            return Frames::SAME;
        }
        let thin = series.thinned(ALIGNED);
        Frames::of(align, self.pairs(&thin, ahead).map(|(_, q, truth)| (q, truth)))
    }

    /// Each estimate with its error.
    pub fn rows<'s>(
        &'s self,
        series: &'s Series,
        ahead: i64,
        frames: Frames,
    ) -> impl Iterator<Item = Row> + 's {
        self.pairs(series, ahead).map(move |(t, q, truth)| {
            let attitude = Attitude::from_quat(frames.undone(q));
            let truth = Attitude::from_quat(truth);
            Row { t, attitude, truth, error: AttitudeError::between(truth, attitude) }
        })
    }

    /// All errors of a series, the number of estimates, and the part of the truth's time that they cover.
    pub fn errors(&self, series: &Series, ahead: i64, frames: Frames) -> Option<(Errors, u64, Coverage)> {
        let (mut tally, mut covered) = (Tally::default(), Covered::new(series));
        for row in self.rows(series, ahead, frames) {
            covered.take(row.t.0);
            tally.add(&row.error, self.angles(&row));
        }
        let Options { from, until, settle, .. } = self.options;
        (tally.count > 0).then(|| (tally.errors(), tally.count, covered.of((until - from - settle).0)))
    }

    /// The differences of roll, pitch and yaw in the estimate's own axes, rad in [−π, π].
    fn angles(&self, row: &Row) -> [f64; 3] {
        let of = |attitude: Attitude| Euler::from_quat(self.options.axes.attitude_out(attitude));
        let (a, b) = (of(row.attitude), of(row.truth));
        [a.roll - b.roll, a.pitch - b.pitch, a.yaw - b.yaw]
            .map(|angle| angle - TAU * libm::round(angle / TAU))
    }
}

/// Which part of the truth's time rows cover.
#[derive(Clone, Copy, Debug)]
pub(super) struct Coverage {
    /// From 0 to 1, without gaps.
    pub share: f64,
    /// The first and the last row, ns.
    pub ends: [i64; 2],
}

/// The time that rows cover.
struct Covered {
    /// Rows further apart than this leave a gap, ns.
    gap: i64,
    interval: i64,
    /// The first row and the last.
    ends: Option<[i64; 2]>,
    sum: i64,
}

impl Covered {
    fn new(series: &Series) -> Covered {
        let interval = series.median_interval().unwrap_or(0).max(0);
        Covered { gap: interval.saturating_mul(5).max(250_000_000), interval, ends: None, sum: 0 }
    }

    fn take(&mut self, t: i64) {
        let step = self.ends.map_or(self.interval, |[_, last]| t.saturating_sub(last));
        self.ends = Some([self.ends.map_or(t, |[first, _]| first), t]);
        self.sum += if (0..=self.gap).contains(&step) { step } else { self.interval };
    }

    fn of(&self, whole: i64) -> Coverage {
        let share = (self.sum as f64 / whole.max(1) as f64).min(1.0);
        Coverage { share, ends: self.ends.unwrap_or_default() }
    }
}
