//! Applies the faults of one output to its packets, between the encoder and the sender.
//!
//! Faults depend only on scene time and packets, so the same scene gives the same bytes at any speed. A packet that
//! is sent later leaves [`Packet::nothing`] in its place, so that time goes on for the far end of a queue. Random
//! faults draw once for each packet, from the stream `output/I/fault/N/KIND`: I counts the run's outputs, N the
//! faults of this one.

use super::fault::{BITS, GAP, HURTS, PIECES, PacketFault, PacketFaultKind, SHARE};
use super::{Packet, Protocol};
use crate::random::{self, Stream};
use crate::sensor::ByKind;
use crate::time::SimTime;
use rand::RngExt;
use std::collections::VecDeque;
use std::mem;

/// What a fault did.
#[derive(Clone, Debug, PartialEq)]
pub struct Acts {
    /// The fault.
    pub kind: PacketFaultKind,
    /// The fault with its times, as text for a person.
    pub what: String,
    /// The packets it acted on, up to the settled time.
    pub packets: u64,
    /// The times when it acted on later packets: packets are made ahead of time.
    ahead: VecDeque<SimTime>,
}

impl Acts {
    /// Counts what it did before `t`.
    pub fn settle(&mut self, t: SimTime) {
        while self.ahead.front().is_some_and(|at| *at < t) {
            self.ahead.pop_front();
            self.packets += 1;
        }
    }
}

/// All faults of an output.
#[derive(Debug)]
pub struct Faults {
    chain: Vec<Faulty>,
    /// Samples removed with their packets, and those that these packets had replaced.
    taken: ByKind<u64>,
    /// Samples that go out a second time.
    added: ByKind<u64>,
    through: Vec<Packet>,
    now: SimTime,
}

impl Faults {
    /// The faults of the run's output `output`, in the given order, except that splits come last. `None` without
    /// any.
    pub fn new(faults: &[PacketFault], protocol: Protocol, seed: u64, output: usize) -> Option<Faults> {
        let faulty = |(n, fault): (usize, &PacketFault)| {
            let stream = format!("output/{output}/fault/{n}/{}", fault.kind.name());
            Faulty::new(fault, protocol, random::stream(seed, &stream))
        };
        let mut chain: Vec<_> = faults.iter().enumerate().map(faulty).collect();
        chain.sort_by_key(|faulty| faulty.acts.kind == PacketFaultKind::Split);
        let (taken, added) = Default::default();
        (!chain.is_empty()).then(|| Faults { chain, taken, added, through: Vec::new(), now: SimTime::ZERO })
    }

    /// Marks the time `t` at which the scene starts; fault times are relative to it.
    pub fn scene_starts(&mut self, t: SimTime) {
        for faulty in &mut self.chain {
            (faulty.start, faulty.end) = (faulty.start + t, faulty.end + t);
        }
    }

    /// Passes packets made at `t` through the faults: leaves those that go out by then, earlier ones included.
    pub fn pass(&mut self, t: SimTime, packets: &mut Vec<Packet>) {
        self.now = t;
        self.through(Some(t), packets);
    }

    /// At the end: passes `packets` through and releases what is still held.
    pub fn end(&mut self, packets: &mut Vec<Packet>) {
        self.through(None, packets);
    }

    fn through(&mut self, t: Option<SimTime>, packets: &mut Vec<Packet>) {
        let Faults { chain, taken, added, through, now } = self;
        for faulty in chain {
            through.clear();
            faulty.release(t, *now, through);
            for packet in packets.drain(..) {
                match packet.is_nothing() {
                    true => through.push(packet),
                    false => faulty.act(packet, t, through, taken, added),
                }
            }
            mem::swap(packets, through);
        }
    }

    /// An encoder's samples after the faults: those that packets carry or replace, counted at each occurrence.
    pub fn account(&self, samples: ByKind<u64>) -> ByKind<u64> {
        std::array::from_fn(|i| samples[i] + self.added[i] - self.taken[i])
    }

    /// Counts what the faults did before `t`.
    pub fn settle(&mut self, t: SimTime) {
        self.chain.iter_mut().for_each(|faulty| faulty.acts.settle(t));
    }

    /// What each fault did.
    pub fn into_acts(self) -> Vec<Acts> {
        self.chain.into_iter().map(|faulty| faulty.acts).collect()
    }
}

/// One fault.
#[derive(Debug)]
struct Faulty {
    start: SimTime,
    end: SimTime,
    share: f64,
    bits: u64,
    /// Whether only the inside of a packet is damaged.
    spares_framing: bool,
    pieces: u64,
    gap: SimTime,
    protocol: Protocol,
    stream: Stream,
    /// Packets that go out later, in that order.
    held: VecDeque<Packet>,
    acts: Acts,
}

