//! The pacing thread: takes the next packet, waits until it is due, writes it, counts. Nothing else; what is not
//! taken in time is the business of `overload`.

use super::lockstep::Step;
use super::overload::{Due, Queue, RETRY};
use super::replies::{Replied, Replies};
use super::tally::{Effort, LinkTally, SensorTally};
use super::watch::Watching;
use super::{Item, Shared};
use crate::clock::Clock;
use crate::link::{Sender, Sent};
use crate::scene::Overload;
use crate::sensor::ByKind;
use crate::time::SimTime;
use crate::wire::Packet;
use rtrb::Consumer;
use std::sync::atomic::Ordering;
use std::time::Duration;

/// How fast scene time goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Speed {
    /// This many scene seconds a second.
    Times(f64),
    /// As fast as the other side reads: nothing paced, nothing dropped.
    Max,
}

/// A wait is cut into pieces this long, ns, to notice that everything stops.
const LOOK_UP: i64 = 50_000_000;
/// The same where replies may come that are to be written soon.
const REPLY_SOON: i64 = 10_000_000;
/// With so much time until the next packet, ns, there is enough for another reply.
const SPARE: i64 = 2_000_000;
/// How long to wait for the producer when the ring is empty.
const EMPTY: Duration = Duration::from_micros(50);

/// What the pacing thread owns.
pub(super) struct Pacer<C> {
    pub clock: C,
    pub ring: Consumer<Item>,
    pub senders: Vec<Sender>,
    pub tallies: Vec<LinkTally>,
    /// Why a link takes nothing any more.
    pub gone: Vec<Option<std::io::ErrorKind>>,
    pub speed: Speed,
    /// What is not sent yet, by output.
    pub queues: Vec<Queue>,
    /// Scene time 0 on its clock, ns.
    pub start: i64,
    /// For how long scene time stood still, ns: `start` has moved by as much.
    pub stretched: i64,
    pub effort: Effort,
    /// The comparison that `timing` asks for.
    pub watching: Option<Watching>,
    /// What is to be written between the packets, by output.
    pub replies: Vec<Option<Replies>>,
    /// Which outputs are in lockstep.
    pub steps: Vec<Option<Step>>,
}

/// What was made and neither sent nor dropped.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Left {
    /// Samples, of each kind.
    pub samples: ByKind<u64>,
    /// Packets, of each output.
    pub packets: Vec<u64>,
}

impl Left {
    pub(super) fn nothing(outputs: usize) -> Left {
        Left { samples: ByKind::default(), packets: vec![0; outputs] }
    }

    fn add(&mut self, output: usize, packet: &Packet) {
        if packet.is_nothing() {
            return;
        }
        self.packets[output] += 1;
        for (i, samples) in self.samples.iter_mut().enumerate() {
            *samples += u64::from(packet.carries >> i & 1) + u64::from(packet.replaced[i]);
        }
    }
}

impl std::ops::AddAssign for Left {
    fn add_assign(&mut self, more: Left) {
        self.samples.iter_mut().zip(more.samples).for_each(|(sum, more)| *sum += more);
        self.packets.iter_mut().zip(more.packets).for_each(|(sum, more)| *sum += more);
    }
}

impl<C: Clock> Pacer<C> {
    /// One sender and one policy an output.
    pub(super) fn new(
        clock: C,
        ring: Consumer<Item>,
        senders: Vec<Sender>,
        policies: impl IntoIterator<Item = Overload>,
        speed: Speed,
    ) -> Pacer<C> {
        let tallies = senders.iter().map(|_| LinkTally::new()).collect();
        let gone = vec![None; senders.len()];
        let queues = policies.into_iter().map(Queue::new).collect();
        let effort = Effort::default();
        let replies = senders.iter().map(|_| None).collect();
        let steps = senders.iter().map(|_| None).collect();
        Pacer {
            clock,
            ring,
            senders,
            tallies,
            gone,
            speed,
            queues,
            start: 0,
            stretched: 0,
            effort,
            watching: None,
            replies,
            steps,
        }
    }

    /// Sends everything, scene time 0 being at `start` (ns on its clock), until the ring has ended or all stops.
    pub(super) fn run(&mut self, start: i64, shared: &Shared) {
        self.start = start;
        self.effort.resume(self.clock.now());
        self.stream(shared);
        self.effort.pause(self.clock.now());
    }

