//! `mavlink`, versions 1 and 2: HIL_SENSOR as simulators send it, HIGHRES_IMU, SCALED_IMU, SCALED_IMU2, SCALED_IMU3 and RAW_IMU as autopilots
//! send what their own sensors read; one sample for each sensor that a message says is new.

use super::{Counts, Sample, Source};
use crate::earth::STANDARD_GRAVITY;
use crate::geometry::Vector;
use crate::sensor::SensorKind;
use crate::time::SimTime;
use crate::wire::mavlink::{MICROTESLA_A_GAUSS, PASCALS_A_HECTOPASCAL};
use glam::DVec3;
use ratetable_protocols::mavlink::{
    Decoder, Header, MAX_LEN, Message, Received, Version, encode, heartbeat, highres_imu, hil_sensor,
    scaled_imu,
};
use ratetable_protocols::{Error, Losses};
use std::collections::BTreeMap;

/// The heartbeat of a ground station: MAV_TYPE_GCS, no autopilot, active.
pub(super) fn ground_station(seq: u8) -> Vec<u8> {
    let header = Header { version: Version::V2, seq, system: 255, component: 190 };
    let beat =
        heartbeat::Repr { kind: 6, autopilot: 8, system_status: 4, mavlink_version: 3, ..Default::default() };
    let mut buffer = [0; MAX_LEN];
    let len = encode(&header, &Message::Heartbeat(beat), &mut buffer).unwrap_or(0);
    buffer[..len].to_vec()
}

#[derive(Default)]
pub(super) struct Reader {
    decoder: Decoder,
    senders: Senders,
}

/// The sequence of each sender, by system and component: several may share a link.
#[derive(Default)]
struct Senders(BTreeMap<[u8; 2], Losses>);

impl Reader {
    pub(super) fn feed(&mut self, bytes: &[u8], counts: &mut Counts, each: &mut impl FnMut(Sample)) {
        let Reader { decoder, senders } = self;
        decoder.feed(bytes, |received| senders.take(received, counts, each));
    }

    pub(super) fn finish(&mut self, counts: &mut Counts, each: &mut impl FnMut(Sample)) {
        let Reader { decoder, senders } = self;
        decoder.finish(|received| {
            if received.is_ok() {
                senders.take(received, counts, each);
            }
        });
    }
}

impl Senders {
    fn take(
        &mut self,
        received: Result<Received, Error>,
        counts: &mut Counts,
        each: &mut impl FnMut(Sample),
    ) {
        let Ok(Received { header, id, message }) = received else { return counts.refuse() };
        counts.packets += 1;
        let sender = [header.system, header.component];
        counts.number(self.0.entry(sender).or_default(), header.seq);
        let name = message.map(|message| message.name());
        match message.and_then(|message| Inertial::of(&message, sender)) {
            Some(inertial) if inertial.is_fresh() => inertial.hand_on(each),
            _ => match name {
                Some(name) => counts.foreign(name),
                None => counts.foreign(&format!("message {id}")),
            },
        }
    }
}

/// The bits of gyro, accel, mag and baro in HIL_SENSOR; the temperature may be another sensor's.
const HIL_SENSOR: [u32; 4] =
    [hil_sensor::GYRO, hil_sensor::ACCEL, hil_sensor::MAG, hil_sensor::PRESSURE & !hil_sensor::TEMPERATURE];

/// What a message with readings says, of gyro, accel, mag and baro.
struct Inertial {
    source: Source,
    t: Option<SimTime>,
    /// Which are new.
    fresh: [bool; 4],
    /// In the message's own units.
    values: [[f64; 3]; 4],
    /// What those are in ours; `None` for counts.
    units: Option<[f64; 4]>,
}

impl Inertial {
    /// `None` for messages without readings.
    fn of(message: &Message, [system, component]: [u8; 2]) -> Option<Inertial> {
        let source = |set| Source { message: message.name(), set: [system, component, set] };
        let floating = [1.0, 1.0, MICROTESLA_A_GAUSS, PASCALS_A_HECTOPASCAL];
        let pressure = |hectopascals| [hectopascals, 0.0, 0.0];
        let (id, ns, fresh, values, units) = match message {
            Message::HilSensor(seen) => {
                let fresh = HIL_SENSOR.map(|mask| seen.fields_updated & mask != 0);
                (
                    seen.id,
                    micros(seen.time_usec),
                    fresh,
                    floats([seen.gyro, seen.accel, seen.mag, pressure(seen.abs_pressure)]),
                    Some(floating),
                )
            }
            Message::HighresImu(seen) => {
                let masks =
                    [highres_imu::GYRO, highres_imu::ACCEL, highres_imu::MAG, highres_imu::ABS_PRESSURE];
                let fresh = masks.map(|mask| seen.fields_updated & mask != 0);
                (
                    seen.id,
                    micros(seen.time_usec),
                    fresh,
                    floats([seen.gyro, seen.accel, seen.mag, pressure(seen.abs_pressure)]),
                    Some(floating),
                )
            }
            Message::ScaledImu(seen) | Message::ScaledImu2(seen) | Message::ScaledImu3(seen) => {
                let scaled_imu::Repr { time_boot_ms, accel, gyro, mag, .. } = seen;
                let milli = [1e-3, 1e-3 * STANDARD_GRAVITY, 1e-3 * MICROTESLA_A_GAUSS, 0.0];
                let ns = Some(i64::from(*time_boot_ms) * 1_000_000);
                (0, ns, present(*mag), ints([*gyro, *accel, *mag]), Some(milli))
            }
            Message::RawImu(seen) => {
                let ns = micros(seen.time_usec);
                (seen.id, ns, present(seen.mag), ints([seen.gyro, seen.accel, seen.mag]), None)
            }
            _ => return None,
        };
        Some(Inertial { source: source(id), t: ns.map(SimTime), fresh, values, units })
    }

    fn is_fresh(&self) -> bool {
        self.fresh.contains(&true)
    }

    fn hand_on(&self, each: &mut impl FnMut(Sample)) {
        let Inertial { source, t, fresh, values, units } = *self;
        let fresh = SensorKind::ALL.into_iter().zip(fresh).filter(|(_, fresh)| *fresh);
        for (kind, _) in fresh {
            let vector = |units: [f64; 4]| DVec3::from_array(values[kind as usize]) * units[kind as usize];
            let value = units.map(vector).filter(|value| value.is_finite()).map(Vector::from_vec);
            each(Sample { kind, source, t, value });
        }
    }
}

/// µs in ns, where that can be said.
fn micros(us: u64) -> Option<i64> {
    i64::try_from(us).ok()?.checked_mul(1000)
}

/// A message without a mask has gyro and accel; a field of exactly nothing is a magnetometer that is not there.
fn present(mag: [i16; 3]) -> [bool; 4] {
    [true, true, mag != [0; 3], false]
}

fn floats(values: [[f32; 3]; 4]) -> [[f64; 3]; 4] {
    values.map(|vector| vector.map(f64::from))
}

fn ints([gyro, accel, mag]: [[i16; 3]; 3]) -> [[f64; 3]; 4] {
    [gyro, accel, mag, [0; 3]].map(|vector| vector.map(f64::from))
}
