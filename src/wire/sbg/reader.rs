//! `sbg`: packets back to readings. The accelerometer is read from IMU_SHORT alone: MAG says it a second time. The
//! 32 bits of microseconds go on counting here where they begin again.

use super::MICROSECOND;
use crate::sensor::SensorKind;
use crate::time::SimTime;
use crate::wire::MagUnit;
use crate::wire::samples::{self, Carrier, Counts, Sample, Sensed, Source};
use crate::wire::wrap::{MICROS_32, unwrapped};
use ratetable_protocols::Error;
use ratetable_protocols::sbg::{Decoder, Packet, Received, air_data, imu_short};

pub(super) struct Reader {
    decoder: Decoder,
    newest: Option<SimTime>,
    unit: MagUnit,
}

impl Reader {
    /// Of a stream whose field is told in this unit.
    pub(super) fn new(unit: MagUnit) -> Reader {
        Reader { decoder: Decoder::new(), newest: None, unit }
    }
}

impl samples::Reader for Reader {
    fn feed(&mut self, bytes: &[u8], counts: &mut Counts, each: &mut dyn FnMut(Sample)) {
        let Reader { decoder, newest, unit } = self;
        decoder.feed(bytes, |received| take(received, newest, *unit, counts, each));
    }

    fn finish(&mut self, counts: &mut Counts, each: &mut dyn FnMut(Sample)) {
        let Reader { decoder, newest, unit } = self;
        decoder.finish(|received| {
            if received.is_ok() {
                take(received, newest, *unit, counts, each);
            }
        });
    }
}

fn take(
    received: Result<Received, Error>,
    newest: &mut Option<SimTime>,
    unit: MagUnit,
    counts: &mut Counts,
    each: &mut dyn FnMut(Sample),
) {
    let Ok(Received { class, id, packet }) = received else { return counts.refuse() };
    counts.packets += 1;
    let mut time = |us: u32| {
        let since = i64::from(us) * MICROSECOND;
        let t = newest.map_or(SimTime(since), |newest| unwrapped(since, MICROS_32, newest));
        *newest = Some(t);
        t
    };
    let mut sample = |kind, t: SimTime, value: Option<Sensed>| {
        each(Sample { kind, source: Source::only("sbg"), t: Some(t), value, packet: Carrier::default() });
    };
    match packet {
        Some(Packet::ImuShort(seen)) => {
            let t = time(seen.time_us);
            let gyro = seen.gyro.map(|count| f64::from(count) / seen.gyro_scale());
            let accel = seen.accel.map(|count| f64::from(count) / imu_short::ACCEL_SCALE);
            sample(SensorKind::Gyro, t, Sensed::triad(gyro, 1.0));
            sample(SensorKind::Accel, t, Sensed::triad(accel, 1.0));
        }
        Some(Packet::Mag(seen)) => {
            let value = Sensed::triad(seen.field, unit.microtesla());
            sample(SensorKind::Mag, time(seen.time_us), value);
        }
        Some(Packet::AirData(seen)) if seen.status & air_data::HAS_PRESSURE != 0 => {
            let value = Sensed::Pressure(f64::from(seen.pressure)).known();
            sample(SensorKind::Baro, time(seen.time_us), value);
        }
        Some(Packet::AirData(_)) => counts.foreign("air_data without pressure"),
        Some(Packet::Quat(_)) => counts.foreign("quat"),
        Some(Packet::Info(_)) => counts.foreign("info"),
        Some(Packet::InfoRequest) => counts.foreign("info request"),
        None => counts.foreign(&format!("class {class} id {id}")),
    }
}
