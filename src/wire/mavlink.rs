//! `mavlink`: HIL_SENSOR at each gyro tick, HEARTBEAT and SYSTEM_TIME once a second.
//!
//! A message carries the newest sample of every sensor, with a bit set for each that ticked since the message
//! before; the temperature of the first sensor that has one in the scene. Axes are Forward-Right-Down; the field is in gauss, which is 100 µT.

use super::{Encoder, EverySecond, Newest, Now, Packet, Setup};
use crate::sensor::{ByKind, SensorKind};
use crate::time::SimTime;
use ratetable_protocols::mavlink::{self, Header, Message, Version, heartbeat, hil_sensor, system_time};

/// The simulator's own ids: the vehicle's system, a component of its own.
const SYSTEM: u8 = 1;
const COMPONENT: u8 = 51;

/// MAV_AUTOPILOT_INVALID: this is no autopilot.
const NO_AUTOPILOT: u8 = 8;
/// MAV_MODE_FLAG_HIL_ENABLED.
const HARDWARE_IN_THE_LOOP: u8 = 0x20;
/// MAV_STATE_ACTIVE.
const ACTIVE: u8 = 4;
/// The `mavlink_version` of every dialect in use.
const DIALECT_VERSION: u8 = 3;

pub(super) const MICROTESLA_A_GAUSS: f64 = 100.0;
/// The bits of `fields_updated` of gyro, accel and mag.
pub(super) const MASKS: [u32; 3] = [hil_sensor::GYRO, hil_sensor::ACCEL, hil_sensor::MAG];

pub(super) struct Mavlink {
    seq: u8,
    seconds: EverySecond,
    newest: Newest,
    /// At whose ticks messages go out: the gyro's, or without one the first sensor's.
    carrier: Option<SensorKind>,
    unix_us_at_start: Option<u64>,
    /// Whose temperature is told, where the scene gives one.
    warm: Option<SensorKind>,
}

impl Mavlink {
    pub(super) fn new(setup: &Setup<'_>) -> Mavlink {
        Mavlink {
            seq: 0,
            seconds: EverySecond::default(),
            newest: Newest::default(),
            carrier: setup.sensors.first().map(|sensor| sensor.kind),
            unix_us_at_start: setup.day.map(|day| day.unix_seconds() as u64 * 1_000_000),
            warm: setup
                .sensors
                .iter()
                .find(|sensor| sensor.values.has("temperature"))
                .map(|sensor| sensor.kind),
        }
    }

    fn bytes<'b>(&mut self, message: &Message, buffer: &'b mut [u8; mavlink::MAX_LEN]) -> &'b [u8] {
        let header = Header { version: Version::V2, seq: self.seq, system: SYSTEM, component: COMPONENT };
        self.seq = self.seq.wrapping_add(1);
        // MAX_LEN holds every message.
        let len = mavlink::encode(&header, message, buffer).unwrap_or(0);
        &buffer[..len]
    }

    fn every_second(&mut self, t: SimTime, out: &mut Vec<Packet>) {
        let mut buffer = [0; mavlink::MAX_LEN];
        let us = t.0 as u64 / 1000;
        let alive = heartbeat::Repr {
            custom_mode: 0,
            kind: 0,
            autopilot: NO_AUTOPILOT,
            base_mode: HARDWARE_IN_THE_LOOP,
            system_status: ACTIVE,
            mavlink_version: DIALECT_VERSION,
        };
        let clock = system_time::Repr {
            time_unix_usec: self.unix_us_at_start.map_or(0, |start| start + us),
            time_boot_ms: (us / 1000) as u32,
        };
        for message in [Message::Heartbeat(alive), Message::SystemTime(clock)] {
            let bytes = self.bytes(&message, &mut buffer);
            out.push(Packet::new(t, 0, bytes));
        }
    }

    fn hil_sensor(&self, t: SimTime) -> Message {
        let value = |kind: SensorKind, unit: f64| {
            self.newest.values[kind as usize]
                .map_or([0.0; 3], |reading| reading.value.v.to_array().map(|x| (x / unit) as f32))
        };
        let fresh = (0..3).filter(|i| self.newest.fresh >> i & 1 == 1).map(|i| MASKS[i]);
        let temperature = self.warm.and_then(|kind| self.newest.values[kind as usize]);
        let fresh = fresh.chain(temperature.map(|_| hil_sensor::TEMPERATURE));
        Message::HilSensor(hil_sensor::Repr {
            time_usec: t.0 as u64 / 1000,
            accel: value(SensorKind::Accel, 1.0),
            gyro: value(SensorKind::Gyro, 1.0),
            mag: value(SensorKind::Mag, MICROTESLA_A_GAUSS),
            abs_pressure: 0.0,
            diff_pressure: 0.0,
            pressure_alt: 0.0,
            temperature: temperature.map_or(0.0, |reading| reading.temperature as f32),
            fields_updated: fresh.fold(0, |mask, bits| mask | bits),
            id: 0,
        })
    }
}

impl Encoder for Mavlink {
    fn encode(&mut self, now: &Now<'_>, out: &mut Vec<Packet>) {
        let Now { t, readings, .. } = *now;
        for second in self.seconds.due(t) {
            self.every_second(second, out);
        }
        self.newest.take_in(readings);
        if readings.iter().any(|reading| Some(reading.kind) == self.carrier) {
            let message = self.hil_sensor(t);
            let mut buffer = [0; mavlink::MAX_LEN];
            let bytes = self.bytes(&message, &mut buffer);
            out.push(self.newest.packet(t, 0b111, bytes));
        }
    }

    fn waiting(&self) -> ByKind<u64> {
        self.newest.waiting()
    }
}
