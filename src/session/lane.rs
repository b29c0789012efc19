//! The pacing thread's half of an output.
//!
//! Every packet from the ring ends as sent, dropped or left, and is counted once. A link sends nothing out of
//! order, and packets wait here only as the output's policy says. The lane allocates nothing and takes no lock.

use super::Shared;
use super::account::Account;
use super::feed::Made;
use super::left::Left;
use super::pace::{Pace, Speed};
use super::queue::{self, Due, Queue};
use super::replies::{Replied, Replies};
use super::shared::LaneCounts;
use super::step::{self, Step, Turn};
use super::tally::{SensorTally, Tally};
use crate::clock::Clock;
use crate::link::{Sender, Sent};
use crate::scene::Overload;
use crate::sensor::Kinds;
use crate::wire::{Head, Packet};
use std::io::ErrorKind;
use std::sync::Arc;
use tokio::time::Instant;

/// The pacing thread's half of an output.
pub(super) struct Lane {
    pub sender: Sender,
    /// Replies to write between the packets, if there is a dialogue.
    pub replies: Option<Replies>,
    /// In lockstep: how far the other side has read.
    pub step: Option<Step>,
    pub tally: Tally,
    pub left: Left,
    /// Why its link stopped taking packets.
    pub end: Option<ErrorKind>,
    /// What the others may know of its counts.
    pub counts: Arc<LaneCounts>,
    policy: Overload,
    queue: Queue,
}

/// What happened to a packet that was due.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[must_use]
pub(super) enum Delivery {
    /// It is sent, lost, or in the queue.
    Over,
    /// To be delivered again soon; scene time stands still until the link takes it.
    Again,
}

impl Lane {
    /// A lane whose link follows this policy when it is too slow.
    pub(super) fn new(sender: Sender, policy: Overload) -> Lane {
        Lane {
            sender,
            replies: None,
            step: None,
            tally: Tally::default(),
            left: Left::default(),
            end: None,
            counts: Arc::default(),
            policy,
            queue: Queue::new(policy),
        }
    }

    /// Whether the link still takes packets.
    pub(super) fn is_open(&self) -> bool {
        self.end.is_none()
    }

    /// Whether a packet waits for its link.
    pub(super) fn is_behind(&self) -> bool {
        !self.queue.is_empty()
    }

    /// Whether the other side owes its first answer.
    pub(super) fn is_unanswered(&self) -> bool {
        self.step.as_ref().is_some_and(Step::is_unanswered)
    }

    /// Whether a packet with these kinds may go now, or waits for the other side.
    pub(super) fn turn(&mut self, carries: Kinds, clock: &impl Clock) -> Turn {
        match &mut self.step {
            Some(step) if self.end.is_none() => step.turn(carries, clock),
            _ => Turn::Goes,
        }
    }

    /// Sends a due packet, or applies the overload policy to it.
    pub(super) fn deliver<C: Clock>(&mut self, packet: &Packet, due: i64, pace: &mut Pace<C>) -> Delivery {
        match (pace.speed, self.policy) {
            _ if self.end.is_some() => self.lose(packet, pace),
            (Speed::Max, _) => self.deliver_all(packet, due, pace),
            (_, Overload::DropNewest) => self.deliver_now(packet, due, pace),
            (_, Overload::DropOldest) => self.deliver_in_turn(packet, due, pace),
            (_, Overload::Stretch) => return self.deliver_late(packet, due, pace),
        }
        self.publish();
        Delivery::Over
    }

    /// Whether its link only puts a packet with others, and nothing else is to be done with it.
    pub(super) fn gathers(&self, head: &Head) -> bool {
        let plain = self.step.is_none() && self.queue.is_empty() && self.end.is_none();
        plain && head.piece == 0 && !head.is_nothing() && self.sender.gathers(head.size())
    }

