//! `bus`: the scene's chips behind a UART-to-I²C bridge. A driver asks, so there are no packets: the room `bus` answers.

use super::row::{Row, any};
use super::samples::{Counts, Reader, Sample};
use super::{Encoder, Now, Packet};
use crate::sensor::Kinds;

pub(super) static ROW: Row = Row {
    name: "bus",
    about: "the scene's parts as chips behind a UART-to-I²C bridge (SC18IM704): their registers, for an unmodified driver",
    carries: Kinds::TRIADS,
    encoder: |_| Box::new(Silent),
    reader: |_| Box::new(Deaf),
    dialogue: |_| None,
    shared: |_, _| None,
    keys: &["chip"],
    check: any,
    greeting: |_| Vec::new(),
    is_numbered: false,
    inside: |len| (0..len, None),
};

/// Sends nothing.
pub(super) struct Silent;

impl Encoder for Silent {
    fn encode(&mut self, _: &Now<'_>, _: &mut Vec<Packet>) {}
}

/// A driver's questions hold no samples.
struct Deaf;

impl Reader for Deaf {
    fn feed(&mut self, _: &[u8], counts: &mut Counts, _: &mut dyn FnMut(Sample)) {
        counts.foreign("bytes of a bus");
    }
}
