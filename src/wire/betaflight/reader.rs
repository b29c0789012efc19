//! `betaflight`: the state back to readings as the firmware takes them (2026.6 and later): whole counts, a sample of
//! gyro and accel in every packet, new or held. Its time is no time of a sample.

use super::{ACCEL_COUNTS, GYRO_COUNTS, GYRO_COUNTS_READ, MAX_COUNT, Release};
use crate::earth::STANDARD_GRAVITY;
use crate::sensor::SensorKind;
use crate::wire::samples::{self, Carrier, Counts, Sample, Sensed, Source};
use ratetable_protocols::Error;
use ratetable_protocols::betaflight::{Decoder, state};

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

fn take(received: Result<state::Repr, Error>, counts: &mut Counts, each: &mut dyn FnMut(Sample)) {
    let Ok(seen) = received else { return counts.refuse() };
    counts.packets += 1;
    let mut sample = |kind, values: [f64; 3]| {
        let value = Sensed::triad(values, 1.0);
        each(Sample { kind, source: Source::only("betaflight"), t: None, value, packet: Carrier::default() });
    };
    let [p, q, r] = seen.gyro.map(rate);
    sample(SensorKind::Gyro, [p, q, Release::default().yaw_sign() * r]);
    let [x, y, z] = seen.accel.map(force);
    sample(SensorKind::Accel, [-x, y, z]);
}

/// What the firmware reads of an angular rate, rad/s.
fn rate(sent: f64) -> f64 {
    (count(sent.to_degrees() * GYRO_COUNTS) / GYRO_COUNTS_READ).to_radians()
}

/// What it reads of a specific force, m/s².
fn force(sent: f64) -> f64 {
    count(sent / STANDARD_GRAVITY * ACCEL_COUNTS) / ACCEL_COUNTS * STANDARD_GRAVITY
}

/// It drops the fraction of a count.
fn count(counts: f64) -> f64 {
    libm::trunc(counts).clamp(-MAX_COUNT, MAX_COUNT)
}
