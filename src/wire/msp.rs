//! `msp`: INAV's simulator message, all sensors in one, at most 100 a second.
//!
//! Axes are forward, left, up. The field is sent as its direction, the place's strength as 20480 counts, with its
//! horizontal part turned to true north: INAV takes the declination as 0. A receiver's fix is in every packet from its
//! first one on, and marked as new in one. A pitot tube's airspeed makes every message longer. INAV keeps what came last for ever, so the stream ends with a vehicle that
//! has stopped.

mod airspeed;
mod dialogue;
mod position;
mod reader;

use super::latest::{Latest, pascals};
use super::row::{Row, Shared, any};
use super::{AtEnd, Encoder, Now, Packet, Setup, stopped};
use crate::earth::{STANDARD_GRAVITY, declination};
use crate::geometry::{Body, Nav, Vector};
use crate::motion::Truth;
use crate::sensor::{ByKind, Kinds, Reading, SensorKind};
use crate::time::Rate;
use position::Position;
use ratetable_protocols::msp::{self, Message, simulator};

pub(super) static ROW: Row = Row {
    name: "msp",
    about: "MSPv2 for INAV: its simulator message (0x201F) with all sensors, at most 100 a second",
    carries: CARRIED,
    encoder: |setup| Box::new(Msp::new(setup)),
    reader: |_| Box::new(reader::Reader::default()),
    dialogue: |controller| Some(Box::new(dialogue::Inav::new(controller))),
    shared: |_, first| {
        let capped = first.rate.as_hz() > FASTEST.as_hz();
        Some(match capped {
            true => Shared {
                kinds: CARRIED,
                rate: FASTEST,
                what: format!("{} packets a second, as many as an INAV board takes", FASTEST.as_hz()),
                fits: Some(FASTEST),
            },
            false => Shared::at_ticks("a packet", CARRIED, first),
        })
    },
    keys: &["at_end", "thin"],
    check: any,
    greeting: |_| reader::question(),
    is_numbered: false,
    // The length of a packet comes first: `$X`, direction, flags, command and size.
    inside: |len| (8.min(len)..len, None),
};

/// The most packets a second that an INAV board accepts.
pub(super) const FASTEST: Rate = Rate::hz(100);

/// What the packets carry.
const CARRIED: Kinds = Kinds::of(&[
    SensorKind::Gyro,
    SensorKind::Accel,
    SensorKind::Mag,
    SensorKind::Baro,
    SensorKind::Gps,
    SensorKind::Airspeed,
]);

/// The field's strength in counts.
const FIELD: f64 = 20480.0;
/// Counts for one deg/s.
pub(super) const GYRO_SCALE: f64 = 16.0;
/// Counts for one g.
pub(super) const ACCEL_SCALE: f64 = 1000.0;

const FLAGS: u8 = simulator::ENABLE | simulator::BATTERY | simulator::MUTE | simulator::OWN_ESTIMATE;

/// Without a flag INAV leaves the simulator: it disarms and returns to its own sensors (`fc_msp.c`, read).
const LEAVE: u8 = 0;

pub(super) struct Msp {
    latest: Latest,
    /// The present readings, with the field turned.
    turned: Vec<Reading>,
    position: Position,
    has_mag: bool,
    at_end: AtEnd,
}

impl Msp {
    pub(super) fn new(setup: &Setup<'_>) -> Msp {
        let at_most = |rate: Rate| if rate.as_hz() > FASTEST.as_hz() { FASTEST } else { rate };
        let mut latest = Latest::new(setup, at_most);
        latest.kinds = CARRIED;
        Msp {
            latest,
            position: Position::new(setup.sensors),
            turned: Vec::with_capacity(setup.sensors.len()),
            at_end: setup.options.at_end,
            has_mag: setup.sensors.iter().any(|sensor| sensor.kind == SensorKind::Mag),
        }
    }
}

