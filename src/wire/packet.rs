//! One packet, as threads pass it on.

use crate::sensor::{ByKind, Kinds, SensorKind};
use crate::time::SimTime;
use std::ops::{Deref, DerefMut};

/// The longest packet of any protocol, bytes: a signed MAVLink 2 message, which a ground station may send.
pub const MAX_PACKET: usize = 280;

/// What there is to know of a packet beside its bytes.
#[derive(Clone, Copy, Debug)]
pub struct Head {
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
}

/// One packet: its due time, the samples it carries, its bytes. Plain data of fixed size, so that passing it on
/// allocates nothing.
#[derive(Clone, Copy, Debug)]
pub struct Packet {
    head: Head,
    pub(super) bytes: [u8; MAX_PACKET],
}

impl Deref for Packet {
    type Target = Head;

    fn deref(&self) -> &Head {
        &self.head
    }
}

impl DerefMut for Packet {
    fn deref_mut(&mut self) -> &mut Head {
        &mut self.head
    }
}

impl Packet {
    /// No bytes, at no time: what a packet is written over.
    pub const BLANK: Packet = Packet {
        head: Head {
            due: SimTime::ZERO,
            carries: Kinds::NONE,
            replaced: [0; SensorKind::ALL.len()],
            merges: false,
            piece: 0,
            len: 0,
        },
        bytes: [0; MAX_PACKET],
    };

    /// A packet of these bytes, due at `due`. Truncates bytes beyond [`MAX_PACKET`], which no protocol here
    /// reaches.
    pub fn new(due: SimTime, carries: Kinds, bytes: &[u8]) -> Packet {
        debug_assert!(bytes.len() <= MAX_PACKET, "{} bytes", bytes.len());
        let mut packet = Packet::BLANK;
        let len = bytes.len().min(MAX_PACKET);
        packet.hold(Head { due, carries, len: len as u16, ..packet.head }).copy_from_slice(&bytes[..len]);
        packet
    }

    /// Appends a packet whose bytes are written where they belong; `write` returns how many there are. A packet that is
    /// made elsewhere and moved here costs as much again as its bytes.
    #[inline(always)]
    pub(super) fn append(
        out: &mut Vec<Packet>,
        due: SimTime,
        carries: Kinds,
        write: impl FnOnce(&mut [u8; MAX_PACKET]) -> usize,
    ) -> &mut Packet {
        let i = out.len();
        out.push(Packet::BLANK);
        let packet = &mut out[i];
        (packet.due, packet.carries) = (due, carries);
        packet.len = write(&mut packet.bytes) as u16;
        packet
    }

    /// The same at another time.
    pub(super) fn due_at(mut self, due: SimTime) -> Packet {
        self.due = due;
        self
    }

    /// Takes on this head, and returns the place for its bytes; those of before stay behind them.
    #[inline]
    pub fn hold(&mut self, head: Head) -> &mut [u8] {
        self.head = head;
        &mut self.bytes[..usize::from(head.len)]
    }

    /// Its bytes.
    #[inline]
    pub fn bytes(&self) -> &[u8] {
        &self.bytes[..usize::from(self.len)]
    }

    /// No packet, but a time at which something is due: `piece` bytes of the previous packet that were held back,
    /// or 0.
    pub fn nothing(due: SimTime, piece: u16) -> Packet {
        let mut packet = Packet::new(due, Kinds::NONE, &[]);
        packet.piece = piece;
        packet
    }
}

impl Head {
    /// The number of its bytes.
    pub fn size(&self) -> usize {
        usize::from(self.len)
    }

    /// Whether it is [`Packet::nothing`].
    pub fn is_nothing(&self) -> bool {
        self.len == 0
    }

    /// The number of samples of a kind that end with it: the one that it carries, and those replaced before it.
    pub fn samples(&self, kind: usize) -> u64 {
        u64::from(self.carries.contains(SensorKind::ALL[kind])) + u64::from(self.replaced[kind])
    }
}
