//! What a board sends back: its attitude, and over MAVLink that it is there.

use std::io;
use std::time::Instant;

use ratetable_protocols::mavlink::{self, Header, Message, Version, attitude_quaternion, heartbeat};
use ratetable_protocols::mpu::{self, Packet, attitude};

use super::port::Port;
use crate::driver::Protocol;
use crate::sample::Sample;

/// The board's system and component id: an autopilot.
const SYSTEM: u8 = 1;
const COMPONENT: u8 = 1;

/// Time between heartbeats, µs of the board's clock.
const HEARTBEAT_US: u64 = 1_000_000;

/// Bytes that wait for the link before new answers are dropped.
const MAX_WAITING: usize = 4096;

/// Sends answers without ever waiting for the link.
pub(super) struct Answers {
    protocol: Protocol,
    every_us: u64,
    due_us: Option<u64>,
    started: Instant,
    heartbeat_due_us: u64,
    seq: u8,
    waiting: Vec<u8>,
    sent: u64,
    dropped: u64,
}

impl Answers {
    pub(super) fn new(protocol: Protocol, every_us: u64, started: Instant) -> Self {
        Self {
            protocol,
            every_us,
            due_us: None,
            started,
            heartbeat_due_us: 0,
            seq: 0,
            waiting: Vec::new(),
            sent: 0,
            dropped: 0,
        }
    }

    /// Packets sent and packets dropped.
    pub(super) fn counts(&self) -> (u64, u64) {
        (self.sent, self.dropped)
    }

    /// Says the attitude after `sample`, if it is time to.
    pub(super) fn attitude(&mut self, port: &mut dyn Port, sample: &Sample, q: [f64; 4]) -> io::Result<()> {
        if !self.is_due(sample.t_us) {
            return Ok(());
        }
        match self.protocol {
            Protocol::Mpu => self.mpu_attitude(port, sample, q),
            Protocol::Mavlink => self.mavlink_attitude(port, sample, q),
        }
    }

    /// Says once a second over MAVLink that the board is there.
    pub(super) fn heartbeat(&mut self, port: &mut dyn Port) -> io::Result<()> {
        let now_us = self.clock_us();
        if self.protocol != Protocol::Mavlink || now_us < self.heartbeat_due_us {
            return Ok(());
        }
        self.heartbeat_due_us = now_us + HEARTBEAT_US;
        let beat = heartbeat::Repr {
            base_mode: 0x20,
            system_status: 4,
            mavlink_version: 3,
            ..heartbeat::Repr::default()
        };
        self.send_message(port, &Message::Heartbeat(beat))
    }

    /// The board's own clock: µs since it started.
    fn clock_us(&self) -> u64 {
        self.started.elapsed().as_micros() as u64
    }

    /// Whether an answer is due at this sample time; times of answers do not drift.
    fn is_due(&mut self, t_us: u64) -> bool {
        let due_us = self.due_us.unwrap_or(t_us);
        if t_us < due_us {
            return false;
        }
        let every_us = self.every_us.max(1);
        self.due_us = Some(due_us + every_us * ((t_us - due_us) / every_us + 1));
        true
    }

    fn mpu_attitude(&mut self, port: &mut dyn Port, sample: &Sample, q: [f64; 4]) -> io::Result<()> {
        let repr = attitude::Repr { clock_us: self.clock_us() as u32, q: q.map(|c| c as f32) };
        let mut bytes = [0; mpu::MAX_LEN];
        let packet = Packet::Attitude(repr);
        let len = mpu::encode(self.seq, sample.t_us as u32, &packet, &mut bytes);
        self.send(port, &bytes[..len.map_err(io::Error::other)?])
    }

    fn mavlink_attitude(&mut self, port: &mut dyn Port, sample: &Sample, q: [f64; 4]) -> io::Result<()> {
        let repr = attitude_quaternion::Repr {
            time_boot_ms: (sample.t_us / 1000) as u32,
            q: q.map(|c| c as f32),
            angular_rate: sample.gyro.unwrap_or_default().map(|w| w as f32),
            repr_offset_q: [0.0; 4],
        };
        self.send_message(port, &Message::AttitudeQuaternion(repr))
    }

    fn send_message(&mut self, port: &mut dyn Port, message: &Message) -> io::Result<()> {
        let header = Header { version: Version::V2, seq: self.seq, system: SYSTEM, component: COMPONENT };
        let mut bytes = [0; mavlink::MAX_LEN];
        let len = mavlink::encode(&header, message, &mut bytes).map_err(io::Error::other)?;
        self.send(port, &bytes[..len])
    }

    /// Hands a packet to the link, or keeps it for later, or drops it if too much waits.
    fn send(&mut self, port: &mut dyn Port, packet: &[u8]) -> io::Result<()> {
        self.seq = self.seq.wrapping_add(1);
        if self.waiting.len() + packet.len() > MAX_WAITING {
            self.dropped += 1;
        } else {
            self.waiting.extend_from_slice(packet);
            self.sent += 1;
        }
        let written = port.write(&self.waiting)?;
        self.waiting.drain(..written);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn answers_keep_their_grid_whatever_the_samples() {
        let mut answers = Answers::new(Protocol::Mpu, 20, Instant::now());
        let times = [100, 110, 119, 121, 130, 145, 300, 301];
        let due = times.map(|t_us| answers.is_due(t_us));
        assert_eq!(due, [true, false, false, true, false, true, true, false]);
    }
}
