//! The cases, and the numbers of each.

use super::harm::{at_half_the_rate, between, clipped, harmed, lost, no_number, repeated, swapped, twice};
use super::trials::{Trial, poles, spin_1500, spin_2000, swing};
use super::{COME_BACK, Case, Effort};
use crate::filters::Readings;
use crate::geometry::{Attitude, Vector, exp};
use glam::DVec3;
use std::f64::consts::PI;

/// When a disturbance begins and is over, s.
const BEGIN: f64 = 10.0;
const OVER: f64 = 20.0;

/// How long a trial is, s: [`COME_BACK`] after the last disturbance is over, and some more; a period of every motion
/// fits in whole.
const SECONDS: i64 = 100;

/// Every case.
pub static CASES: [Case; 21] = [
    Case {
        name: "calm",
        about: "nothing is the matter: a gyro bias of 0.1 deg/s, swings about every axis",
        needs_mag: false,
        trial: |_| lasting(|_| ()),
    },
    Case {
        name: "start-upside-down",
        about: "starts half a turn of roll off",
        needs_mag: false,
        trial: |_| started(DVec3::X * PI),
    },
    Case {
        name: "start-heading-180",
        about: "starts half a turn of heading off",
        needs_mag: true,
        trial: |_| started(DVec3::Z * PI),
    },
    Case {
        name: "pitch-90",
        about: "nose straight up and straight down, some seconds each",
        needs_mag: false,
        trial: |_| Trial::new(poles, SECONDS),
    },
    Case {
        name: "rate-2000",
        about: "2000 deg/s at 100 Hz about no main axis for 5 s",
        needs_mag: false,
        trial: |_| Trial::new(spin_2000, SECONDS).over_at(15.0),
    },
    Case {
        name: "gyro-clipped",
        about: "1500 deg/s for 1 s read by a gyro of 500 deg/s",
        needs_mag: false,
        trial: |_| {
            let clip = |w| clipped(w, 500_f64.to_radians());
            let trial = Trial::new(spin_1500, SECONDS).over_at(11.0);
            harmed(trial, |readings| between(&mut readings.gyro, 0.0, f64::INFINITY, clip))
        },
    },
    Case {
        name: "gyro-bias-10",
        about: "a gyro bias of 10 deg/s on one axis; counts after 60 s",
        needs_mag: false,
        trial: |_| {
            let bias = DVec3::Y * 10_f64.to_radians();
            let trial = lasting(|readings| between(&mut readings.gyro, 0.0, f64::INFINITY, |w| w + bias));
            Trial { from: COME_BACK, ..trial }
        },
    },
    Case {
        name: "free-fall",
        about: "specific force 0 for 10 s",
        needs_mag: false,
        trial: |_| passing(|readings| between(&mut readings.accel, BEGIN, OVER, |_| DVec3::ZERO)),
    },
    Case {
        name: "accel-pushed",
        about: "0.5 g forward for 10 s",
        needs_mag: false,
        trial: |_| {
            let push = DVec3::X * 4.9;
            passing(|readings| between(&mut readings.accel, BEGIN, OVER, |force| force + push))
        },
    },
    Case {
        name: "mag-lost",
        about: "no more magnetometer from 10 s on",
        needs_mag: true,
        trial: |_| lasting(|readings| readings.mag.retain(|(t, _)| t.seconds() < BEGIN)),
    },
    Case {
        name: "mag-saturated",
        about: "a magnetometer of 10 uT for 10 s",
        needs_mag: true,
        trial: |_| passing(|readings| between(&mut readings.mag, BEGIN, OVER, |field| clipped(field, 10.0))),
    },
    Case {
        name: "mag-vertical",
        about: "a field without a level part for 10 s",
        needs_mag: true,
        trial: |_| passing(vertical),
    },
    Case {
        name: "dt-doubled",
        about: "every sensor at half of its rate from 10 s on",
        needs_mag: false,
        trial: |_| lasting(at_half_the_rate),
    },
    Case {
        name: "dt-zero",
        about: "one gyro reading in ten comes twice at the same time",
        needs_mag: false,
        trial: |_| lasting(|readings| twice(&mut readings.gyro)),
    },
    Case {
        name: "samples-lost",
        about: "one gyro reading in ten is lost",
        needs_mag: false,
        trial: |_| lasting(|readings| lost(&mut readings.gyro)),
    },
    Case {
        name: "samples-repeated",
        about: "one gyro reading in ten is the one before it again",
        needs_mag: false,
        trial: |_| lasting(|readings| repeated(&mut readings.gyro)),
    },
    Case {
        name: "out-of-order",
        about: "one gyro reading in ten comes after the next",
        needs_mag: false,
        trial: |_| lasting(|readings| swapped(&mut readings.gyro)),
    },
    Case {
        name: "nan-gyro",
        about: "one gyro reading is no number",
        needs_mag: false,
        trial: |_| passing(|readings| no_number(&mut readings.gyro)).over_at(BEGIN),
    },
    Case {
        name: "nan-accel",
        about: "one accelerometer reading is no number",
        needs_mag: false,
        trial: |_| passing(|readings| no_number(&mut readings.accel)).over_at(BEGIN),
    },
    Case {
        name: "nan-mag",
        about: "one magnetometer reading is no number",
        needs_mag: true,
        trial: |_| passing(|readings| no_number(&mut readings.mag)).over_at(BEGIN),
    },
    Case {
        name: "day",
        about: "calm for a day at 100 Hz (10 minutes with --quick)",
        needs_mag: false,
        trial: |effort: Effort| Trial { rounds: effort.rounds, ..lasting(|_| ()) },
    },
];

/// A disturbance for as long as the trial lasts.
fn lasting(harm: impl FnOnce(&mut Readings)) -> Trial {
    harmed(Trial::new(swing, SECONDS), harm)
}

/// A disturbance that is over at [`OVER`].
fn passing(harm: impl FnOnce(&mut Readings)) -> Trial {
    lasting(harm).over_at(OVER)
}

/// A start that is off by a turn.
fn started(turn: DVec3) -> Trial {
    let wrong = Attitude::from_quat(exp(turn) * swing(0.0).q);
    Trial { start: Some(wrong), from: 0.0, ..Trial::new(swing, SECONDS) }.over_at(0.0)
}

/// For ten seconds the field has no level part.
fn vertical(readings: &mut Readings) {
    for (t, field) in &mut readings.mag {
        if (BEGIN..OVER).contains(&t.seconds()) {
            let down = swing(t.seconds()).inverse().apply(Vector::new(0.0, 0.0, 45.0));
            *field = down;
        }
    }
}
