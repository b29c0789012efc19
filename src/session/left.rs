//! What was made for an output and neither sent nor dropped.

use crate::sensor::ByKind;
use crate::wire::Packet;

/// Counts of it.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Left {
    /// Samples, of each kind.
    pub samples: ByKind<u64>,
    pub packets: u64,
}

impl Left {
    /// One packet more, with the samples that newer ones replaced before it.
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
