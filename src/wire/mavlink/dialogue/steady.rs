//! Whether an attitude estimate has settled.

use crate::geometry::{Attitude, Nav, Vector};
use crate::time::NANOS;
use glam::DVec3;
use std::collections::VecDeque;

/// How far roll and pitch may spread, rad: 0.2°.
const SPREAD: f64 = 0.2 * std::f64::consts::PI / 180.0;
/// For how long they have to keep to it, ns.
const FOR: i64 = 2 * NANOS;
/// A pause after which nothing is known of what lies between, ns.
const GAP: i64 = NANOS / 2;

/// Attitudes nearer to one another than this are kept as one, so that no sender fills the memory, ns.
const GRAIN: i64 = NANOS / 100;

/// The attitudes of the last two seconds.
///
/// What is compared is the direction of down in body axes, which heading does not move: near level its x is −pitch and
/// its y is roll, and it is as good at any other attitude.
#[derive(Debug, Default)]
pub(super) struct Steady {
    grains: VecDeque<Grain>,
    newest: i64,
}

/// The least and greatest of attitudes that came together, the first of them then.
#[derive(Clone, Copy, Debug)]
struct Grain {
    t: i64,
    low: DVec3,
    high: DVec3,
}

impl Steady {
    /// Takes the next attitude and says whether all of the last two seconds keep together.
    pub(super) fn take(&mut self, attitude: Attitude, now: i64) -> bool {
        let down = attitude.inverse().apply(Vector::<Nav>::new(0.0, 0.0, 1.0)).v;
        if now - self.newest > GAP {
            self.grains.clear();
        }
        self.newest = now;
        match self.grains.back_mut().filter(|grain| now - grain.t < GRAIN) {
            Some(grain) => (grain.low, grain.high) = (grain.low.min(down), grain.high.max(down)),
            None => self.grains.push_back(Grain { t: now, low: down, high: down }),
        }
        while self.grains.get(1).is_some_and(|second| now - second.t >= FOR) {
            self.grains.pop_front();
        }
        let low = self.grains.iter().fold(down, |low, grain| low.min(grain.low));
        let high = self.grains.iter().fold(down, |high, grain| high.max(grain.high));
        let covered = self.grains.front().is_some_and(|first| now - first.t >= FOR);
        covered && (high - low).max_element() <= SPREAD
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Euler;

    /// When the first of these attitudes, each 20 ms after the other, is steady; s.
    fn steady_at(attitude: impl Fn(f64) -> [f64; 3]) -> Option<f64> {
        let mut steady = Steady::default();
        (0..500).map(|k| f64::from(k) * 0.02).find(|&t| {
            let [roll, pitch, yaw] = attitude(t).map(f64::to_radians);
            let q = Euler { roll, pitch, yaw }.to_quat();
            steady.take(Attitude::from_quat(q), (t * 1e9) as i64)
        })
    }

    #[test]
    fn an_estimate_is_steady_two_seconds_after_it_has_settled() {
        assert_eq!(steady_at(|_| [0.0, 0.0, 0.0]), Some(2.0));
        let settling = steady_at(|t| [30.0 * (-2.0 * t).exp(), 0.0, 0.0]).unwrap();
        // Within 0.2° of its end from ln(150)/2 = 2.505 s on.
        assert!((4.5..=4.54).contains(&settling), "{settling}");
        assert_eq!(steady_at(|t| [0.0, 0.0, 90.0 * t]), Some(2.0), "heading is not asked for");
        let upside_down = |t: f64| [if (50.0 * t).round() % 2.0 == 0.0 { 179.99 } else { -179.99 }, 0.0, 0.0];
        assert_eq!(steady_at(upside_down), Some(2.0), "nor is ±180° a jump");
    }

    #[test]
    fn an_estimate_that_drifts_or_shakes_never_is() {
        assert_eq!(steady_at(|t| [0.11 * t, 0.0, 0.0]), None);
        assert_eq!(steady_at(|t| [0.0, 0.11 * (60.0 * t).sin(), 0.0]), None);
        assert!(steady_at(|t| [0.09 * t, 0.0, 0.0]).is_some());
    }

    #[test]
    fn a_flood_of_attitudes_does_not_fill_the_memory() {
        let mut steady = Steady::default();
        let shaking =
            |k: i64| Attitude::from_quat(glam::DQuat::from_rotation_x(if k == 15_000 { 0.01 } else { 0.0 }));
        let settled = (0..40_000).filter(|k| steady.take(shaking(*k), k * NANOS / 10_000)).count();
        assert!(steady.grains.len() <= 202, "{}", steady.grains.len());
        // Of 4 s, the 2 s after the one that is off, at 1.5 s, are not steady; a grain is 10 ms.
        assert!((4_800..=5_000).contains(&settled), "{settled}");
    }

    #[test]
    fn a_pause_begins_it_anew() {
        let mut steady = Steady::default();
        let level = Attitude::IDENTITY;
        assert!(!steady.take(level, 0));
        assert!(!steady.take(level, 3 * NANOS), "one before and one after are no stretch");
    }
}
