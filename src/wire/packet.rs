//! One packet, as threads pass it on.

use crate::sensor::{ByKind, Kinds, SensorKind};
use crate::time::SimTime;

/// The longest packet of any protocol, bytes: a signed MAVLink 2 message, which a ground station may send.
pub const MAX_PACKET: usize = 280;

/// One packet: its due time, the samples it carries, its bytes. Plain data of fixed size, so that passing it on
/// allocates nothing.
#[derive(Clone, Copy, Debug)]
pub struct Packet {
    /// When it is due.
    pub due: SimTime,
    /// The kinds of which it carries a new sample.
    pub carries: Kinds,
    /// Samples of each kind that a newer one replaced before any packet carried them.
    pub replaced: ByKind<u32>,
    /// Whether those are in it all the same: it carries the mean.
    pub merges: bool,
    /// How many of its bytes go out at once, with the others a little later; 0 = all of them. For a packet without
    /// bytes: how many bytes of the previous packet go out then.
    pub piece: u16,
    pub(super) len: u16,
    pub(super) bytes: [u8; MAX_PACKET],
}

impl Packet {
    /// A packet of these bytes, due at `due`. Truncates bytes beyond [`MAX_PACKET`], which no protocol here
    /// reaches.
    #[inline]
    pub fn new(due: SimTime, carries: Kinds, bytes: &[u8]) -> Packet {
        debug_assert!(bytes.len() <= MAX_PACKET, "{} bytes", bytes.len());
        let len = bytes.len().min(MAX_PACKET);
        let mut packet = Packet {
            due,
            carries,
            replaced: ByKind::default(),
            merges: false,
            piece: 0,
            len: len as u16,
            bytes: [0; MAX_PACKET],
        };
        packet.bytes[..len].copy_from_slice(&bytes[..len]);
        packet
    }

    /// A packet whose bytes are written where they belong; `write` returns how many there are.
    #[inline]
    pub(super) fn fill(due: SimTime, carries: Kinds, write: impl FnOnce(&mut [u8]) -> usize) -> Packet {
        let mut packet = Packet::new(due, carries, &[]);
        packet.len = write(&mut packet.bytes) as u16;
        packet
    }

    /// No packet, but a time at which something is due: `piece` bytes of the previous packet that were held back,
    /// or 0.
    pub fn nothing(due: SimTime, piece: u16) -> Packet {
        Packet { piece, ..Packet::new(due, Kinds::NONE, &[]) }
    }

    /// The number of samples of a kind that end with it: the one that it carries, and those replaced before it.
    pub fn samples(&self, kind: usize) -> u64 {
        u64::from(self.carries.contains(SensorKind::ALL[kind])) + u64::from(self.replaced[kind])
    }

    /// Whether it is [`Packet::nothing`].
    pub fn is_nothing(&self) -> bool {
        self.len == 0
    }

    /// Its bytes.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes[..usize::from(self.len)]
    }
}
