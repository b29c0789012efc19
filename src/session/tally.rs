//! Counting without allocating: what was sent and dropped, how late, how evenly.

use crate::report::{Interval, Late, SensorReport, Spread};
use crate::scene::Plan;
use crate::sensor::SensorKind;
use crate::wire::Packet;
use hdrhistogram::Histogram;

/// The longest time told apart, ns; longer ones count as this.
const LONGEST: u64 = 60_000_000_000;

/// One sensor on one link.
#[derive(Clone, Debug)]
pub(super) struct SensorTally {
    pub sent: u64,
    pub dropped: u64,
    first: i64,
    last: i64,
    late: Histogram<u64>,
    interval: Histogram<u64>,
    write: Histogram<u64>,
}

impl SensorTally {
    pub(super) fn new() -> SensorTally {
        // The bounds are constants that the library accepts; three digits keep percentiles within 0.1 %.
        let histogram =
            || Histogram::new_with_bounds(1, LONGEST, 3).unwrap_or_else(|_| unreachable!("constant bounds"));
        SensorTally {
            sent: 0,
            dropped: 0,
            first: 0,
            last: 0,
            late: histogram(),
            interval: histogram(),
            write: histogram(),
        }
    }

    /// Counts a sample whose packet was written at `now` (ns), `late` ns after it was due, in `write` ns.
    pub(super) fn sent(&mut self, now: i64, late: i64, write: i64) {
        if self.sent == 0 {
            self.first = now;
        } else {
            self.interval.saturating_record((now - self.last).max(0) as u64);
        }
        self.last = now;
        self.sent += 1;
        self.late.saturating_record(late.max(0) as u64);
        self.write.saturating_record(write.max(0) as u64);
    }
}

#[cfg(test)]
impl SensorTally {
    /// How many times lateness was recorded.
    pub(super) fn lateness_count(&self) -> u64 {
        self.late.len()
    }

    /// The greatest lateness, ns, within the histogram's 0.1 %.
    pub(super) fn latest_ns(&self) -> i64 {
        self.late.max() as i64
    }
}

/// One link.
#[derive(Clone, Debug)]
pub(super) struct LinkTally {
    pub packets: u64,
    pub bytes: u64,
    pub dropped: u64,
    pub sensors: [SensorTally; 3],
    pub gaps: Gaps,
    /// When its first and its last packet were sent, ns, and the bytes of the last.
    first: i64,
    last: i64,
    last_bytes: u64,
}

impl LinkTally {
    pub(super) fn new() -> LinkTally {
        LinkTally {
            packets: 0,
            bytes: 0,
            dropped: 0,
            sensors: [0; 3].map(|_| SensorTally::new()),
            gaps: Gaps::default(),
            first: 0,
            last: 0,
            last_bytes: 0,
        }
    }

    /// Counts a packet as sent at `now`, `late` ns after it was due, in a call of `write` ns.
    pub(super) fn sent(&mut self, packet: &Packet, now: i64, late: i64, write: i64) {
        self.gaps.end(now);
        if self.packets == 0 {
            self.first = now;
        }
        (self.last, self.last_bytes) = (now, packet.bytes().len() as u64);
        self.packets += 1;
        self.bytes += self.last_bytes;
        let sensors = self.sensors.iter_mut().enumerate();
        for (_, sensor) in sensors.filter(|(i, _)| packet.carries >> i & 1 == 1) {
            sensor.sent(now, late, write);
        }
    }

    /// Counts a packet as dropped; how many samples that is.
    pub(super) fn dropped(&mut self, packet: &Packet) -> u64 {
        let sensors = self.sensors.iter_mut().enumerate();
        let lost =
            sensors.filter(|(i, _)| packet.carries >> i & 1 == 1).map(|(_, sensor)| sensor.dropped += 1);
        let samples = lost.count() as u64;
        self.dropped += 1;
        if self.gaps.since.is_some() {
            self.gaps.dropped += 1;
            self.gaps.samples += samples;
        }
        samples
    }

    /// Counts the samples as dropped that newer ones replaced before this packet; how many.
    pub(super) fn replaced(&mut self, packet: &Packet) -> u64 {
        let pairs = self.sensors.iter_mut().zip(packet.replaced);
        pairs
            .map(|(sensor, replaced)| {
                sensor.dropped += u64::from(replaced);
                u64::from(replaced)
            })
            .sum()
    }

    /// Bytes a second between its first and its last packet; `None` before there are two.
    pub(super) fn bytes_per_s(&self) -> Option<f64> {
        let span = (self.last - self.first) as f64 * 1e-9;
        (span > 0.0).then(|| (self.bytes - self.last_bytes) as f64 / span)
    }
}

/// When a port was pulled out.
#[derive(Clone, Debug, Default)]
pub(super) struct Gaps {
    pub count: u64,
    pub total_ns: i64,
    /// Packets dropped meanwhile, and the samples in them.
    pub dropped: u64,
    pub samples: u64,
    since: Option<i64>,
}

impl Gaps {
    /// The port was found gone.
    pub(super) fn begin(&mut self, now: i64) {
        if self.since.is_none() {
            self.since = Some(now);
            self.count += 1;
        }
    }

    /// It took a packet again, or nothing more is to be sent.
    pub(super) fn end(&mut self, now: i64) {
        if let Some(since) = self.since.take() {
            self.total_ns += now - since;
        }
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
    let mut all = SensorTally::new();
    let mut sent_hz = None;
    for tally in tallies.iter().map(|link| &link.sensors[kind as usize]) {
        all.sent += tally.sent;
        all.dropped += tally.dropped;
        // Equal bounds: adding cannot fail.
        let _ = all.late.add(&tally.late);
        let _ = all.interval.add(&tally.interval);
        let _ = all.write.add(&tally.write);
        if tally.sent > 1 && tally.last > tally.first {
            sent_hz = sent_hz.or(Some((tally.sent - 1) as f64 / ((tally.last - tally.first) as f64 * 1e-9)));
        }
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
        late_us: (paced && !all.late.is_empty()).then(|| late(&all.late)),
        interval_us: (paced && !all.interval.is_empty()).then(|| interval(&all.interval)),
        write_us: (!all.write.is_empty()).then(|| spread(&all.write)),
    }
}

fn us(ns: u64) -> f64 {
    ns as f64 / 1000.0
}

fn late(histogram: &Histogram<u64>) -> Late {
    Late {
        min: us(histogram.min()),
        p50: us(histogram.value_at_quantile(0.5)),
        p99: us(histogram.value_at_quantile(0.99)),
        p99_9: us(histogram.value_at_quantile(0.999)),
        max: us(histogram.max()),
    }
}

fn interval(histogram: &Histogram<u64>) -> Interval {
    let Late { min, p50, p99, p99_9, max } = late(histogram);
    Interval { min, std: histogram.stdev() / 1000.0, p50, p99, p99_9, max }
}

fn spread(histogram: &Histogram<u64>) -> Spread {
    let Late { p50, p99, max, .. } = late(histogram);
    Spread { p50, p99, max }
}
