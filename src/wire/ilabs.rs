//! `ilabs`: frames of an Inertial Labs unit, at each gyro tick.
//!
//! A frame tells the time, every sensor that the scene has, always a pressure (without a barometer that of the standard
//! atmosphere at sea level), an attitude, and that the unit is well. Vectors are right, forward, up; the specific force
//! is in a g of 9.8106 m/s². The attitude is level unless the output asks for the true one. The stream ends with a
//! vehicle that has stopped.

mod reader;

use super::latest::{CARRIED, Latest, pascals};
use super::newest::Told;
use super::row::{Row, Shared, any};
use super::wrap::{WEEK, next_step};
use super::{Claim, Encoder, Now, Packet, Setup};
use crate::geometry::{Body, Euler, Vector};
use crate::motion::Truth;
use crate::sensor::{ByKind, Kinds, REFERENCE_TEMPERATURE, SensorKind};
use crate::time::{NANOS, SimTime};
use ratetable_protocols::ilabs::data::{Angles, G, Pressure, Repr};
use ratetable_protocols::ilabs::{self, HEADER_LEN};

pub(super) static ROW: Row = Row {
    name: "ilabs",
    about: "an Inertial Labs unit for ArduPilot and PX4: accel, gyro, pressure and mag at each gyro tick",
    carries: CARRIED,
    encoder: |setup| Box::new(Ilabs::new(setup)),
    reader: |_| Box::new(reader::Reader::default()),
    dialogue: |_| None,
    shared: |_, first| Some(Shared::at_ticks("a frame", CARRIED, first)),
    keys: &["attitude", "thin"],
    check: any,
    greeting: |_| vec![0],
    is_numbered: false,
    inside: |len| (HEADER_LEN.min(len)..len, None),
};

/// Of a count, m/s².
const ACCEL: f64 = 1e-6 * G;
/// Of a count, rad/s.
const GYRO: f64 = 1e-5 * std::f64::consts::PI / 180.0;
/// Of a count, µT.
const MAG: f64 = 0.01;
/// Of a count, Pa.
const PRESSURE: f64 = 2.0;
const MILLISECOND: i64 = NANOS / 1000;

pub(super) struct Ilabs {
    latest: Latest,
    kinds: Kinds,
    claim: Claim,
}

impl Ilabs {
    pub(super) fn new(setup: &Setup<'_>) -> Ilabs {
        let mut kinds = Kinds::NONE;
        setup.sensors.iter().for_each(|sensor| kinds.insert(sensor.kind));
        Ilabs { latest: Latest::new(setup, |own| own), kinds, claim: setup.options.claim }
    }
}

impl Encoder for Ilabs {
    fn encode(&mut self, now: &Now<'_>, out: &mut Vec<Packet>) {
        let attitude = angles(self.claim, now.truth);
        let write = |t: SimTime, newest: &Told, buffer: &mut [u8]| write(t, newest, attitude, buffer);
        self.latest.encode(now.t, now.readings, out, write);
    }

    fn farewell(&mut self, end: &Truth, out: &mut Vec<Packet>) {
        if !self.latest.has_begun() {
            return;
        }
        let still = self.latest.stopped(end, self.kinds);
        let mut buffer = [0; ilabs::MAX_LEN];
        let told = next_step(end.t, MILLISECOND);
        let len = write(told, &still, angles(self.claim, end), &mut buffer);
        out.push(Packet::new(end.t, Kinds::NONE, &buffer[..len]));
    }

    fn waiting(&self) -> ByKind<u64> {
        self.latest.waiting()
    }
}

/// The frame of the newest readings.
fn write(t: SimTime, newest: &Told, attitude: Angles, buffer: &mut [u8]) -> usize {
    let warm = [SensorKind::Gyro, SensorKind::Accel].into_iter().find_map(|kind| newest.temperature(kind));
    let warm = warm.unwrap_or(REFERENCE_TEMPERATURE);
    let vector = |kind, unit| newest.body(kind).map(|value| counts(value, unit));
    let half_pascals = (pascals(newest) / PRESSURE).round_ties_even() as u16;
    let told = Repr {
        time_ms: Some((t.0.rem_euclid(WEEK) / MILLISECOND) as u32),
        accel: vector(SensorKind::Accel, ACCEL).map(|counts| counts.map(|count| count as i32)),
        gyro: vector(SensorKind::Gyro, GYRO).map(|counts| counts.map(|count| count as i32)),
        pressure: Some(Pressure { half_pascals, altitude: 0 }),
        // Equally far both ways, as the unit clips.
        mag: vector(SensorKind::Mag, MAG).map(|counts| counts.map(|count| (count as i16).max(-i16::MAX))),
        attitude: Some(attitude),
        status: Some(0),
        status_2: Some(0),
        temperature: Some((10.0 * warm).round_ties_even() as i16),
    };
    // MAX_LEN holds every frame.
    ilabs::encode(&told, buffer).unwrap_or(0)
}

/// Right, forward, up, in the nearest whole counts.
fn counts(value: Vector<Body>, unit: f64) -> [f64; 3] {
    let [x, y, z] = value.v.to_array();
    [y, x, -z].map(|value| (value / unit).round_ties_even())
}

/// What is said of the attitude.
fn angles(claim: Claim, truth: &Truth) -> Angles {
    match claim {
        Claim::Level => Angles::default(),
        Claim::Truth => {
            let Euler { roll, pitch, yaw } = Euler::from_quat(truth.attitude.q);
            let hundredths = |angle: f64| (100.0 * angle.to_degrees()).round_ties_even();
            let yaw = hundredths(yaw).rem_euclid(36_000.0) as u16;
            Angles { yaw, pitch: hundredths(pitch) as i16, roll: hundredths(roll) as i16 }
        }
    }
}

#[cfg(test)]
mod tests;