impl Encoder for Msp {
    fn encode(&mut self, now: &Now<'_>, out: &mut Vec<Packet>) {
        let to_true_north = to_true_north(now.truth);
        self.turned.clear();
        self.turned.extend(now.readings.iter().map(|reading| match reading.kind {
            SensorKind::Mag => {
                reading.with_body(reading.body().map_or(Vector::ZERO, |mag| mag.value + to_true_north))
            }
            _ => *reading,
        }));
        let strength = now.truth.field.length();
        let Msp { latest, turned, position, .. } = self;
        let mut fix = now.readings.iter().find_map(|reading| Some(reading.position()?.fix));
        latest.encode(now.t, turned, out, |due, newest, buffer| {
            // A packet that is due before now does not know the fix of now.
            position.take_in(fix.take_if(|_| due == now.t));
            let value = |kind| newest.body(kind).unwrap_or(Vector::ZERO);
            let vectors = [SensorKind::Gyro, SensorKind::Accel, SensorKind::Mag].map(value);
            let pitot = newest.pressure(SensorKind::Airspeed);
            frame(message(vectors, strength, pascals(newest)), position, pitot, buffer)
        });
        position.take_in(fix);
    }

    fn farewell(&mut self, end: &Truth, out: &mut Vec<Packet>) {
        if !self.latest.has_begun() {
            return;
        }
        let [gyro, accel, field] = stopped(end);
        let mag = if self.has_mag { field + to_true_north(end) } else { Vector::ZERO };
        let mut buffer = [0; msp::MAX_LEN];
        self.position.stop();
        let last = message([gyro, accel, mag], end.field.length(), pascals(self.latest.newest()));
        let pitot = self.latest.newest().pressure(SensorKind::Airspeed).map(|_| 0.0);
        let len = frame(last, &mut self.position, pitot, &mut buffer);
        out.push(Packet::new(end.t, Kinds::NONE, &buffer[..len]));
        if self.at_end == AtEnd::Leave {
            // MAX_LEN holds every frame.
            let message = simulator::Repr { version: simulator::VERSION, flags: LEAVE, ..Default::default() };
            let len = msp::encode(&Message::Simulator(message), &mut buffer).unwrap_or(0);
            out.push(Packet::new(end.t, Kinds::NONE, &buffer[..len]));
        }
    }

    fn waiting(&self) -> ByKind<u64> {
        self.latest.waiting()
    }
}

/// The vector, in body axes, that turns the place's field to true north. Added to a reading, it leaves the
/// magnetometer's own errors on its own axes.
fn to_true_north(truth: &Truth) -> Vector<Body> {
    let field = truth.attitude.apply(truth.field);
    if declination(field) == 0.0 {
        return Vector::ZERO;
    }
    let turned: Vector<Nav> = Vector::new(libm::hypot(field.v.x, field.v.y), 0.0, field.v.z);
    truth.attitude.inverse().apply(turned - field)
}

/// What is said of gyro, accel and mag; `strength` is the place's field in µT, `pressure` in Pa.
fn message([gyro, accel, mag]: [Vector<Body>; 3], strength: f64, pressure: f64) -> simulator::Repr {
    let field = if strength > 0.0 { FIELD / strength } else { 0.0 };
    simulator::Repr {
        version: simulator::VERSION,
        flags: FLAGS,
        accel: counts(accel, ACCEL_SCALE / STANDARD_GRAVITY),
        gyro: counts(gyro, GYRO_SCALE * 1f64.to_degrees()),
        pressure: libm::round(pressure) as i32,
        mag: counts(mag, field),
        ..simulator::Repr::default()
    }
}

/// The frame of a message, the position that goes with it and a pitot tube's pressure, Pa.
fn frame(
    mut message: simulator::Repr,
    position: &mut Position,
    pitot: Option<f64>,
    buffer: &mut [u8],
) -> usize {
    position.put_into(&mut message);
    let message = match pitot {
        Some(pressure) => Message::SimulatorAir(airspeed::with(message, pressure)),
        None => Message::Simulator(message),
    };
    // MAX_LEN holds every frame.
    msp::encode(&message, buffer).unwrap_or(0)
}

/// Forward, left and up, rounded to counts and clipped to 16 bits.
fn counts(value: Vector<Body>, scale: f64) -> [i16; 3] {
    let [x, y, z] = value.v.to_array();
    [x, -y, -z].map(|axis| libm::round(axis * scale) as i16)
}
