//! One sensor of a stream: its count and evenness, by the sender's times and by ours. Memory is fixed.

use super::pace::{Evidence, Pace};
use crate::report::{HeardSensor, Times};
use crate::sensor::SensorKind;
use crate::wire::samples::{Sample, Source};

/// A clock of 32 bits wraps after this long: in µs and in ms, given in ns.
const WRAPS: [i64; 2] = [(1 << 32) * 1000, (1 << 32) * 1_000_000];

/// How far apart two consecutive samples around a wrap may be, ns.
const AROUND: i64 = 10_000_000_000;

/// A gap in the sequence numbers explains a gap in the times up to this length, ns; a longer one means that the
/// sender restarted.
const LONGEST_LOSS: i64 = 60_000_000_000;

/// One sensor of a stream.
#[derive(Clone, Debug)]
pub struct Stream {
    name: String,
    kind: SensorKind,
    source: Source,
    count: u64,
    /// The newest arrival time, ns.
    arrived: Option<i64>,
    /// The total time between arrivals, and the number of intervals.
    arrivals: (i64, u64),
    /// The newest sample time, ns, with wraps added.
    sampled: Option<i64>,
    /// The total of the wraps of the sender's clock, ns.
    wrapped: i64,
    /// The number of lost packets at the newest sample.
    lost: Option<u64>,
    read: u64,
    /// Samples that arrived in the same read as the one before; `None` where reads are unknown.
    together: Option<u64>,
    steps_back: u64,
    longest_back: i64,
    /// The newest sample time before the last one, if that was older.
    overtaken: Option<i64>,
    /// Samples that came after a newer one: each fills a gap.
    filled: u64,
    interval: Times,
    pace: Pace,
    jitter: Times,
}

/// The arrival of a sample, as far as known.
#[derive(Clone, Copy, Debug)]
pub(super) struct Arrival {
    /// Arrival time, ns, on any clock; `None` for a recording without stamps.
    pub at: Option<i64>,
    /// Whether it comes from a recording's stamp, whose clock may be set.
    pub stamped: bool,
    /// The number of the read.
    pub read: u64,
}

impl Stream {
    pub(super) fn new(name: String, sample: &Sample) -> Stream {
        Stream {
            name,
            kind: sample.kind,
            source: sample.source,
            count: 0,
            arrived: None,
            arrivals: (0, 0),
            sampled: None,
            wrapped: 0,
            lost: None,
            read: 0,
            together: None,
            steps_back: 0,
            longest_back: 0,
            overtaken: None,
            filled: 0,
            interval: Times::new(),
            pace: Pace::new(),
            jitter: Times::new(),
        }
    }

    pub(super) fn is_of(&self, sample: &Sample) -> bool {
        (self.kind, self.source) == (sample.kind, sample.source)
    }

    /// The kind of sensor.
    pub fn kind(&self) -> SensorKind {
        self.kind
    }

    /// Its name in the report: `gyro`, and `gyro-2` for another gyro on the same link.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Samples so far.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// Intervals between arrivals in µs, each with its count.
    pub fn intervals_us(&self) -> Vec<(f64, u64)> {
        self.interval.values()
    }

    /// Records a sample.
    pub(super) fn take(&mut self, sample: &Sample, arrival: Arrival) {
        self.count += 1;
        let waited =
            arrival.at.and_then(|at| self.arrived.replace(at).map(|before| at.saturating_sub(before)));
        let lossless =
            sample.packet.lost.map(|lost| self.lost.replace(lost).is_some_and(|before| lost <= before));
        let step = sample.t.and_then(|t| self.step(t.0));
        let step = step.and_then(|step| self.go_on(step, waited, lossless));
        if arrival.at.is_some() && !arrival.stamped {
            *self.together.get_or_insert(0) += u64::from(waited.is_some() && arrival.read == self.read);
        }
        self.read = arrival.read;
        let Some(waited) = waited.filter(|waited| !arrival.stamped || self.is_plausible(*waited, step))
        else {
            return;
        };
        self.interval.record(waited);
        self.arrivals = (self.arrivals.0.saturating_add(waited), self.arrivals.1 + 1);
        if let Some(step) = step {
            self.jitter.record(waited.saturating_sub(step).saturating_abs());
        }
    }

