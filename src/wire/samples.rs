//! The stream of any protocol to samples: everything that a receiver can read without knowing the scene.
//!
//! Each protocol is one file that passes on every [`Sample`] and counts everything else ([`Counts`]). No bytes
//! cause a panic, memory stays bounded, and damage costs at most the damaged packets.

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

/// One sample of one sensor, as a packet carries it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// The kind of sensor.
    pub kind: SensorKind,
    /// Which of several sensors of that kind on the link.
    pub source: Source,
    /// When it was taken by the sender's clock, if the packet gives it, in whole µs (text, `vectornav`, `mip`: ns;
    /// `ilabs`, some MAVLink messages: ms). A clock that begins again (32 bits of µs, a week)
    /// goes on here.
    pub t: Option<SimTime>,
    /// The reading. `None` where the packet does not give the scale of its counts (`mpu` before its first config
    /// packet, raw messages, the field in `msp`) or marks them as invalid (an overflow).
    pub value: Option<Sensed>,
    /// More about its packet.
    pub packet: Carrier,
}

/// The value of a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Sensed {
    /// Of a gyroscope (rad/s), an accelerometer (m/s²) or a magnetometer (µT), in body axes.
    Body(Vector<Body>),
    /// Of a barometer or a pitot tube, Pa.
    Pressure(f64),
}

impl Sensed {
    /// The value in body axes; `None` for a pressure.
    pub fn body(self) -> Option<Vector<Body>> {
        match self {
            Sensed::Body(body) => Some(body),
            Sensed::Pressure(_) => None,
        }
    }

    /// The pressure in Pa; `None` for body axes.
    pub fn pressure(self) -> Option<f64> {
        match self {
            Sensed::Pressure(pascals) => Some(pascals),
            Sensed::Body(_) => None,
        }
    }

    /// Body axes, from units of `unit`; `None` where a component is not finite.
    pub(super) fn triad(values: [impl Into<f64>; 3], unit: f64) -> Option<Sensed> {
        let [x, y, z] = values.map(Into::into);
        Sensed::Body(Vector::new(x, y, z) * unit).known()
    }

    /// The value itself, or `None` if it is not finite.
    pub(super) fn known(self) -> Option<Sensed> {
        let is_number = match self {
            Sensed::Body(body) => body.v.is_finite(),
            Sensed::Pressure(pascals) => pascals.is_finite(),
        };
        is_number.then_some(self)
    }
}

/// What is known of the packet of a sample, beside its content.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Carrier {
    /// Its arrival since 1970, where a recording gives it.
    pub arrived: Option<SimTime>,
    /// How many packets its sender lost up to here, if they have sequence numbers.
    pub lost: Option<u64>,
}

/// Which of several sensors of a kind a sample comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Source {
    /// The MAVLink message, in lower case; for the others, which have one sensor of a kind, the protocol's name.
    pub message: &'static str,
    /// The MAVLink system, component and the sensor set that the message names; 0 for the others.
    pub set: [u8; 3],
}

impl Source {
    /// The only sensor of its kind on the link.
    pub(super) const fn only(message: &'static str) -> Source {
        Source { message, set: [0; 3] }
    }
}

impl fmt::Display for Source {
    /// `mpu`, `hil_sensor 1/51/0`: the message, and where needed its system, component and set.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Source { message, set: [system, component, set] } = self;
        match self.set {
            [0, 0, 0] => f.write_str(message),
            _ => write!(f, "{message} {system}/{component}/{set}"),
        }
    }
}

/// What a reader must assume because the packets do not carry it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Assumed {
    /// The axes of text.
    pub axes: Axes,
    /// From body to chip axes, of gyro, accel and mag, for the registers of `mpu`.
    pub mounts: [Mount; 3],
    /// The unit that a field is told in whose protocol does not say it (`sbg`).
    pub mag: MagUnit,
    /// Whether it is a recording, which may have a stamp before each packet.
    pub recorded: bool,
}

impl Default for Assumed {
    /// Forward-right-down, and chips with x forward and z up, which is what the encoders use for a plain scene.
    fn default() -> Assumed {
        Assumed { axes: Axes::NedFrd, mounts: [Mount::flu(); 3], mag: MagUnit::default(), recorded: false }
    }
}

/// Counts of what a stream brought so far.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Bytes received.
    pub bytes: u64,
    /// Whole packets of the protocol, with samples or not; each line of text is a packet, the header line too.
    pub packets: u64,
    /// Packets that fail their checksum or are truncated, and stretches of other bytes. MAVLink's sequence numbers
    /// show how many packets one stretch hides; without sequence numbers it counts as one.
    pub damaged: u64,
    /// 1 if the stream began in the middle of a packet, which is no damage.
    pub joined_midway: u64,
    /// Packets missing by sequence number, damaged ones included. The number counts modulo 256 for each sender, so
    /// of a longer gap only the remainder counts. 0 for protocols without sequence numbers.
    pub lost: u64,
    /// Packets whose number came twice in a row.
    pub duplicates: u64,
    /// Packets that one with a later number overtook, by at most sixteen places; they are not lost.
    pub out_of_order: u64,
    /// Whether packets have sequence numbers.
    pub numbered: bool,
    /// Packets whose checksum cannot be checked because their id is outside the dialects `common` and
    /// `ardupilotmega`. They show no gap, but fill one.
    pub unchecked: u64,
    /// The stamps of a recording that has one before each packet.
    pub stamps: Option<Stamps>,
    /// Packets that carry no sample, by name.
    pub foreign: BTreeMap<String, u64>,
}

impl Counts {
    /// How many names of foreign packets are counted separately.
    const NAMES: usize = 64;

    /// Counts bytes that are no packet: damage, unless the stream began there.
    pub(super) fn refuse(&mut self) {
        let first = self.packets == 0 && self.damaged == 0 && self.joined_midway == 0;
        *if first { &mut self.joined_midway } else { &mut self.damaged } += 1;
    }

    /// Records the sequence number of a packet from the sender that `losses` tracks.
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

/// Reads a protocol's packets into samples.
pub(super) trait Reader: Send {
    /// Processes bytes as they arrive, and passes every sample in them to `each`.
    fn feed(&mut self, bytes: &[u8], counts: &mut Counts, each: &mut dyn FnMut(Sample));

    /// Reads held bytes as if the stream ended here.
    fn finish(&mut self, _counts: &mut Counts, _each: &mut dyn FnMut(Sample)) {}
}

#[cfg(test)]
mod tests;
