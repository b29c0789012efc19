//! The truth on an even grid: for a search that looks at it a million times.

use super::judge::Truth;
use crate::geometry::{angle_between, log};
use crate::time::SimTime;
use glam::{DQuat, DVec3};

/// The finest grid, ns.
const STEP: i64 = 2_000_000;
/// The most points; a longer run has a wider grid.
const POINTS: i64 = 200_000;

/// Attitudes at even times, between them interpolated.
pub(super) struct Sampled {
    from: i64,
    step: i64,
    points: Vec<DQuat>,
}

impl Sampled {
    /// Of `[from, to]`, ns; empty where there is nothing between them.
    pub fn new(truth: Truth<'_>, from: i64, to: i64) -> Sampled {
        let span = to.saturating_sub(from);
        let step = STEP.max(span / POINTS);
        let count = if span < 0 { 0 } else { span / step + 1 };
        let points = (0..count).map(|i| truth(SimTime(from + i * step)).q).collect();
        Sampled { from, step, points }
    }

    /// At `t` ns, by the chord: on a grid so fine the arc is no different.
    pub fn at(&self, t: i64) -> Option<DQuat> {
        let (i, share) = self.place(t)?;
        let a = self.points[i];
        let Some(&b) = self.points.get(i + 1) else { return (share == 0.0).then_some(a) };
        let b = if a.dot(b) < 0.0 { -b } else { b };
        Some((a * (1.0 - share) + b * share).normalize())
    }

    /// Angular rate at `t` ns in nav axes, rad/s.
    pub fn rate(&self, t: i64) -> Option<DVec3> {
        let (i, _) = self.place(t)?;
        let (a, b) = (self.points[i], *self.points.get(i + 1)?);
        Some(log(b * a.conjugate()) / (self.step as f64 * 1e-9))
    }

    /// Whether it never turns, but for a thousandth of a rad.
    pub fn is_still(&self) -> bool {
        self.points.first().is_some_and(|first| self.points.iter().all(|q| angle_between(*first, *q) < 1e-3))
    }

    fn place(&self, t: i64) -> Option<(usize, f64)> {
        let past = t.checked_sub(self.from)?;
        let i = usize::try_from(past.div_euclid(self.step)).ok()?;
        (i < self.points.len()).then(|| (i, past.rem_euclid(self.step) as f64 / self.step as f64))
    }
}
