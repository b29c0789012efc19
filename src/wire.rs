//! Readings to packets: the only room that knows both the sensors and the protocols.
//!
//! Each protocol is one file with an [`Encoder`]; `dialogue` handles what comes back. Only this room converts from
//! the program's axes (Forward-Right-Down, SI, µT) to those of a protocol. To add a protocol: its payloads in the
//! `protocols` crate, its folder beside this file, one line in `protocol.rs`.
//!
//! ```
//! use ratetable::player::{BLOCK, Player};
//! use ratetable::scene::Plan;
//! use ratetable::wire::samples::Samples;
//! use ratetable::wire::{self, Now, Options, Protocol, Setup, dialogue::Peer};
//!
//! let plan = Plan::load("still", &["duration=1 s".into()])?;
//! let setup = Setup {
//!     sensors: &plan.sensors,
//!     axes: plan.axes,
//!     day: plan.day,
//!     options: Options::default(),
//!     peer: Peer::default(),
//! };
//! let (mut encoder, mut packets) = (wire::encoder(Protocol::Mavlink, &setup), Vec::new());
//! Player::new(&plan, plan.duration, BLOCK).play(|moment| {
//!     encoder.encode(&Now { t: moment.t, truth: moment.truth, readings: moment.readings }, &mut packets);
//!     Ok::<(), std::convert::Infallible>(())
//! })?;
//! let (mut reader, mut samples) = (Samples::new(Protocol::Mavlink), 0);
//! packets.iter().for_each(|packet| reader.feed(packet.bytes(), |_| samples += 1));
//! assert!(samples > 0 && reader.counts().damaged == 0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod beat;
mod betaflight;
mod bus;
mod claim;
pub mod dialogue;
mod fault;
mod faults;
mod ilabs;
mod latest;
mod load;
mod mag_unit;
mod mavlink;
mod mip;
mod mpu;
mod msp;
mod newest;
mod packet;
mod protocol;
mod row;
pub mod samples;
mod sbg;
mod seconds;
mod text;
mod vectornav;
mod wrap;

pub use betaflight::Release;
pub use claim::Claim;
pub use fault::{PacketFault, PacketFaultKind};
pub use faults::{Acts, Faults};
pub use load::load;
pub use mag_unit::MagUnit;
pub use packet::{Head, MAX_PACKET, Packet};
pub use protocol::{Protocol, check, encoder, warnings};

use newest::Newest;
use seconds::EverySecond;

use crate::earth::{Day, STANDARD_GRAVITY, default_field};
use crate::geometry::{Attitude, Axes, Body, Vector};
use crate::motion::Truth;
use crate::sensor::{ByKind, Reading, SensorPlan};
use crate::time::SimTime;
use dialogue::Peer;

pub use mavlink::{Extra, Extras};
pub use ratetable_protocols::mavlink::Version;

/// How `mpu` carries gyro and accel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layout {
    /// Each in separate packets.
    Separate,
    /// Together in `imu` packets at the faster rate, with the slower one held: what a burst read of the chip
    /// returns.
    Burst,
}

/// A flight controller that uses its own variant of a protocol.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Controller {
    /// PX4 on its board, in HITL: a sample's time is its arrival.
    Px4,
    /// PX4 as a program, in lockstep.
    Px4Sitl,
    /// PX4 with a VectorNav unit on a UART, whose samples its own estimator runs on.
    Px4Vectornav,
    /// ArduPilot with an external AHRS.
    Ardupilot,
    /// INAV with its HITL simulator message.
    Inav,
    /// Betaflight as a program, of that release.
    Betaflight(Release),
}

/// What a packet carries of the samples since the packet before.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Thin {
    /// Their mean: no part of a rotation or of a change of velocity is lost between packets.
    Mean,
    /// The last of them. The others are dropped.
    Last,
}

impl Thin {
    /// As a scene spells them.
    pub const NAMES: [&str; 2] = ["mean", "last"];

    /// The one of this name; the last sample for any other.
    pub fn from_name(name: &str) -> Thin {
        if name == Thin::NAMES[0] { Thin::Mean } else { Thin::Last }
    }
}

impl Options {
    /// Whether packets carry means.
    pub fn means(&self) -> bool {
        self.thin.map_or(self.controller.is_some(), |thin| thin == Thin::Mean)
    }
}

