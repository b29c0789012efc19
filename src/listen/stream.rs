//! One sensor of a stream: how many, how evenly, by the sender's times and by ours. Memory is fixed.

use crate::report::{HeardSensor, Interval, Late};
use crate::sensor::SensorKind;
use crate::time::SimTime;
use crate::wire::samples::{Sample, Source};
use hdrhistogram::Histogram;

/// The longest time told apart, ns; longer ones count as this.
const LONGEST: u64 = 60_000_000_000;

/// One sensor of a stream.
#[derive(Clone, Debug)]
pub struct Stream {
    name: String,
    kind: SensorKind,
    source: Source,
    count: u64,
    arrivals: Ends,
    samples: Ends,
    timed: u64,
    read: u64,
    together: u64,
    steps_back: u64,
    interval: Histogram<u64>,
    sample_interval: Histogram<u64>,
    jitter: Histogram<u64>,
}

/// The first and the last of a row of times, ns.
#[derive(Clone, Copy, Debug, Default)]
struct Ends {
    first: Option<i64>,
    last: Option<i64>,
}

impl Ends {
    /// Takes the next time in; the step from the one before.
    fn take(&mut self, t: i64) -> Option<i64> {
        self.first.get_or_insert(t);
        self.last.replace(t).map(|before| t.saturating_sub(before))
    }

    /// `(n − 1)/(last − first)`, Hz.
    fn rate(&self, count: u64) -> Option<f64> {
        let span = self.last?.saturating_sub(self.first?);
        (count > 1 && span > 0).then(|| (count - 1) as f64 * 1e9 / span as f64)
    }
}

impl Stream {
    pub(super) fn new(name: String, sample: &Sample) -> Stream {
        // The bounds are constants that the library accepts; three digits keep percentiles within 0.1 %.
        let histogram =
            || Histogram::new_with_bounds(1, LONGEST, 3).unwrap_or_else(|_| unreachable!("constant bounds"));
        Stream {
            name,
            kind: sample.kind,
            source: sample.source,
            count: 0,
            arrivals: Ends::default(),
            samples: Ends::default(),
            timed: 0,
            read: 0,
            together: 0,
            steps_back: 0,
            interval: histogram(),
            sample_interval: histogram(),
            jitter: histogram(),
        }
    }

    pub(super) fn is_of(&self, sample: &Sample) -> bool {
        (self.kind, self.source) == (sample.kind, sample.source)
    }

    /// What is sensed.
    pub fn kind(&self) -> SensorKind {
        self.kind
    }

    /// As the report calls it: `gyro`, and `gyro-2` for another gyro on the same link.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Samples so far.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// Intervals between arrivals in µs, each with how often it occurred.
    pub fn intervals_us(&self) -> impl Iterator<Item = (f64, u64)> + '_ {
        recorded(&self.interval)
    }

    /// Takes a sample in that arrived at `now` (ns) in the `read`-th read; `now` is `None` for a recording.
    pub(super) fn take(&mut self, t: Option<SimTime>, now: Option<i64>, read: u64) {
        let arrival = now.and_then(|now| self.arrivals.take(now));
        if let Some(step) = arrival {
            self.interval.saturating_record(step.max(0) as u64);
            self.together += u64::from(read == self.read);
        }
        self.read = read;
        self.count += 1;
        let Some(t) = t else { return };
        self.timed += 1;
        let Some(step) = self.samples.take(t.0) else { return };
        if step <= 0 {
            self.steps_back += 1;
            return;
        }
        self.sample_interval.saturating_record(step as u64);
        if let Some(arrival) = arrival {
            self.jitter.saturating_record(arrival.abs_diff(step));
        }
    }

    /// Samples that a gap between two sample times hides: how often the median interval fits into it, less one.
    fn missing(&self) -> Option<u64> {
        let median = self.sample_interval.value_at_quantile(0.5);
        let hidden = |interval: u64| (interval + median / 2) / median - 1;
        let gaps = self.sample_interval.iter_recorded();
        let long = gaps.map(|gap| (gap.value_iterated_to(), gap.count_at_value()));
        (median > 0).then(|| {
            long.filter(|(interval, _)| *interval > median).map(|(gap, count)| hidden(gap) * count).sum()
        })
    }

    pub(super) fn report(&self) -> HeardSensor {
        let live = self.arrivals.first.is_some();
        HeardSensor {
            name: self.name.clone(),
            source: self.source.to_string(),
            received: self.count,
            rate_hz: self.samples.rate(self.timed),
            received_hz: self.arrivals.rate(self.count),
            missing: self.missing(),
            steps_back: self.steps_back,
            burst_share: live.then(|| self.together as f64 / (self.count - 1).max(1) as f64),
            interval_us: Interval::of_ns(&self.interval),
            sample_interval_us: Interval::of_ns(&self.sample_interval),
            jitter_us: Late::of_ns(&self.jitter),
        }
    }
}

fn recorded(histogram: &Histogram<u64>) -> impl Iterator<Item = (f64, u64)> + '_ {
    histogram.iter_recorded().map(|bin| (bin.value_iterated_to() as f64 / 1000.0, bin.count_at_value()))
}
