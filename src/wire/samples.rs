//! The stream of any protocol back to samples: what a receiver that knows nothing of the scene can read.
//!
//! Each protocol is one file that hands on every [`Sample`] and counts what came besides ([`Counts`]). Nothing
//! panics on any bytes, memory stays bounded, and damage costs at most itself.

pub(super) mod log;
mod stream;

pub use log::Stamps;
pub use stream::Samples;

use super::mag_unit::MagUnit;
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
    /// When it was taken by the sender's clock, where the packet says so, in whole µs (text, `vectornav`, `mip`: ns; `ilabs`,
    /// some MAVLink messages: ms). A clock that begins again (32 bits of µs, a week) goes on counting here.
    pub t: Option<SimTime>,
    /// The reading; `None` where the packet does not say what its counts mean
    /// (`mpu` before its first config packet, raw messages, the field in `msp`) or that they mean nothing (an
    /// overflow).
    pub value: Option<Sensed>,
    /// What else is known of its packet.
    pub packet: Carrier,
}

/// What a sample says.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Sensed {
    /// Of a gyroscope (rad/s), an accelerometer (m/s²) or a magnetometer (µT), in body axes.
    Body(Vector<Body>),
    /// Of a barometer or a pitot tube, Pa.
    Pressure(f64),
}

impl Sensed {
    /// Body axes; `None` of a pressure.
    pub fn body(self) -> Option<Vector<Body>> {
        match self {
            Sensed::Body(body) => Some(body),
            Sensed::Pressure(_) => None,
        }
    }

    /// Pa; `None` of body axes.
    pub fn pressure(self) -> Option<f64> {
        match self {
            Sensed::Pressure(pascals) => Some(pascals),
            Sensed::Body(_) => None,
        }
    }

    /// Body axes in so many of our units; `None` where they are no numbers.
    pub(super) fn triad(values: [impl Into<f64>; 3], unit: f64) -> Option<Sensed> {
        let [x, y, z] = values.map(Into::into);
        Sensed::Body(Vector::new(x, y, z) * unit).known()
    }

    /// Itself, unless it is no number.
    pub(super) fn known(self) -> Option<Sensed> {
        let is_number = match self {
            Sensed::Body(body) => body.v.is_finite(),
            Sensed::Pressure(pascals) => pascals.is_finite(),
        };
        is_number.then_some(self)
    }
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
    pub(super) const fn only(message: &'static str) -> Source {
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

/// What the packets do not say, so that a reader has to assume it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Assumed {
    /// The axes that text is written in.
    pub axes: Axes,
    /// From body to the chip's axes, of gyro, accel and mag, for the registers of `mpu`.
    pub mounts: [Mount; 3],
    /// The unit that a field is told in whose protocol does not say it (`sbg`).
    pub mag: MagUnit,
    /// Whether it is a recording, which may have a stamp before each packet.
    pub recorded: bool,
}

impl Default for Assumed {
    /// Forward-right-down, and chips whose x points forward and z up, as the encoders of a plain scene have it.
    fn default() -> Assumed {
        Assumed { axes: Axes::NedFrd, mounts: [Mount::flu(); 3], mag: MagUnit::default(), recorded: false }
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
    pub(super) fn refuse(&mut self) {
        let first = self.packets == 0 && self.damaged == 0 && self.joined_midway == 0;
        *if first { &mut self.joined_midway } else { &mut self.damaged } += 1;
    }

    /// Takes in the number of a packet by the sender that `losses` keeps account of.
    pub(super) fn number(&mut self, losses: &mut Losses, seq: u8) {
        let before = *losses;
        losses.observe(seq);
        self.duplicates += losses.duplicates() - before.duplicates();
        self.out_of_order += losses.out_of_order() - before.out_of_order();
        self.lost = self.lost + losses.lost() - before.lost();
    }

    pub(super) fn foreign(&mut self, name: &str) {
        if let Some(count) = self.foreign.get_mut(name) {
            *count += 1;
            return;
        }
        let name = if self.foreign.len() < Self::NAMES { name } else { "others" };
        *self.foreign.entry(name.to_string()).or_default() += 1;
    }
}

/// Reads a protocol's packets back to samples.
pub(super) trait Reader: Send {
    /// Takes bytes in as they arrive, and hands every sample in them to `each`.
    fn feed(&mut self, bytes: &[u8], counts: &mut Counts, each: &mut dyn FnMut(Sample));

    /// Judges what is held as if nothing more were to come.
    fn finish(&mut self, _counts: &mut Counts, _each: &mut dyn FnMut(Sample)) {}
}

#[cfg(test)]
mod tests;