    fn stream(&mut self, shared: &Shared) {
        let start = self.start;
        shared.start_ns.store(start, Ordering::Relaxed);
        while !shared.stopped() && self.gone.contains(&None) {
            let replied = self.reply(shared);
            let look_up = if self.something_waits() {
                self.send_all_waiting(shared);
                RETRY
            } else if self.replies.iter().any(Option::is_some) {
                REPLY_SOON
            } else {
                LOOK_UP
            };
            let Ok(item) = self.ring.peek() else {
                if shared.all_made.load(Ordering::Acquire) && self.ring.is_empty() {
                    return self.settle(shared);
                }
                std::thread::sleep(EMPTY);
                continue;
            };
            if self.watching.as_ref().is_some_and(|watching| watching.interrupts(&item.packet)) {
                self.compare(shared);
                continue;
            }
            let (output, carries, t) = (item.output, item.packet.carries, item.packet.due);
            if self.steps_after(output, carries, t, shared) {
                continue;
            }
            let (due, now) = (self.due(t), self.clock.now());
            if due > now + look_up {
                self.clock.sleep_until(now + look_up / 2);
                continue;
            }
            if replied != Replied::Nothing && due > now + SPARE {
                // Right behind a packet a link is full: later it may take the reply, too.
                if replied == Replied::Full {
                    self.clock.sleep_until(now + RETRY);
                }
                continue;
            }
            // The packet leaves the ring before the wait, so that nothing stands between the wait and the write.
            let Ok(Item { output, packet }) = self.ring.pop() else { continue };
            if due != i64::MIN {
                self.clock.wait_until(due);
            }
            if replied == Replied::Full {
                // Whoever waits for an answer waits longer than one who misses a sample.
                self.reply(shared);
            }
            if packet.is_nothing() {
                self.senders[output].send_kept(packet.piece.into());
            } else {
                self.deliver(output, Due { packet, due }, shared);
            }
            shared.stream_ns.store(packet.due.0, Ordering::Relaxed);
        }
    }

    /// When what is due at the stream time `t` is due on the clock, ns; `i64::MIN` where nothing is paced.
    pub(super) fn due(&self, t: SimTime) -> i64 {
        match self.tempo() {
            Speed::Times(1.0) => self.start + t.0,
            Speed::Times(times) => self.start + (t.0 as f64 / times) as i64,
            Speed::Max => i64::MIN,
        }
    }

    /// A slice of the bare timer, in which scene time stands still.
    fn compare(&mut self, shared: &Shared) {
        let Some(watching) = &mut self.watching else { return };
        self.effort.pause(self.clock.now());
        self.start = watching.bare_timer(&mut self.clock, shared);
        self.tallies.iter_mut().flat_map(|tally| &mut tally.sensors).for_each(SensorTally::pause);
        shared.start_ns.store(self.start, Ordering::Relaxed);
        self.effort.resume(self.clock.now());
    }

    /// Writes a packet, and counts it if the link took it.
    pub(super) fn attempt(&mut self, output: usize, it: &Due, shared: &Shared) -> Sent {
        let Due { packet, due } = it;
        let taken = self.steps[output].as_ref().map_or(0, Step::taken);
        let before = self.clock.now();
        let (sender, bytes) = (&mut self.senders[output], packet.bytes());
        let sent = match (self.speed, usize::from(packet.piece)) {
            (Speed::Max, 0) => sender.send_all(bytes, &shared.stop),
            (Speed::Max, piece) => sender.send_all_first(bytes, piece, &shared.stop),
            (Speed::Times(_), 0) => sender.send(bytes),
            (Speed::Times(_), piece) => sender.send_first(bytes, piece),
        };
        let tally = &mut self.tallies[output];
        match sent {
            Sent::Done => {
                let late = if *due == i64::MIN { 0 } else { before - due };
                tally.sent(packet, before, late, self.clock.now() - before);
                shared.packets.fetch_add(1, Ordering::Relaxed);
                self.forget_replaced(output, packet, shared);
                self.watch(packet, *due, Some(before));
                if let Some(step) = &mut self.steps[output] {
                    step.sent(packet, taken, before);
                }
            }
            Sent::Away => tally.gaps.begin(before),
            Sent::Gone(kind) => self.gone[output] = Some(kind),
            Sent::Full => {}
        }
        sent
    }

    /// Counts a packet as dropped.
    pub(super) fn lose(&mut self, output: usize, packet: &Packet, shared: &Shared) {
        let lost = self.tallies[output].dropped(packet);
        shared.dropped.fetch_add(lost, Ordering::Relaxed);
        self.forget_replaced(output, packet, shared);
        self.watch(packet, self.start + packet.due.0, None);
    }

    fn watch(&mut self, packet: &Packet, due: i64, sent: Option<i64>) {
        if let Some(watching) = &mut self.watching {
            watching.packet(packet, due, sent);
        }
    }

    /// Samples that newer ones replaced before this packet are dropped, whatever becomes of it.
    fn forget_replaced(&mut self, output: usize, packet: &Packet, shared: &Shared) {
        let lost = self.tallies[output].replaced(packet);
        shared.dropped.fetch_add(lost, Ordering::Relaxed);
    }

    /// What is left in the ring and in the queues: made, but neither sent nor dropped.
    pub(super) fn left(&mut self) -> Left {
        let mut left = Left::nothing(self.senders.len());
        for (output, queue) in self.queues.iter_mut().enumerate() {
            queue.drain().for_each(|packet| left.add(output, &packet));
        }
        while let Ok(item) = self.ring.pop() {
            left.add(item.output, &item.packet);
        }
        left
    }
}
