//! What becomes of a packet that its link does not take when it is due: dropped, kept for a while, or waited for.
//!
//! Every packet that leaves the ring ends as sent, dropped or queued, and is counted as it does. Nothing is sent
//! out of order on a link, and nothing waits here that the policy did not ask for.

use super::Shared;
use super::pacer::{Pacer, Speed};
use crate::clock::Clock;
use crate::link::Sent;
use crate::scene::Overload;
use crate::wire::Packet;
use std::collections::VecDeque;
use std::sync::atomic::Ordering;

/// Packets that `drop-oldest` keeps for a link: 64 ms of a sensor at 1 kHz. What the system's own buffers hold comes
/// on top, and is older.
pub(super) const BACKLOG: usize = 64;
/// Between two tries of a link that was full, ns.
pub(super) const RETRY: i64 = 1_000_000;
/// At the end, packets that wait are given up when none has moved for so long, ns.
const PATIENCE: i64 = 1_000_000_000;

/// A packet that is due, with its due time on the pacing thread's clock (`i64::MIN` where nothing is paced).
#[derive(Clone, Copy, Debug)]
pub(super) struct Due {
    pub packet: Packet,
    pub due: i64,
}

/// How one output deals with a link that is too slow.
#[derive(Debug)]
pub(super) struct Queue {
    policy: Overload,
    /// Oldest first; as large as it gets from the start.
    waiting: VecDeque<Due>,
}

impl Queue {
    pub(super) fn new(policy: Overload) -> Queue {
        let room = if policy == Overload::DropOldest { BACKLOG } else { 1 };
        Queue { policy, waiting: VecDeque::with_capacity(room) }
    }

    /// Takes the packets that wait, for counting.
    pub(super) fn drain(&mut self) -> impl Iterator<Item = Packet> + '_ {
        self.waiting.drain(..).map(|it| it.packet)
    }
}

impl<C: Clock> Pacer<C> {
    /// Sends a packet that is due, or does with it what its output's policy says.
    pub(super) fn deliver(&mut self, output: usize, it: Due, shared: &Shared) {
        if self.gone[output].is_some() {
            return self.lose(output, &it.packet, shared);
        }
        match (self.speed, self.queues[output].policy) {
            (Speed::Max, _) => self.deliver_all(output, it, shared),
            (_, Overload::DropNewest) => match self.attempt(output, &it, shared) {
                Sent::Done => {}
                _ => self.lose(output, &it.packet, shared),
            },
            (_, Overload::DropOldest) => self.deliver_in_turn(output, it, shared),
            (_, Overload::Stretch) => self.stretch(output, it, shared),
        }
    }

    /// Nothing is paced: the link has all the time it needs.
    fn deliver_all(&mut self, output: usize, it: Due, shared: &Shared) {
        match self.attempt(output, &it, shared) {
            Sent::Done => {}
            Sent::Gone(_) => self.lose(output, &it.packet, shared),
            // Stopped meanwhile.
            Sent::Full | Sent::Away => self.queues[output].waiting.push_back(it),
        }
    }

    /// After those that wait; one more than there is room for costs the oldest.
    fn deliver_in_turn(&mut self, output: usize, it: Due, shared: &Shared) {
        self.send_waiting(output, shared);
        if self.queues[output].waiting.is_empty() {
            match self.attempt(output, &it, shared) {
                Sent::Done => return,
                Sent::Full => {}
                Sent::Away | Sent::Gone(_) => return self.lose(output, &it.packet, shared),
            }
        }
        if self.queues[output].waiting.len() == BACKLOG
            && let Some(oldest) = self.queues[output].waiting.pop_front()
        {
            self.lose(output, &oldest.packet, shared);
        }
        self.queues[output].waiting.push_back(it);
    }

    /// Sends what waits for one link as far as it takes it now.
    fn send_waiting(&mut self, output: usize, shared: &Shared) {
        while let Some(&it) = self.queues[output].waiting.front() {
            match self.attempt(output, &it, shared) {
                Sent::Full => return,
                Sent::Done => {}
                // A port that comes back gets the present, not what was due before it left.
                Sent::Away | Sent::Gone(_) => self.lose(output, &it.packet, shared),
            }
            self.queues[output].waiting.pop_front();
        }
    }

    /// Sends what waits anywhere, as far as the links take it now.
    pub(super) fn send_all_waiting(&mut self, shared: &Shared) {
        for output in 0..self.queues.len() {
            if self.queues[output].policy == Overload::DropOldest {
                self.send_waiting(output, shared);
            }
        }
    }

    /// Whether a packet waits for its link.
    pub(super) fn something_waits(&self) -> bool {
        self.queues.iter().any(|queue| !queue.waiting.is_empty())
    }

    /// Waits for the link, and lets scene time stand still for as long: all that follows is due later.
    fn stretch(&mut self, output: usize, mut it: Due, shared: &Shared) {
        let due = it.due;
        let begun = self.clock.now();
        loop {
            it.due = due + (self.clock.now() - begun);
            match self.attempt(output, &it, shared) {
                Sent::Done => break,
                Sent::Gone(_) => {
                    self.lose(output, &it.packet, shared);
                    break;
                }
                Sent::Full | Sent::Away if shared.stopped() => {
                    self.queues[output].waiting.push_back(it);
                    break;
                }
                Sent::Full | Sent::Away => {}
            }
            let soon = self.clock.now() + RETRY;
            self.clock.wait_until(soon);
            self.send_all_waiting(shared);
        }
        self.shift(it.due - due, it.packet.due.0, shared);
    }

    /// From scene time `t` on everything is due `by` later.
    pub(super) fn shift(&mut self, by: i64, t: i64, shared: &Shared) {
        if by > 0 {
            self.start += by;
            self.stretched += by;
            shared.stretched_at_ns.store(t, Ordering::Relaxed);
            shared.start_ns.store(self.start, Ordering::Relaxed);
        }
    }

    /// At the end: what waits may still go, as long as some of it moves.
    pub(super) fn settle(&mut self, shared: &Shared) {
        let mut moved = self.clock.now();
        while self.something_waits() && !shared.stopped() && self.clock.now() - moved < PATIENCE {
            let before = shared.packets.load(Ordering::Relaxed);
            let soon = self.clock.now() + RETRY;
            self.clock.wait_until(soon);
            self.send_all_waiting(shared);
            if shared.packets.load(Ordering::Relaxed) > before {
                moved = self.clock.now();
            }
        }
    }
}
