//! What there is to know of a protocol: one row, in the protocol's own file.

use super::dialogue::Dialogue;
use super::samples::{Assumed, Reader};
use super::{Controller, Encoder, Options, Setup};
use crate::sensor::{Kinds, SensorPlan};
use crate::time::Rate;
use std::ops::Range;

/// All that differs from protocol to protocol.
pub(super) struct Row {
    /// As `--to` spells it.
    pub name: &'static str,
    /// One line for `list protocols`.
    pub about: &'static str,
    /// The kinds of sensor that it carries.
    pub carries: Kinds,
    /// Readings to packets.
    pub encoder: fn(&Setup<'_>) -> Box<dyn Encoder>,
    /// Packets back to samples.
    pub reader: fn(&Assumed) -> Box<dyn Reader>,
    /// The conversation, as the controller wants it led; `None` where the other side says nothing.
    pub dialogue: fn(Option<Controller>) -> Option<Box<dyn Dialogue>>,
    /// The packets that carry several sensors, of a scene whose first carried sensor is this one.
    pub shared: fn(&SensorPlan) -> Option<Shared>,
    /// Whether it can be sent with these options.
    pub check: fn(&Options, &[SensorPlan]) -> Result<(), String>,
    /// Bytes that make a sender begin which waits for some, with a sequence number.
    pub greeting: fn(u8) -> Vec<u8>,
    /// Whether packets have a sequence number.
    pub is_numbered: bool,
    /// Of a packet of this length: the bytes that may be damaged without harm to its neighbours, and the byte that none
    /// of them may become.
    pub inside: fn(usize) -> (Range<usize>, Option<u8>),
}

/// Packets that carry the newest sample of several sensors: a sensor that is faster loses samples to newer ones.
pub(super) struct Shared {
    /// The kinds that they carry: another kind has packets of its own.
    pub kinds: Kinds,
    /// How many packets a second there are.
    pub rate: Rate,
    /// What they are, and when they are sent.
    pub what: String,
    /// The rate that loses nothing, where it is lower than the scene's.
    pub fits: Option<Rate>,
}

impl Shared {
    /// Packets called so that carry these kinds, at each tick of the first sensor.
    pub fn at_ticks(what: &str, kinds: Kinds, first: &SensorPlan) -> Shared {
        let what = format!("{what} at each {} tick ({})", first.kind, first.rate);
        Shared { kinds, rate: first.rate, what, fits: None }
    }
}

/// A row's `check` where every option will do.
pub(super) fn any(_: &Options, _: &[SensorPlan]) -> Result<(), String> {
    Ok(())
}
