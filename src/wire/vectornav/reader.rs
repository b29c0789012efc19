//! `vectornav`: IMU packets to readings, a sample of each sensor in every packet, new or held.

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
    let Packet::Imu(seen) = packet else { return counts.foreign(packet.name()) };
    let t = i64::try_from(seen.time_ns).ok().map(SimTime);
    let mut sample = |kind, values: [f32; 3], unit: f64| {
        let value = Sensed::triad(values, unit);
        each(Sample { kind, source: Source::only("vectornav"), t, value, packet: Carrier::default() });
    };
    sample(SensorKind::Gyro, seen.gyro, 1.0);
    sample(SensorKind::Accel, seen.accel, 1.0);
    // A field of exactly zero means that there is no magnetometer.
    if seen.mag != [0.0; 3] {
        sample(SensorKind::Mag, seen.mag, MICROTESLA_A_GAUSS);
    }
}
