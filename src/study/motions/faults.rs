//! What may happen to samples on the way: taken at the wrong time, or lost.

use super::Path;
use crate::random::stream;
use glam::{DQuat, DVec3};
use rand::Rng;

/// A number in [0, 1) that depends on nothing but `name` and `key`.
fn uniform(name: &str, key: u64) -> f64 {
    (stream(key, name).next_u64() >> 11) as f64 / (1u64 << 53) as f64
}

/// Every sample is taken up to a tenth of a period early or late, and nobody says so.
#[derive(Debug)]
pub struct Jitter<'a> {
    /// The motion.
    pub path: &'a dyn Path,
    /// The sensor's rate, Hz.
    pub hz: f64,
}

impl Jitter<'_> {
    /// The time at which the sample due at `t` is taken: the same however often it is asked.
    fn taken(&self, t: f64) -> f64 {
        t + 0.2 * (uniform("jitter", t.to_bits()) - 0.5) / self.hz
    }
}

impl Path for Jitter<'_> {
    fn attitude(&self, t: f64) -> DQuat {
        self.path.attitude(t)
    }

    fn rate(&self, t: f64) -> DVec3 {
        self.path.rate(self.taken(t))
    }

    fn increment(&self, from: f64, to: f64) -> DVec3 {
        self.path.increment(self.taken(from), self.taken(to))
    }
}

/// One sample in a hundred is lost, and the one before it is used again.
#[derive(Debug)]
pub struct Gaps<'a> {
    /// The motion.
    pub path: &'a dyn Path,
    /// The sensor's rate, Hz.
    pub hz: f64,
}

impl Gaps<'_> {
    /// How many periods before `t` the last sample was not lost.
    fn age(&self, t: f64) -> f64 {
        // A sample belongs to the period it starts or falls in; a billionth absorbs the rounding of t.
        let period = (t * self.hz + 1e-9).floor();
        let lost = |age: &f64| *age < period && uniform("gaps", (period - age) as u64) < 0.01;
        (0..).map(f64::from).find(|age| !lost(age)).unwrap_or(0.0) / self.hz
    }
}

impl Path for Gaps<'_> {
    fn attitude(&self, t: f64) -> DQuat {
        self.path.attitude(t)
    }

    fn rate(&self, t: f64) -> DVec3 {
        self.path.rate(t - self.age(t))
    }

    fn increment(&self, from: f64, to: f64) -> DVec3 {
        let age = self.age(from);
        self.path.increment(from - age, to - age)
    }
}

#[cfg(test)]
mod tests {
    use super::super::Turn;
    use super::*;

    #[test]
    fn a_lost_sample_is_the_last_one_again() {
        let gaps = Gaps { path: &Turn::degrees(1.0, DVec3::X), hz: 100.0 };
        let ages =
            |c: f64| (0..10_000).map(move |k| f64::from(k) + c).map(|k| gaps.age(k / gaps.hz)).collect();
        let (starts, middles): (Vec<f64>, Vec<f64>) = (ages(0.0), ages(0.5));
        let count = starts.iter().filter(|age| **age > 0.0).count();
        assert!((60..140).contains(&count), "{count} of 10000");
        assert!(starts.iter().all(|age| *age < 0.06) && starts[0] == 0.0);
        assert_eq!(starts, middles, "the middle of a lost period is lost with it");
    }

    #[test]
    fn a_jittered_sample_is_taken_at_the_same_time_however_often_it_is_asked() {
        let jitter = Jitter { path: &Turn::degrees(1.0, DVec3::X), hz: 1000.0 };
        let off: Vec<_> = (0..10_000).map(|k| f64::from(k) / 1000.0).map(|t| jitter.taken(t) - t).collect();
        assert!(off.iter().all(|off| off.abs() <= 1.001e-4) && off.iter().any(|off| off.abs() > 0.9e-4));
        // Uniform over ±10⁻⁴: the mean's standard deviation is 2·10⁻⁴/√(12·n).
        assert!((off.iter().sum::<f64>() / 1e4).abs() < 4.0 * 2e-4 / (12.0f64 * 1e4).sqrt());
        assert_eq!(jitter.taken(0.5), jitter.taken(0.5));
    }
}