    /// Puts a packet with others, which its link [`gathers`](Lane::gathers), and counts it as sent at `now`.
    pub(super) fn gather(&mut self, packet: &Packet, now: i64, shared: &Shared) {
        self.sender.gather(packet.bytes());
        self.tally.gathered(packet, now);
        if shared.scene_time(packet.due).is_some() {
            self.tally.in_scene(now, true);
        }
        let lost = self.tally.replaced(packet);
        shared.dropped.add(lost);
    }

    /// The packets gathered since the last call are sent at `now`.
    pub(super) fn gathered(&mut self, now: i64, shared: &Shared) {
        shared.packets.add(self.tally.gathered_by(now));
        self.publish();
    }

    /// Lets the others know of its counts.
    fn publish(&self) {
        self.counts.packets.set(self.tally.packets);
        self.counts.bytes.set(self.tally.bytes);
        self.counts.dropped.set(self.tally.dropped);
        self.counts.queued.set(self.queue.len() as u64);
    }

    fn deliver_now<C: Clock>(&mut self, packet: &Packet, due: i64, pace: &mut Pace<C>) {
        if self.attempt(packet, due, pace) != Sent::Done {
            self.lose(packet, pace);
        }
    }

    /// Unpaced: the link gets all the time it needs.
    fn deliver_all<C: Clock>(&mut self, packet: &Packet, due: i64, pace: &mut Pace<C>) {
        match self.attempt(packet, due, pace) {
            Sent::Done => {}
            Sent::Gone(_) => self.lose(packet, pace),
            // Everything stopped meanwhile.
            Sent::Full | Sent::Away => self.queue.push(Due { packet: *packet, due }),
        }
    }

    /// Queues the packet behind those that wait; a full queue drops its oldest.
    fn deliver_in_turn<C: Clock>(&mut self, packet: &Packet, due: i64, pace: &mut Pace<C>) {
        self.catch_up(pace);
        if self.queue.is_empty() {
            match self.attempt(packet, due, pace) {
                Sent::Done => return,
                Sent::Full => {}
                Sent::Away | Sent::Gone(_) => return self.lose(packet, pace),
            }
        }
        if let Some(oldest) = self.queue.make_room() {
            self.lose(&oldest.packet, pace);
        }
        self.queue.push(Due { packet: *packet, due });
    }

    /// Loses nothing: a packet that the link does not take becomes due when it does.
    fn deliver_late<C: Clock>(&mut self, packet: &Packet, due: i64, pace: &mut Pace<C>) -> Delivery {
        match self.attempt(packet, due, pace) {
            Sent::Done => {}
            Sent::Gone(_) => self.lose(packet, pace),
            Sent::Full | Sent::Away if pace.shared.stopped() => self.queue.push(Due { packet: *packet, due }),
            Sent::Full | Sent::Away => return Delivery::Again,
        }
        self.publish();
        Delivery::Over
    }

    /// Sends waiting packets as far as the link takes them now.
    pub(super) fn catch_up<C: Clock>(&mut self, pace: &mut Pace<C>) {
        if self.policy != Overload::DropOldest {
            return;
        }
        while let Some(it) = self.queue.oldest() {
            match self.attempt(&it.packet, it.due, pace) {
                Sent::Full => return,
                Sent::Done => {}
                // A port that comes back gets current packets, not those due before it left.
                Sent::Away | Sent::Gone(_) => self.lose(&it.packet, pace),
            }
            self.queue.pop();
            self.publish();
        }
    }

    /// Writes a packet and counts it if the link took it.
    fn attempt<C: Clock>(&mut self, packet: &Packet, due: i64, pace: &mut Pace<C>) -> Sent {
        let taken = self.step.as_ref().map_or(0, Step::taken);
        let before = pace.clock.now();
        let sent = self.write(packet, pace);
        match sent {
            Sent::Done => {
                self.tally.sent(packet, before, queue::late(due, before), pace.clock.now() - before);
                if pace.shared.scene_time(packet.due).is_some() {
                    self.tally.in_scene(before, self.step.is_none() || step::is_answered(packet.carries));
                }
                pace.shared.packets.add(1);
                self.forget_replaced(packet, pace);
                pace.record_sent(packet, due, before);
                if let Some(step) = &mut self.step {
                    step.sent(packet, taken, before);
                }
            }
            Sent::Away => self.tally.gaps.begin(before),
            Sent::Full | Sent::Gone(_) => {}
        }
        sent
    }