impl Faulty {
    fn new(fault: &PacketFault, protocol: Protocol, stream: Stream) -> Faulty {
        let PacketFault { kind, start, end, values } = fault;
        Faulty {
            start: *start,
            end: *end,
            share: values.get(SHARE).unwrap_or(1.0),
            bits: values.get(BITS).unwrap_or(1),
            spares_framing: values.get(HURTS) != Some("framing"),
            pieces: values.get(PIECES).unwrap_or(1),
            gap: values.get(GAP).unwrap_or_default(),
            protocol,
            stream,
            held: VecDeque::new(),
            acts: Acts { kind: *kind, what: fault.to_string(), packets: 0, ahead: VecDeque::new() },
        }
    }

    /// Releases what was held until `t` (`None`: at the end), at the time `now`.
    fn release(&mut self, t: Option<SimTime>, now: SimTime, out: &mut Vec<Packet>) {
        match self.acts.kind {
            PacketFaultKind::Stall if t.is_none_or(|t| t >= self.end) => {
                let due = self.end.min(now);
                out.extend(self.held.drain(..).map(|packet| packet.due_at(packet.due.max(due))));
            }
            PacketFaultKind::Split => {
                while let Some(rest) = self.held.pop_front_if(|rest| t.is_none_or(|t| rest.due <= t)) {
                    out.push(rest);
                }
            }
            PacketFaultKind::Reorder if t.is_none() => out.extend(self.held.drain(..)),
            _ => {}
        }
    }

    fn act(
        &mut self,
        mut packet: Packet,
        t: Option<SimTime>,
        out: &mut Vec<Packet>,
        taken: &mut ByKind<u64>,
        added: &mut ByKind<u64>,
    ) {
        let due = packet.due;
        if self.acts.kind == PacketFaultKind::Split {
            // The next packet of a stream also brings the rest of the one before.
            self.held.clear();
        }
        if self.acts.kind == PacketFaultKind::Reorder
            && let Some(overtaken) = self.held.pop_front()
        {
            self.acts.ahead.push_back(due);
            return out.extend([packet, overtaken.due_at(due)]);
        }
        if !(self.start..self.end).contains(&due) || !self.hits() {
            return out.push(packet);
        }
        match self.acts.kind {
            PacketFaultKind::Drop => {
                for (i, taken) in taken.iter_mut().enumerate() {
                    *taken += packet.samples(i);
                }
                out.push(Packet::nothing(due, 0));
            }
            PacketFaultKind::Corrupt => {
                self.corrupt(&mut packet);
                out.push(packet);
            }
            PacketFaultKind::Duplicate => {
                for kind in packet.carries.iter() {
                    added[kind as usize] += 1;
                }
                out.push(packet);
                packet.replaced = ByKind::default();
                out.push(packet);
            }
            // Counted when it happens.
            PacketFaultKind::Reorder => {
                self.held.push_back(packet);
                return out.push(Packet::nothing(due, 0));
            }
            PacketFaultKind::Stall if t.is_none_or(|t| t >= self.end) => return out.push(packet),
            PacketFaultKind::Stall => {
                self.held.push_back(packet);
                out.push(Packet::nothing(due, 0));
            }
            PacketFaultKind::Split => {
                packet.piece = packet.len.div_ceil(self.pieces as u16);
                let later = |i: u64| SimTime(due.0.saturating_add(self.gap.0.saturating_mul(i as i64)));
                let rest = (1..self.pieces).map(|i| Packet::nothing(later(i), packet.piece));
                self.held.extend(rest);
                out.push(packet);
            }
        }
        self.acts.ahead.push_back(due);
    }

    fn hits(&mut self) -> bool {
        self.acts.kind == PacketFaultKind::Stall || self.stream.random::<f64>() < self.share
    }

    /// Flips bits, each at most once.
    fn corrupt(&mut self, packet: &mut Packet) {
        let len = usize::from(packet.len);
        let (within, never) =
            if self.spares_framing { (self.protocol.row().inside)(len) } else { (0..len, None) };
        let mut places: Vec<_> = within.flat_map(|byte| (0..8).map(move |bit| (byte, 1u8 << bit))).collect();
        let mut left = self.bits;
        while left > 0 && !places.is_empty() {
            let (byte, bit) = places.swap_remove(self.stream.random_range(0..places.len()));
            let flipped = packet.bytes[byte] ^ bit;
            if Some(flipped) != never {
                packet.bytes[byte] = flipped;
                left -= 1;
            }
        }
    }
}
