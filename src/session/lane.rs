//! All that the pacing thread has of one output.
//!
//! Every packet that comes out of the ring ends as sent, dropped or left, and is counted as it does. Nothing is sent
//! out of order on a link, and nothing waits here that the output's policy did not ask for. It allocates nothing and
//! takes no lock.

use super::account::Account;
use super::feed::Made;
use super::left::Left;
use super::pace::{Pace, Speed};
use super::queue::{Due, Queue};
use super::replies::{Replied, Replies};
use super::step::{Step, Turn};
use super::tally::{SensorTally, Tally};
use crate::clock::Clock;
use crate::link::{Sender, Sent};
use crate::scene::Overload;
use crate::sensor::Kinds;
use crate::wire::Packet;
use std::io::ErrorKind;
use tokio::time::Instant;

/// The pacing thread's half of an output.
pub(super) struct Lane {
    pub sender: Sender,
    /// What is to be written between the packets, where the other side is spoken with.
    pub replies: Option<Replies>,
    /// In lockstep: how far the other side is.
    pub step: Option<Step>,
    pub tally: Tally,
    pub left: Left,
    /// Why its link takes nothing any more.
    pub end: Option<ErrorKind>,
    policy: Overload,
    queue: Queue,
}

/// What came of a packet that was due.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[must_use]
pub(super) enum Delivery {
    /// It is sent, lost, or in the queue.
    Over,
    /// It is to be delivered again soon, and scene time stands still until its link takes it.
    Again,
}

impl Lane {
    /// Of a link that is too slow, this is to become.
    pub(super) fn new(sender: Sender, policy: Overload) -> Lane {
        Lane {
            sender,
            replies: None,
            step: None,
            tally: Tally::default(),
            left: Left::default(),
            end: None,
            policy,
            queue: Queue::new(policy),
        }
    }

    /// Whether its link may still take something.
    pub(super) fn is_open(&self) -> bool {
        self.end.is_none()
    }

    /// Whether a packet waits for its link.
    pub(super) fn is_behind(&self) -> bool {
        !self.queue.is_empty()
    }

    /// Whether the other side has not answered anything yet that it is to answer.
    pub(super) fn is_unanswered(&self) -> bool {
        self.step.as_ref().is_some_and(Step::is_unanswered)
    }

    /// Whether a packet that carries these kinds may go, or has to wait for the other side.
    pub(super) fn turn(&mut self, carries: Kinds, clock: &impl Clock) -> Turn {
        match &mut self.step {
            Some(step) if self.end.is_none() => step.turn(carries, clock),
            _ => Turn::Goes,
        }
    }

    /// Sends a packet that is due, or does with it what the policy says.
    pub(super) fn deliver<C: Clock>(&mut self, it: Due, pace: &mut Pace<C>) -> Delivery {
        match (pace.speed, self.policy) {
            _ if self.end.is_some() => self.lose(&it.packet, pace),
            (Speed::Max, _) => self.deliver_all(it, pace),
            (_, Overload::DropNewest) => self.deliver_now(it, pace),
            (_, Overload::DropOldest) => self.deliver_in_turn(it, pace),
            (_, Overload::Stretch) => return self.deliver_late(it, pace),
        }
        Delivery::Over
    }

    fn deliver_now<C: Clock>(&mut self, it: Due, pace: &mut Pace<C>) {
        if self.attempt(&it, pace) != Sent::Done {
            self.lose(&it.packet, pace);
        }
    }

    /// Nothing is paced: the link has all the time it needs.
    fn deliver_all<C: Clock>(&mut self, it: Due, pace: &mut Pace<C>) {
        match self.attempt(&it, pace) {
            Sent::Done => {}
            Sent::Gone(_) => self.lose(&it.packet, pace),
            // Stopped meanwhile.
            Sent::Full | Sent::Away => self.queue.push(it),
        }
    }

