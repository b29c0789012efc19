//! The pacing thread: takes the next packet, waits until it is due, has its lane deliver it. Nothing else.

use super::Item;
use super::lane::{Delivery, Lane};
use super::pace::{AT_ONCE, Pace, Speed};
use super::queue::Due;
use super::replies::Replied;
use super::step::Turn;
use crate::clock::Clock;
use crate::sensor::Kinds;
use crate::time::SimTime;
use rtrb::Consumer;
use std::sync::atomic::Ordering;
use std::time::Duration;

/// A wait is cut into pieces this long, ns, to notice that everything stops.
const LOOK_UP: i64 = 50_000_000;
/// The same where replies may come that are to be written soon.
const REPLY_SOON: i64 = 10_000_000;
/// With so much time until the next packet, ns, there is enough for another reply.
const SPARE: i64 = 2_000_000;
/// Between two tries of a link that was full, or of a packet that waits for its turn, ns.
const RETRY: i64 = 1_000_000;
/// How long to wait for the producer when the ring is empty.
const EMPTY: Duration = Duration::from_micros(50);
/// At the end, packets that wait are given up when none has moved for so long, ns.
const PATIENCE: i64 = 1_000_000_000;

/// What the pacing thread owns.
pub(super) struct Pacer<C> {
    pub pace: Pace<C>,
    pub ring: Consumer<Item>,
    /// One an output.
    pub lanes: Vec<Lane>,
}

/// What is to be known of a packet that is still in the ring.
#[derive(Clone, Copy, Debug)]
struct Next {
    lane: usize,
    carries: Kinds,
    t: SimTime,
}

impl<C: Clock> Pacer<C> {
    /// Sends everything, stream time 0 being at `start` (ns on its clock), until the ring has ended or all stops.
    pub(super) fn run(&mut self, start: i64) {
        self.pace.begin(start);
        self.stream();
        self.pace.end();
    }

    fn stream(&mut self) {
        while !self.pace.shared.stopped() && self.lanes.iter().any(Lane::is_open) {
            let replied = self.reply();
            let look_up = self.look_up();
            match self.ring.peek() {
                Ok(Item { lane, packet }) => {
                    let next = Next { lane: *lane, carries: packet.carries, t: packet.due };
                    if let Some(due) = self.comes_up(next, look_up, replied) {
                        self.send_next(due, replied);
                    }
                }
                Err(_) if self.pace.shared.all_made.load(Ordering::Acquire) && self.ring.is_empty() => {
                    return self.settle();
                }
                Err(_) => std::thread::sleep(EMPTY),
            }
        }
    }

    /// Writes the next reply to each link; the most that came of it.
    fn reply(&mut self) -> Replied {
        let replied = self.lanes.iter_mut().map(|lane| lane.reply(&self.pace));
        replied.max().unwrap_or(Replied::Nothing)
    }

    /// Sends what waits, as far as the links take it now; how far ahead of a packet something else may happen, ns.
    fn look_up(&mut self) -> i64 {
        if self.lanes.iter().any(Lane::is_behind) {
            self.catch_up();
            RETRY
        } else if self.lanes.iter().any(|lane| lane.replies.is_some()) {
            REPLY_SOON
        } else {
            LOOK_UP
        }
    }

    /// When the next packet is due on the clock, once nothing is to be done before it; if something is, some of that
    /// is done.
    fn comes_up(&mut self, next: Next, look_up: i64, replied: Replied) -> Option<i64> {
        if self.pace.is_bare_timers_turn(next.t) {
            self.pace.compare();
            self.lanes.iter_mut().for_each(Lane::pause);
            return None;
        }
        if !self.may_go(next) {
            return None;
        }
        let (due, now) = (self.due(next.t), self.pace.clock.now());
        if due > now + look_up {
            self.pace.clock.sleep_until(now + look_up / 2);
            return None;
        }
        if replied != Replied::Nothing && due > now + SPARE {
            // Right behind a packet a link is full: later it may take the reply, too.
            if replied == Replied::Full {
                self.pace.clock.sleep_until(now + RETRY);
            }
            return None;
        }
        Some(due)
    }

