//! PX4 as a program, over TCP, in lockstep: it connects to the simulator, and its clock is the simulator's.
//!
//! The time of sensor 0 sets its clock. Once its modules are up it answers each `HIL_SENSOR` with one
//! `HIL_ACTUATOR_CONTROLS`; before, it takes them in and says nothing.

use ratetable_protocols::mavlink::{
    Decoder, Message, Received, command_long, heartbeat, hil_actuator_controls, hil_sensor,
    hil_state_quaternion,
};

use super::hil::{CUSTOM, HIL, PX4, QUADROTOR, Senders, Voice, sample};
use super::{Firmware, Own, Record, Settings};

/// PX4 as a program.
pub struct Px4Sitl {
    decoder: Decoder,
    rest: Program,
}

/// Everything but the stream's own state.
struct Program {
    voice: Voice,
    own: Own,
    record: Record,
    senders: Senders,
    greeted: bool,
    /// Its clock, once it is set.
    clock_us: Option<u64>,
    /// Samples that it takes in without an answer before its modules are up: 20 to 460.
    unanswered: u64,
}

impl Px4Sitl {
    /// Just started.
    pub fn new(settings: &Settings) -> Self {
        let rest = Program {
            voice: Voice::default(),
            own: Own::new(settings.ahrs, settings.declination_rad),
            record: Record::default(),
            senders: Senders::default(),
            greeted: false,
            clock_us: None,
            unanswered: settings.unanswered,
        };
        Self { decoder: Decoder::new(), rest }
    }
}

impl Firmware for Px4Sitl {
    fn receive(&mut self, bytes: &[u8], _now_us: u64, out: &mut Vec<u8>) {
        let Self { decoder, rest } = self;
        decoder.feed(bytes, |received| match received {
            Ok(received) => rest.take(&received, out),
            Err(_) => rest.record.counts.damaged += 1,
        });
    }

    fn turn(&mut self, _now_us: u64, out: &mut Vec<u8>) {
        if !std::mem::replace(&mut self.rest.greeted, true) {
            self.rest.greet(out);
        }
    }

    fn record(&self) -> &Record {
        &self.rest.record
    }
}

impl Program {
    /// What it says on connecting: it would like to know the true state, and it is there.
    fn greet(&mut self, out: &mut Vec<u8>) {
        let wish = command_long::Repr {
            params: [hil_state_quaternion::ID as f32, 5000.0, 0.0, 0.0, 0.0, 0.0, 0.0],
            command: command_long::SET_MESSAGE_INTERVAL,
            ..command_long::Repr::default()
        };
        let beat = heartbeat::Repr {
            kind: QUADROTOR,
            autopilot: PX4,
            base_mode: HIL | CUSTOM,
            mavlink_version: 3,
            ..heartbeat::Repr::default()
        };
        self.record.counts.asked += 1;
        self.voice.say(&Message::CommandLong(wish), out);
        self.voice.say(&Message::Heartbeat(beat), out);
    }

    fn take(&mut self, received: &Received, out: &mut Vec<u8>) {
        self.record.counts.packets += 1;
        self.record.counts.lost = self.senders.observe(&received.header);
        match received.message {
            Some(Message::HilSensor(message)) => self.feel(&message, out),
            Some(Message::HilStateQuaternion(_)) => self.record.counts.foreign += 1,
            _ => {}
        }
    }

    fn feel(&mut self, message: &hil_sensor::Repr, out: &mut Vec<u8>) {
        if message.id == 0 {
            // Its clock does not go back.
            self.clock_us = Some(self.clock_us.unwrap_or(0).max(message.time_usec));
        }
        let sample = self.clock_us.and_then(|now_us| sample(message, now_us)).filter(|_| message.id == 0);
        let Some(sample) = sample else {
            self.record.counts.refused += 1;
            return;
        };
        self.record.counts.samples += 1;
        self.own.take(&sample, Some(message.time_usec), &mut self.record);
        if self.record.counts.samples <= self.unanswered {
            return;
        }
        let controls = hil_actuator_controls::Repr {
            time_usec: sample.t_us,
            flags: hil_actuator_controls::LOCKSTEP,
            mode: HIL | CUSTOM,
            ..hil_actuator_controls::Repr::default()
        };
        self.record.counts.answered += 1;
        self.voice.say(&Message::HilActuatorControls(controls), out);
    }
}
