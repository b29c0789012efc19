//! The two packets that PX4 asks for: gyro and accelerometer, and everything else beside them.

use super::{kilopascals, temperature};
use crate::earth::STANDARD_GRAVITY;
use crate::geometry::{Nav, Vector};
use crate::motion::Truth;
use crate::sensor::{Kinds, SensorKind};
use crate::time::{Rate, SimTime};
use crate::wire::latest::in_units;
use crate::wire::mavlink::MICROTESLA_A_GAUSS;
use crate::wire::newest::Told;
use ratetable_protocols::vectornav::{Packet, inertial, navigation};

/// What an inertial packet carries, and what a navigation packet does.
pub(super) const INERTIAL: Kinds = Kinds::of(&[SensorKind::Gyro, SensorKind::Accel]);
pub(super) const NAVIGATION: Kinds = Kinds::of(&[SensorKind::Mag, SensorKind::Baro]);
/// Navigation packets a second where nobody asked for a number.
pub(super) const USUAL: Rate = Rate::hz(100);

/// The inertial packet of the newest readings.
pub(super) fn readings(t: SimTime, newest: &Told) -> Packet {
    let [gyro, accel] = [SensorKind::Gyro, SensorKind::Accel].map(|kind| in_units(newest.body(kind), 1.0));
    Packet::Inertial(inertial::Repr { time_ns: t.0 as u64, accel, gyro })
}

/// The navigation packet of the newest readings and the truth. Its status says that no position is tracked, so PX4
/// publishes none: position, velocity and their uncertainties are zero.
pub(super) fn rest(t: SimTime, newest: &Told, truth: &Truth) -> Packet {
    let q = truth.attitude.q;
    let weight: Vector<Nav> = Vector::new(0.0, 0.0, STANDARD_GRAVITY);
    let acceleration = truth.attitude.apply(truth.force) + weight;
    Packet::Navigation(navigation::Repr {
        time_ns: t.0 as u64,
        temperature: temperature(newest),
        pressure: kilopascals(newest),
        mag: in_units(newest.body(SensorKind::Mag), MICROTESLA_A_GAUSS),
        xyzw: [q.x, q.y, q.z, q.w].map(|x| x as f32),
        acceleration: acceleration.v.to_array().map(|x| x as f32),
        ..navigation::Repr::default()
    })
}
