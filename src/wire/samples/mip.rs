//! `mip`: inertial packets back to readings, a sample of each sensor in every packet, new or held. They say no time.

use super::{Counts, Sample, Source};
use crate::earth::STANDARD_GRAVITY;
use crate::geometry::Vector;
use crate::sensor::SensorKind;
use crate::wire::mavlink::MICROTESLA_A_GAUSS;
use glam::DVec3;
use ratetable_protocols::Error;
use ratetable_protocols::mip::{Decoder, imu};

#[derive(Default)]
pub(super) struct Reader(Decoder);

impl Reader {
    pub(super) fn feed(&mut self, bytes: &[u8], counts: &mut Counts, each: &mut impl FnMut(Sample)) {
        self.0.feed(bytes, |received| take(received, counts, each));
    }

    pub(super) fn finish(&mut self, counts: &mut Counts, each: &mut impl FnMut(Sample)) {
        self.0.finish(|received| {
            if !matches!(received, Err(Error::Malformed | Error::Checksum)) {
                take(received, counts, each);
            }
        });
    }
}

fn take(received: Result<imu::Repr, Error>, counts: &mut Counts, each: &mut impl FnMut(Sample)) {
    let seen = match received {
        Ok(seen) => seen,
        Err(Error::UnknownType(descriptor)) => {
            counts.packets += 1;
            return counts.foreign(&format!("descriptor {descriptor:02x}"));
        }
        Err(_) => return counts.refuse(),
    };
    counts.packets += 1;
    if [seen.gyro, seen.accel, seen.mag] == [None; 3] {
        return counts.foreign("pressure alone");
    }
    let mut sample = |kind, values: Option<[f32; 3]>, unit: f64| {
        let Some(values) = values else { return };
        let value = DVec3::from_array(values.map(f64::from)) * unit;
        let value = value.is_finite().then(|| Vector::from_vec(value));
        each(Sample { kind, source: Source::only("mip"), t: None, value });
    };
    sample(SensorKind::Gyro, seen.gyro, 1.0);
    sample(SensorKind::Accel, seen.accel, STANDARD_GRAVITY);
    sample(SensorKind::Mag, seen.mag, MICROTESLA_A_GAUSS);
}
