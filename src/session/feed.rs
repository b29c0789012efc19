//! The producer thread's half of an output.

use crate::motion::Truth;
use crate::player::Moment;
use crate::report::AskedRate;
use crate::scene::{Output, Plan};
use crate::sensor::ByKind;
use crate::time::SimTime;
use crate::wire::{self, Acts, Encoder, Faults, Now, Packet, Protocol, Setup, dialogue::Peer};
use std::collections::BTreeMap;
use std::sync::mpsc::Receiver;

/// The producer's half of an output: makes packets of readings and applies the output's faults to them.
pub(super) struct Feed {
    /// A protocol without a field for a sensor makes no samples of it.
    protocol: Protocol,
    encoder: Box<dyn Encoder>,
    faults: Option<Faults>,
    /// Faults apply only within the scene.
    in_scene: bool,
    /// Samples and packets made so far.
    samples: ByKind<u64>,
    packets: u64,
    /// The packets made last.
    newest: Vec<Packet>,
    /// What the other side asks for from now on.
    news: Option<Receiver<Peer>>,
    peer: Peer,
    asked: Vec<AskedRate>,
}

/// What was made for one output.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Made {
    /// Samples of each kind, and those that still wait in the encoder for a packet.
    pub samples: ByKind<u64>,
    pub waiting: ByKind<u64>,
    pub packets: u64,
    /// What each fault did.
    pub faults: Vec<Acts>,
    /// The rates that the other side asked for meanwhile.
    pub asked: Vec<AskedRate>,
}

impl Feed {
    /// The feed of output `i` of the run, given what is known of its other side.
    pub(super) fn new(plan: &Plan, i: usize, output: &Output, peer: Peer) -> Feed {
        let protocol = output.to.protocol;
        let setup =
            Setup { sensors: &plan.sensors, axes: plan.axes, day: plan.day, options: output.wire, peer };
        Feed {
            protocol,
            encoder: wire::encoder(protocol, &setup),
            faults: Faults::new(&output.faults, protocol, plan.seed, i),
            in_scene: false,
            samples: ByKind::default(),
            packets: 0,
            newest: Vec::new(),
            news: None,
            peer,
            asked: Vec::new(),
        }
    }

    /// Makes what the other side asks for, whenever it does.
    pub(super) fn listen(&mut self, news: Receiver<Peer>) {
        self.news = Some(news).filter(|_| self.encoder.follows());
    }

    /// Whether what it makes may change: then it is not made far ahead.
    pub(super) fn follows(&self) -> bool {
        self.news.is_some()
    }

    /// From `t` on makes what was asked for last.
    fn follow(&mut self, t: SimTime) {
        let Some(peer) = self.news.as_ref().and_then(|news| news.try_iter().last()) else { return };
        self.encoder.follow(&peer, t);
        if let Some(rate) = peer.rate.filter(|_| peer.rate != self.peer.rate) {
            self.asked.push(AskedRate { at_s: t.seconds(), hz: rate.as_hz() });
        }
        self.peer = peer;
    }

    /// Whether a packet may go out at another time than that of its readings.
    pub(super) fn is_faulty(&self) -> bool {
        self.faults.is_some()
    }

    /// Marks the stream time `t` at which the scene begins.
    pub(super) fn scene_starts(&mut self, t: SimTime) {
        self.in_scene = true;
        if let Some(faults) = &mut self.faults {
            faults.scene_starts(t);
        }
    }

    /// The packets of the readings at one moment of the stream; everything up to `sent` has gone out.
    pub(super) fn make(&mut self, moment: &Moment<'_>, sent: SimTime) -> &[Packet] {
        let Moment { t, truth, readings } = *moment;
        for reading in readings.iter().filter(|reading| self.protocol.carries(reading.kind)) {
            self.samples[reading.kind as usize] += 1;
        }
        self.newest.clear();
        self.follow(t);
        self.encoder.encode(&Now { t, truth, readings }, &mut self.newest);
        if let Some(faults) = self.faults.as_mut().filter(|_| self.in_scene) {
            faults.pass(t, &mut self.newest);
            faults.settle(sent);
        }
        self.count()
    }

    /// Ends the stream: releases what faults still hold.
    pub(super) fn end(&mut self) -> &[Packet] {
        self.newest.clear();
        if let Some(faults) = &mut self.faults {
            faults.end(&mut self.newest);
        }
        self.count()
    }

    fn count(&mut self) -> &[Packet] {
        self.packets += self.newest.iter().filter(|packet| !packet.is_nothing()).count() as u64;
        &self.newest
    }

    /// Packets that show the other side a vehicle that stops where it is at `end`; they are not part of the stream.
    pub(super) fn farewell(&mut self, end: &Truth) -> &[Packet] {
        self.newest.clear();
        self.encoder.farewell(end, &mut self.newest);
        &self.newest
    }

    /// Totals of what was made.
    pub(super) fn made(self) -> Made {
        Made {
            samples: self.faults.as_ref().map_or(self.samples, |faults| faults.account(self.samples)),
            waiting: self.encoder.waiting(),
            packets: self.packets,
            faults: self.faults.map_or(Vec::new(), Faults::into_acts),
            asked: self.asked,
        }
    }
}

impl Made {
    /// Counts what faults did before the stream time `t`.
    pub(super) fn settle(&mut self, t: SimTime) {
        self.faults.iter_mut().for_each(|acts| acts.settle(t));
    }

    /// The number of packets that each kind of the output's faults acted on.
    pub(super) fn by_fault(&self, output: &Output) -> BTreeMap<&'static str, u64> {
        let mut all: BTreeMap<_, _> = output.faults.iter().map(|fault| (fault.kind.name(), 0)).collect();
        self.faults.iter().for_each(|acts| *all.entry(acts.kind.name()).or_default() += acts.packets);
        all
    }

    /// The output's faults that acted: `mpu@pty drop from 2 s to 3 s`.
    pub(super) fn fired(&self, output: &Output) -> Vec<String> {
        let acted = self.faults.iter().filter(|acts| acts.packets > 0);
        acted.map(|acts| format!("{} {}", output.to, acts.what)).collect()
    }
}
