//! The stream of any protocol back to samples: what a receiver that knows nothing of the scene can read.
//!
//! Each protocol is one file that hands on every [`Sample`] and counts what came besides ([`Counts`]). Nothing
//! panics on any bytes, memory stays bounded, and damage costs at most itself.

mod damage;
mod log;
mod mavlink;
mod mip;
mod mpu;
mod msp;
mod text;
mod vectornav;

pub use log::Stamps;

use super::Protocol;
use crate::geometry::{Axes, Body, Vector};
use crate::sensor::{Mount, SensorKind};
use crate::time::SimTime;
use ratetable_protocols::Losses;
use std::collections::BTreeMap;
use std::fmt;

/// One sample of one sensor, as a packet says it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// What is sensed.
    pub kind: SensorKind,
    /// Which of several sensors of that kind on the link.
    pub source: Source,
    /// When it was taken by the sender's clock, where the packet says so, in whole µs (text, `vectornav`, `mip`: ns; some
    /// MAVLink messages: ms). The 32 bits of `mpu` and `mip` go on counting here where they wrap.
    pub t: Option<SimTime>,
    /// The reading in body axes, rad/s, m/s² or µT; `None` where the packet does not say what its counts mean
    /// (`mpu` before its first config packet, raw messages, the field in `msp`) or that they mean nothing (an
    /// overflow).
    pub value: Option<Vector<Body>>,
    /// What else is known of its packet.
    pub packet: Carrier,
}

/// What is known of the packet that brings a sample, beside what it says.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Carrier {
    /// When it arrived, since 1970, where a recording says so.
    pub arrived: Option<SimTime>,
    /// How many packets of its sender were lost up to here, where they have numbers.
    pub lost: Option<u64>,
}

/// Who among several sensors of a kind a sample is from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Source {
    /// The MAVLink message, in lower case; the protocol's name for the others, which have one sensor of a kind.
    pub message: &'static str,
    /// The MAVLink system, component and the set of sensors that the message names; 0 for the others.
    pub set: [u8; 3],
}

impl Source {
    /// The only sensor of its kind on the link.
    const fn only(message: &'static str) -> Source {
        Source { message, set: [0; 3] }
    }
}

impl fmt::Display for Source {
    /// `mpu`, `hil_sensor 1/51/0`: the message, and where it matters its system, component and set.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Source { message, set: [system, component, set] } = self;
        match self.set {
            [0, 0, 0] => f.write_str(message),
            _ => write!(f, "{message} {system}/{component}/{set}"),
        }
    }
}

/// A word that makes a sender begin which waits for one: a ground station's heartbeat in MAVLink, and in the other
/// protocols bytes that mean nothing.
pub fn greeting(protocol: Protocol, seq: u8) -> Vec<u8> {
    match protocol {
        Protocol::Mavlink => mavlink::ground_station(seq),
        Protocol::Mpu | Protocol::Mip => vec![0],
        Protocol::Msp => msp::question(),
        Protocol::Vectornav | Protocol::Csv | Protocol::Jsonl => b"\n".to_vec(),
    }
}

/// What the packets do not say, so that a reader has to assume it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Assumed {
    /// The axes that text is written in.
    pub axes: Axes,
    /// From body to the chip's axes, of gyro, accel and mag, for the registers of `mpu`.
    pub mounts: [Mount; 3],
}

impl Default for Assumed {
    /// Forward-right-down, and chips whose x points forward and z up, as the encoders of a plain scene have it.
    fn default() -> Assumed {
        Assumed { axes: Axes::NedFrd, mounts: [Mount::flu(); 3] }
    }
}

/// What a stream has brought so far.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Bytes taken in.
    pub bytes: u64,
    /// Whole packets of the protocol, sensors' or not; a line of text is a packet, the line of names too.
    pub packets: u64,
    /// Packets that fail their checksum or are cut short, and stretches of other bytes. Where several in a row cannot be
    /// told apart, MAVLink's numbers say how many they were; without numbers such a stretch counts as one.
    pub damaged: u64,
    /// 1 if the stream began in the middle of a packet, which is no damage.
    pub joined_midway: u64,
    /// Packets missing by the sequence number, damaged ones included: the number counts modulo 256 for each sender,
    /// so a longer gap counts what is left of it after whole turns. 0 for protocols without a number.
    pub lost: u64,
    /// Packets whose number came twice in a row.
    pub duplicates: u64,
    /// Packets that one with a later number overtook, sixteen places at most; they are not lost.
    pub out_of_order: u64,
    /// Whether packets have a sequence number at all.
    pub numbered: bool,
    /// Packets whose checksum cannot be checked, because their id is beyond the dialects `common` and `ardupilotmega`:
    /// they show no gap, but fill one.
    pub unchecked: u64,
    /// The stamps of a recording that has one in front of each packet.
    pub stamps: Option<Stamps>,
    /// Packets that carry no sample, by name.
    pub foreign: BTreeMap<String, u64>,
}

