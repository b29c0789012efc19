//! `sbg`: sbgECom packets of an SBG Systems unit.
//!
//! IMU_SHORT goes out at each tick of the gyro (without one, of the first sensor) with the newest sample of gyro and
//! accelerometer, MAG at each tick of the magnetometer with the accelerometer's newest sample again, AIR_DATA at each
//! tick of the barometer, or ten times a second with the standard atmosphere's pressure at sea level where the scene has
//! none. QUAT tells an attitude 50 times a second: level, unless the output asks for the true one. Vectors are forward,
//! right, down. The stream ends with a vehicle that has stopped.

mod dialogue;
mod reader;

use super::latest::{in_units, pascals};
use super::newest::Told;
use super::row::{Row, Shared, any};
use super::wrap::next_step;
use super::{Claim, Encoder, MagUnit, Newest, Now, Packet, Setup, stopped};
use crate::motion::Truth;
use crate::sensor::{ByKind, Kinds, REFERENCE_TEMPERATURE, SensorKind};
use crate::time::{Rate, SimTime};
use ratetable_protocols::sbg::{self, HEADER_LEN, MAX_LEN, air_data, imu_short, mag, quat};

pub(super) static ROW: Row = Row {
    name: "sbg",
    about: "an SBG Systems unit (sbgECom) for ArduPilot: IMU_SHORT at the gyro's rate, MAG and AIR_DATA at their own",
    carries: Kinds::of(&[SensorKind::Gyro, SensorKind::Accel, SensorKind::Mag, SensorKind::Baro]),
    encoder: |setup| Box::new(Sbg::new(setup)),
    reader: |assumed| Box::new(reader::Reader::new(assumed.mag)),
    dialogue: |_| Some(Box::new(dialogue::Unit::default())),
    shared: |_, first| Some(Shared::at_ticks("IMU_SHORT", INERTIAL, first)),
    keys: &["attitude", "mag_unit", "thin"],
    check: any,
    greeting: |_| vec![0],
    is_numbered: false,
    inside: |len| (HEADER_LEN.min(len)..len, None),
};

/// What IMU_SHORT carries.
const INERTIAL: Kinds = Kinds::of(&[SensorKind::Gyro, SensorKind::Accel]);
/// QUAT packets a second.
const QUAT: Rate = Rate::hz(50);
/// AIR_DATA packets a second where the scene has no barometer.
const AIR: Rate = Rate::hz(10);
/// The standard deviation that QUAT claims of the true attitude, rad.
const UNCERTAINTY: f32 = 0.002;
/// QUAT's status of a solution whose attitude and heading hold.
const SOLVED: u32 = 0x32;
const MICROSECOND: i64 = 1000;

pub(super) struct Sbg {
    newest: Newest,
    /// At whose ticks IMU_SHORT goes out.
    carrier: Option<SensorKind>,
    kinds: Kinds,
    claim: Claim,
    unit: MagUnit,
    /// Which QUAT and which AIR_DATA of those that have a rate of their own is next.
    next_quat: u64,
    next_air: u64,
}

impl Sbg {
    pub(super) fn new(setup: &Setup<'_>) -> Sbg {
        let mut kinds = Kinds::NONE;
        setup.sensors.iter().for_each(|sensor| kinds.insert(sensor.kind));
        let inertial = [SensorKind::Gyro, SensorKind::Accel].into_iter().find(|kind| kinds.contains(*kind));
        Sbg {
            newest: Newest::new(&setup.options),
            carrier: inertial,
            kinds,
            claim: setup.options.claim,
            unit: setup.options.mag_unit(),
            next_quat: 0,
            next_air: 0,
        }
    }
}

impl Encoder for Sbg {
    fn encode(&mut self, now: &Now<'_>, out: &mut Vec<Packet>) {
        self.newest.take_in(now.readings);
        let ticks = |kind: SensorKind| now.readings.iter().any(|reading| reading.kind == kind);
        let told = self.newest.told;
        if self.carrier.is_some_and(ticks) {
            self.push(now.t, INERTIAL, &imu(now.t, &told), out);
        }
        if ticks(SensorKind::Mag) {
            self.push(now.t, SensorKind::Mag.into(), &field(now.t, &told, self.unit), out);
        }
        let own = !self.kinds.contains(SensorKind::Baro) && due(AIR, &mut self.next_air, now.t);
        if own || ticks(SensorKind::Baro) {
            self.push(now.t, SensorKind::Baro.into(), &air(now.t, &told), out);
        }
        if due(QUAT, &mut self.next_quat, now.t) {
            self.push(now.t, Kinds::NONE, &attitude(now.t, self.claim, now.truth), out);
        }
    }

