//! Counts without allocating: packets sent and dropped, lateness, evenness.

use super::gaps::Gaps;
use crate::report::Times;
use crate::sensor::ByKind;
use crate::wire::Packet;

/// The counts of one sensor on one link.
#[derive(Clone, Debug, Default)]
pub(super) struct SensorTally {
    pub sent: u64,
    pub dropped: u64,
    /// Dropped samples that a newer one replaced.
    pub replaced: u64,
    /// Those of the sent that are in a packet as part of a mean.
    pub merged: u64,
    /// When the last one was sent, unless a pause followed.
    last: Option<i64>,
    /// Time from first to last of each stretch without a pause, summed, ns.
    span: i64,
    pub late: Times,
    pub interval: Times,
    pub write: Times,
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

    /// The time to the next sample does not count as an interval.
    pub(super) fn pause(&mut self) {
        self.last = None;
    }

    /// Adds another link's counts of the same sensor, except its rate.
    pub(super) fn add(&mut self, other: &SensorTally) {
        self.sent += other.sent;
        self.dropped += other.dropped;
        self.replaced += other.replaced;
        self.merged += other.merged;
        self.late.add(&other.late);
        self.interval.add(&other.interval);
        self.write.add(&other.write);
    }

    /// (n − 1)/(t_last − t_first), numerator and denominator summed over stretches without a pause, Hz.
    pub(super) fn hz(&self) -> Option<f64> {
        (self.span > 0).then(|| self.interval.count() as f64 / (self.span as f64 * 1e-9))
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

/// The counts of one link.
#[derive(Clone, Debug, Default)]
pub(super) struct Tally {
    pub packets: u64,
    pub bytes: u64,
    pub dropped: u64,
    /// Packets beside the stream: replies, requests, a farewell.
    pub replies: u64,
    pub sensors: ByKind<SensorTally>,
    pub gaps: Gaps,
    /// Packets of the scene that the other side answers, where it answers each.
    pub asked: u64,
    /// When the scene's first packet was sent, ns.
    scene_began: Option<i64>,
    /// When its first and last packets were sent, ns, and the bytes of the last.
    first: i64,
    last: i64,
    last_bytes: u64,
    /// Those of the sent that were put with others since the clock was read.
    gathered: u64,
}

impl Tally {
    /// Counts a packet as sent at `now`, `late` ns after it was due, in a call of `write` ns.
    pub(super) fn sent(&mut self, packet: &Packet, now: i64, late: i64, write: i64) {
        self.gaps.end(now);
        if self.packets == 0 {
            self.first = now;
        }
        (self.last, self.last_bytes) = (now, packet.bytes().len() as u64);
        self.packets += 1;
        self.bytes += self.last_bytes;
        for kind in packet.carries.iter() {
            self.sensors[kind as usize].sent(now, late, write);
        }
        self.merged(packet);
    }

    /// Counts the samples that a sent packet carries as part of a mean.
    fn merged(&mut self, packet: &Packet) {
        if packet.merges {
            for (sensor, merged) in self.sensors.iter_mut().zip(packet.replaced) {
                sensor.sent += u64::from(merged);
                sensor.merged += u64::from(merged);
            }
        }
    }

    /// Counts a packet as sent that was put with others since `began`, without a look at the clock: nothing is paced
    /// then, so there is no lateness, and there was no call to measure.
    #[inline]
    pub(super) fn gathered(&mut self, packet: &Packet, began: i64) {
        if self.packets == 0 {
            self.first = began;
        }
        self.last_bytes = packet.size() as u64;
        self.packets += 1;
        self.bytes += self.last_bytes;
        self.gathered += 1;
        for kind in packet.carries.iter() {
            self.sensors[kind as usize].sent += 1;
        }
        self.merged(packet);
    }

    /// The packets gathered since the last call were sent by `now`; returns how many.
    pub(super) fn gathered_by(&mut self, now: i64) -> u64 {
        self.last = now;
        std::mem::take(&mut self.gathered)
    }

    /// Counts the packet sent at `now` as one of the scene; `asks` is whether the other side answers such packets.
    pub(super) fn in_scene(&mut self, now: i64, asks: bool) {
        self.scene_began.get_or_insert(now);
        self.asked += u64::from(asks);
    }

    /// How long the scene was sent, and when its last packet went out, ns.
    pub(super) fn scene(&self) -> (i64, i64) {
        (self.scene_began.map_or(0, |began| self.last - began), self.last)
    }

    /// Counts a packet as dropped; returns its number of samples.
    pub(super) fn dropped(&mut self, packet: &Packet) -> u64 {
        for kind in packet.carries.iter() {
            self.sensors[kind as usize].dropped += 1;
        }
        let mut samples = packet.carries.len() as u64;
        if packet.merges {
            for (sensor, merged) in self.sensors.iter_mut().zip(packet.replaced) {
                sensor.dropped += u64::from(merged);
                samples += u64::from(merged);
            }
        }
        self.dropped += 1;
        self.gaps.lost(samples);
        samples
    }

    /// Counts the samples that newer ones replaced before this packet as dropped; returns how many.
    pub(super) fn replaced(&mut self, packet: &Packet) -> u64 {
        if packet.merges || packet.replaced.iter().all(|&replaced| replaced == 0) {
            return 0;
        }
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