    /// The step from the previous sample time, on a clock unwrapped where its 32 bits wrap.
    fn step(&mut self, said: i64) -> Option<i64> {
        let mut t = said.saturating_add(self.wrapped);
        if let Some(before) = self.sampled {
            let step = t.saturating_sub(before);
            let wrapped = |wrap: &i64| said <= AROUND && (1..=AROUND).contains(&step.saturating_add(*wrap));
            let from_before = |wrap: &i64| {
                self.wrapped >= *wrap && (-AROUND..=AROUND).contains(&step.saturating_sub(*wrap))
            };
            if let Some(wrap) = WRAPS.into_iter().find(wrapped) {
                self.wrapped += wrap;
                t += wrap;
            } else if let Some(wrap) = WRAPS.into_iter().find(from_before) {
                t -= wrap;
            }
        }
        self.sampled.replace(t).map(|before| t.saturating_sub(before))
    }

    /// Records a step of the sample time. `waited` is the time between the arrivals; `lossless` says whether the
    /// sequence numbers show no loss; both if known. Returns the step if it is the time between two samples.
    fn go_on(&mut self, step: i64, waited: Option<i64>, lossless: Option<bool>) -> Option<i64> {
        let t = self.sampled?;
        if step <= 0 {
            self.steps_back += 1;
            self.longest_back = self.longest_back.min(step);
            self.overtaken = (step < 0).then(|| t.saturating_sub(step));
            return None;
        }
        // If time goes on from before a step back, that was one sample out of order, not a restart.
        let skipped = self.overtaken.take().map(|newest| t.saturating_sub(newest)).filter(|ahead| *ahead > 0);
        self.filled += u64::from(skipped.is_some());
        let may_lose = lossless == Some(false) && step <= LONGEST_LOSS;
        let went_by = waited.is_some_and(|waited| waited >= step / 2);
        let may_jump = !may_lose && !went_by;
        let evidence = Evidence { may_jump, lossless: lossless == Some(true) };
        self.pace.take(skipped.unwrap_or(step), evidence);
        let follows = skipped.is_none() && !(may_jump && self.pace.is_long(step));
        follows.then_some(step)
    }

    /// Whether a recording's stamps advanced plausibly: not back, and not far ahead unless the sender's clock did.
    fn is_plausible(&self, waited: i64, step: Option<i64>) -> bool {
        waited >= 0 && !(self.pace.is_long(waited) && step.is_some_and(|step| step < waited / 2))
    }

    /// The clock's longest step, s; negative for a step back.
    fn longest_step(&self, forward: i64) -> Option<f64> {
        let longest = if forward > -self.longest_back { forward } else { self.longest_back };
        (longest != 0).then_some(longest as f64 * 1e-9)
    }

    pub(super) fn report(&self) -> HeardSensor {
        let pace = self.pace.settled();
        let (waited, intervals) = self.arrivals;
        let (steps_forward, longest) = pace.jumps();
        HeardSensor {
            name: self.name.clone(),
            source: self.source.to_string(),
            received: self.count,
            rate_hz: pace.rate(),
            received_hz: (waited > 0).then(|| intervals as f64 * 1e9 / waited as f64),
            missing: pace.missing().map(|missing| missing.saturating_sub(self.filled)),
            steps_back: self.steps_back,
            steps_forward,
            longest_step_s: self.longest_step(longest),
            burst_share: self.together.map(|together| together as f64 / (self.count - 1).max(1) as f64),
            interval_us: self.interval.interval(),
            sample_interval_us: pace.steps().interval(),
            jitter_us: self.jitter.late(),
        }
    }
}
