//! Durations counted in fixed memory, and their percentiles for a report.

use super::{Interval, Late, Spread};
use hdrhistogram::Histogram;

/// The longest duration to distinguish, ns; longer ones count as this.
const LONGEST: u64 = 60_000_000_000;

/// A histogram of durations from 1 ns to a minute whose percentiles are within 0.1 %; counting allocates nothing.
#[derive(Clone, Debug)]
pub struct Times(Histogram<u64>);

impl Default for Times {
    fn default() -> Times {
        Times::new()
    }
}

impl Times {
    /// An empty histogram.
    pub fn new() -> Times {
        // The bounds are constants that the library accepts; three digits are 0.1 %.
        Times(Histogram::new_with_bounds(1, LONGEST, 3).unwrap_or_else(|_| unreachable!("constant bounds")))
    }

    /// Counts a duration, ns; a negative one counts as 0.
    pub fn record(&mut self, ns: i64) {
        self.0.saturating_record(ns.max(0) as u64);
    }

    /// Adds the counts of another.
    pub fn add(&mut self, other: &Times) {
        // Equal bounds: adding cannot fail.
        let _ = self.0.add(&other.0);
    }

    /// The number of durations.
    pub fn count(&self) -> u64 {
        self.0.len()
    }

    /// The mean, ns; 0 where nothing was counted.
    pub fn mean_ns(&self) -> f64 {
        self.0.mean()
    }

    /// How many were longer than `ns`.
    pub fn above(&self, ns: i64) -> u64 {
        self.0.count_between(ns.max(0) as u64 + 1, LONGEST)
    }

    /// As lateness, µs; `None` if nothing was counted.
    pub fn late(&self) -> Option<Late> {
        let at = |share| us(self.0.value_at_quantile(share));
        let late = Late {
            min: us(self.0.min()),
            p50: at(0.5),
            p99: at(0.99),
            p99_9: at(0.999),
            max: us(self.0.max()),
        };
        (self.count() > 0).then_some(late)
    }

    /// As intervals, µs.
    pub fn interval(&self) -> Option<Interval> {
        let Late { min, p50, p99, p99_9, max } = self.late()?;
        Some(Interval { min, std: self.0.stdev() / 1000.0, p50, p99, p99_9, max })
    }

    /// As durations, µs.
    pub fn spread(&self) -> Option<Spread> {
        let Late { p50, p99, max, .. } = self.late()?;
        Some(Spread { p50, p99, max })
    }

    /// Every distinct value, µs, with its count, for a chart.
    pub fn values(&self) -> Vec<(f64, u64)> {
        self.0.iter_recorded().map(|step| (us(step.value_iterated_to()), step.count_at_value())).collect()
    }
}

fn us(ns: u64) -> f64 {
    ns as f64 / 1000.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_are_those_of_the_sorted_values_to_a_thousandth() {
        // Squares give a distribution with a tail; the order is scrambled.
        let mut values: Vec<i64> = (0..10_000).map(|i| (i * 7919 % 10_000i64).pow(2)).collect();
        let mut times = Times::new();
        values.iter().for_each(|&ns| times.record(ns));
        values.sort();
        let late = times.late().unwrap();
        for (share, found) in [(0.5, late.p50), (0.99, late.p99), (0.999, late.p99_9), (1.0, late.max)] {
            let exact = values[(share * 10_000.0) as usize - 1] as f64 / 1000.0;
            assert!((found / exact - 1.0).abs() < 1e-3, "{share}: {found} for {exact}");
        }
        assert_eq!(late.min, 0.0);
        let above = values.iter().filter(|&&ns| ns > 25_000_000).count() as f64;
        assert!((times.above(25_000_000) as f64 / above - 1.0).abs() < 2e-3);
    }

    #[test]
    fn nothing_counted_is_nothing_known_and_what_is_off_the_scale_still_counts() {
        let mut times = Times::new();
        assert!(times.late().is_none() && times.spread().is_none());
        times.record(-5);
        times.record(i64::MAX);
        let late = times.late().unwrap();
        assert_eq!((times.count(), late.min), (2, 0.0));
        assert!((late.max / 60e6 - 1.0).abs() < 1e-3);
    }
}
