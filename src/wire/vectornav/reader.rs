//! `vectornav`: packets back to readings, a sample of each sensor that a packet carries, new or held.

use crate::sensor::SensorKind;
use crate::time::SimTime;
use crate::wire::mavlink::MICROTESLA_A_GAUSS;
use crate::wire::samples::{self, Carrier, Counts, Sample, Sensed, Source};
use ratetable_protocols::Error;
use ratetable_protocols::vectornav::{Decoder, Packet};

#[derive(Default)]
pub(super) struct Reader(Decoder);

impl samples::Reader for Reader {
    fn feed(&mut self, bytes: &[u8], counts: &mut Counts, each: &mut dyn FnMut(Sample)) {
        self.0.feed(bytes, |received| take(received, counts, each));
    }

    fn finish(&mut self, counts: &mut Counts, each: &mut dyn FnMut(Sample)) {
        self.0.finish(|received| {
            if received.is_ok() {
                take(received, counts, each);
            }
        });
    }
}

fn take(received: Result<Packet, Error>, counts: &mut Counts, each: &mut dyn FnMut(Sample)) {
    let Ok(packet) = received else { return counts.refuse() };
    counts.packets += 1;
    let (time_ns, [gyro, accel, mag]) = match packet {
        Packet::Imu(seen) => (seen.time_ns, [Some(seen.gyro), Some(seen.accel), Some(seen.mag)]),
        Packet::Inertial(seen) => (seen.time_ns, [Some(seen.gyro), Some(seen.accel), None]),
        Packet::Navigation(seen) => (seen.time_ns, [None, None, Some(seen.mag)]),
        Packet::Ahrs(_) | Packet::Line(_) => return counts.foreign(packet.name()),
    };
    let t = i64::try_from(time_ns).ok().map(SimTime);
    let mut sample = |kind, values: Option<[f32; 3]>, unit: f64| {
        let Some(values) = values else { return };
        let value = Sensed::triad(values, unit);
        each(Sample { kind, source: Source::only("vectornav"), t, value, packet: Carrier::default() });
    };
    sample(SensorKind::Gyro, gyro, 1.0);
    sample(SensorKind::Accel, accel, 1.0);
    // A field of exactly nothing is a magnetometer that is not there.
    sample(SensorKind::Mag, mag.filter(|&mag| mag != [0.0; 3]), MICROTESLA_A_GAUSS);
}
