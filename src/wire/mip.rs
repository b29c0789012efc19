//! `mip`: inertial packets of a MicroStrain unit, at each gyro tick.
//!
//! A packet has a field for each sensor in the scene, and always the pressure: the barometer's, or without one that
//! of the standard atmosphere at sea level. Axes are forward, right, down; the field is in gauss, specific force in
//! g. The stream ends with a vehicle that has stopped.

mod reader;

use super::latest::{CARRIED, Latest, in_units, pascals};
use super::mavlink::{MICROTESLA_A_GAUSS, PASCALS_A_HECTOPASCAL};
use super::newest::Told;
use super::row::{Row, Shared, any};
use super::{Encoder, Now, Packet, Setup, stopped};
use crate::earth::STANDARD_GRAVITY;
use crate::motion::Truth;
use crate::sensor::{ByKind, Kinds, SensorKind};
use ratetable_protocols::mip::{self, imu};

pub(super) static ROW: Row = Row {
    name: "mip",
    about: "a MicroStrain unit for ArduPilot: pressure, mag, accel and gyro at each gyro tick",
    carries: CARRIED,
    encoder: |setup| Box::new(Mip::new(setup)),
    reader: |_| Box::new(reader::Reader::default()),
    dialogue: |_| None,
    shared: |_, first| Some(Shared::at_ticks("a packet", CARRIED, first)),
    keys: &["thin"],
    check: any,
    greeting: |_| vec![0],
    is_numbered: false,
    // The length of a packet comes first: two sync bytes, the descriptor set and the length.
    inside: |len| (4.min(len)..len, None),
};

pub(super) struct Mip {
    latest: Latest,
    kinds: Vec<SensorKind>,
}

impl Mip {
    pub(super) fn new(setup: &Setup<'_>) -> Mip {
        let kinds = setup.sensors.iter().map(|sensor| sensor.kind).collect();
        Mip { latest: Latest::new(setup, |own| own), kinds }
    }
}

impl Encoder for Mip {
    fn encode(&mut self, now: &Now<'_>, out: &mut Vec<Packet>) {
        self.latest.encode(now.t, now.readings, out, |_, newest, buffer| write(newest, buffer));
    }

    fn farewell(&mut self, end: &Truth, out: &mut Vec<Packet>) {
        if !self.latest.has_begun() {
            return;
        }
        let mut still = *self.latest.newest();
        for (kind, value) in
            [SensorKind::Gyro, SensorKind::Accel, SensorKind::Mag].into_iter().zip(stopped(end))
        {
            still.put(kind, self.kinds.contains(&kind).then_some(value));
        }
        let mut buffer = [0; mip::MAX_LEN];
        let len = write(&still, &mut buffer);
        out.push(Packet::new(end.t, Kinds::NONE, &buffer[..len]));
    }

    fn waiting(&self) -> ByKind<u64> {
        self.latest.waiting()
    }
}

/// The packet of the newest readings.
fn write(newest: &Told, buffer: &mut [u8]) -> usize {
    let field = |kind: SensorKind, unit: f64| newest.body(kind).map(|value| in_units(Some(value), unit));
    let imu = imu::Repr {
        // A millibar is a hectopascal.
        pressure: Some((pascals(newest) / PASCALS_A_HECTOPASCAL) as f32),
        mag: field(SensorKind::Mag, MICROTESLA_A_GAUSS),
        accel: field(SensorKind::Accel, STANDARD_GRAVITY),
        gyro: field(SensorKind::Gyro, 1.0),
        time: None,
    };
    // MAX_LEN holds every packet.
    mip::encode(&imu, buffer).unwrap_or(0)
}
