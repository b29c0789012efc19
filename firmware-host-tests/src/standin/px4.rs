//! PX4 on its board, in HITL, as its own code was measured to behave over a serial port.
//!
//! It hears `HIL_SENSOR` only in HIL mode and on a link of more than 5000 B/s; nothing else tells that it does not.
//! A sample's time is its arrival: the message's own time and its `id` are not looked at.

use std::collections::BTreeMap;

use ratetable_protocols::mavlink::{
    Decoder, Message, Received, attitude, attitude_quaternion, command_ack, command_long, heartbeat,
    hil_actuator_controls, hil_sensor, param_id, param_name, param_request_read, param_value, timesync,
};

use super::hil::{CUSTOM, Every, HIL, PX4, QUADROTOR, SYSTEM, Senders, Voice, sample};
use super::validator::Validator;
use super::{Firmware, Own, Record, Settings};
use crate::quaternion::to_euler;

/// The slowest link that samples are not taken from, B/s.
const DEAF_RATE: i32 = 5000;
/// MAV_RESULT_UNSUPPORTED.
const UNSUPPORTED: u8 = 3;

/// Its whole-number parameters by name.
pub type Parameters = BTreeMap<String, i32>;

/// PX4 in HITL.
pub struct Px4 {
    decoder: Decoder,
    rest: Autopilot,
}

/// Everything but the stream's own state.
struct Autopilot {
    parameters: Parameters,
    voice: Voice,
    own: Own,
    record: Record,
    senders: Senders,
    gyro: Validator,
    accel: Validator,
    beat: Every,
    compare: Every,
    actuate: Every,
    /// Messages asked for by id.
    streams: BTreeMap<u32, Every>,
    /// When the newest sample came.
    fed_us: Option<u64>,
    compared_ns: Option<i64>,
}

impl Px4 {
    /// As its guide for HITL has it, on TELEM 1 at 921600 baud.
    pub fn parameters() -> Parameters {
        let all = [
            ("SYS_HITL", 1),
            ("MAV_0_CONFIG", 101),
            ("MAV_0_RATE", 0),
            ("SER_TEL1_BAUD", 921_600),
            ("MAV_1_CONFIG", 0),
            ("MAV_1_RATE", 0),
            ("MAV_2_CONFIG", 0),
            ("MAV_2_RATE", 100_000),
        ];
        all.map(|(name, value)| (name.to_owned(), value)).into()
    }

    /// Just booted.
    pub fn new(settings: &Settings) -> Self {
        let mut parameters = Self::parameters();
        parameters.extend(settings.parameters.clone());
        let rest = Autopilot {
            parameters,
            voice: Voice::default(),
            own: Own::new(settings.ahrs, settings.declination_rad),
            record: Record::default(),
            senders: Senders::default(),
            gyro: Validator::default(),
            accel: Validator::default(),
            beat: Every::new(1_000_000),
            compare: Every::new(100_000),
            actuate: Every::new(5_000),
            streams: BTreeMap::new(),
            fed_us: None,
            compared_ns: None,
        };
        Self { decoder: Decoder::new(), rest }
    }
}

impl Firmware for Px4 {
    fn receive(&mut self, bytes: &[u8], now_us: u64, out: &mut Vec<u8>) {
        let Self { decoder, rest } = self;
        decoder.feed(bytes, |received| match received {
            Ok(received) => rest.take(&received, now_us, out),
            Err(_) => rest.record.counts.damaged += 1,
        });
    }

    fn turn(&mut self, now_us: u64, out: &mut Vec<u8>) {
        self.rest.turn(now_us, out);
    }

    fn record(&self) -> &Record {
        &self.rest.record
    }
}

impl Autopilot {
    fn parameter(&self, name: &str) -> i32 {
        self.parameters.get(name).copied().unwrap_or(0)
    }

    fn is_hitl(&self) -> bool {
        self.parameter("SYS_HITL") == 1
    }

    /// Whether this link is listened to: its data rate, of which 0 means a twentieth of the baud rate.
    fn hears(&self) -> bool {
        let rate = match self.parameter("MAV_0_RATE") {
            0 => self.parameter("SER_TEL1_BAUD") / 20,
            rate => rate,
        };
        self.is_hitl() && rate > DEAF_RATE
    }

    fn take(&mut self, received: &Received, now_us: u64, out: &mut Vec<u8>) {
        self.record.counts.packets += 1;
        self.record.counts.lost = self.senders.observe(&received.header);
        match received.message {
            Some(Message::HilSensor(message)) => self.feel(&message, now_us, out),
            Some(Message::HilStateQuaternion(_)) => self.record.counts.foreign += 1,
            Some(Message::ParamRequestRead(request)) => self.tell(&request, out),
            Some(Message::CommandLong(command)) => self.obey(&command, out),
            Some(Message::Timesync(timesync::Repr { tc1: 0, ts1 })) => {
                let tc1 = now_us as i64 * 1000;
                self.voice.say(&Message::Timesync(timesync::Repr { tc1, ts1 }), out);
            }
            Some(Message::Timesync(timesync::Repr { ts1, .. })) if self.compared_ns == Some(ts1) => {
                self.record.counts.answers += 1;
            }
            _ => {}
        }
    }

