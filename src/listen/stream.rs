//! One sensor of a stream: how many, how evenly, by the sender's times and by ours. Memory is fixed.

use crate::report::{HeardSensor, Times};
use crate::sensor::SensorKind;
use crate::time::SimTime;
use crate::wire::samples::{Sample, Source};

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
    /// The newest sample time before the last one, where that was older.
    overtaken: Option<i64>,
    /// Samples that came after a newer one: no gap hides them.
    filled: u64,
    interval: Times,
    sample_interval: Times,
    jitter: Times,
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
            overtaken: None,
            filled: 0,
            interval: Times::new(),
            sample_interval: Times::new(),
            jitter: Times::new(),
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
    pub fn intervals_us(&self) -> Vec<(f64, u64)> {
        self.interval.values()
    }

    /// Takes a sample in that arrived at `now` (ns) in the `read`-th read; `now` is `None` for a recording.
    pub(super) fn take(&mut self, t: Option<SimTime>, now: Option<i64>, read: u64) {
        let arrival = now.and_then(|now| self.arrivals.take(now));
        if let Some(step) = arrival {
            self.interval.record(step);
            self.together += u64::from(read == self.read);
        }
        self.read = read;
        self.count += 1;
        let Some(t) = t else { return };
        self.timed += 1;
        let newest = self.samples.last;
        let Some(step) = self.samples.take(t.0) else { return };
        if step <= 0 {
            self.steps_back += 1;
            self.overtaken = newest.filter(|_| step < 0);
            return;
        }
        // Time goes on from before a step back: that was one sample out of order, and no new beginning.
        let skipped = self.overtaken.take().filter(|newest| t.0 > *newest);
        self.filled += u64::from(skipped.is_some());
        self.sample_interval.record(skipped.map_or(step, |newest| t.0.saturating_sub(newest)));
        if let Some(arrival) = arrival.filter(|_| skipped.is_none()) {
            self.jitter.record(arrival.saturating_sub(step).saturating_abs());
        }
    }

    /// Samples that a gap between two sample times hides: how often the median interval fits into it, less one.
    fn missing(&self) -> Option<u64> {
        let median = self.sample_interval.late()?.p50;
        let hidden = |(gap, count): (f64, u64)| ((gap / median).round() as u64).saturating_sub(1) * count;
        let hidden: u64 = self.sample_interval.values().into_iter().map(hidden).sum();
        Some(hidden.saturating_sub(self.filled))
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
            interval_us: self.interval.interval(),
            sample_interval_us: self.sample_interval.interval(),
            jitter_us: self.jitter.late(),
        }
    }
}
