//! The times of a log's rows: the rows around a time, gaps, and derivatives at a row.

use crate::time::SimTime;
use glam::DVec3;
use std::ops::Range;

/// Times in order, starting at 0; at least two.
#[derive(Debug)]
pub(super) struct Grid {
    times: Vec<SimTime>,
    /// The median of the intervals.
    pub median: SimTime,
}

/// The number of rows for a derivative.
const NEAR: usize = 5;

impl Grid {
    pub(super) fn new(times: Vec<SimTime>) -> Grid {
        let mut intervals: Vec<_> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let middle = intervals.len() / 2;
        let median = *intervals.select_nth_unstable(middle).1;
        Grid { times, median }
    }

    /// The time of a row.
    pub(super) fn at(&self, row: usize) -> SimTime {
        self.times[row]
    }

    /// The number of rows.
    pub(super) fn len(&self) -> usize {
        self.times.len()
    }

    /// The time of the last row.
    pub(super) fn end(&self) -> SimTime {
        self.times[self.times.len() - 1]
    }

    /// The interval from row `i` to the next, s.
    pub(super) fn interval(&self, i: usize) -> f64 {
        (self.times[i + 1] - self.times[i]).seconds()
    }

    /// Whether rows are missing after row `i`: the interval is more than three times the median.
    pub(super) fn is_gap(&self, i: usize) -> bool {
        (self.times[i + 1] - self.times[i]).0 > self.median.0.saturating_mul(3)
    }

    /// The last row at or before `t`, except the very last. Rows are mostly even, so the search starts where it
    /// would be on an even grid.
    pub(super) fn before(&self, t: SimTime) -> usize {
        let last = self.len() - 2;
        let share = t.0 as f64 / self.end().0 as f64;
        let guess = ((share * (self.len() - 1) as f64) as usize).min(last);
        for i in [guess, guess.saturating_sub(1), (guess + 1).min(last)] {
            if self.times[i] <= t && t < self.times[i + 1] {
                return i;
            }
        }
        self.times.partition_point(|row| *row <= t).saturating_sub(1).min(last)
    }

    /// The first row after `t`.
    pub(super) fn next(&self, t: SimTime) -> Option<SimTime> {
        if t < SimTime::ZERO {
            return self.times.first().copied();
        }
        (t < self.end()).then(|| self.times[self.before(t) + 1])
    }

    /// The nearest rows around row `i` without a gap between, five if there are that many.
    fn near(&self, i: usize) -> Range<usize> {
        let (mut from, mut to) = (i, i + 1);
        while from > 0 && i - from < NEAR - 1 && !self.is_gap(from - 1) {
            from -= 1;
        }
        while to < self.len() && to - i < NEAR && !self.is_gap(to - 1) {
            to += 1;
        }
        let first = i.saturating_sub(NEAR / 2).max(from).min(to.saturating_sub(NEAR)).max(from);
        first..to.min(first + NEAR)
    }

    /// The first and second derivative of `value(row, near)` at each row; it is called for the rows near it.
    pub(super) fn derivatives(
        &self,
        mut value: impl FnMut(usize, usize) -> DVec3,
        mut take: impl FnMut(DVec3, DVec3),
    ) {
        let mut last = (Vec::new(), [[0.0; 2]; NEAR]);
        for i in 0..self.len() {
            let near = self.near(i);
            let apart = near.clone().map(|j| self.times[j].0 - self.times[i].0);
            if !apart.clone().eq(last.0.iter().copied()) {
                let x: Vec<f64> = apart.clone().map(|ns| SimTime(ns).seconds()).collect();
                last = (apart.collect(), weights(&x));
            }
            let (mut first, mut second) = (DVec3::ZERO, DVec3::ZERO);
            for (j, [w1, w2]) in near.zip(last.1) {
                let value = value(i, j);
                first += value * w1;
                second += value * w2;
            }
            take(first, second);
        }
    }
}

/// The weights of the first and second derivative at 0 of the polynomial through values at `x`: B. Fornberg,
/// *Generation of finite difference formulas on arbitrarily spaced grids*, Math. Comp. 51(184), 1988.
fn weights(x: &[f64]) -> [[f64; 2]; NEAR] {
    let mut c = [[0.0; 3]; NEAR];
    c[0][0] = 1.0;
    let mut before = 1.0;
    for i in 1..x.len() {
        let mut product = 1.0;
        for j in 0..i {
            let apart = x[i] - x[j];
            product *= apart;
            for k in (0..3).rev() {
                let lower = |c: [f64; 3]| if k > 0 { k as f64 * c[k - 1] } else { 0.0 };
                if j == i - 1 {
                    c[i][k] = before * (lower(c[j]) - x[j] * c[j][k]) / product;
                }
                c[j][k] = (x[i] * c[j][k] - lower(c[j])) / apart;
            }
        }
        before = product;
    }
    c.map(|[_, first, second]| [first, second])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(ms: &[i64]) -> Grid {
        Grid::new(ms.iter().map(|ms| SimTime(ms * 1_000_000)).collect())
    }

    #[test]
    fn derivatives_of_a_quartic_are_exact_on_any_grid_up_to_gaps() {
        for ms in [&[0, 10, 20, 30, 40, 50, 60][..], &[0, 7, 20, 33, 35, 50, 61, 70], &[0, 5, 11, 15, 21]] {
            let grid = grid(ms);
            let quartic = |t: f64| DVec3::new(3.0 * t - 2.0, t * t - 4.0 * t * t * t, 7.0 * t * t * t * t);
            let at = |i: usize| grid.at(i).seconds();
            let mut i = 0;
            grid.derivatives(
                |_, j| quartic(at(j)),
                |first, second| {
                    let t = at(i);
                    let exact = DVec3::new(3.0, 2.0 * t - 12.0 * t * t, 28.0 * t * t * t);
                    assert!((first - exact).length() < 1e-11, "{first} against {exact} at {t} s");
                    let exact = DVec3::new(0.0, 2.0 - 24.0 * t, 84.0 * t * t);
                    assert!((second - exact).length() < 1e-8, "{second} against {exact} at {t} s");
                    i += 1;
                },
            );
            assert_eq!(i, ms.len());
        }
    }

    #[test]
    fn rows_across_a_gap_are_not_near() {
        let grid = grid(&[0, 10, 20, 300, 310, 320, 330, 340, 350]);
        assert!(grid.is_gap(2) && !grid.is_gap(1) && !grid.is_gap(3));
        let near: Vec<_> = (0..9).map(|i| grid.near(i)).collect();
        assert_eq!(near[..4], [0..3, 0..3, 0..3, 3..8]);
        assert_eq!(near[5..], [3..8, 4..9, 4..9, 4..9]);
    }

    #[test]
    fn the_row_before_a_time_is_found_on_uneven_grids() {
        let grid = grid(&[0, 1, 2, 3, 4, 500, 501, 1000]);
        for ns in (0..1_000_000_000).step_by(333_333) {
            let (t, i) = (SimTime(ns), grid.before(SimTime(ns)));
            assert!(grid.at(i) <= t && t < grid.at(i + 1), "{t}");
            assert_eq!(grid.next(t), Some(grid.at(i + 1)));
        }
        assert_eq!((grid.before(grid.end()), grid.next(grid.end())), (6, None));
    }
}
