//! Attitudes over time, thinned to a bounded number.

use crate::geometry::{Attitude, AttitudeError};
use crate::time::SimTime;

/// Attitudes that were told, with how far each is off the truth, where that is known.
#[derive(Clone, Debug, Default)]
pub(super) struct Track {
    /// Kept at most.
    most: usize,
    /// One of so many is kept.
    every: u64,
    count: u64,
    /// The one told last, whether it is kept or not.
    last: Option<Fix>,
    pub fixes: Vec<Fix>,
}

/// An attitude at a time.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fix {
    pub t: SimTime,
    pub attitude: Attitude,
    pub error: Option<AttitudeError>,
}

impl Track {
    /// Keeps at most so many.
    pub(super) fn new(most: usize) -> Track {
        Track { most: most.max(2), every: 1, ..Track::default() }
    }

    /// Takes an attitude in.
    pub(super) fn add(&mut self, fix: Fix) {
        self.last = Some(fix);
        if self.count.is_multiple_of(self.every) {
            self.fixes.push(fix);
        }
        self.count += 1;
        if self.fixes.len() > self.most {
            halve(&mut self.fixes);
            self.every *= 2;
        }
    }

    /// What is kept, and the last.
    pub(super) fn with_last(&self) -> Vec<Fix> {
        let kept = self.fixes.last().map(|fix| fix.t);
        let last = self.last.filter(|last| Some(last.t) != kept);
        self.fixes.iter().copied().chain(last).collect()
    }

    /// Takes everything out.
    pub(super) fn take(&mut self) -> Vec<Fix> {
        let fixes = self.with_last();
        *self = Track::new(self.most);
        fixes
    }
}

/// Leaves every second one of a list, from the first on.
pub(super) fn halve<T>(list: &mut Vec<T>) {
    let mut stays = false;
    list.retain(|_| {
        stays = !stays;
        stays
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_track_is_even_and_ends_with_the_last() {
        let mut track = Track::new(100);
        let fix = |k: i64| Fix { t: SimTime(k), attitude: Attitude::IDENTITY, error: None };
        (0..100_000).for_each(|k| track.add(fix(k)));
        let t: Vec<i64> = track.with_last().iter().map(|fix| fix.t.0).collect();
        assert!(t.len() <= 102 && t.len() > 40 && t.last() == Some(&99_999), "{}", t.len());
        let steps: Vec<i64> = t.windows(2).rev().skip(1).map(|pair| pair[1] - pair[0]).collect();
        assert!(steps.windows(2).all(|pair| pair[0] == pair[1]), "{steps:?}");
        assert_eq!(track.take().len(), t.len());
        assert!(track.with_last().is_empty());
    }
}
