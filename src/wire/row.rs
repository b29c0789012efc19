//! The description of a protocol: one row, in the protocol's own file.

use super::dialogue::Dialogue;
use super::samples::{Assumed, Reader};
use super::{Controller, Encoder, Options, Setup};
use crate::sensor::{Kinds, SensorPlan};
use crate::time::Rate;
use std::ops::Range;

/// Everything that differs between protocols.
pub(super) struct Row {
    /// Its name in `--to`.
    pub name: &'static str,
    /// One line for `list protocols`.
    pub about: &'static str,
    /// The kinds of sensor that it carries.
    pub carries: Kinds,
    /// Readings to packets.
    pub encoder: fn(&Setup<'_>) -> Box<dyn Encoder>,
    /// Packets back to samples.
    pub reader: fn(&Assumed) -> Box<dyn Reader>,
    /// The dialogue for a controller; `None` where the other side says nothing.
    pub dialogue: fn(Option<Controller>) -> Option<Box<dyn Dialogue>>,
    /// The packets that carry several sensors, with these options in a scene whose first carried sensor is
    /// this one.
    pub shared: fn(&Options, &SensorPlan) -> Option<Shared>,
    /// The keys of `[[output]]` that are for it alone.
    pub keys: &'static [&'static str],
    /// Checks that it works with these options.
    pub check: fn(&Options, &[SensorPlan]) -> Result<(), String>,
    /// Bytes that start a sender which waits for some, with a sequence number.
    pub greeting: fn(u8) -> Vec<u8>,
    /// Whether packets have a sequence number.
    pub is_numbered: bool,
    /// For a packet of this length: the bytes that may be damaged without harm to neighbouring packets, and the
    /// value that none of them may take.
    pub inside: fn(usize) -> (Range<usize>, Option<u8>),
}

/// Packets that carry the newest sample of several sensors: a faster sensor loses samples to newer ones.
pub(super) struct Shared {
    /// The kinds that they carry; other kinds have separate packets.
    pub kinds: Kinds,
    /// Packets a second.
    pub rate: Rate,
    /// Their name, and when they are sent.
    pub what: String,
    /// The sensor rate that loses nothing, if it is below the scene's.
    pub fits: Option<Rate>,
}

impl Shared {
    /// Packets with this name and these kinds, at each tick of the first sensor.
    pub fn at_ticks(what: &str, kinds: Kinds, first: &SensorPlan) -> Shared {
        let what = format!("{what} at each {} tick ({})", first.kind, first.rate);
        Shared { kinds, rate: first.rate, what, fits: None }
    }
}

/// A row's `check` that accepts every option.
pub(super) fn any(_: &Options, _: &[SensorPlan]) -> Result<(), String> {
    Ok(())
}
