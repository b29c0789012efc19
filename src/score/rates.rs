//! Angular rates on an even grid: they agree for two series of attitudes, whatever constant error one of them has.
//!
//! The body's rate over a cell is the mean of `log(qᵢ* ⊗ qᵢ₊₁)` over the rows within it. A constant turn of the nav
//! axes does not change it, one of the body axes rotates it, and neither changes its magnitude.

use crate::geometry::log;
use glam::{DQuat, DVec3};
use std::ops::Range;

/// Mean angular rates in body axes, rad/s: value `i` covers `width` cells from `first + i` on.
pub(super) struct Rates {
    /// The index of the first cell; cell `k` starts at `k·step`.
    pub first: i64,
    /// Length of a cell, ns.
    pub step: i64,
    pub values: Vec<DVec3>,
    /// Whether rows determine the rate.
    pub known: Vec<bool>,
}

impl Rates {
    /// Rates of rows in time order (ns), with even turning between them; across more than `gap` ns they are
    /// unknown.
    pub fn of(rows: impl Iterator<Item = (i64, DQuat)>, step: i64, width: usize, gap: i64) -> Rates {
        let mut edges = Edges { first: None, step, turned: Vec::new(), unknown: Vec::new() };
        let mut last: Option<(i64, DQuat)> = None;
        let (mut turned, mut unknown) = (DVec3::ZERO, 0i64);
        for (t, q) in rows {
            let Some((from, before)) = last.replace((t, q)) else { continue };
            let turn = log(before.conjugate() * q);
            let lost = if t - from > gap { t - from } else { 0 };
            edges.pass(from..t, (turned, turn), (unknown, lost));
            turned += turn;
            unknown += lost;
        }
        edges.rates(width)
    }

    /// The largest magnitude, rad/s.
    pub fn fastest(&self) -> f64 {
        self.known().map(|rate| rate.length()).fold(0.0, f64::max)
    }

    /// The known rates.
    pub fn known(&self) -> impl Iterator<Item = DVec3> + '_ {
        self.values.iter().zip(&self.known).filter(|(_, known)| **known).map(|(rate, _)| *rate)
    }

    /// Treats rates above `limit` rad/s as jumps, and marks them as unknown.
    pub fn without_jumps(mut self, limit: f64) -> Rates {
        for (rate, known) in self.values.iter().zip(&mut self.known) {
            *known &= rate.length() <= limit;
        }
        self
    }
}

/// The turn so far, and the unknown time so far, at the edges of the cells.
struct Edges {
    first: Option<i64>,
    step: i64,
    turned: Vec<DVec3>,
    unknown: Vec<f64>,
}

impl Edges {
    /// Fills the edges within a time in which both grow evenly; each pair is the start value and the increase.
    fn pass(&mut self, time: Range<i64>, turned: (DVec3, DVec3), unknown: (i64, i64)) {
        let first = *self.first.get_or_insert(
            time.start.div_euclid(self.step) + i64::from(time.start.rem_euclid(self.step) > 0),
        );
        loop {
            let edge = (first + self.turned.len() as i64) * self.step;
            if edge >= time.end {
                break;
            }
            let share = (edge - time.start) as f64 / (time.end - time.start) as f64;
            self.turned.push(turned.0 + turned.1 * share);
            self.unknown.push(unknown.0 as f64 + unknown.1 as f64 * share);
        }
    }

    fn rates(self, width: usize) -> Rates {
        let span = self.step as f64 * 1e-9 * width as f64;
        let pairs = |edges: usize| (0..edges.saturating_sub(width)).map(move |i| (i, i + width));
        Rates {
            first: self.first.unwrap_or(0),
            step: self.step,
            values: pairs(self.turned.len()).map(|(a, b)| (self.turned[b] - self.turned[a]) / span).collect(),
            known: pairs(self.unknown.len()).map(|(a, b)| self.unknown[b] == self.unknown[a]).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::exp;

    const MS: i64 = 1_000_000;

    #[test]
    fn an_even_turn_has_its_rate_in_every_cell_on_any_rows() {
        let rate = DVec3::new(0.3, -0.2, 0.1);
        let times = (0..400).map(|k| 7 * MS + k * 11 * MS + k % 3 * MS);
        let start = exp(DVec3::new(0.4, 1.0, -2.0));
        let rows = times.map(|t| (t, start * exp(rate * (t as f64 * 1e-9))));
        let rates = Rates::of(rows, 20 * MS, 5, 250 * MS);
        assert!(rates.values.len() > 200 && rates.first == 1);
        for (value, known) in rates.values.iter().zip(&rates.known) {
            assert!(*known && (*value - rate).length() < 1e-9, "{value}");
        }
    }

    #[test]
    fn of_a_gap_and_of_a_jump_nothing_is_known() {
        let turn = |t: i64| exp(DVec3::X * (0.5 * t as f64 * 1e-9 + if t > 4000 * MS { 1.0 } else { 0.0 }));
        let rows = (0..600).map(|k| 10 * MS * k).filter(|t| !(1000 * MS..2000 * MS).contains(t));
        let rates = Rates::of(rows.map(|t| (t, turn(t))), 20 * MS, 5, 250 * MS).without_jumps(1.2);
        let cell = |t: i64| (t / 20 - rates.first) as usize;
        for (t, known) in [(500, true), (1500, false), (2500, true), (3960, false), (4100, true)] {
            assert_eq!(rates.known[cell(t)], known, "{t} ms");
        }
        assert!((rates.fastest() - 0.5).abs() < 1e-9);
    }
}