    /// Takes readings, as of now.
    fn feel(&mut self, message: &hil_sensor::Repr, now_us: u64, out: &mut Vec<u8>) {
        let Some(mut sample) = sample(message, now_us).filter(|_| self.hears()) else {
            self.record.counts.refused += 1;
            return;
        };
        let stale = &mut self.record.counts.stale;
        for (reading, validator, raw) in [
            (&mut sample.gyro, &mut self.gyro, message.gyro),
            (&mut sample.accel, &mut self.accel, message.accel),
        ] {
            if reading.is_some() && !validator.take(raw, now_us) {
                *stale += 1;
                *reading = None;
            }
        }
        self.record.counts.samples += 1;
        self.fed_us = Some(now_us);
        self.own.take(&sample, Some(message.time_usec), &mut self.record);
        // Its outputs follow its rate controller, and that follows the gyro.
        if sample.gyro.is_some() && self.actuate.is_due(now_us) {
            let controls = hil_actuator_controls::Repr {
                time_usec: now_us,
                mode: HIL | CUSTOM,
                ..hil_actuator_controls::Repr::default()
            };
            self.voice.say(&Message::HilActuatorControls(controls), out);
        }
    }

    /// Answers a request for a parameter that it has. The bits of a whole number go in the message's float.
    fn tell(&mut self, request: &param_request_read::Repr, out: &mut Vec<u8>) {
        let name = param_name(&request.param_id);
        let found = self.parameters.keys().position(|known| known == name);
        let (Some(index), SYSTEM) = (found, request.target_system) else { return };
        let value = param_value::Repr {
            param_value: f32::from_bits(self.parameter(name) as u32),
            param_count: self.parameters.len() as u16,
            param_index: index as u16,
            param_id: param_id(name),
            param_type: param_value::INT32,
        };
        self.voice.say(&Message::ParamValue(value), out);
    }

    fn obey(&mut self, command: &command_long::Repr, out: &mut Vec<u8>) {
        let &command_long::Repr { params: [id, interval_us, ..], command, target_system, .. } = command;
        if target_system != SYSTEM {
            return;
        }
        let id = id as u32;
        let known = [attitude::ID, attitude_quaternion::ID].contains(&id);
        let result = match (command, known) {
            (command_long::SET_MESSAGE_INTERVAL, true) => {
                if interval_us > 0.0 {
                    self.streams.insert(id, Every::new(interval_us as u64));
                } else {
                    self.streams.remove(&id);
                }
                command_ack::ACCEPTED
            }
            _ => UNSUPPORTED,
        };
        let ack = command_ack::Repr { command, result, ..command_ack::Repr::default() };
        self.voice.say(&Message::CommandAck(ack), out);
    }

    fn turn(&mut self, now_us: u64, out: &mut Vec<u8>) {
        if self.beat.is_due(now_us) {
            let beat = heartbeat::Repr {
                kind: QUADROTOR,
                autopilot: PX4,
                base_mode: CUSTOM | if self.is_hitl() { HIL } else { 0 },
                system_status: 3,
                mavlink_version: 3,
                custom_mode: 0,
            };
            self.voice.say(&Message::Heartbeat(beat), out);
        }
        if self.compare.is_due(now_us) {
            let ts1 = now_us as i64 * 1000;
            self.compared_ns = Some(ts1);
            self.record.counts.asked += 1;
            self.voice.say(&Message::Timesync(timesync::Repr { tc1: 0, ts1 }), out);
        }
        let silent = [&mut self.gyro, &mut self.accel].map(|validator| validator.times_out(now_us));
        self.record.counts.timeouts += u64::from(silent.contains(&true));
        self.stream(now_us, out);
    }

    /// Tells its attitude to whoever has asked for it, as of its newest sample.
    fn stream(&mut self, now_us: u64, out: &mut Vec<u8>) {
        let Some(newest) = self.record.history.last() else { return };
        let time_boot_ms = (newest.t_us / 1000) as u32;
        let [roll, pitch, yaw] = to_euler(newest.attitude).map(|angle| angle as f32);
        let q = newest.attitude.map(|c| c as f32);
        for (id, every) in &mut self.streams {
            if every.is_due(now_us) {
                let message = match *id {
                    attitude::ID => Message::Attitude(attitude::Repr {
                        time_boot_ms,
                        roll,
                        pitch,
                        yaw,
                        ..attitude::Repr::default()
                    }),
                    _ => Message::AttitudeQuaternion(attitude_quaternion::Repr {
                        time_boot_ms,
                        q,
                        ..attitude_quaternion::Repr::default()
                    }),
                };
                self.record.counts.told += 1;
                self.voice.say(&message, out);
            }
        }
    }
}
