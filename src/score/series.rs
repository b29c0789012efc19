//! Estimates with their times, stored compactly.

use super::packed::Packed;
use crate::geometry::Attitude;
use glam::DQuat;
use std::ops::Range;

/// Attitudes (body to nav) with their times (ns), in the given order: 24 bytes each.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Series {
    times: Vec<i64>,
    attitudes: Vec<Packed>,
}

impl Series {
    /// A series of rows of time (ns) and attitude; normalises each quaternion.
    pub fn new(rows: impl IntoIterator<Item = (i64, Attitude)>) -> Series {
        let (times, attitudes) =
            rows.into_iter().map(|(t, attitude)| (t, Packed::new(attitude.q.normalize()))).unzip();
        Series { times, attitudes }
    }

    /// A series of times (ns) and as many attitudes.
    pub fn of(times: Vec<i64>, attitudes: Vec<Packed>) -> Series {
        Series { times, attitudes }
    }

    /// Some of the rows.
    pub fn part(&self, range: Range<usize>) -> Series {
        Series { times: self.times[range.clone()].to_vec(), attitudes: self.attitudes[range].to_vec() }
    }

    /// Adds a row.
    pub fn push(&mut self, t: i64, attitude: Attitude) {
        self.times.push(t);
        self.attitudes.push(Packed::new(attitude.q.normalize()));
    }

    /// The number of rows.
    pub fn len(&self) -> usize {
        self.times.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.times.is_empty()
    }

    /// The times, ns.
    pub fn times(&self) -> &[i64] {
        &self.times
    }

    /// The i-th attitude.
    pub fn attitude(&self, i: usize) -> Attitude {
        self.attitudes[i].attitude()
    }

    /// The rows in the given order.
    pub(super) fn rows(&self) -> impl ExactSizeIterator<Item = (i64, DQuat)> + Clone + '_ {
        self.times.iter().zip(&self.attitudes).map(|(t, q)| (*t, q.quat()))
    }

    /// Every k-th row, so that at most `count` remain.
    pub(super) fn thinned(&self, count: usize) -> Series {
        let every = self.len().div_ceil(count).max(1);
        Series {
            times: self.times.iter().copied().step_by(every).collect(),
            attitudes: self.attitudes.iter().copied().step_by(every).collect(),
        }
    }

    /// The same with each attitude changed.
    pub(super) fn map(&self, change: impl Fn(DQuat) -> DQuat) -> Series {
        let attitudes = self.attitudes.iter().map(|q| Packed::new(change(q.quat()).normalize())).collect();
        Series { times: self.times.clone(), attitudes }
    }

    /// The median interval, ns; `None` for fewer than two rows.
    pub(super) fn median_interval(&self) -> Option<i64> {
        let every = (self.times.len() / 10_000).max(1);
        let pairs = self.times.windows(2).step_by(every);
        let mut steps: Vec<i64> = pairs.map(|pair| pair[1].saturating_sub(pair[0])).collect();
        let middle = steps.len() / 2;
        (!steps.is_empty()).then(|| *steps.select_nth_unstable(middle).1)
    }
}
