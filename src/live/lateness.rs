//! Lateness and delivered rate of a sensor over time, in stretches that are joined two by two when there are too many.

use crate::time::SimTime;

/// Parts of a histogram in each doubling of the lateness.
const PARTS: f64 = 8.0;
/// The lateness at which the first part ends, ns: what is earlier counts there.
const FIRST: f64 = 62.5;
/// How many parts: up to 16 s.
const BINS: usize = 224;
/// The shortest stretch, ns.
const STRETCH: i64 = 500_000_000;
/// Stretches kept.
const MOST: usize = 600;

/// Counts by lateness, in parts that are an eighth of a doubling wide: a percentile is within 9 %.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Bins {
    counts: Vec<u64>,
    /// The greatest, ns.
    max: i64,
}

impl Default for Bins {
    fn default() -> Bins {
        Bins { counts: vec![0; BINS], max: 0 }
    }
}

impl Bins {
    /// The bounds of the parts, µs: one more than there are parts.
    pub(super) fn edges_us() -> Vec<f64> {
        let edge = |i: usize| if i == 0 { 0.0 } else { Bins::end(i - 1) * 1e-3 };
        (0..=BINS).map(edge).collect()
    }

    /// Where a part ends, ns.
    fn end(i: usize) -> f64 {
        FIRST * libm::exp2(i as f64 / PARTS)
    }

    fn record(&mut self, ns: i64) {
        let place = libm::ceil(PARTS * libm::log2((ns.max(1) as f64 / FIRST).max(1.0)));
        self.counts[(place as usize).min(BINS - 1)] += 1;
        self.max = self.max.max(ns);
    }

    fn add(&mut self, other: &Bins) {
        self.counts.iter_mut().zip(&other.counts).for_each(|(sum, count)| *sum += count);
        self.max = self.max.max(other.max);
    }

    /// How many in each part.
    pub(super) fn counts(&self) -> &[u64] {
        &self.counts
    }

    /// How many in all.
    pub(super) fn count(&self) -> u64 {
        self.counts.iter().sum()
    }

    /// What a share of the samples is not later than, µs: the end of the part that it lies in, the greatest at most.
    fn quantile_us(&self, share: f64) -> f64 {
        let wanted = libm::ceil(share * self.count() as f64) as u64;
        let mut seen = 0;
        let part = self.counts.iter().position(|count| {
            seen += *count;
            seen >= wanted
        });
        part.map_or(self.max as f64, Bins::end).min(self.max as f64) * 1e-3
    }
}

/// A stretch of time.
#[derive(Clone, Debug)]
struct Stretch {
    /// Scene time of its first sample and of its last.
    t: (SimTime, SimTime),
    /// When those were sent, ns.
    sent: (i64, i64),
    /// Samples sent.
    count: u64,
    bins: Bins,
}

/// A point for a chart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Point {
    /// The middle of the stretch, in scene time.
    pub t: SimTime,
    /// Samples a second: (n − 1)/(t_last − t_first); `None` of a single sample.
    pub hz: Option<f64>,
    pub p50_us: f64,
    pub p99_us: f64,
    pub max_us: f64,
}

/// One sensor's lateness.
#[derive(Clone, Debug)]
pub(super) struct Lateness {
    width: i64,
    stretches: Vec<Stretch>,
    /// Of all samples.
    pub all: Bins,
    /// Stretches that were given out: how many, and how wide they were.
    given: usize,
}

impl Default for Lateness {
    fn default() -> Lateness {
        Lateness { width: STRETCH, stretches: Vec::new(), all: Bins::default(), given: 0 }
    }
}

impl Lateness {
    /// A sample of the scene time `t` was due at `due` and sent at `sent`, ns.
    pub(super) fn record(&mut self, t: SimTime, due: i64, sent: i64) {
        self.all.record(sent - due);
        let place = |t: SimTime| t.0.div_euclid(self.width);
        match self.stretches.last_mut().filter(|last| place(last.t.0) == place(t)) {
            Some(last) => {
                (last.t.1, last.sent.1) = (t, sent);
                last.count += 1;
                last.bins.record(sent - due);
            }
            None => {
                let mut bins = Bins::default();
                bins.record(sent - due);
                self.stretches.push(Stretch { t: (t, t), sent: (sent, sent), count: 1, bins });
            }
        }
        if self.stretches.len() > MOST {
            self.widen();
        }
    }