    fn farewell(&mut self, end: &Truth, out: &mut Vec<Packet>) {
        if !SensorKind::ALL.into_iter().any(|kind| self.newest.told.has(kind)) {
            return;
        }
        let t = end.t;
        let mut still = self.newest.told;
        for (kind, value) in SensorKind::TRIADS.into_iter().zip(stopped(end)) {
            still.put(kind, self.kinds.contains(kind).then_some(value));
        }
        let told = next_step(t, MICROSECOND);
        if self.kinds.contains(SensorKind::Mag) {
            out.push(packet(t, Kinds::NONE, &field(told, &still, self.unit)));
        }
        out.push(packet(t, Kinds::NONE, &imu(told, &still)));
    }

    fn waiting(&self) -> ByKind<u64> {
        self.newest.waiting()
    }
}

impl Sbg {
    /// Appends a packet that carries the fresh samples among `kinds`.
    fn push(&mut self, t: SimTime, kinds: Kinds, said: &sbg::Packet, out: &mut Vec<Packet>) {
        // A packet of ours holds every one of the unit's.
        self.newest.append(out, t, kinds, |_, bytes| sbg::encode(said, bytes).unwrap_or(0));
    }
}

/// A packet that carries no sample.
fn packet(t: SimTime, kinds: Kinds, said: &sbg::Packet) -> Packet {
    let mut buffer = [0; MAX_LEN];
    let len = sbg::encode(said, &mut buffer).unwrap_or(0);
    Packet::new(t, kinds, &buffer[..len])
}

/// Whether one of a rate of its own is due at `t`, the first tick of any sensor at or after its time; counted once.
fn due(rate: Rate, next: &mut u64, t: SimTime) -> bool {
    let due = rate.tick(*next) <= t;
    if due {
        *next = rate.ticks_before(SimTime::ZERO, SimTime(t.0 + 1));
    }
    due
}

/// The unit's clock, which begins again with its 32 bits.
fn micros(t: SimTime) -> u32 {
    (t.0 / MICROSECOND) as u32
}

/// Gyro and accelerometer in counts, the gyro in larger ones where it is too fast for the others.
fn imu(t: SimTime, newest: &Told) -> sbg::Packet {
    let warm = [SensorKind::Gyro, SensorKind::Accel].into_iter().find_map(|kind| newest.temperature(kind));
    let counts = |kind: SensorKind, scale: f64| {
        let value = newest.body(kind).map_or([0.0; 3], |value| value.v.to_array());
        value.map(|value| (value * scale).round_ties_even())
    };
    let whole = |counts: [f64; 3]| counts.map(|count| count as i32);
    let fits = |counts: [f64; 3]| counts.iter().all(|count| count.abs() <= f64::from(i32::MAX));
    let gyro = counts(SensorKind::Gyro, imu_short::GYRO_SCALE);
    let (gyro, status) = match fits(gyro) {
        true => (gyro, imu_short::GOOD),
        false => {
            (counts(SensorKind::Gyro, imu_short::GYRO_SCALE_HIGH), imu_short::GOOD | imu_short::HIGH_RANGE)
        }
    };
    let warm = imu_short::TEMPERATURE_SCALE * warm.unwrap_or(REFERENCE_TEMPERATURE);
    sbg::Packet::ImuShort(imu_short::Repr {
        time_us: micros(t),
        status,
        accel: whole(counts(SensorKind::Accel, imu_short::ACCEL_SCALE)),
        gyro: whole(gyro),
        temperature: warm.round_ties_even() as i16,
    })
}

/// The magnetometer, and the accelerometer again: ArduPilot takes that for a sample of its own.
fn field(t: SimTime, newest: &Told, unit: MagUnit) -> sbg::Packet {
    sbg::Packet::Mag(mag::Repr {
        time_us: micros(t),
        status: mag::GOOD,
        field: in_units(newest.body(SensorKind::Mag), unit.microtesla()),
        accel: in_units(newest.body(SensorKind::Accel), 1.0),
    })
}

fn air(t: SimTime, newest: &Told) -> sbg::Packet {
    let warm = newest.temperature(SensorKind::Baro).unwrap_or(REFERENCE_TEMPERATURE);
    sbg::Packet::AirData(air_data::Repr {
        time_us: micros(t),
        status: air_data::HAS_PRESSURE | air_data::HAS_TEMPERATURE,
        pressure: pascals(newest) as f32,
        temperature: warm as f32,
        ..air_data::Repr::default()
    })
}

/// What is said of the attitude: of a false one also that there is no solution.
fn attitude(t: SimTime, claim: Claim, truth: &Truth) -> sbg::Packet {
    let q = truth.attitude.q;
    let (wxyz, status) = match claim {
        Claim::Level => ([1.0, 0.0, 0.0, 0.0], 0),
        Claim::Truth => ([q.w, q.x, q.y, q.z].map(|x| x as f32), SOLVED),
    };
    sbg::Packet::Quat(quat::Repr { time_us: micros(t), wxyz, uncertainty: [UNCERTAINTY; 3], status })
}

#[cfg(test)]
mod tests;
