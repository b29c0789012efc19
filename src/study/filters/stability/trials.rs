//! Readings free of noise, made from a motion in closed form.

use crate::filters::{Column, Readings, Stream, Streams};
use crate::geometry::{Attitude, Body, Euler, Vector, exp, log};
use crate::time::SimTime;
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, TAU};

/// Gyro and accelerometer readings a second.
pub(super) const HZ: i64 = 100;
/// Of these every so many comes with one of the magnetometer.
const MAG_EVERY: i64 = 2;
/// Gravity, m/s².
const GRAVITY: f64 = 9.80665;
/// The field in North-East-Down, µT: as at a latitude of 55 degrees.
const FIELD: DVec3 = DVec3::new(20.0, 0.0, 45.0);
/// What a calibration leaves of the gyro's bias, deg/s.
pub const BIAS: DVec3 = DVec3::new(0.1, -0.1, 0.05);
/// How long a filter that finds its start by itself is shown the wrong one, s.
const BEFORE: i64 = 1;

/// What a filter is put through.
#[derive(Clone, Debug)]
pub struct Trial {
    /// The exact attitude, body to North-East-Down, at a time in seconds.
    pub truth: fn(f64) -> Attitude,
    /// What the sensors read.
    pub readings: Readings,
    /// Where the filter is told to start.
    pub start: Option<Attitude>,
    /// The error counts from here on, s.
    pub from: f64,
    /// When the disturbance is over, s; none where it lasts.
    pub over: Option<f64>,
    /// How often the readings come, one round after the other; the motion has their length as a period.
    pub rounds: u64,
}

impl Trial {
    /// Good readings of a motion for some seconds; the error counts from five on.
    pub(super) fn new(truth: fn(f64) -> Attitude, seconds: i64) -> Trial {
        let ticks = 0..seconds * HZ;
        let rate = |k: i64| {
            let [before, after] = [k - 1, k].map(|k| truth(k as f64 / HZ as f64).q);
            let turn = log(before.conjugate() * after) * HZ as f64;
            turn + BIAS.map(f64::to_radians)
        };
        let readings = Readings {
            gyro: ticks.clone().map(|k| (tick(k), Vector::from_vec(rate(k)))).collect(),
            accel: ticks.clone().map(|k| (tick(k), force(truth(k as f64 / HZ as f64)))).collect(),
            mag: ticks
                .step_by(MAG_EVERY as usize)
                .map(|k| (tick(k), field(truth(k as f64 / HZ as f64))))
                .collect(),
        };
        Trial { truth, readings, start: None, from: 5.0, over: None, rounds: 1 }
    }

    /// With a disturbance that is over at `over` seconds.
    pub(super) fn over_at(self, over: f64) -> Trial {
        Trial { over: Some(over), ..self }
    }

    /// The readings as they come, those of rest at `before` first.
    pub(super) fn streams(&self, before: Option<Attitude>) -> Streams<'_> {
        let rest = |of: fn(Attitude) -> Vector<Body>, every: i64| -> Column {
            let ticks = (-BEFORE * HZ..0).step_by(every as usize);
            before.map_or_else(Vec::new, |at| ticks.map(|k| (tick(k), of(at))).collect())
        };
        Streams {
            gyro: self.rounds_of(&self.readings.gyro, rest(|_| Vector::ZERO, 1)),
            accel: self.rounds_of(&self.readings.accel, rest(force, 1)),
            mag: self.rounds_of(&self.readings.mag, rest(field, MAG_EVERY)),
        }
    }

    fn rounds_of<'a>(&self, column: &'a Column, before: Column) -> Stream<'a> {
        let length = self.readings.gyro.len() as i64;
        let round = move |n: u64| {
            let begin = tick(n as i64 * length);
            column.iter().map(move |&(t, v)| (begin + t, v))
        };
        Box::new(before.into_iter().chain((0..self.rounds).flat_map(round)))
    }
}

fn tick(k: i64) -> SimTime {
    SimTime(k * 1_000_000_000 / HZ)
}

/// What an accelerometer reads at rest, m/s².
fn force(attitude: Attitude) -> Vector<Body> {
    attitude.inverse().apply(Vector::from_vec(DVec3::NEG_Z * GRAVITY))
}

/// What a magnetometer reads, µT.
fn field(attitude: Attitude) -> Vector<Body> {
    attitude.inverse().apply(Vector::from_vec(FIELD))
}

fn euler(roll: f64, pitch: f64, yaw: f64) -> Attitude {
    Attitude::from_quat(Euler { roll, pitch, yaw }.to_quat())
}

/// Swings about every axis, the same after 20 s; level and to the north at 0.
pub(super) fn swing(t: f64) -> Attitude {
    let sine = |size: f64, hz: f64| size * libm::sin(TAU * hz * t);
    euler(sine(0.3, 0.1), sine(0.2, 0.15), sine(0.5, 0.05))
}

/// To the nose straight up, some seconds there, and down to straight down, the same after 20 s.
pub(super) fn poles(t: f64) -> Attitude {
    euler(0.0, FRAC_PI_2 * (1.5 * libm::sin(TAU * 0.05 * t)).clamp(-1.0, 1.0), 0.0)
}

/// From 10 s on about an axis that is none of the body's, at `rate` deg/s for `seconds`.
fn spin(t: f64, rate: f64, seconds: f64) -> Attitude {
    let axis = DVec3::new(3.0, 5.0, 8.0).normalize();
    Attitude::from_quat(exp(axis * (rate.to_radians() * (t - 10.0).clamp(0.0, seconds))))
}

/// 2000 deg/s from 10 to 15 s.
pub(super) fn spin_2000(t: f64) -> Attitude {
    spin(t, 2000.0, 5.0)
}

/// 1500 deg/s from 10 to 11 s.
pub(super) fn spin_1500(t: f64) -> Attitude {
    spin(t, 1500.0, 1.0)
}