    fn widen(&mut self) {
        self.width *= 2;
        let mut joined: Vec<Stretch> = Vec::with_capacity(MOST);
        for stretch in std::mem::take(&mut self.stretches) {
            let place = |t: SimTime| t.0.div_euclid(self.width);
            match joined.last_mut().filter(|last| place(last.t.0) == place(stretch.t.0)) {
                Some(last) => {
                    (last.t.1, last.sent.1) = (stretch.t.1, stretch.sent.1);
                    last.count += stretch.count;
                    last.bins.add(&stretch.bins);
                }
                None => joined.push(stretch),
            }
        }
        self.given = self.given.min(joined.len()) / 2;
        self.stretches = joined;
    }

    /// Every stretch.
    pub(super) fn points(&self) -> Vec<Point> {
        self.stretches.iter().map(|it| it.point(self.width)).collect()
    }

    /// The last stretch that is over.
    pub(super) fn latest(&self) -> Option<Point> {
        self.stretches.iter().rev().nth(1).map(|it| it.point(self.width))
    }

    /// The stretches that are over and were not given before.
    pub(super) fn fresh(&mut self) -> Vec<Point> {
        let over = self.stretches.len().saturating_sub(1);
        let from = self.given.min(over);
        self.given = self.given.max(over);
        self.stretches[from..over].iter().map(|it| it.point(self.width)).collect()
    }
}

impl Stretch {
    /// A stretch of this width; those of all sensors have the same middles.
    fn point(&self, width: i64) -> Point {
        let span = (self.sent.1 - self.sent.0) as f64 * 1e-9;
        Point {
            t: SimTime(self.t.0.0.div_euclid(width) * width + width / 2),
            hz: (span > 0.0).then(|| (self.count - 1) as f64 / span),
            p50_us: self.bins.quantile_us(0.5),
            p99_us: self.bins.quantile_us(0.99),
            max_us: self.bins.max as f64 * 1e-3,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MILLI: i64 = 1_000_000;

    /// A minute at 1 kHz, each sample as late as `late` says, ns.
    fn minute(late: impl Fn(i64) -> i64) -> Lateness {
        let mut lateness = Lateness::default();
        (0..60_000).for_each(|k| lateness.record(SimTime(k * MILLI), k * MILLI, k * MILLI + late(k)));
        lateness
    }

    #[test]
    fn percentiles_are_those_of_the_samples_within_a_part() {
        let points = minute(|k| 1000 * (k % 500)).points();
        assert_eq!(points.len(), 120);
        for point in &points {
            assert!(point.p50_us >= 249.0 && point.p50_us < 249.0 * 1.1, "{point:?}");
            assert!(point.p99_us >= 494.0 && point.p99_us <= 499.0, "{point:?}");
            assert_eq!(point.max_us, 499.0);
            assert!((point.hz.unwrap() - 1000.0).abs() < 2.0, "{point:?}");
        }
    }

    #[test]
    fn a_day_takes_no_more_room_than_ten_minutes_and_loses_no_sample() {
        let mut lateness = Lateness::default();
        let second = 1000 * MILLI;
        (0..86_400).for_each(|k| lateness.record(SimTime(k * second), k * second, k * second + 5000));
        assert!(lateness.points().len() <= MOST);
        assert_eq!(lateness.stretches.iter().map(|it| it.count).sum::<u64>(), 86_400);
        assert_eq!(lateness.all.count(), 86_400);
    }

    #[test]
    fn what_is_given_is_over_and_given_once() {
        let mut lateness = minute(|_| 0);
        assert_eq!(lateness.fresh().len(), 119);
        assert_eq!(lateness.fresh(), []);
        lateness.record(SimTime(60_000 * MILLI), 0, 0);
        assert_eq!(lateness.fresh().len(), 1);
    }

    #[test]
    fn each_part_holds_what_lies_between_its_edges() {
        let edges = Bins::edges_us();
        for ns in [0, 1, 62, 63, 80, 1000, 123_456, 50_000_000, i64::MAX] {
            let mut bins = Bins::default();
            bins.record(ns);
            let part = bins.counts().iter().position(|count| *count == 1).unwrap();
            let us = ns as f64 * 1e-3;
            assert!(edges[part] <= us, "{ns}: {part}");
            assert!(us <= edges[part + 1] || part == BINS - 1, "{ns}: {part}");
        }
    }
}