impl Counts {
    /// As many names of foreign packets as are kept apart.
    const NAMES: usize = 64;

    /// Counts what is no packet: damage, unless the stream was joined there.
    fn refuse(&mut self) {
        let first = self.packets == 0 && self.damaged == 0 && self.joined_midway == 0;
        *if first { &mut self.joined_midway } else { &mut self.damaged } += 1;
    }

    /// Takes in the number of a packet by the sender that `losses` keeps account of.
    fn number(&mut self, losses: &mut Losses, seq: u8) {
        let before = *losses;
        losses.observe(seq);
        self.duplicates += losses.duplicates() - before.duplicates();
        self.out_of_order += losses.out_of_order() - before.out_of_order();
        self.lost = self.lost + losses.lost() - before.lost();
    }

    fn foreign(&mut self, name: &str) {
        if let Some(count) = self.foreign.get_mut(name) {
            *count += 1;
            return;
        }
        let name = if self.foreign.len() < Self::NAMES { name } else { "others" };
        *self.foreign.entry(name.to_string()).or_default() += 1;
    }
}

/// Reads the samples out of one stream of bytes, however it is cut up.
pub struct Samples {
    counts: Counts,
    reader: Reader,
}

enum Reader {
    Mpu(Box<mpu::Reader>),
    Mavlink(Box<mavlink::Reader>),
    Msp(Box<msp::Reader>),
    Vectornav(Box<vectornav::Reader>),
    Mip(Box<mip::Reader>),
    Text(text::Reader),
}

impl Samples {
    /// For a stream of which nothing more is known.
    pub fn new(protocol: Protocol) -> Samples {
        Samples::assuming(protocol, &Assumed::default())
    }

    /// For what was recorded before: the same, and a recording of MAVLink may be a ground station's log (`.tlog`), with a
    /// stamp in front of each packet, which its content tells.
    pub fn recorded(protocol: Protocol) -> Samples {
        match protocol {
            Protocol::Mavlink => Samples::of(Reader::Mavlink(Box::new(mavlink::Reader::recorded()))),
            _ => Samples::new(protocol),
        }
    }

    /// For a stream whose axes are known.
    pub fn assuming(protocol: Protocol, assumed: &Assumed) -> Samples {
        let reader = match protocol {
            Protocol::Mpu => Reader::Mpu(Box::new(mpu::Reader::new(assumed.mounts))),
            Protocol::Mavlink => Reader::Mavlink(Box::default()),
            Protocol::Msp => Reader::Msp(Box::default()),
            Protocol::Vectornav => Reader::Vectornav(Box::default()),
            Protocol::Mip => Reader::Mip(Box::default()),
            Protocol::Csv => Reader::Text(text::Reader::csv(assumed.axes)),
            Protocol::Jsonl => Reader::Text(text::Reader::jsonl(assumed.axes)),
        };
        Samples::of(reader)
    }

    fn of(reader: Reader) -> Samples {
        let numbered = matches!(reader, Reader::Mpu(_) | Reader::Mavlink(_));
        Samples { counts: Counts { numbered, ..Counts::default() }, reader }
    }

    /// Takes bytes in as they arrive and hands on every sample in them, in the order of the bytes.
    pub fn feed(&mut self, bytes: &[u8], mut each: impl FnMut(Sample)) {
        self.counts.bytes += bytes.len() as u64;
        match &mut self.reader {
            Reader::Mpu(reader) => reader.feed(bytes, &mut self.counts, &mut each),
            Reader::Mavlink(reader) => reader.feed(bytes, &mut self.counts, &mut each),
            Reader::Msp(reader) => reader.feed(bytes, &mut self.counts, &mut each),
            Reader::Vectornav(reader) => reader.feed(bytes, &mut self.counts, &mut each),
            Reader::Mip(reader) => reader.feed(bytes, &mut self.counts, &mut each),
            Reader::Text(reader) => reader.feed(bytes, &mut self.counts, &mut each),
        }
    }

    /// Judges what is held as if nothing more were to come; half a packet at the end is no damage.
    pub fn finish(&mut self, mut each: impl FnMut(Sample)) {
        match &mut self.reader {
            // A packet ends with its zero.
            Reader::Mpu(_) => {}
            Reader::Mavlink(reader) => reader.finish(&mut self.counts, &mut each),
            Reader::Msp(reader) => reader.finish(&mut self.counts, &mut each),
            Reader::Vectornav(reader) => reader.finish(&mut self.counts, &mut each),
            Reader::Mip(reader) => reader.finish(&mut self.counts, &mut each),
            Reader::Text(reader) => reader.finish(&mut self.counts, &mut each),
        }
    }

    /// What has come so far.
    pub fn counts(&self) -> &Counts {
        &self.counts
    }
}

#[cfg(test)]
mod tests;
