//! Counting without allocating: what was sent and dropped, how late, how evenly.

use crate::os;
use crate::report::{SensorReport, Times};
use crate::scene::Plan;
use crate::sensor::{ByKind, SensorKind};
use crate::wire::Packet;
use std::time::Duration;

/// One sensor on one link.
#[derive(Clone, Debug, Default)]
pub(super) struct SensorTally {
    pub sent: u64,
    pub dropped: u64,
    /// Those of them that a newer one replaced.
    pub replaced: u64,
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

#[cfg(test)]
impl SensorTally {
    /// How many times lateness was recorded.
    pub(super) fn lateness_count(&self) -> u64 {
        self.late.count()
    }

    /// The greatest lateness, ns, within the histogram's 0.1 %.
    pub(super) fn latest_ns(&self) -> i64 {
        self.late.late().map_or(0, |late| (late.max * 1e3) as i64)
    }
}

/// One link.
#[derive(Clone, Debug)]
pub(super) struct LinkTally {
    pub packets: u64,
    pub bytes: u64,
    pub dropped: u64,
    /// Packets beside the stream: answers, requests, a farewell.
    pub replies: u64,
    pub sensors: ByKind<SensorTally>,
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
            replies: 0,
            sensors: Default::default(),
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
                sensor.replaced += u64::from(replaced);
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
    made: ByKind<u64>,
    queued: ByKind<u64>,
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
    made: ByKind<u64>,
    queued: ByKind<u64>,
    paced: bool,
) -> SensorReport {
    let mut all = SensorTally::default();
    let mut sent_hz = None;
    for tally in tallies.iter().map(|link| &link.sensors[kind as usize]) {
        all.sent += tally.sent;
        all.dropped += tally.dropped;
        all.replaced += tally.replaced;
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
        replaced: all.replaced,
        queued: queued[kind as usize],
        late_us: all.late.late().filter(|_| paced),
        interval_us: all.interval.interval().filter(|_| paced),
        write_us: all.write.spread(),
        timing: None,
    }
}
