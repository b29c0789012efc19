//! The two packets that ArduPilot asks for: all readings, and the true attitude beside them.

use super::{kilopascals, temperature};
use crate::geometry::Euler;
use crate::motion::Truth;
use crate::sensor::SensorKind;
use crate::time::{Rate, SimTime};
use crate::wire::latest::in_units;
use crate::wire::mavlink::MICROTESLA_A_GAUSS;
use crate::wire::newest::Told;
use ratetable_protocols::vectornav::{Packet, ahrs, imu};

/// AHRS packets a second where nobody asked for a number.
pub(super) const AHRS: Rate = Rate::hz(50);
/// The standard deviation that an AHRS packet claims, degrees.
const UNCERTAINTY: f32 = 0.1;

/// The IMU packet of the newest readings.
pub(super) fn readings(t: SimTime, newest: &Told) -> Packet {
    let [gyro, accel, mag] = SensorKind::TRIADS.map(|kind| newest.body(kind));
    let (gyro, accel) = (in_units(gyro, 1.0), in_units(accel, 1.0));
    Packet::Imu(imu::Repr {
        time_ns: t.0 as u64,
        gyro,
        accel,
        raw_accel: accel,
        raw_gyro: gyro,
        mag: in_units(mag, MICROTESLA_A_GAUSS),
        temperature: temperature(newest),
        pressure: kilopascals(newest),
    })
}

/// The AHRS packet of the truth.
pub(super) fn attitude(truth: &Truth) -> Packet {
    let q = truth.attitude.q;
    let Euler { roll, pitch, yaw } = Euler::from_quat(q);
    Packet::Ahrs(ahrs::Repr {
        time_ns: truth.t.0 as u64,
        yaw_pitch_roll: [yaw, pitch, roll].map(|angle| angle.to_degrees() as f32),
        xyzw: [q.x, q.y, q.z, q.w].map(|x| x as f32),
        uncertainty: [UNCERTAINTY; 3],
    })
}
