//! `vectornav`: the two binary outputs that ArduPilot requests from a VN-100.
//!
//! IMU packets go out at the rate that the flight controller requested, else at the gyro's. AHRS packets with the
//! true attitude go out 50 times a second, at the first tick of any sensor at or after their time; ArduPilot's own
//! estimators do not use it. Axes are forward, right, down; the field is in gauss. The stream ends with a vehicle
//! that has stopped.

mod dialogue;
mod reader;

use super::latest::{CARRIED, Latest, in_units, pascals};
use super::mavlink::MICROTESLA_A_GAUSS;
use super::newest::Told;
use super::row::{Row, Shared, any};
use super::{Encoder, Now, Packet, Setup, stopped};
use crate::geometry::{Euler, Vector};
use crate::motion::Truth;
use crate::sensor::{ByKind, Kinds, REFERENCE_TEMPERATURE, SensorKind};
use crate::time::{Rate, SimTime};
use ratetable_protocols::vectornav::{self, MAX_LEN, ahrs, imu};

pub(super) static ROW: Row = Row {
    name: "vectornav",
    about: "a VN-100 for ArduPilot: IMU packets at the gyro's rate or that asked for, AHRS packets at 50 Hz",
    carries: CARRIED,
    encoder: |setup| Box::new(Vectornav::new(setup)),
    reader: |_| Box::new(reader::Reader::default()),
    dialogue: |controller| Some(Box::new(dialogue::Unit::new(controller))),
    shared: |_, first| Some(Shared::at_ticks("a packet", CARRIED, first)),
    keys: &["thin"],
    check: any,
    greeting: |_| b"\n".to_vec(),
    is_numbered: false,
    // The length of a packet comes first: the sync byte and up to five bytes of groups and fields.
    inside: |len| (6.min(len)..len, None),
};

/// AHRS packets a second.
const AHRS: Rate = Rate::hz(50);
/// The standard deviation that an AHRS packet claims, degrees.
const UNCERTAINTY: f32 = 0.1;
const PASCALS_A_KILOPASCAL: f64 = 1000.0;

pub(super) struct Vectornav {
    latest: Latest,
    /// The index of the next AHRS packet.
    next: u64,
    has_mag: bool,
}

impl Vectornav {
    pub(super) fn new(setup: &Setup<'_>) -> Vectornav {
        Vectornav {
            latest: Latest::new(setup, |own| setup.peer.rate.unwrap_or(own)),
            next: 0,
            has_mag: setup.sensors.iter().any(|sensor| sensor.kind == SensorKind::Mag),
        }
    }
}

impl Encoder for Vectornav {
    fn encode(&mut self, now: &Now<'_>, out: &mut Vec<Packet>) {
        let mut buffer = [0; MAX_LEN];
        self.latest.encode(now.t, now.readings, out, &mut buffer, write);
        if AHRS.tick(self.next) <= now.t {
            self.next = AHRS.ticks_before(SimTime::ZERO, SimTime(now.t.0 + 1));
            let len = encoded(&vectornav::Packet::Ahrs(attitude(now.truth)), &mut buffer);
            out.push(Packet::new(now.t, Kinds::NONE, &buffer[..len]));
        }
    }

    fn farewell(&mut self, end: &Truth, out: &mut Vec<Packet>) {
        if !self.latest.has_begun() {
            return;
        }
        let mut still = *self.latest.newest();
        for (kind, value) in
            [SensorKind::Gyro, SensorKind::Accel, SensorKind::Mag].into_iter().zip(stopped(end))
        {
            let value = if kind == SensorKind::Mag && !self.has_mag { Vector::ZERO } else { value };
            still.put(kind, Some(value));
        }
        let mut buffer = [0; MAX_LEN];
        let len = write(end.t, &still, &mut buffer);
        out.push(Packet::new(end.t, Kinds::NONE, &buffer[..len]));
    }

    fn waiting(&self) -> ByKind<u64> {
        self.latest.waiting()
    }
}

/// The IMU packet of the newest readings.
fn write(t: SimTime, newest: &Told, buffer: &mut [u8]) -> usize {
    let warm = [SensorKind::Gyro, SensorKind::Accel].into_iter().find_map(|kind| newest.temperature(kind));
    let warm = warm.unwrap_or(REFERENCE_TEMPERATURE);
    let [gyro, accel, mag] = SensorKind::TRIADS.map(|kind| newest.body(kind));
    let (gyro, accel) = (in_units(gyro, 1.0), in_units(accel, 1.0));
    let imu = imu::Repr {
        time_ns: t.0 as u64,
        gyro,
        accel,
        raw_accel: accel,
        raw_gyro: gyro,
        mag: in_units(mag, MICROTESLA_A_GAUSS),
        temperature: warm as f32,
        pressure: (pascals(newest) / PASCALS_A_KILOPASCAL) as f32,
    };
    encoded(&vectornav::Packet::Imu(imu), buffer)
}

/// The AHRS payload of the truth.
fn attitude(truth: &Truth) -> ahrs::Repr {
    let q = truth.attitude.q;
    let Euler { roll, pitch, yaw } = Euler::from_quat(q);
    ahrs::Repr {
        time_ns: truth.t.0 as u64,
        yaw_pitch_roll: [yaw, pitch, roll].map(|angle| angle.to_degrees() as f32),
        xyzw: [q.x, q.y, q.z, q.w].map(|x| x as f32),
        uncertainty: [UNCERTAINTY; 3],
    }
}

/// MAX_LEN holds every packet.
fn encoded(packet: &vectornav::Packet, buffer: &mut [u8]) -> usize {
    vectornav::encode(packet, buffer).unwrap_or(0)
}
