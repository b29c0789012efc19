//! Counting without allocating: what was sent and dropped, how late, how evenly.

use crate::os;
use crate::report::{SensorReport, Times};
use crate::scene::Plan;
use crate::sensor::SensorKind;
use std::time::Duration;

/// One sensor on one link.
#[derive(Clone, Debug, Default)]
pub(super) struct SensorTally {
    pub sent: u64,
    pub dropped: u64,
    /// When the last one was sent, unless a pause has come since.
    last: Option<i64>,
    /// From the first to the last of each stretch without a pause, summed, ns.
    span: i64,
    late: Times,
    interval: Times,
    write: Times,
}

impl SensorTally {
    /// Counts a sample whose packet was written at `now` (ns), `late` ns after it was due, in `write` ns.
    pub(super) fn sent(&mut self, now: i64, late: i64, write: i64) {
        if let Some(last) = self.last.replace(now) {
            self.interval.record(now - last);
            self.span += now - last;
        }
        self.sent += 1;
        self.late.record(late);
        self.write.record(write);
    }

    /// The time to the next sample is no interval.
    pub(super) fn pause(&mut self) {
        self.last = None;
    }

    /// (n − 1)/(t_last − t_first), numerator and denominator summed over stretches without a pause, Hz.
    fn hz(&self) -> Option<f64> {
        (self.span > 0).then(|| self.interval.count() as f64 / (self.span as f64 * 1e-9))
    }
}

/// How much of a core the calling thread uses, pauses left out.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Effort {
    used: Duration,
    spent: i64,
    since: Option<(Duration, i64)>,
}

impl Effort {
    /// Counts from now (ns) on.
    pub(super) fn resume(&mut self, now: i64) {
        self.since = Some((os::thread_cpu_time(), now));
    }

    /// Counts up to now.
    pub(super) fn pause(&mut self, now: i64) {
        if let Some((used, began)) = self.since.take() {
            self.used += os::thread_cpu_time().saturating_sub(used);
            self.spent += now - began;
        }
    }

    /// The share of a core; `None` before anything was counted.
    pub(super) fn share(&self) -> Option<f64> {
        (self.spent > 0).then(|| self.used.as_secs_f64() / (self.spent as f64 * 1e-9))
    }
}

/// One link.
#[derive(Clone, Debug)]
pub(super) struct LinkTally {
    pub packets: u64,
    pub bytes: u64,
    pub dropped: u64,
    pub sensors: [SensorTally; 3],
}

impl LinkTally {
    pub(super) fn new() -> LinkTally {
        LinkTally { packets: 0, bytes: 0, dropped: 0, sensors: Default::default() }
    }
}

/// Every sensor's report: counts summed over links, histograms merged; `made` and `queued` are by kind.
/// `paced` says whether lateness means anything.
pub(super) fn sensors(
    plan: &Plan,
    tallies: &[LinkTally],
    made: [u64; 3],
    queued: [u64; 3],
    paced: bool,
) -> Vec<SensorReport> {
    plan.sensors
        .iter()
        .map(|sensor| report(sensor.kind, sensor.rate.as_hz(), tallies, made, queued, paced))
        .collect()
}

fn report(
    kind: SensorKind,
    rate_hz: f64,
    tallies: &[LinkTally],
    made: [u64; 3],
    queued: [u64; 3],
    paced: bool,
) -> SensorReport {
    let mut all = SensorTally::default();
    let mut sent_hz = None;
    for tally in tallies.iter().map(|link| &link.sensors[kind as usize]) {
        all.sent += tally.sent;
        all.dropped += tally.dropped;
        all.late.add(&tally.late);
        all.interval.add(&tally.interval);
        all.write.add(&tally.write);
        sent_hz = sent_hz.or(tally.hz());
    }
    SensorReport {
        name: kind.name().to_string(),
        rate_hz,
        sent_hz: sent_hz.filter(|_| paced),
        received_hz: None,
        made: made[kind as usize],
        sent: all.sent,
        dropped: all.dropped,
        queued: queued[kind as usize],
        late_us: all.late.late().filter(|_| paced),
        interval_us: all.interval.interval().filter(|_| paced),
        write_us: all.write.spread(),
        timing: None,
    }
}
