//! The producer thread: plays the plan, encodes, and keeps the ring full.

use super::{Item, Shared};
use crate::player::{BLOCK, Moment, Player};
use crate::scene::{Output, Plan};
use crate::sensor::ByKind;
use crate::time::SimTime;
use crate::wire::{self, Acts, Encoder, Faults, Now, Packet, Protocol, Setup, dialogue::Peer};
use rtrb::{Producer, PushError};
use std::sync::atomic::Ordering;
use std::time::Duration;

/// How long to wait when the ring is full: far less than it holds.
const FULL: Duration = Duration::from_micros(200);

/// Samples made, and made but still waiting in an encoder for a packet: of each output, by sensor kind. And packets
/// made of them, of each output.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Made {
    pub samples: Vec<ByKind<u64>>,
    pub waiting: Vec<ByKind<u64>>,
    pub packets: Vec<u64>,
    /// What faults have done, of each output.
    pub faults: Vec<Vec<Acts>>,
}

/// Everything stopped before the end.
struct Stopped;

/// Plays `plan` up to `end` into the ring.
pub(super) fn produce(
    plan: &Plan,
    outputs: &[Output],
    end: SimTime,
    ring: Producer<Item>,
    shared: &Shared,
) -> Made {
    let setup = |output: &Output| Setup {
        sensors: &plan.sensors,
        axes: plan.axes,
        day: plan.day,
        options: output.wire,
        peer: Peer::default(),
    };
    let encoders: Vec<_> =
        outputs.iter().map(|output| wire::encoder(output.to.protocol, &setup(output))).collect();
    let faults = outputs
        .iter()
        .enumerate()
        .map(|(i, output)| Faults::new(&output.faults, output.to.protocol, plan.seed, i));
    let mut maker = Maker {
        protocols: outputs.iter().map(|output| output.to.protocol).collect(),
        samples: vec![ByKind::default(); outputs.len()],
        encoders,
        faults: faults.collect(),
        made: vec![0; outputs.len()],
        packets: Vec::new(),
        items: Vec::new(),
        ring,
        shared,
    };
    let mut player = Player::new(plan, end, BLOCK);
    // Stopping early is no failure: what was made is counted either way.
    let _ = player.play(|moment| maker.make(moment));
    maker.end();
    shared.all_made.store(true, Ordering::Release);
    let waiting = maker.encoders.iter().map(|encoder| encoder.waiting()).collect();
    let samples = maker.samples.iter().zip(&maker.faults);
    let samples = samples.map(|(made, faults)| faults.as_ref().map_or(*made, |faults| faults.account(*made)));
    Made {
        samples: samples.collect(),
        waiting,
        packets: maker.made,
        faults: maker.faults.into_iter().map(|faults| faults.map_or(Vec::new(), Faults::into_acts)).collect(),
    }
}

struct Maker<'a> {
    /// Of each output; one that has no place for a sensor makes no samples of it.
    protocols: Vec<Protocol>,
    encoders: Vec<Box<dyn Encoder>>,
    faults: Vec<Option<Faults>>,
    samples: Vec<ByKind<u64>>,
    made: Vec<u64>,
    packets: Vec<Packet>,
    items: Vec<Item>,
    ring: Producer<Item>,
    shared: &'a Shared,
}

impl Maker<'_> {
    fn make(&mut self, Moment { t, truth, readings }: Moment<'_>) -> Result<(), Stopped> {
        if self.shared.stopped() {
            return Err(Stopped);
        }
        self.items.clear();
        for output in 0..self.encoders.len() {
            for reading in readings.iter().filter(|reading| self.protocols[output].carries(reading.kind)) {
                self.samples[output][reading.kind as usize] += 1;
            }
            self.packets.clear();
            self.encoders[output].encode(&Now { t, truth, readings }, &mut self.packets);
            if let Some(faults) = &mut self.faults[output] {
                faults.pass(t, &mut self.packets);
                faults.settle(SimTime(self.shared.scene_ns.load(Ordering::Relaxed)));
            }
            self.count(output);
        }
        self.hand_over();
        Ok(())
    }

    /// What faults still hold goes out.
    fn end(&mut self) {
        self.items.clear();
        for output in 0..self.faults.len() {
            self.packets.clear();
            if let Some(faults) = &mut self.faults[output] {
                faults.end(&mut self.packets);
            }
            self.count(output);
        }
        self.hand_over();
    }

    fn count(&mut self, output: usize) {
        self.made[output] += self.packets.iter().filter(|packet| !packet.is_nothing()).count() as u64;
        self.items.extend(self.packets.iter().map(|&packet| Item { output, packet }));
    }

    fn hand_over(&mut self) {
        if self.encoders.len() > 1 || self.faults.iter().any(Option::is_some) {
            // A packet due between two ticks of one output must not wait behind a later one of another.
            self.items.sort_by_key(|item| item.packet.due);
        }
        self.items.iter().for_each(|item| push(&mut self.ring, *item, self.shared));
    }
}

/// Waits for room; once everything stops, a packet more than fits is put in the place of waiting for ever: the
/// ring is then emptied by whoever counts what was left.
fn push(ring: &mut Producer<Item>, mut item: Item, shared: &Shared) {
    while let Err(PushError::Full(back)) = ring.push(item) {
        item = back;
        if shared.stopped() && ring.is_abandoned() {
            return;
        }
        std::thread::sleep(FULL);
    }
}
