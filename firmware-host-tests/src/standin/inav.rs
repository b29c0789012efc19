//! INAV with its HITL simulator message over MSP, as its own code was measured to behave.
//!
//! Bytes wait in a buffer of 256; what finds no room is lost. A task looks into it 100 times a second and takes one
//! command each time. The readings of the newest message are held: the attitude loop runs on them a thousand times a
//! second, whether or not anything new has come, and for ever. Axes are forward, left, up on the wire.

use std::collections::VecDeque;

use ratetable_protocols::msp::{
    self, Decoder, Direction, MAX_LEN, Message, Received, api_version, attitude, fc_variant, simulator,
    simulator_reply,
};

use super::record::{Moment, Record};
use super::{Firmware, Settings};
use crate::ahrs::Mahony;
use crate::quaternion::{from_euler, to_euler};

/// Bytes that the port's driver keeps.
const BUFFER: usize = 256;
/// Of the task that looks for commands, µs.
const TASK_US: u64 = 10_000;
/// Of the attitude loop, µs.
const LOOP_US: u64 = 1_000;
/// So long after its boot its gains are high, µs.
const EAGER_US: u64 = 20_000_000;
/// How high.
const EAGER: f64 = 10.0;
/// Counts a deg/s, and a g.
const GYRO_SCALE: f64 = 16.0;
const ACCEL_SCALE: f64 = 1000.0;
/// m/s² in a g.
const G: f64 = 9.80665;

/// INAV.
pub struct Inav {
    buffer: VecDeque<u8>,
    decoder: Decoder,
    ahrs: Mahony,
    /// What the sensors read, and for which message that was.
    held: Option<simulator::Repr>,
    record: Record,
    /// When the attitude loop and the task run next.
    loop_us: u64,
    task_us: u64,
}

impl Inav {
    /// Just booted.
    pub fn new(_settings: &Settings) -> Self {
        Self {
            buffer: VecDeque::with_capacity(BUFFER),
            decoder: Decoder::new(),
            ahrs: Mahony::inav(),
            held: None,
            record: Record::default(),
            loop_us: 0,
            task_us: 0,
        }
    }

    /// Runs what is due by then, in order.
    fn run_until(&mut self, now_us: u64, out: &mut Vec<u8>) {
        while self.loop_us <= now_us {
            self.think();
            if self.task_us <= self.loop_us {
                self.task_us = self.loop_us + TASK_US;
                self.look(self.loop_us, out);
            }
            self.loop_us += LOOP_US;
        }
    }

    /// One step of the attitude loop.
    fn think(&mut self) {
        let Some(held) = &self.held else { return };
        if held.flags & simulator::OWN_ESTIMATE == 0 {
            // The simulator's attitude in place of its own.
            let [roll, pitch, yaw] = held.attitude.map(|angle| (f64::from(angle) / 10.0).to_radians());
            self.ahrs.set(from_euler(roll, -pitch, yaw));
            return;
        }
        self.ahrs.gain = if self.loop_us < EAGER_US { EAGER } else { 1.0 };
        self.ahrs.step(
            LOOP_US as f64 * 1e-6,
            frd(held.gyro, 1.0 / GYRO_SCALE).map(f64::to_radians),
            frd(held.accel, G / ACCEL_SCALE),
            frd(held.mag, 1.0),
        );
    }

    /// Takes one command out of the buffer, if there is a whole one, and answers it.
    fn look(&mut self, now_us: u64, out: &mut Vec<u8>) {
        while let Some(byte) = self.buffer.pop_front() {
            let mut taken = None;
            self.decoder.feed(&[byte], |received| match received {
                Ok(received) => taken = Some(received),
                Err(_) => self.record.counts.damaged += 1,
            });
            if let Some(received) = taken {
                return self.answer(&received, now_us, out);
            }
        }
    }

    fn answer(&mut self, received: &Received, now_us: u64, out: &mut Vec<u8>) {
        self.record.counts.packets += 1;
        if received.direction != Direction::Request {
            return;
        }
        let command = received.command;
        let reply = match (command, received.message) {
            (simulator::COMMAND, Some(Message::Simulator(message))) => self.simulate(message, now_us),
            (simulator::COMMAND, Some(Message::SimulatorAir(message))) => {
                self.simulate(message.readings, now_us)
            }
            (attitude::COMMAND, Some(_)) => {
                let [roll, pitch, yaw] = self.told();
                Message::Attitude(attitude::Repr { roll, pitch, yaw: yaw / 10 })
            }
            (fc_variant::COMMAND, Some(_)) => Message::FcVariant(fc_variant::Repr { name: fc_variant::INAV }),
            (api_version::COMMAND, Some(_)) => {
                Message::ApiVersion(api_version::Repr { protocol: 0, major: 2, minor: 5 })
            }
            _ => Message::Empty { direction: Direction::Refusal, command },
        };
        let mut bytes = [0; MAX_LEN];
        // MAX_LEN holds every message.
        let len = msp::encode(&reply, &mut bytes).unwrap_or(0);
        out.extend_from_slice(&bytes[..len]);
    }

    /// Takes the readings of a simulator message in; the reply has the attitude so far.
    fn simulate(&mut self, message: simulator::Repr, now_us: u64) -> Message {
        let (known, stays) = (message.version == simulator::VERSION, message.flags & simulator::ENABLE != 0);
        if !known || !stays {
            // Told to leave the simulator, it does (read in `fc_msp.c`).
            self.held = None;
            self.record.counts.refused += u64::from(!known);
            return Message::Empty { direction: Direction::Reply, command: simulator::COMMAND };
        }
        self.record.counts.samples += 1;
        self.record.counts.foreign += u64::from(message.attitude != [0; 3]);
        if self.held.replace(message).is_some() {
            let attitude = self.ahrs.attitude();
            self.record.history.push(Moment { t_us: now_us, said_us: None, attitude });
        }
        self.record.counts.told += 1;
        self.record.counts.answered += 1;
        let attitude = self.told();
        Message::SimulatorReply(simulator_reply::Repr {
            attitude,
            display: [255, 0],
            ..simulator_reply::Repr::default()
        })
    }

    /// Roll, pitch (nose down positive) and yaw (0 to 3600), 0.1°.
    fn told(&self) -> [i16; 3] {
        let [roll, pitch, yaw] = to_euler(self.ahrs.attitude()).map(|angle| angle.to_degrees() * 10.0);
        [roll, -pitch, yaw.rem_euclid(3600.0)].map(|angle| angle.round() as i16)
    }
}

impl Firmware for Inav {
    fn receive(&mut self, bytes: &[u8], now_us: u64, out: &mut Vec<u8>) {
        self.run_until(now_us, out);
        let room = BUFFER - self.buffer.len();
        let kept = bytes.len().min(room);
        self.buffer.extend(&bytes[..kept]);
        self.record.counts.overflowed += (bytes.len() - kept) as u64;
    }

    fn turn(&mut self, now_us: u64, out: &mut Vec<u8>) {
        self.run_until(now_us, out);
    }

    fn record(&self) -> &Record {
        &self.record
    }
}

/// Forward, left, up counts as forward, right, down.
fn frd([x, y, z]: [i16; 3], scale: f64) -> [f64; 3] {
    [f64::from(x) * scale, -f64::from(y) * scale, -f64::from(z) * scale]
}