/// What a controller that keeps the last readings is left with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum AtEnd {
    /// It leaves the simulator: it disarms and returns to its own sensors.
    #[default]
    Leave,
    /// It stays in the simulator, on the readings of a vehicle that has stopped.
    Hold,
}

impl AtEnd {
    /// As a scene spells them, the default first.
    pub const NAMES: [&str; 2] = ["leave", "hold"];

    /// The one of this name; the default for any other.
    pub fn from_name(name: &str) -> AtEnd {
        if name == AtEnd::NAMES[1] { AtEnd::Hold } else { AtEnd::Leave }
    }
}

/// How a protocol lays out its packets, and which controller it talks to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Options {
    /// For `mpu`; `None` is burst where the rates are equal, else separate.
    pub layout: Option<Layout>,
    /// The controller whose variant the protocol follows.
    pub controller: Option<Controller>,
    /// What packets carry of a sensor that is faster than they are; `None` is the mean for a controller, and otherwise the
    /// last.
    pub thin: Option<Thin>,
    /// For `msp`: what its receiver is left with.
    pub at_end: AtEnd,
    /// For `mavlink`: the version of its framing.
    pub version: Version,
    /// For `mavlink`: the messages to send beside HIL_SENSOR.
    pub extras: Extras,
    /// For `ilabs` and `sbg`: what the unit says of its own attitude.
    pub claim: Claim,
    /// For `sbg`: the unit of the field; `None` is what the controller takes it for.
    pub mag: Option<MagUnit>,
    /// Nothing is sent: what the other side tells is heard.
    pub is_mute: bool,
    /// For `bus`: the chip of sensors without a part.
    pub chip: Option<&'static str>,
}

impl Options {
    /// The unit of a field whose protocol does not say it.
    fn mag_unit(&self) -> MagUnit {
        let usual =
            if self.controller == Some(Controller::Px4) { MagUnit::Gauss } else { MagUnit::Milligauss };
        self.mag.unwrap_or(usual)
    }
}

/// What an encoder needs of the scene.
#[derive(Clone, Copy, Debug)]
pub struct Setup<'a> {
    /// The sensors, in order.
    pub sensors: &'a [SensorPlan],
    /// The axes of the scene, for text.
    pub axes: Axes,
    /// The scene's date.
    pub day: Option<Day>,
    /// How packets are laid out.
    pub options: Options,
    /// What the conversation has found out about the other side.
    pub peer: Peer,
}

/// One moment of the scene, for an encoder.
#[derive(Clone, Copy, Debug)]
pub struct Now<'a> {
    /// The time.
    pub t: SimTime,
    /// The truth at that time, for packets that carry it.
    pub truth: &'a Truth,
    /// The readings due at that time, in the order of sensors.
    pub readings: &'a [Reading],
}

/// Turns readings into packets, in order of time.
pub trait Encoder: Send {
    /// Appends the packets of the readings due now, and other messages of the protocol.
    fn encode(&mut self, now: &Now<'_>, out: &mut Vec<Packet>);

    /// Appends the last packets for the other side: those of a vehicle that stops where it is at the time of `end`, the
    /// last moment that was sent.
    fn farewell(&mut self, _end: &Truth, _out: &mut Vec<Packet>) {}

    /// Samples of each kind that no packet has carried yet.
    fn waiting(&self) -> ByKind<u64> {
        ByKind::default()
    }

    /// Whether the other side may ask for other packets while it is sent these: then they are not made far ahead.
    fn follows(&self) -> bool {
        false
    }

    /// From `now` on makes the packets that the other side asks for.
    fn follow(&mut self, _peer: &Peer, _now: SimTime) {}
}

/// A level vehicle that faces north, where nothing else is known of the scene.
fn at_rest(t: SimTime) -> Truth {
    Truth {
        t,
        attitude: Attitude::IDENTITY,
        rate: Vector::ZERO,
        force: Vector::new(0.0, 0.0, -STANDARD_GRAVITY),
        field: Vector::from_vec(default_field().v),
    }
}

/// The readings of gyro, accel and mag of a vehicle that has stopped in its present attitude.
fn stopped(truth: &Truth) -> [Vector<Body>; 3] {
    let up = Vector::new(0.0, 0.0, -STANDARD_GRAVITY);
    [Vector::ZERO, truth.attitude.inverse().apply(up), truth.field]
}

#[cfg(test)]
mod controller_tests;
#[cfg(test)]
mod tests;