    /// Writes a packet to the link, and records when the port is gone.
    fn write<C: Clock>(&mut self, packet: &Packet, pace: &Pace<C>) -> Sent {
        let (bytes, stop) = (packet.bytes(), &pace.shared.stop);
        let sent = match (pace.speed, usize::from(packet.piece)) {
            (Speed::Max, 0) => self.sender.send_all(bytes, stop),
            (Speed::Max, piece) => self.sender.send_all_first(bytes, piece, stop),
            (Speed::Times(_), 0) => self.sender.send(bytes),
            (Speed::Times(_), piece) => self.sender.send_first(bytes, piece),
        };
        if let Sent::Gone(kind) = sent {
            self.end = Some(kind);
        }
        sent
    }

    /// Sends up to this many more bytes of a packet that the link took in part.
    pub(super) fn send_kept(&mut self, bytes: u16) {
        self.sender.send_kept(bytes.into());
    }

    /// Counts a packet as dropped.
    fn lose<C: Clock>(&mut self, packet: &Packet, pace: &mut Pace<C>) {
        let lost = self.tally.dropped(packet);
        pace.shared.dropped.add(lost);
        self.forget_replaced(packet, pace);
        pace.record_lost(packet);
    }

    /// Counts samples that newer ones replaced before this packet as dropped, whatever happens to it.
    fn forget_replaced<C: Clock>(&mut self, packet: &Packet, pace: &Pace<C>) {
        let lost = self.tally.replaced(packet);
        pace.shared.dropped.add(lost);
    }

    /// Writes the next reply, and says what happened.
    pub(super) fn reply<C: Clock>(&mut self, pace: &Pace<C>) -> Replied {
        let Some(packet) = self.replies.as_mut().and_then(Replies::next) else { return Replied::Nothing };
        if self.end.is_some() {
            return Replied::Nothing;
        }
        // At full speed a link that is always full would never take it without a wait.
        match self.write(&packet, pace) {
            Sent::Done => {
                self.tally.replies += 1;
                Replied::Some
            }
            Sent::Full => {
                self.replies.iter_mut().for_each(|replies| replies.keep(packet));
                Replied::Full
            }
            Sent::Away | Sent::Gone(_) => Replied::Nothing,
        }
    }

    /// Scene time stands still: the time to the next sample does not count as an interval.
    pub(super) fn pause(&mut self) {
        self.tally.sensors.iter_mut().for_each(SensorTally::pause);
    }

    /// Gives up the packets that wait.
    pub(super) fn give_up(&mut self) {
        while let Some(it) = self.queue.pop() {
            self.left.add(&it.packet);
        }
    }

    /// Sends the farewell packets, each for as long as it takes, until the deadline.
    pub(super) async fn take_leave(&mut self, farewell: &[Packet], deadline: Instant) {
        for packet in farewell.iter().filter(|_| self.end.is_none()) {
            let sent = loop {
                match self.sender.send(packet.bytes()) {
                    Sent::Full if Instant::now() < deadline => tokio::time::sleep(super::shared::TICK).await,
                    sent => break sent,
                }
            };
            self.tally.replies += u64::from(sent == Sent::Done);
        }
    }

    /// Sends the rest of packets that went out in part.
    pub(super) fn finish(&mut self) {
        if let Err(error) = self.sender.finish() {
            self.end.get_or_insert(error.kind());
        }
    }

    /// Releases the link at `now` and gives the account of its packets.
    pub(super) fn account(mut self, made: Made, now: i64) -> Account {
        self.tally.gaps.end(now);
        Account { made, tally: self.tally, left: self.left, end: self.end }
    }
}
