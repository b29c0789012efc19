//! `mavlink`: HIL_SENSOR at each gyro tick, HIL_GPS at each tick of a receiver, HEARTBEAT and SYSTEM_TIME once a
//! second, and extra messages on request.
//!
//! The sender is a component of the system that the conversation has found, or of system 1. A message carries the
//! newest sample of every sensor, with a bit set for each that ticked since the previous message. Its temperature
//! is that of the first sensor that has one in the scene, else the barometer's. Axes are Forward-Right-Down; the
//! field is in gauss (1 G = 100 µT), pressure in hPa.

mod damage;
mod dialogue;
mod extra;
mod gps;
mod reader;

pub use extra::{Extra, Extras};

use super::row::{Row, Shared};
use super::{Controller, Encoder, EverySecond, Newest, Now, Options, Packet, Setup};
use crate::earth::pressure_altitude;
use crate::sensor::{ByKind, Claims, Kinds, SensorKind, TEMPERATURE};
use crate::time::{Rate, SimTime};
use extra::Sender;
use ratetable_protocols::mavlink::{self, Header, Message, Version, heartbeat, hil_sensor, system_time};

pub(super) static ROW: Row = Row {
    name: "mavlink",
    about: "MAVLink 2: HIL_SENSOR (gyro, accel, mag, baro, airspeed) at each gyro tick, HIL_GPS, HEARTBEAT and SYSTEM_TIME once a second",
    carries: Kinds::ALL,
    encoder: |setup| Box::new(Mavlink::new(setup)),
    reader: |assumed| match assumed.recorded {
        true => Box::new(reader::Reader::recorded()),
        false => Box::new(reader::Reader::default()),
    },
    dialogue: |controller| Some(Box::new(dialogue::Mavlink::new(controller))),
    shared: |options, first| {
        let every = every(options, first.rate);
        Some(match first.rate.times(1, every) {
            Some(rate) if every > 1 => Shared {
                kinds: KINDS,
                rate,
                what: format!(
                    "HIL_SENSOR at every {every}th {} tick ({rate}), as PX4 keeps up with in lockstep",
                    first.kind
                ),
                fits: Some(rate),
            },
            _ => Shared::at_ticks("HIL_SENSOR", KINDS, first),
        })
    },
    keys: &["version", "messages", "thin"],
    check: |options, _| {
        let px4 = matches!(options.controller, Some(Controller::Px4 | Controller::Px4Sitl));
        let truth = options.extras.iter().find(|extra| px4 && extra.is_truth());
        truth.map_or(Ok(()), |truth| {
            Err(format!(
                "{} carries the true attitude, which PX4 has to find out itself: in HITL it fights the estimator; leave it out, the score does not need it",
                truth.name()
            ))
        })
    },
    greeting: reader::ground_station,
    is_numbered: true,
    // Magic, length, flags, sequence, sender and message: without them the length of the packet is lost.
    inside: |len| (10.min(len)..len, None),
};

/// PX4 in lockstep stops answering at 500 samples a second with its default IMU_INTEG_RATE; at 250 it keeps up
/// (measured).
const SITL_FASTEST: f64 = 250.0;

/// Of how many ticks of the first sensor one sends HIL_SENSOR.
fn every(options: &Options, rate: Rate) -> u64 {
    match options.controller {
        Some(Controller::Px4Sitl) => libm::ceil(rate.as_hz() / SITL_FASTEST).max(1.0) as u64,
        _ => 1,
    }
}

/// The simulator's own ids: the vehicle's system if unknown, and a separate component.
pub(super) const SYSTEM: u8 = 1;
pub(super) const COMPONENT: u8 = 51;

/// MAV_AUTOPILOT_INVALID: this is no autopilot.
pub(super) const NO_AUTOPILOT: u8 = 8;
/// MAV_MODE_FLAG_HIL_ENABLED.
pub(super) const HARDWARE_IN_THE_LOOP: u8 = 0x20;
/// MAV_STATE_ACTIVE.
const ACTIVE: u8 = 4;
/// The `mavlink_version` of every dialect in use.
const DIALECT_VERSION: u8 = 3;

pub(super) const MICROTESLA_A_GAUSS: f64 = 100.0;
pub(super) const PASCALS_A_HECTOPASCAL: f64 = 100.0;
/// The kinds of sensor that HIL_SENSOR carries, and their bits of `fields_updated`.
const MASKS: [(SensorKind, u32); 5] = [
    (SensorKind::Gyro, hil_sensor::GYRO),
    (SensorKind::Accel, hil_sensor::ACCEL),
    (SensorKind::Mag, hil_sensor::MAG),
    (SensorKind::Baro, hil_sensor::PRESSURE),
    (SensorKind::Airspeed, hil_sensor::DIFF_PRESSURE),
];
/// Those kinds.
const KINDS: Kinds = {
    let (mut kinds, mut i) = (Kinds::NONE, 0);
    while i < MASKS.len() {
        kinds.insert(MASKS[i].0);
        i += 1;
    }
    kinds
};

pub(super) struct Mavlink {
    version: Version,
    system: u8,
    seq: u8,
    seconds: EverySecond,
    extras: Vec<Sender>,
    newest: Newest,
    /// Of gyro, accel and mag: the unit of one count.
    counts: [f64; 3],
    /// The sensor whose ticks send messages: the gyro, or without one the first sensor.
    carrier: Option<SensorKind>,
    /// Of how many of its ticks one sends a message, and how many are left until then.
    every: u64,
    left: u64,
    /// The accuracy that the scene's receiver claims for its fixes.
    claims: Option<Claims>,
    unix_us_at_start: Option<u64>,
    /// The sensor whose temperature goes out, where the scene gives one.
    warm: Option<SensorKind>,
}

