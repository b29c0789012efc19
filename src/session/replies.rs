//! Replies to the other sides: whole packets between those of the stream, never inside one.
//!
//! Before the stream starts the control side writes them itself. After that the links belong to the pacing thread,
//! and replies reach it over one ring for each link, so that it neither waits nor locks.

use crate::link::{Sender, Sent};
use crate::sensor::Kinds;
use crate::time::SimTime;
use crate::wire::{MAX_PACKET, Packet};
use rtrb::{Consumer, Producer, RingBuffer};

/// Replies on their way to a link: more than any controller requests at once.
const ROOM: usize = 64;

/// How replies reach one link.
pub(super) enum Way {
    /// The link itself, and the number of replies that it took.
    Link(Sender, u64),
    /// A ring to the pacing thread, and the number of replies that the link took before.
    Ring(Producer<Packet>, u64),
}

impl Way {
    /// Sends a reply. False if it was lost because the link or the ring is full, or it is too long.
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

    /// Gives the link away; later replies come out of the returned end.
    ///
    /// # Panics
    /// When the link was given away before.
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

    /// The number of replies that the link took before it was given away.
    pub(super) fn written(&self) -> u64 {
        match self {
            Way::Link(_, count) | Way::Ring(_, count) => *count,
        }
    }
}

/// The result of a look at the replies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Replied {
    /// There was no reply.
    Nothing,
    /// One was written; more may follow.
    Some,
    /// One waits for its link.
    Full,
}

/// The pacing thread's end of the ring.
pub(super) struct Replies {
    ring: Consumer<Packet>,
    /// The reply that its link has not taken yet.
    unsent: Option<Packet>,
}

impl Replies {
    /// Takes the next reply.
    pub(super) fn next(&mut self) -> Option<Packet> {
        self.unsent.take().or_else(|| self.ring.pop().ok())
    }

    /// Puts back a reply that its link did not take: it is next again.
    pub(super) fn keep(&mut self, packet: Packet) {
        self.unsent = Some(packet);
    }
}
