//! What the other sides are answered: whole packets beside the stream, never in the middle of one.
//!
//! Before the stream begins the control side writes them itself. From then on the links belong to the pacing thread,
//! and they reach it over a ring a link, so that it neither waits nor locks.

use crate::link::{Sender, Sent};
use crate::sensor::Kinds;
use crate::time::SimTime;
use crate::wire::{MAX_PACKET, Packet};
use rtrb::{Consumer, Producer, RingBuffer};

/// Replies on their way to a link: more than any controller asks for at once.
const ROOM: usize = 64;

/// The way to one link.
pub(super) enum Way {
    /// The link itself, and how many replies it took.
    Link(Sender, u64),
    /// To the pacing thread; how many the link had taken before.
    Ring(Producer<Packet>, u64),
}

impl Way {
    /// Answers with a packet; false where it was lost because the link or the ring is full, or it is too long.
    pub(super) fn reply(&mut self, bytes: &[u8]) -> bool {
        if bytes.len() > MAX_PACKET {
            return false;
        }
        match self {
            Way::Link(sender, count) => {
                let sent = sender.send(bytes) == Sent::Done;
                *count += u64::from(sent);
                sent
            }
            Way::Ring(ring, _) => ring.push(Packet::new(SimTime::ZERO, Kinds::NONE, bytes)).is_ok(),
        }
    }

    /// Gives the link away; what is said from now on comes out of the other end.
    ///
    /// # Panics
    /// When it was given away before.
    pub(super) fn hand_over(&mut self) -> (Sender, Replies) {
        let (producer, ring) = RingBuffer::new(ROOM);
        match std::mem::replace(self, Way::Ring(producer, 0)) {
            Way::Link(sender, before) => {
                if let Way::Ring(_, count) = self {
                    *count = before;
                }
                (sender, Replies { ring, unsent: None })
            }
            Way::Ring(..) => unreachable!("a link is given away once"),
        }
    }

    /// Whether nothing that was said waits for the pacing thread.
    pub(super) fn is_empty(&self) -> bool {
        match self {
            Way::Link(..) => true,
            Way::Ring(ring, _) => ring.slots() == ROOM,
        }
    }

    /// How many the link took before it was given away.
    pub(super) fn written(&self) -> u64 {
        match self {
            Way::Link(_, count) | Way::Ring(_, count) => *count,
        }
    }
}

/// What came of a look at the replies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Replied {
    /// There was none.
    Nothing,
    /// One was written; there may be others.
    Some,
    /// One waits for its link.
    Full,
}

/// The pacing thread's end of a way.
pub(super) struct Replies {
    ring: Consumer<Packet>,
    /// The one that its link did not take yet.
    unsent: Option<Packet>,
}

impl Replies {
    /// Takes the next one.
    pub(super) fn next(&mut self) -> Option<Packet> {
        self.unsent.take().or_else(|| self.ring.pop().ok())
    }

    /// Puts one back that its link did not take: it is the next again.
    pub(super) fn keep(&mut self, packet: Packet) {
        self.unsent = Some(packet);
    }
}
