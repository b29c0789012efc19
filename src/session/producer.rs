//! The producer thread: plays the plan, encodes, and keeps the ring full.

use super::{Item, Shared};
use crate::player::{BLOCK, Moment, Player};
use crate::scene::{Output, Plan};
use crate::sensor::ByKind;
use crate::time::SimTime;
use crate::wire::{self, Encoder, Now, Packet, Setup, dialogue::Peer};
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
    let mut maker = Maker {
        samples: vec![ByKind::default(); outputs.len()],
        encoders,
        made: vec![0; outputs.len()],
        packets: Vec::new(),
        items: Vec::new(),
        ring,
        shared,
    };
    let mut player = Player::new(plan, end, BLOCK);
    // Stopping early is no failure: what was made is counted either way.
    let _ = player.play(|moment| maker.make(moment));
    shared.all_made.store(true, Ordering::Release);
    let waiting = maker.encoders.iter().map(|encoder| encoder.waiting()).collect();
    Made { samples: maker.samples, waiting, packets: maker.made }
}

struct Maker<'a> {
    encoders: Vec<Box<dyn Encoder>>,
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
        for (output, encoder) in self.encoders.iter_mut().enumerate() {
            for reading in readings {
                self.samples[output][reading.kind as usize] += 1;
            }
            self.packets.clear();
            encoder.encode(&Now { t, truth, readings }, &mut self.packets);
            self.made[output] += self.packets.len() as u64;
            self.items.extend(self.packets.iter().map(|&packet| Item { output, packet }));
        }
        if self.encoders.len() > 1 {
            // A packet due between two ticks of one output must not wait behind a later one of another.
            self.items.sort_by_key(|item| item.packet.due);
        }
        self.items.iter().for_each(|item| push(&mut self.ring, *item, self.shared));
        Ok(())
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
