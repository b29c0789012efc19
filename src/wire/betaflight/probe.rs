//! Whether the firmware's gyro answers: a test rate on the stream's link before the stream, told over MSP.
//!
//! Its start-up has races. Of 200 boots one had a control loop whose gyro read nothing (measured), and a run on it
//! would score an attitude that never moves. So it is turned a little, there and back for as long.

use super::{Release, readings};
use crate::earth::STANDARD_GRAVITY;
use crate::geometry::{Body, Vector};
use ratetable_protocols::betaflight::{self, GYRO_COUNTS_READ, state};
use ratetable_protocols::msp::raw_imu;

/// Test packets with which nothing turns yet: after a silence of half a second the firmware leaves one out.
const LEAD: u32 = 5;
/// The most that it is turned for, and then back for, ns.
const PATIENCE: i64 = 1_000_000_000;
/// The test rate about forward, right and down, deg/s: each axis has its own.
const RATE: [f64; 3] = [30.0, 20.0, 10.0];
/// How far an answer may be off, deg/s: its filters take a moment.
const SLACK: f64 = 2.0;

/// What the test has come to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Verdict {
    /// It goes on.
    Open,
    /// The gyro answers as it should.
    Alive,
    /// It answers, but for the sign of the rate about down: a build for another simulator.
    Mirrored,
    /// It does not answer.
    Dead,
}

/// The test.
#[derive(Debug, Default)]
pub(super) struct Probe {
    began: Option<i64>,
    /// Packets so far, and those that turned it there and back.
    sent: u32,
    there: u32,
    back: u32,
    /// Whether a packet without a rate came after those.
    rested: bool,
    /// What it told, once that was the test rate.
    seen: Option<Verdict>,
}

impl Probe {
    /// The next packet, at `now`.
    pub fn next(&mut self, now: i64, release: Release) -> state::Repr {
        let began = *self.began.get_or_insert(now);
        self.sent += 1;
        let turns_on = self.seen.is_none() && now - began < PATIENCE;
        let turn = match () {
            () if self.sent <= LEAD => 0.0,
            () if turns_on => {
                self.there += 1;
                1.0
            }
            () if self.back < self.there => {
                self.back += 1;
                -1.0
            }
            () => {
                self.rested = true;
                0.0
            }
        };
        let [p, q, r] = RATE.map(|rate| turn * rate.to_radians());
        let up = Vector::<Body>::new(0.0, 0.0, -STANDARD_GRAVITY);
        readings(Vector::new(p, q, r), up, release)
    }

    /// Takes in what the gyro tells.
    pub fn hear(&mut self, told: &raw_imu::Repr) {
        let near = |signs: [f64; 3]| {
            let seen = told.gyro.map(|counts| f64::from(counts) / GYRO_COUNTS_READ);
            seen.iter().zip(RATE).zip(signs).all(|((seen, rate), sign)| (seen - sign * rate).abs() <= SLACK)
        };
        let seen = match () {
            // About forward, left and up.
            () if near([1.0, -1.0, -1.0]) => Verdict::Alive,
            () if near([1.0, -1.0, 1.0]) => Verdict::Mirrored,
            () => return,
        };
        self.seen.get_or_insert(seen);
    }

    /// What it has come to, once the vehicle is turned back and stands.
    pub fn verdict(&self) -> Verdict {
        match self.seen {
            _ if !self.rested => Verdict::Open,
            seen => seen.unwrap_or(Verdict::Dead),
        }
    }
}

/// Its bytes.
pub(super) fn bytes(state: &state::Repr) -> [u8; betaflight::MAX_LEN] {
    let mut buffer = [0; betaflight::MAX_LEN];
    // MAX_LEN holds every packet.
    let _ = betaflight::encode(state, &mut buffer);
    buffer
}
