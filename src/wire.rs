//! Readings to packets: the only room that knows both the sensors and the protocols.
//!
//! Each protocol is one file with an [`Encoder`]; what comes back is the business of `dialogue`. Conversion from the
//! program's axes (Forward-Right-Down, SI, µT) to a protocol's own happens here and nowhere else.
//! To add a protocol: its payloads in the `protocols` crate, its folder beside this file, one line in `protocol.rs`.
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

mod betaflight;
pub mod dialogue;
mod fault;
mod faults;
mod latest;
mod load;
mod mavlink;
mod mip;
mod mpu;
mod msp;
mod newest;
mod packet;
mod protocol;
mod row;
pub mod samples;
mod seconds;
mod text;
mod vectornav;

pub use betaflight::Release;
pub use fault::{PacketFault, PacketFaultKind};
pub use faults::{Acts, Faults};
pub use load::load;
pub use packet::{MAX_PACKET, Packet};
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
    /// Each in packets of its own.
    Separate,
    /// Together in `imu` packets at the faster rate, the slower one held: what a burst read of the chip returns.
    Burst,
}

/// A flight controller that wants a protocol spoken its own way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Controller {
    /// PX4 on its board, in HITL: time is arrival.
    Px4,
    /// PX4 as a program, in lockstep.
    Px4Sitl,
    /// ArduPilot with an external AHRS.
    Ardupilot,
    /// INAV with its HITL simulator message.
    Inav,
    /// Betaflight as a program, of that release.
    Betaflight(Release),
}

/// How a protocol lays its packets out, and whom it talks to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Options {
    /// For `mpu`; `None` is burst where the rates are equal, else separate.
    pub layout: Option<Layout>,
    /// Whose ways the protocol keeps to.
    pub controller: Option<Controller>,
    /// For `mavlink`: the version of its framing.
    pub version: Version,
    /// For `mavlink`: what is sent beside HIL_SENSOR.
    pub extras: Extras,
}

/// What an encoder needs to know of the scene.
#[derive(Clone, Copy, Debug)]
pub struct Setup<'a> {
    /// The sensors, in order.
    pub sensors: &'a [SensorPlan],
    /// The axes the scene is written in, for text.
    pub axes: Axes,
    /// The scene's date.
    pub day: Option<Day>,
    /// How packets are laid out.
    pub options: Options,
    /// What the conversation has brought to light of the other side.
    pub peer: Peer,
}

/// What an encoder is told of one moment of the scene.
#[derive(Clone, Copy, Debug)]
pub struct Now<'a> {
    /// When.
    pub t: SimTime,
    /// What is true then, for packets that carry truth.
    pub truth: &'a Truth,
    /// The readings due then, in the order of sensors.
    pub readings: &'a [Reading],
}

/// Turns readings into packets, in order of time.
pub trait Encoder: Send {
    /// Appends the packets of the readings due now, and whatever the protocol sends besides.
    fn encode(&mut self, now: &Now<'_>, out: &mut Vec<Packet>);

    /// What the other side is left with, at the very end: appends the packets of a vehicle that has stopped at `t`.
    fn farewell(&mut self, _t: SimTime, _out: &mut Vec<Packet>) {}

    /// Samples of each kind taken in that no packet has carried yet.
    fn waiting(&self) -> ByKind<u64> {
        ByKind::default()
    }
}

/// A vehicle that stands level, facing north, where nothing else is known of the scene.
fn at_rest(t: SimTime) -> Truth {
    Truth {
        t,
        attitude: Attitude::IDENTITY,
        rate: Vector::ZERO,
        force: Vector::new(0.0, 0.0, -STANDARD_GRAVITY),
        field: Vector::from_vec(default_field().v),
    }
}

/// What gyro, accel and mag of a vehicle read that has stopped as it is.
fn stopped(truth: &Truth) -> [Vector<Body>; 3] {
    let up = Vector::new(0.0, 0.0, -STANDARD_GRAVITY);
    [Vector::ZERO, truth.attitude.inverse().apply(up), truth.field]
}

#[cfg(test)]
mod controller_tests;
#[cfg(test)]
mod tests;
