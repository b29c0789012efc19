//! Packets that their link did not take when they were due.

use super::pace::AT_ONCE;
use crate::scene::Overload;
use crate::wire::Packet;
use std::collections::VecDeque;

/// Packets that `drop-oldest` keeps for a link: 64 ms of a sensor at 1 kHz. Packets in the
/// system's own buffers come on top, and are older.
pub(super) const BACKLOG: usize = 64;

/// A packet that is due, with its due time on the pacing thread's clock (or [`AT_ONCE`]).
#[derive(Clone, Copy, Debug)]
pub(super) struct Due {
    pub packet: Packet,
    pub due: i64,
}

/// How late a write at `now` of what was due at `due` is, ns.
pub(super) fn late(due: i64, now: i64) -> i64 {
    if due == AT_ONCE { 0 } else { now - due }
}

/// The waiting packets of one link, oldest first.
#[derive(Debug)]
pub(super) struct Queue {
    /// Allocated at its full size from the start.
    waiting: VecDeque<Due>,
}

impl Queue {
    /// A queue with the room that this policy needs.
    pub(super) fn new(policy: Overload) -> Queue {
        let room = if policy == Overload::DropOldest { BACKLOG } else { 1 };
        Queue { waiting: VecDeque::with_capacity(room) }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.waiting.is_empty()
    }

    /// How many wait.
    pub(super) fn len(&self) -> usize {
        self.waiting.len()
    }

    /// The packet that has waited longest.
    pub(super) fn oldest(&self) -> Option<Due> {
        self.waiting.front().copied()
    }

    /// Takes the packet that has waited longest.
    pub(super) fn pop(&mut self) -> Option<Due> {
        self.waiting.pop_front()
    }

    /// Takes the packet that has waited longest, if there is no room for another.
    pub(super) fn make_room(&mut self) -> Option<Due> {
        if self.waiting.len() == BACKLOG { self.waiting.pop_front() } else { None }
    }

    /// Adds a packet.
    pub(super) fn push(&mut self, it: Due) {
        self.waiting.push_back(it);
    }
}