    /// Whether the next packet need not wait for the other side; if it has to, some of that wait has passed.
    fn may_go(&mut self, Next { lane, carries, t }: Next) -> bool {
        match self.lanes[lane].turn(carries, &self.pace.clock) {
            Turn::Goes => {}
            Turn::Waits => {
                let soon = self.pace.clock.now() + RETRY;
                self.pace.clock.doze_until(soon);
                return false;
            }
            Turn::WasLate => self.pace.stood_still(self.due(t), t),
            // The tempo is another from here on.
            Turn::Even => self.pace.due_now(self.due(t)),
            Turn::Untaken => {
                self.pace.shared.untaken.add(1);
                self.pace.due_now(self.due(t));
            }
        }
        true
    }

    /// Waits until `due` and delivers the next packet.
    fn send_next(&mut self, due: i64, replied: Replied) {
        // The packet leaves the ring before the wait, so that nothing stands between the wait and the write.
        let Ok(Item { lane, packet }) = self.ring.pop() else { return };
        if due != AT_ONCE {
            self.pace.clock.wait_until(due);
        }
        if replied == Replied::Full {
            // Whoever waits for an answer waits longer than one who misses a sample.
            self.reply();
        }
        if packet.is_nothing() {
            self.lanes[lane].send_kept(packet.piece);
        } else {
            self.deliver(lane, Due { packet, due });
        }
        self.pace.shared.stream_ns.store(packet.due.0, Ordering::Relaxed);
    }

    /// Has its lane deliver a packet; for as long as that waits for its link, scene time stands still: all that follows
    /// is due later.
    fn deliver(&mut self, lane: usize, mut it: Due) {
        let due = it.due;
        if self.lanes[lane].deliver(it, &mut self.pace) == Delivery::Over {
            return;
        }
        let begun = self.pace.clock.now();
        loop {
            self.pace.wait(RETRY);
            self.catch_up();
            it.due = due + (self.pace.clock.now() - begun);
            if self.lanes[lane].deliver(it, &mut self.pace) == Delivery::Over {
                return self.pace.shift(it.due - due, it.packet.due);
            }
        }
    }

    fn catch_up(&mut self) {
        self.lanes.iter_mut().for_each(|lane| lane.catch_up(&mut self.pace));
    }

    /// At the end: what waits may still go, as long as some of it moves.
    fn settle(&mut self) {
        let packets = |pacer: &Self| pacer.pace.shared.packets.get();
        let mut moved = self.pace.clock.now();
        while self.lanes.iter().any(Lane::is_behind)
            && !self.pace.shared.stopped()
            && self.pace.clock.now() - moved < PATIENCE
        {
            let before = packets(self);
            self.pace.wait(RETRY);
            self.catch_up();
            if packets(self) > before {
                moved = self.pace.clock.now();
            }
        }
    }

    /// When what is due at the stream time `t` is due on the clock, ns, or [`AT_ONCE`].
    fn due(&self, t: SimTime) -> i64 {
        self.pace.due(t, self.tempo())
    }

    /// How fast stream time goes now: a controller that has not answered yet is not sent packets faster than in real
    /// time.
    fn tempo(&self) -> Speed {
        match self.pace.speed {
            Speed::Times(times) if times <= 1.0 => self.pace.speed,
            _ if self.lanes.iter().any(Lane::is_unanswered) => Speed::Times(1.0),
            _ => self.pace.speed,
        }
    }

    /// Counts what is in the ring and the queues as left: made, but neither sent nor dropped.
    pub(super) fn give_up(&mut self) {
        self.lanes.iter_mut().for_each(Lane::give_up);
        while let Ok(item) = self.ring.pop() {
            self.lanes[item.lane].left.add(&item.packet);
        }
    }
}
