//! Betaflight as a program (SITL) under a simulator, as master of 2026-08 (2026.12-alpha) was measured to behave.
//!
//! Samples come in UDP datagrams; on a TCP connection of its own it answers MSP. What is said here is measured on the
//! firmware itself unless it is marked *read* (in its source).

use ratetable_protocols::betaflight::{ACCEL_COUNTS, GYRO_COUNTS, GYRO_COUNTS_READ, MAX_COUNT, state};
use ratetable_protocols::msp::{
    self, Decoder, Direction, MAX_LEN, Message, Received, attitude, attitude_quaternion, fc_variant,
    fc_version, raw_imu, status,
};

use super::record::{Moment, Record};
use super::{Firmware, Settings};
use crate::ahrs::Mahony;
use crate::quaternion::to_euler;

/// A longer silence costs the packet behind it, µs.
const SILENCE_US: u64 = 500_000;
/// A longer step of the simulator's time says nothing of the clock, s (*read*).
const LONGEST_STEP: f64 = 0.02;
/// Of the attitude loop, and of the task that looks for questions, µs of its own clock.
const TASK_US: f64 = 10_000.0;
/// Of the loop here in which the rate is integrated, µs of its own clock.
const LOOP_US: f64 = 1_000.0;
/// After a faster turn its gain is low, deg/s; for so long, µs (*read*).
const QUIET_DPS: f64 = 15.0;
const QUIET_US: f64 = 250_000.0;
/// Then for so long its gain is highest, µs (*read*).
const EAGER_US: f64 = 500_000.0;
/// Its gains, disarmed: at first, then, and from then on.
const GAINS: [f64; 3] = [1.0, 100.0, 10.0];
/// m/s² in a g.
const G: f64 = 9.80665;

/// How it is built, and what its boot left standing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Build {
    /// The year since 2000 and the month of its version, or the two parts of a 4.5.
    pub version: [u8; 2],
    /// Whether it takes the rates of the simulator Gazebo, or of the others (`ENABLE_GAZEBO_BRIDGE`).
    pub gazebo: bool,
    /// Whether its MSP answers: in 11 of 200 boots it did not.
    pub msp: bool,
    /// Whether its gyro reads what comes: in one of 200 boots it did not.
    pub gyro: bool,
}

impl Default for Build {
    /// 2026.12, well.
    fn default() -> Self {
        Self { version: [26, 12], gazebo: true, msp: true, gyro: true }
    }
}

impl Build {
    /// Whether its attitude is its own (*read*: `USE_IMU_CALC`).
    fn estimates(self) -> bool {
        self.version >= [26, 6]
    }

    /// The sign of the packet's rate about the vertical: about up.
    fn yaw_sign(self) -> f64 {
        if self.estimates() && self.gazebo { 1.0 } else { -1.0 }
    }
}

/// Betaflight.
pub struct Betaflight {
    build: Build,
    decoder: Decoder,
    ahrs: Mahony,
    /// Counts of accelerometer and gyro, about and along forward, left and up.
    accel: [i16; 3],
    gyro: [i16; 3],
    record: Record,
    /// The packet before: the simulator's time in it, s, and its arrival, µs.
    before: Option<(f64, u64)>,
    /// Its own clock, µs, how fast that goes, and how far time has come.
    own_us: f64,
    speed: f64,
    now_us: u64,
    /// On its own clock: when its loop and its tasks run next, and since when it has not turned.
    loop_us: f64,
    task_us: f64,
    quiet_us: f64,
    questions: Vec<u16>,
}

impl Betaflight {
    /// Just booted: it heads north.
    pub fn new(settings: &Settings) -> Self {
        Self {
            build: settings.build,
            decoder: Decoder::new(),
            ahrs: Mahony::betaflight(),
            accel: [0; 3],
            gyro: [0; 3],
            record: Record::default(),
            before: None,
            own_us: 0.0,
            speed: 1.0,
            now_us: 0,
            loop_us: 0.0,
            task_us: 0.0,
            quiet_us: 0.0,
            questions: Vec::new(),
        }
    }

    /// Runs what is due by then, in order, on a clock that goes as the simulator makes it.
    fn run_until(&mut self, now_us: u64, out: &mut Vec<u8>) {
        // Times never go back, whatever two links say.
        let now_us = now_us.max(self.now_us);
        self.own_us += (now_us - self.now_us) as f64 * self.speed;
        self.now_us = now_us;
        while self.loop_us <= self.own_us {
            self.think();
            if self.task_us <= self.loop_us {
                self.task_us += TASK_US;
                for command in std::mem::take(&mut self.questions) {
                    self.answer(command, out);
                }
            }
            self.loop_us += LOOP_US;
        }
    }

    /// One step of the estimator.
    fn think(&mut self) {
        let rate = self.gyro.map(|counts| f64::from(counts) / GYRO_COUNTS_READ);
        if rate.iter().any(|rate| rate.abs() > QUIET_DPS) {
            self.quiet_us = self.loop_us;
        }
        if !self.build.estimates() {
            return;
        }
        let quiet = self.loop_us - self.quiet_us;
        let gain = usize::from(quiet >= QUIET_US) + usize::from(quiet >= QUIET_US + EAGER_US);
        self.ahrs.gain = GAINS[gain];
        let force = self.accel.map(|counts| f64::from(counts) / ACCEL_COUNTS * G);
        self.ahrs.step(LOOP_US * 1e-6, frd(rate).map(f64::to_radians), frd(force), [0.0; 3]);
    }