    /// After those that wait; one more than there is room for costs the oldest.
    fn deliver_in_turn<C: Clock>(&mut self, it: Due, pace: &mut Pace<C>) {
        self.catch_up(pace);
        if self.queue.is_empty() {
            match self.attempt(&it, pace) {
                Sent::Done => return,
                Sent::Full => {}
                Sent::Away | Sent::Gone(_) => return self.lose(&it.packet, pace),
            }
        }
        if let Some(oldest) = self.queue.make_room() {
            self.lose(&oldest.packet, pace);
        }
        self.queue.push(it);
    }

    /// Nothing is lost: what the link does not take is due when it does.
    fn deliver_late<C: Clock>(&mut self, it: Due, pace: &mut Pace<C>) -> Delivery {
        match self.attempt(&it, pace) {
            Sent::Done => {}
            Sent::Gone(_) => self.lose(&it.packet, pace),
            Sent::Full | Sent::Away if pace.shared.stopped() => self.queue.push(it),
            Sent::Full | Sent::Away => return Delivery::Again,
        }
        Delivery::Over
    }

    /// Sends what waits here, as far as the link takes it now.
    pub(super) fn catch_up<C: Clock>(&mut self, pace: &mut Pace<C>) {
        if self.policy != Overload::DropOldest {
            return;
        }
        while let Some(it) = self.queue.oldest() {
            match self.attempt(&it, pace) {
                Sent::Full => return,
                Sent::Done => {}
                // A port that comes back gets the present, not what was due before it left.
                Sent::Away | Sent::Gone(_) => self.lose(&it.packet, pace),
            }
            self.queue.pop();
        }
    }

    /// Writes a packet, and counts it if the link took it.
    fn attempt<C: Clock>(&mut self, it: &Due, pace: &mut Pace<C>) -> Sent {
        let taken = self.step.as_ref().map_or(0, Step::taken);
        let before = pace.clock.now();
        let sent = self.write(&it.packet, pace);
        match sent {
            Sent::Done => {
                self.tally.sent(&it.packet, before, it.late(before), pace.clock.now() - before);
                pace.shared.packets.add(1);
                self.forget_replaced(&it.packet, pace);
                pace.record_sent(&it.packet, it.due, before);
                if let Some(step) = &mut self.step {
                    step.sent(&it.packet, taken, before);
                }
            }
            Sent::Away => self.tally.gaps.begin(before),
            Sent::Full | Sent::Gone(_) => {}
        }
        sent
    }

    /// Hands a packet to the link, and notes where it is gone.
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

    /// Sends so many bytes more of the packet before, which went out in part.
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

    /// Samples that newer ones replaced before this packet are dropped, whatever becomes of it.
    fn forget_replaced<C: Clock>(&mut self, packet: &Packet, pace: &Pace<C>) {
        let lost = self.tally.replaced(packet);
        pace.shared.dropped.add(lost);
    }

    /// Writes the next reply; what came of it.
    pub(super) fn reply<C: Clock>(&mut self, pace: &Pace<C>) -> Replied {
        let Some(packet) = self.replies.as_mut().and_then(Replies::next) else { return Replied::Nothing };
        if self.end.is_some() {
            return Replied::Nothing;
        }
        // At full speed a link that is full all the time would never take it without a wait.
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

    /// Scene time stands still: the time to the next sample is no interval.
    pub(super) fn pause(&mut self) {
        self.tally.sensors.iter_mut().for_each(SensorTally::pause);
    }

    /// What waits is not sent any more.
    pub(super) fn give_up(&mut self) {
        while let Some(it) = self.queue.pop() {
            self.left.add(&it.packet);
        }
    }

    /// Sends what the other side is left with, each packet as long as it takes until the deadline.
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

    /// Sends all that is kept of earlier packets.
    pub(super) fn finish(&mut self) {
        if let Err(error) = self.sender.finish() {
            self.end.get_or_insert(error.kind());
        }
    }

    /// Lets go of the link at `now`; what came of the packets made for it.
    pub(super) fn account(mut self, made: Made, now: i64) -> Account {
        self.tally.gaps.end(now);
        Account { made, tally: self.tally, left: self.left, end: self.end }
    }
}
