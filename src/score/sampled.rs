//! The truth on an even grid, for a search that reads it a million times.

use super::given::Truth;
use crate::geometry::log;
use crate::time::SimTime;
use glam::DQuat;

/// The finest grid, ns.
const STEP: i64 = 2_000_000;
/// The most points; a longer run gets a coarser grid.
const POINTS: i64 = 200_000;

/// Attitudes at even times, interpolated between; `None` where unknown.
pub(super) struct Sampled {
    from: i64,
    step: i64,
    points: Vec<Option<DQuat>>,
}

impl Sampled {
    /// The truth over `[from, to]`, ns; empty if the interval is empty.
    pub fn new(truth: Truth<'_>, from: i64, to: i64) -> Sampled {
        let span = to.saturating_sub(from);
        let step = STEP.max(span / POINTS);
        let count = if span < 0 { 0 } else { span / step + 1 };
        let points = (0..count).map(|i| truth(SimTime(from + i * step)).map(|at| at.q)).collect();
        Sampled { from, step, points }
    }

    /// The attitude at `t` ns, by the chord: on such a fine grid its difference from the arc is negligible.
    pub fn at(&self, t: i64) -> Option<DQuat> {
        let past = t.checked_sub(self.from)?;
        let i = usize::try_from(past.div_euclid(self.step)).ok()?;
        let share = past.rem_euclid(self.step) as f64 / self.step as f64;
        let a = (*self.points.get(i)?)?;
        let Some(&Some(b)) = self.points.get(i + 1) else { return (share == 0.0).then_some(a) };
        let b = if a.dot(b) < 0.0 { -b } else { b };
        Some((a * (1.0 - share) + b * share).normalize())
    }

    /// The known points, with their times in ns.
    pub fn rows(&self) -> impl Iterator<Item = (i64, DQuat)> + '_ {
        (0..).zip(&self.points).filter_map(|(i, point)| Some((self.from + i * self.step, (*point)?)))
    }

    /// The interval between points, ns.
    pub fn step(&self) -> i64 {
        self.step
    }

    /// The largest angular rate from point to point, rad/s.
    pub fn fastest(&self) -> f64 {
        let pairs = self.points.windows(2).filter_map(|pair| Some((pair[0]?, pair[1]?)));
        let fastest = pairs.map(|(a, b)| log(a.conjugate() * b).length()).fold(0.0, f64::max);
        fastest / (self.step as f64 * 1e-9)
    }
}
