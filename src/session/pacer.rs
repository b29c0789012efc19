//! The pacing thread: takes the next packet, waits until it is due, writes it, counts. Nothing else.

use super::tally::{Effort, LinkTally, SensorTally};
use super::watch::Watching;
use super::{Item, Shared};
use crate::clock::Clock;
use crate::link::{Sender, Sent};
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
    pub effort: Effort,
    /// The comparison that `timing` asks for.
    pub watching: Option<Watching>,
}

impl<C: Clock> Pacer<C> {
    pub(super) fn new(clock: C, ring: Consumer<Item>, senders: Vec<Sender>, speed: Speed) -> Pacer<C> {
        let tallies = senders.iter().map(|_| LinkTally::new()).collect();
        let gone = vec![None; senders.len()];
        Pacer { clock, ring, senders, tallies, gone, speed, effort: Effort::default(), watching: None }
    }

    /// Sends everything, scene time 0 being at `start` (ns on its clock), until the ring has ended or all stops.
    pub(super) fn run(&mut self, start: i64, shared: &Shared) {
        self.effort.resume(self.clock.now());
        self.stream(start, shared);
        self.effort.pause(self.clock.now());
    }

    fn stream(&mut self, mut start: i64, shared: &Shared) {
        shared.start_ns.store(start, Ordering::Relaxed);
        while !shared.stopped() && self.gone.contains(&None) {
            let Ok(item) = self.ring.peek() else {
                if shared.all_made.load(Ordering::Acquire) && self.ring.is_empty() {
                    return;
                }
                std::thread::sleep(EMPTY);
                continue;
            };
            if self.watching.as_ref().is_some_and(|watching| watching.interrupts(&item.packet)) {
                start = self.compare(shared).unwrap_or(start);
                continue;
            }
            let due = match self.speed {
                Speed::Times(1.0) => start + item.packet.due.0,
                Speed::Times(times) => start + (item.packet.due.0 as f64 / times) as i64,
                Speed::Max => i64::MIN,
            };
            if due > self.clock.now() + LOOK_UP {
                self.clock.sleep_until(self.clock.now() + LOOK_UP / 2);
                continue;
            }
            // The packet leaves the ring before the wait, so that nothing stands between the wait and the write.
            let Ok(Item { output, packet }) = self.ring.pop() else { continue };
            if due != i64::MIN {
                self.clock.wait_until(due);
            }
            self.send(output, &packet, due, shared);
        }
    }

    /// A slice of the bare timer: answers where scene time 0 is after it.
    fn compare(&mut self, shared: &Shared) -> Option<i64> {
        let watching = self.watching.as_mut()?;
        self.effort.pause(self.clock.now());
        let start = watching.bare_timer(&mut self.clock, shared);
        self.tallies.iter_mut().flat_map(|tally| &mut tally.sensors).for_each(SensorTally::pause);
        shared.start_ns.store(start, Ordering::Relaxed);
        self.effort.resume(self.clock.now());
        Some(start)
    }

    fn send(&mut self, output: usize, packet: &Packet, due: i64, shared: &Shared) {
        let before = self.clock.now();
        let sent = match self.speed {
            _ if self.gone[output].is_some() => Sent::Full,
            Speed::Max => self.senders[output].send_all(packet.bytes(), &shared.stop),
            Speed::Times(_) => self.senders[output].send(packet.bytes()),
        };
        let after = self.clock.now();
        let done = sent == Sent::Done;
        if let Sent::Gone(kind) = sent {
            self.gone[output] = Some(kind);
        }
        let tally = &mut self.tallies[output];
        let late = if due == i64::MIN { 0 } else { before - due };
        for (i, sensor) in tally.sensors.iter_mut().enumerate() {
            let mut lost = u64::from(packet.replaced[i]);
            match (packet.carries >> i & 1 == 1, done) {
                (true, true) => sensor.sent(before, late, after - before),
                (true, false) => lost += 1,
                (false, _) => {}
            }
            sensor.dropped += lost;
            shared.dropped.fetch_add(lost, Ordering::Relaxed);
        }
        if let Some(watching) = &mut self.watching {
            watching.packet(packet, due, done.then_some(before));
        }
        tally.packets += u64::from(done);
        tally.bytes += if done { packet.bytes().len() as u64 } else { 0 };
        tally.dropped += u64::from(!done);
        shared.packets.fetch_add(u64::from(done), Ordering::Relaxed);
        shared.scene_ns.store(packet.due.0, Ordering::Relaxed);
    }

    /// Samples left in the ring, of each kind: made, but neither sent nor dropped.
    pub(super) fn left(&mut self) -> [u64; 3] {
        let mut left = [0; 3];
        while let Ok(item) = self.ring.pop() {
            for (i, left) in left.iter_mut().enumerate() {
                *left += u64::from(item.packet.carries >> i & 1) + u64::from(item.packet.replaced[i]);
            }
        }
        left
    }
}