    /// Takes a packet in.
    fn sense(&mut self, packet: &state::Repr, now_us: u64) {
        let before = self.before;
        let now_us = now_us.max(self.now_us);
        let silent = before.is_none_or(|(_, at)| now_us - at > SILENCE_US);
        if silent {
            self.record.counts.refused += 1;
            self.before = Some((packet.timestamp, now_us));
            return;
        }
        if let Some((time, at)) = before {
            let step = packet.timestamp - time;
            if step < 0.0 {
                self.record.counts.stale += 1;
                return;
            }
            // Two at once would stop time altogether here; in the firmware the clock leaps (measured: 242 times).
            if step > 0.0 && step < LONGEST_STEP && now_us > at {
                self.speed = step * 1e6 / (now_us - at) as f64;
            }
        }
        self.before = Some((packet.timestamp, now_us));
        self.record.counts.samples += 1;
        let state::Repr { gyro: [p, q, r], accel, orientation, .. } = *packet;
        self.accel = accel.map(|force| count(-force / G * ACCEL_COUNTS));
        if self.build.gyro {
            let rates = [p, -q, self.build.yaw_sign() * r];
            self.gyro = rates.map(|rate| count(rate.to_degrees() * GYRO_COUNTS));
        }
        if self.build.estimates() {
            self.record.counts.foreign += u64::from(orientation != state::Repr::LEVEL.orientation);
        } else {
            let [w, x, y, z] = orientation;
            self.ahrs.set([w, x, -y, -z]);
        }
        self.record.history.push(Moment { t_us: now_us, said_us: None, attitude: self.ahrs.attitude() });
    }

    fn answer(&mut self, command: u16, out: &mut Vec<u8>) {
        let [major, minor] = self.build.version;
        let [w, x, y, z] = self.ahrs.attitude();
        let [roll, pitch, yaw] = to_euler([w, x, y, z]).map(f64::to_degrees);
        self.record.counts.answered += 1;
        let reply = match command {
            fc_variant::COMMAND => Message::FcVariant(fc_variant::Repr { name: fc_variant::BETAFLIGHT }),
            fc_version::COMMAND => Message::FcVersion(fc_version::Repr { major, minor, patch: 0 }),
            status::COMMAND => Message::Status(status::Repr { cycle_time: 1000, ..Default::default() }),
            raw_imu::COMMAND => {
                Message::RawImu(raw_imu::Repr { accel: self.accel, gyro: self.gyro, mag: [0; 3] })
            }
            attitude::COMMAND => {
                self.record.counts.told += 1;
                let [roll, pitch] = [roll, -pitch].map(|angle| (angle * 10.0) as i16);
                Message::Attitude(attitude::Repr { roll, pitch, yaw: yaw.rem_euclid(360.0) as i16 })
            }
            attitude_quaternion::COMMAND if self.build.estimates() => {
                self.record.counts.told += 1;
                let q = [w, x, -y, -z].map(|part| (part * attitude_quaternion::SCALE).round() as i16);
                Message::AttitudeQuaternion(attitude_quaternion::Repr { q })
            }
            _ => Message::Empty { direction: Direction::Refusal, command },
        };
        let mut bytes = [0; MAX_LEN];
        // MAX_LEN holds every message.
        let len = msp::encode(&reply, &mut bytes).unwrap_or(0);
        out.extend_from_slice(&bytes[..len]);
    }

    /// What its gyro reads, deg/s about forward, right and down.
    pub fn rate_dps(&self) -> [f64; 3] {
        frd(self.gyro.map(|counts| f64::from(counts) / GYRO_COUNTS_READ))
    }
}

impl Firmware for Betaflight {
    /// One datagram; of another length it is not taken (136 and 143 bytes were tried).
    fn receive(&mut self, bytes: &[u8], now_us: u64, out: &mut Vec<u8>) {
        self.run_until(now_us, out);
        self.record.counts.packets += 1;
        match state::Payload::new_checked(bytes) {
            Ok(payload) => self.sense(&state::Repr::parse(&payload), now_us),
            Err(_) => self.record.counts.damaged += 1,
        }
    }

    fn receive_apart(&mut self, bytes: &[u8], now_us: u64, out: &mut Vec<u8>) {
        self.run_until(now_us, out);
        let (msp, questions) = (self.build.msp, &mut self.questions);
        self.decoder.feed(bytes, |received| {
            if let Ok(Received { direction: Direction::Request, command, .. }) = received
                && msp
            {
                questions.push(command);
            }
        });
    }

    fn turn(&mut self, now_us: u64, out: &mut Vec<u8>) {
        self.run_until(now_us, out);
    }

    fn record(&self) -> &Record {
        &self.record
    }
}

/// The fraction is dropped, and what does not fit is clipped.
fn count(counts: f64) -> i16 {
    counts.clamp(-MAX_COUNT, MAX_COUNT) as i16
}

/// Forward, left, up as forward, right, down.
fn frd([x, y, z]: [f64; 3]) -> [f64; 3] {
    [x, -y, -z]
}
