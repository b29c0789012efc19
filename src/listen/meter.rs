//! From bytes and their arrival times to rates, intervals, losses and damage. No clock, no I/O.

use super::stream::{Arrival, Stream};
use crate::report::{HeardLink, HeardSensor};
use crate::sensor::SensorKind;
use crate::time::SimTime;
use crate::wire::Protocol;
use crate::wire::samples::{Counts, Sample, Samples, Sensed};
use ratetable_protocols::mavlink::STAMP_LEN;
use std::fmt;

/// The most sensors to distinguish on one link.
const STREAMS: usize = 32;

/// Bytes kept until the first packet, to identify another protocol.
const KEPT: usize = 16_384;

/// The number of packets that identify a protocol.
const ENOUGH: u64 = 3;

/// What a sample said.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Value {
    /// The index of its sensor among the [streams](Meter::streams).
    pub stream: usize,
    /// When it was taken by the sender's clock, if the packet says so.
    pub t: Option<SimTime>,
    /// The value.
    pub sensed: Sensed,
}

/// Measures one stream of bytes.
pub struct Meter {
    samples: Samples,
    recorded: bool,
    streams: Vec<Stream>,
    reads: u64,
    first: Option<i64>,
    last: Option<i64>,
    /// What the samples said since it was taken last, where that is kept.
    values: Option<Vec<Value>>,
    /// Bytes of the first read: they arrived before the first interval began.
    before: u64,
    kept: Vec<u8>,
}

impl fmt::Debug for Meter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Meter").field("counts", self.counts()).finish_non_exhaustive()
    }
}

impl Meter {
    /// A meter for a stream of which only the protocol is known.
    pub fn new(protocol: Protocol) -> Meter {
        Meter::of(Samples::new(protocol), false)
    }

    /// A meter for a recording, which may contain the arrival times of its packets: a `.tlog`.
    pub fn recorded(protocol: Protocol) -> Meter {
        Meter::of(Samples::recorded(protocol), true)
    }

    fn of(samples: Samples, recorded: bool) -> Meter {
        Meter {
            samples,
            recorded,
            streams: Vec::new(),
            reads: 0,
            first: None,
            last: None,
            values: None,
            before: 0,
            kept: Vec::new(),
        }
    }

    /// Processes the bytes of one read at `now` (ns, on a clock that never goes back). `now` is `None` for a
    /// recording, where the arrival time has no meaning.
    pub fn arrived(&mut self, bytes: &[u8], now: Option<i64>) {
        if self.reads == 0 {
            self.before = bytes.len() as u64;
        }
        self.reads += 1;
        self.first = self.first.or(now);
        self.last = now.or(self.last);
        let Meter { samples, streams, reads, kept, values, .. } = self;
        samples.feed(bytes, |sample| {
            let stream = take(streams, sample, now, *reads);
            if let (Some(values), Some(sensed)) = (values.as_mut(), sample.value) {
                values.push(Value { stream, t: sample.t, sensed });
            }
        });
        match samples.counts().packets {
            0 => kept.extend(bytes.iter().take(KEPT - kept.len())),
            _ => *kept = Vec::new(),
        }
    }

    /// Reads what is held of a last packet; the stream has ended.
    pub fn finish(&mut self) {
        let Meter { samples, streams, reads, last, .. } = self;
        samples.finish(|sample| {
            take(streams, sample, *last, *reads);
        });
    }

    /// From now on keeps what the samples say.
    pub fn keep_values(&mut self) {
        self.values = Some(Vec::new());
    }

    /// What the samples said since this was called last; empty unless it [is kept](Meter::keep_values).
    pub fn take_values(&mut self) -> Vec<Value> {
        self.values.as_mut().map(std::mem::take).unwrap_or_default()
    }

    /// The counts so far.
    pub fn counts(&self) -> &Counts {
        self.samples.counts()
    }

    /// Each sensor heard, in order of its first sample.
    pub fn streams(&self) -> &[Stream] {
        &self.streams
    }

    /// Time from the first to the last read or stamp without steps of the stamps, s; `None` for a recording without
    /// stamps.
    pub fn duration_s(&self) -> Option<f64> {
        let stamped = self.counts().stamps.map(|stamps| stamps.span_ns);
        Some(
            stamped.or(self.last.zip(self.first).map(|(last, first)| last.saturating_sub(first)))? as f64
                * 1e-9,
        )
    }

    /// Another protocol that matches bytes without a packet of the expected one.
    pub fn reads_as(&self) -> Option<Protocol> {
        let makes_packets = |protocol: &Protocol| {
            let mut samples =
                if self.recorded { Samples::recorded(*protocol) } else { Samples::new(*protocol) };
            samples.feed(&self.kept, |_| {});
            samples.finish(|_| {});
            let counts = samples.counts();
            counts.packets >= ENOUGH && counts.packets > counts.damaged
        };
        Protocol::STREAMS.into_iter().find(makes_packets)
    }

    /// Each sensor's report, in the order gyro, accel, mag.
    pub fn sensors(&self) -> Vec<HeardSensor> {
        let of = |kind: SensorKind| self.streams.iter().filter(move |stream| stream.kind() == kind);
        SensorKind::ALL.into_iter().flat_map(of).map(Stream::report).collect()
    }

    /// The link's report. `to` is the link as requested, `name` as opened; `baud` is given where a rate applies.
    pub fn link(&self, to: String, name: String, baud: Option<u32>) -> HeardLink {
        let counts = self.counts().clone();
        // The first read brings bytes that gathered earlier, so the rate counts the bytes after it. Stamps were not
        // on the link.
        let after = match counts.stamps {
            Some(_) => counts.bytes.saturating_sub(STAMP_LEN as u64 * counts.packets),
            None => counts.bytes - self.before,
        };
        let bytes_per_s = self.duration_s().filter(|span| *span > 0.0).map(|span| after as f64 / span);
        HeardLink {
            attitudes: None,
            to,
            name,
            packets: counts.packets,
            bytes: counts.bytes,
            bytes_per_s,
            // 8N1: ten bits a byte.
            utilisation: baud.and_then(|baud| Some(10.0 * bytes_per_s? / f64::from(baud))),
            crc_errors: counts.damaged,
            lost_seq: counts.numbered.then_some(counts.lost),
            duplicates: counts.numbered.then_some(counts.duplicates),
            out_of_order: counts.numbered.then_some(counts.out_of_order),
            joined_midway: counts.joined_midway,
            unchecked: counts.unchecked,
            stamp_steps: counts.stamps.map(|stamps| stamps.steps),
            foreign: counts.foreign,
        }
    }
}

/// Passes a sample to its stream, whose index it returns. A new stream beyond [`STREAMS`] is merged with the last.
fn take(streams: &mut Vec<Stream>, sample: Sample, now: Option<i64>, read: u64) -> usize {
    let place = streams.iter().position(|stream| stream.is_of(&sample)).unwrap_or_else(|| {
        if streams.len() < STREAMS {
            let before = streams.iter().filter(|stream| stream.kind() == sample.kind).count();
            let name = match before {
                0 => sample.kind.name().to_string(),
                n => format!("{}-{}", sample.kind, n + 1),
            };
            streams.push(Stream::new(name, &sample));
        }
        streams.len() - 1
    });
    let stamp = sample.packet.arrived.map(|t| t.0);
    streams[place].take(&sample, Arrival { at: stamp.or(now), stamped: stamp.is_some(), read });
    place
}
