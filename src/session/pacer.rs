//! The pacing thread: takes the next packet, waits until it is due and has its lane deliver it. Nothing else.

use super::lane::{Delivery, Lane};
use super::pace::{AT_ONCE, Pace, Speed};
use super::replies::Replied;
use super::ring::{Item, Outlet};
use super::step::Turn;
use crate::clock::Clock;
use crate::sensor::Kinds;
use crate::time::SimTime;
use crate::wire::{Head, Packet};
use std::sync::atomic::Ordering;
use std::time::Duration;

/// Waits are cut into pieces this long, ns, to notice a stop.
const LOOK_UP: i64 = 50_000_000;
/// The length of a piece where replies may come that must go out soon, ns.
const REPLY_SOON: i64 = 10_000_000;
/// With at least this much time before the next packet, ns, another reply fits in.
const SPARE: i64 = 2_000_000;
/// Time between two attempts on a full link, or for a packet that waits for its turn, ns.
const RETRY: i64 = 1_000_000;
/// Wait for the producer when the ring is empty.
const EMPTY: Duration = Duration::from_micros(50);
/// The most packets that go to one link without a look at anything else.
const GATHERED: usize = 64;
/// At the end, waiting packets are given up when none has moved for this long, ns.
const PATIENCE: i64 = 1_000_000_000;

/// What the pacing thread owns.
pub(super) struct Pacer<C> {
    pub pace: Pace<C>,
    pub ring: Outlet,
    /// One for each output.
    pub lanes: Vec<Lane>,
    /// The packet that was taken last.
    packet: Packet,
}

/// What the pacer needs to know of a packet that is still in the ring.
#[derive(Clone, Copy, Debug)]
struct Next {
    lane: usize,
    carries: Kinds,
    t: SimTime,
}

impl<C: Clock> Pacer<C> {
    pub(super) fn new(pace: Pace<C>, ring: Outlet, lanes: Vec<Lane>) -> Pacer<C> {
        Pacer { pace, ring, lanes, packet: Packet::BLANK }
    }

    /// Sends everything until the ring ends or the run stops. Stream time 0 is at `start` (ns on its clock).
    pub(super) fn run(&mut self, start: i64) {
        self.pace.begin(start);
        self.stream();
        self.pace.end();
    }

    fn stream(&mut self) {
        while !self.pace.shared.stopped() && self.lanes.iter().any(Lane::is_open) {
            let replied = self.reply();
            let look_up = self.look_up();
            if self.gather() {
                continue;
            }
            match self.ring.peek() {
                Some(&Item { lane, head: Head { carries, due: t, .. } }) => {
                    let next = Next { lane, carries, t };
                    if let Some(due) = self.comes_up(next, look_up, replied) {
                        self.send_next(due, replied);
                    }
                }
                None if self.pace.shared.all_made.load(Ordering::Acquire) && self.ring.is_empty() => {
                    return self.settle();
                }
                None => std::thread::sleep(EMPTY),
            }
        }
    }

    /// Writes the next reply to each link; returns the strongest result.
    fn reply(&mut self) -> Replied {
        let replied = self.lanes.iter_mut().map(|lane| lane.reply(&self.pace));
        replied.max().unwrap_or(Replied::Nothing)
    }

    /// Sends waiting packets as far as the links take them now. Returns how long before a packet other work may
    /// run, ns.
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

    /// When the next packet is due on the clock, once nothing comes before it; otherwise does part of that work and
    /// returns `None`.
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
            // A link is full right after a packet: it may take the reply later.
            if replied == Replied::Full {
                self.pace.clock.sleep_until(now + RETRY);
            }
            return None;
        }
        Some(due)
    }

    /// Whether the next packet may go without waiting for the other side; if not, part of that wait passes here.
    fn may_go(&mut self, Next { lane, carries, t }: Next) -> bool {
        match self.lanes[lane].turn(carries, &self.pace.clock) {
            Turn::Goes => {}
            Turn::Waits => {
                let soon = self.pace.clock.now() + RETRY;
                self.pace.clock.doze_until(soon);
                return false;
            }
            Turn::WasLate => self.pace.stood_still(self.due(t), t),
            // The tempo changes from here on.
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
        // The packet leaves the ring before the wait, so that nothing comes between the wait and the write.
        let Some(lane) = self.ring.take(&mut self.packet) else { return };
        if due != AT_ONCE {
            self.pace.clock.wait_until(due);
        }
        if replied == Replied::Full {
            // A controller that waits for an answer waits longer than one that misses a sample.
            self.reply();
        }
        if self.packet.is_nothing() {
            self.lanes[lane].send_kept(self.packet.piece);
        } else {
            self.deliver(lane, due);
        }
        self.pace.shared.stream_ns.store(self.packet.due.0, Ordering::Relaxed);
    }

    /// Has its lane deliver the packet that was taken last. While it waits for its link, scene time stands still:
    /// everything after it becomes due later.
    fn deliver(&mut self, lane: usize, due: i64) {
        if self.lanes[lane].deliver(&self.packet, due, &mut self.pace) == Delivery::Over {
            return;
        }
        let begun = self.pace.clock.now();
        loop {
            self.pace.wait(RETRY);
            self.catch_up();
            let by = self.pace.clock.now() - begun;
            if self.lanes[lane].deliver(&self.packet, due + by, &mut self.pace) == Delivery::Over {
                return self.pace.shift(by, self.packet.due);
            }
        }
    }

    /// At full speed: takes the next packets as long as their link only puts them with others, which needs neither a
    /// clock nor a turn. Whether there were any.
    fn gather(&mut self) -> bool {
        if self.pace.speed.is_paced() || self.pace.watching.is_some() {
            return false;
        }
        let Some(&Item { lane, head }) = self.ring.peek() else { return false };
        if !self.lanes[lane].gathers(&head) {
            return false;
        }
        let began = self.pace.clock.now();
        for _ in 0..GATHERED {
            match self.ring.peek() {
                Some(next) if next.lane == lane && self.lanes[lane].gathers(&next.head) => {}
                _ => break,
            }
            self.ring.take(&mut self.packet);
            self.lanes[lane].gather(&self.packet, began, &self.pace.shared);
        }
        self.lanes[lane].gathered(self.pace.clock.now(), &self.pace.shared);
        self.pace.shared.stream_ns.store(self.packet.due.0, Ordering::Relaxed);
        true
    }

    fn catch_up(&mut self) {
        self.lanes.iter_mut().for_each(|lane| lane.catch_up(&mut self.pace));
    }

    /// At the end: waiting packets may still go, as long as some of them move.
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

    /// The due time on the clock of the stream time `t`, ns, or [`AT_ONCE`].
    fn due(&self, t: SimTime) -> i64 {
        self.pace.due(t, self.tempo())
    }

    /// The present speed of stream time: a controller that has not answered yet gets packets no faster than in real
    /// time.
    fn tempo(&self) -> Speed {
        match self.pace.speed {
            Speed::Times(times) if times <= 1.0 => self.pace.speed,
            _ if self.lanes.iter().any(Lane::is_unanswered) => Speed::Times(1.0),
            _ => self.pace.speed,
        }
    }

    /// Counts packets in the ring and the queues as left: made, but neither sent nor dropped.
    pub(super) fn give_up(&mut self) {
        self.lanes.iter_mut().for_each(Lane::give_up);
        while let Some(lane) = self.ring.take(&mut self.packet) {
            self.lanes[lane].left.add(&self.packet);
        }
    }
}
