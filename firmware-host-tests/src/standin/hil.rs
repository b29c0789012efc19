//! What both PX4s make of MAVLink: `HIL_SENSOR` as samples, and a voice.

use std::collections::BTreeMap;

use ratetable_protocols::Losses;
use ratetable_protocols::mavlink::{self, Header, Message, Version, hil_sensor};

use crate::driver::readings;
use crate::sample::Sample;

/// Its system and component id: an autopilot.
pub(super) const SYSTEM: u8 = 1;
pub(super) const COMPONENT: u8 = 1;

/// MAV_AUTOPILOT_PX4.
pub(super) const PX4: u8 = 12;
/// MAV_TYPE_QUADROTOR.
pub(super) const QUADROTOR: u8 = 2;
/// MAV_MODE_FLAG_HIL_ENABLED.
pub(super) const HIL: u8 = 0x20;
/// MAV_MODE_FLAG_CUSTOM_MODE_ENABLED.
pub(super) const CUSTOM: u8 = 0x01;

/// The new readings of a message as a sample of that time; `None` where nothing is new.
pub(super) fn sample(message: &hil_sensor::Repr, t_us: u64) -> Option<Sample> {
    let sample = Sample { t_us, ..readings(message) };
    let any = sample.gyro.is_some() || sample.accel.is_some() || sample.mag.is_some();
    any.then_some(sample)
}

/// Packets missing by their numbers, of each sender on the link.
#[derive(Debug, Default)]
pub(super) struct Senders(BTreeMap<(u8, u8), Losses>);

impl Senders {
    /// Takes note of a packet; how many are missing by now.
    pub(super) fn observe(&mut self, header: &Header) -> u64 {
        self.0.entry((header.system, header.component)).or_default().observe(header.seq);
        self.0.values().map(Losses::lost).sum()
    }
}

/// Packs its messages.
#[derive(Debug, Default)]
pub(super) struct Voice {
    seq: u8,
}

impl Voice {
    /// Appends a message.
    pub(super) fn say(&mut self, message: &Message, out: &mut Vec<u8>) {
        let header = Header { version: Version::V2, seq: self.seq, system: SYSTEM, component: COMPONENT };
        let mut bytes = [0; mavlink::MAX_LEN];
        // MAX_LEN holds every message.
        if let Ok(len) = mavlink::encode(&header, message, &mut bytes) {
            self.seq = self.seq.wrapping_add(1);
            out.extend_from_slice(&bytes[..len]);
        }
    }
}

/// What is due again and again, on the firmware's clock.
#[derive(Debug, Clone, Copy)]
pub(super) struct Every {
    period_us: u64,
    next_us: u64,
}

impl Every {
    /// Due at once and then every `period_us`.
    pub(super) fn new(period_us: u64) -> Self {
        Self { period_us: period_us.max(1), next_us: 0 }
    }

    /// Whether it is due; what was missed is not made up for.
    pub(super) fn is_due(&mut self, now_us: u64) -> bool {
        let due = now_us >= self.next_us;
        if due {
            self.next_us = now_us - now_us % self.period_us + self.period_us;
        }
        due
    }
}
