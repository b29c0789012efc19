//! The producer thread: plays the plan, encodes, and keeps the ring full.

use super::{Item, Shared};
use crate::motion::Truth;
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
/// How far ahead of what is sent the rest is made, ns of stream time: so soon the scene can begin once it may.
const LEAD: i64 = 200_000_000;
/// Between two looks at how far what is sent has come: far less than the lead.
const AHEAD: Duration = Duration::from_millis(1);
/// The rest is made in blocks of so few ticks that little is computed in vain at its end.
const REST_BLOCK: usize = 32;

/// What is to be made.
#[derive(Clone, Copy, Debug)]
pub(super) struct Task<'a> {
    pub plan: &'a Plan,
    pub outputs: &'a [Output],
    /// What is known of the other side of each output.
    pub peers: &'a [Peer],
    /// Scene time at which it ends.
    pub end: SimTime,
    /// How long the vehicle is held still before the scene at the least; `None` begins with the scene.
    pub rest: Option<SimTime>,
}

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

/// Each output's encoder, once nothing more is made: it knows how to take leave.
pub(super) type Encoders = Vec<Box<dyn Encoder>>;

/// Everything stopped before the end.
struct Stopped;

/// Plays the task into the ring.
pub(super) fn produce(task: Task<'_>, ring: Producer<Item>, shared: &Shared) -> (Made, Encoders) {
    let Task { plan, outputs, peers, end, rest } = task;
    let setup = |i: usize| Setup {
        sensors: &plan.sensors,
        axes: plan.axes,
        day: plan.day,
        options: outputs[i].wire,
        peer: peers.get(i).copied().unwrap_or_default(),
    };
    let encoders: Encoders =
        outputs.iter().enumerate().map(|(i, output)| wire::encoder(output.to.protocol, &setup(i))).collect();
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
        start: SimTime::ZERO,
        resting: rest.is_some(),
        ring,
        shared,
    };
    // Stopping early is no failure: what was made is counted either way.
    let _ = maker.play(plan, end, rest);
    maker.end();
    shared.all_made.store(true, Ordering::Release);
    let waiting = maker.encoders.iter().map(|encoder| encoder.waiting()).collect();
    let samples = maker.samples.iter().zip(&maker.faults);
    let samples = samples.map(|(made, faults)| faults.as_ref().map_or(*made, |faults| faults.account(*made)));
    let made = Made {
        samples: samples.collect(),
        waiting,
        packets: maker.made,
        faults: maker.faults.into_iter().map(|faults| faults.map_or(Vec::new(), Faults::into_acts)).collect(),
    };
    (made, maker.encoders)
}

struct Maker<'a> {
    /// Of each output; one that has no place for a sensor makes no samples of it.
    protocols: Vec<Protocol>,
    encoders: Encoders,
    faults: Vec<Option<Faults>>,
    samples: Vec<ByKind<u64>>,
    made: Vec<u64>,
    packets: Vec<Packet>,
    items: Vec<Item>,
    /// Stream time at which what is played began.
    start: SimTime,
    /// Whether the vehicle is held still before the scene.
    resting: bool,
    ring: Producer<Item>,
    shared: &'a Shared,
}

impl Maker<'_> {
    fn play(&mut self, plan: &Plan, end: SimTime, rest: Option<SimTime>) -> Result<(), Stopped> {
        if let Some(rest) = rest {
            self.start = self.hold_still(plan, rest)?;
            self.shared.scene_starts_ns.store(self.start.0, Ordering::Release);
            self.faults.iter_mut().flatten().for_each(|faults| faults.scene_starts(self.start));
            self.resting = false;
        }
        Player::new(plan, end, BLOCK).play(|moment| self.make(moment))
    }

    /// The vehicle at rest for at least so long and until everybody is ready; gives back the stream time at which the
    /// scene begins.
    fn hold_still(&mut self, plan: &Plan, rest: SimTime) -> Result<SimTime, Stopped> {
        /// The rest is over: the scene begins then.
        enum Over {
            At(SimTime),
            Stopped,
        }
        let (at_rest, seam) = (plan.at_rest(), plan.seam());
        let mut next = SimTime((rest.0.max(0) + seam.0 - 1) / seam.0 * seam.0);
        let over = Player::new(&at_rest, SimTime::FOREVER, REST_BLOCK).play(|moment| {
            while moment.t >= next {
                if self.shared.ready.load(Ordering::Relaxed) {
                    return Err(Over::At(next));
                }
                next = next + seam;
            }
            self.wait_for_lead(moment.t).map_err(|Stopped| Over::Stopped)?;
            self.make(moment).map_err(|Stopped| Over::Stopped)
        });
        match over {
            Err(Over::At(start)) => Ok(start),
            _ => Err(Stopped),
        }
    }

    /// Waits until what is sent has come near to `t`, or nothing is left to send.
    fn wait_for_lead(&self, t: SimTime) -> Result<(), Stopped> {
        let far = || t.0 - self.shared.stream_ns.load(Ordering::Relaxed) > LEAD;
        while far() && self.ring.slots() < self.ring.buffer().capacity() {
            if self.shared.stopped() {
                return Err(Stopped);
            }
            std::thread::sleep(AHEAD);
        }
        Ok(())
    }

    fn make(&mut self, Moment { t, truth, readings }: Moment<'_>) -> Result<(), Stopped> {
        if self.shared.stopped() {
            return Err(Stopped);
        }
        let t = self.start + t;
        let truth = &Truth { t, ..*truth };
        self.items.clear();
        for output in 0..self.encoders.len() {
            for reading in readings.iter().filter(|reading| self.protocols[output].carries(reading.kind)) {
                self.samples[output][reading.kind as usize] += 1;
            }
            self.packets.clear();
            self.encoders[output].encode(&Now { t, truth, readings }, &mut self.packets);
            // What goes wrong goes wrong in the scene.
            if let Some(faults) = self.faults[output].as_mut().filter(|_| !self.resting) {
                faults.pass(t, &mut self.packets);
                faults.settle(SimTime(self.shared.stream_ns.load(Ordering::Relaxed)));
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
