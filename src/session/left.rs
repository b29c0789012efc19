//! Packets of an output that were neither sent nor dropped.

use crate::sensor::ByKind;
use crate::wire::Packet;

/// Their counts.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Left {
    /// Samples of each kind.
    pub samples: ByKind<u64>,
    pub packets: u64,
}

impl Left {
    /// Adds a packet, with the samples that newer ones replaced before it.
    pub(super) fn add(&mut self, packet: &Packet) {
        if packet.is_nothing() {
            return;
        }
        self.packets += 1;
        for (i, samples) in self.samples.iter_mut().enumerate() {
            *samples += packet.samples(i);
        }
    }
}