impl Mavlink {
    pub(super) fn new(setup: &Setup<'_>) -> Mavlink {
        Mavlink {
            version: setup.options.version,
            system: setup.peer.system.unwrap_or(SYSTEM),
            seq: 0,
            seconds: EverySecond::default(),
            extras: setup.options.extras.iter().map(Sender::new).collect(),
            counts: super::mpu::counts(setup.sensors),
            newest: Newest::new(&setup.options),
            carrier: setup.sensors.iter().map(|sensor| sensor.kind).find(|kind| KINDS.contains(*kind)),
            every: setup.sensors.first().map_or(1, |first| every(&setup.options, first.rate)),
            left: 0,
            claims: setup
                .sensors
                .iter()
                .find(|sensor| sensor.kind == SensorKind::Gps)
                .map(|sensor| Claims::of(&sensor.values)),
            unix_us_at_start: setup.day.map(|day| day.unix_seconds() as u64 * 1_000_000),
            warm: setup
                .sensors
                .iter()
                .find(|sensor| sensor.values.has(TEMPERATURE))
                .map(|sensor| sensor.kind),
        }
    }

    fn header(&mut self) -> Header {
        let seq = self.seq;
        self.seq = seq.wrapping_add(1);
        Header { version: self.version, seq, system: self.system, component: COMPONENT }
    }

    fn bytes<'b>(&mut self, message: &Message, buffer: &'b mut [u8; mavlink::MAX_LEN]) -> &'b [u8] {
        let header = self.header();
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
            out.push(Packet::new(t, Kinds::NONE, bytes));
        }
    }

    /// Whether this tick of the carrier sends a message.
    fn is_turn(&mut self) -> bool {
        let turn = self.left == 0;
        self.left = if turn { self.every - 1 } else { self.left - 1 };
        turn
    }

    fn readings(&self) -> Readings<'_> {
        Readings { newest: &self.newest, counts: self.counts, warm: self.warm }
    }

    fn hil_sensor(&self, t: SimTime) -> Message {
        let readings = self.readings();
        let value = |kind, unit| readings.over(kind, unit).map(|x| x as f32);
        let temperature = readings.temperature();
        let mut fields_updated = temperature.map_or(0, |_| hil_sensor::TEMPERATURE);
        for (kind, mask) in MASKS {
            fields_updated |= if self.newest.fresh.contains(kind) { mask } else { 0 };
        }
        let told = &self.newest.told;
        let absolute = told.pressure(SensorKind::Baro);
        let differential = told.pressure(SensorKind::Airspeed);
        Message::HilSensor(hil_sensor::Repr {
            time_usec: t.0 as u64 / 1000,
            accel: value(SensorKind::Accel, 1.0),
            gyro: value(SensorKind::Gyro, 1.0),
            mag: value(SensorKind::Mag, MICROTESLA_A_GAUSS),
            abs_pressure: absolute.map_or(0.0, |pascals| (pascals / PASCALS_A_HECTOPASCAL) as f32),
            diff_pressure: differential.map_or(0.0, |pascals| (pascals / PASCALS_A_HECTOPASCAL) as f32),
            pressure_alt: absolute.map_or(0.0, |pascals| pressure_altitude(pascals) as f32),
            temperature: temperature.or(told.temperature(SensorKind::Baro)).unwrap_or(0.0) as f32,
            fields_updated,
            id: 0,
        })
    }

    fn extras(&mut self, now: &Now<'_>, out: &mut Vec<Packet>) {
        let ticked = now.readings.iter().map(|reading| reading.kind).collect();
        let mut extras = std::mem::take(&mut self.extras);
        for sender in &mut extras {
            if sender.is_due(now.t, ticked) {
                let message = sender.message(now.truth, &self.readings());
                let mut buffer = [0; mavlink::MAX_LEN];
                out.push(Packet::new(now.t, Kinds::NONE, self.bytes(&message, &mut buffer)));
            }
        }
        self.extras = extras;
    }
}

/// The newest reading of each sensor, for messages.
struct Readings<'a> {
    newest: &'a Newest,
    counts: [f64; 3],
    warm: Option<SensorKind>,
}

impl Readings<'_> {
    /// A reading in units of `unit`; 0 before the first.
    fn over(&self, kind: SensorKind, unit: f64) -> [f64; 3] {
        self.newest.told.body(kind).map_or([0.0; 3], |value| value.v.to_array().map(|x| x / unit))
    }

    /// The temperature in °C, where the scene gives one.
    fn temperature(&self) -> Option<f64> {
        self.newest.told.temperature(self.warm?)
    }
}

impl Encoder for Mavlink {
    fn encode(&mut self, now: &Now<'_>, out: &mut Vec<Packet>) {
        let Now { t, readings, .. } = *now;
        for second in self.seconds.due(t) {
            self.every_second(second, out);
        }
        self.newest.take_in(readings);
        if readings.iter().any(|reading| Some(reading.kind) == self.carrier) && self.is_turn() {
            let (message, header) = (self.hil_sensor(t), self.header());
            // A packet holds every message.
            self.newest
                .append(out, t, KINDS, |_, bytes| mavlink::encode(&header, &message, bytes).unwrap_or(0));
        }
        let fix = readings.iter().find_map(|reading| Some(reading.position()?.fix));
        if let (Some(fix), Some(claims)) = (fix, &self.claims) {
            let (message, header) = (gps::message(t, &fix, claims), self.header());
            self.newest.append(out, t, SensorKind::Gps.into(), |_, bytes| {
                mavlink::encode(&header, &message, bytes).unwrap_or(0)
            });
        }
        if !self.extras.is_empty() {
            self.extras(now, out);
        }
    }

    fn waiting(&self) -> ByKind<u64> {
        self.newest.waiting()
    }
}

#[cfg(test)]
mod tests;
