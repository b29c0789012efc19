//! `mip`: inertial packets to readings, a sample of each sensor in every packet, new or held. The time comes from
//! whichever field carries one; our packets carry none.

use crate::earth::STANDARD_GRAVITY;
use crate::sensor::SensorKind;
use crate::time::SimTime;
use crate::wire::mavlink::MICROTESLA_A_GAUSS;
use crate::wire::samples::{self, Carrier, Counts, Sample, Sensed, Source};
use ratetable_protocols::Error;
use ratetable_protocols::mip::{Decoder, imu};

#[derive(Default)]
pub(super) struct Reader {
    decoder: Decoder,
}

impl samples::Reader for Reader {
    fn feed(&mut self, bytes: &[u8], counts: &mut Counts, each: &mut dyn FnMut(Sample)) {
        let Reader { decoder } = self;
        decoder.feed(bytes, |received| take(received, counts, each));
    }

    fn finish(&mut self, counts: &mut Counts, each: &mut dyn FnMut(Sample)) {
        let Reader { decoder } = self;
        decoder.finish(|received| {
            if !matches!(received, Err(Error::Malformed | Error::Checksum)) {
                take(received, counts, each);
            }
        });
    }
}

/// When the packet's data were sampled.
fn time(time: Option<imu::Time>) -> Option<SimTime> {
    i64::try_from(time?.ns()?).ok().map(SimTime)
}

fn take(received: Result<imu::Repr, Error>, counts: &mut Counts, each: &mut dyn FnMut(Sample)) {
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
    let t = time(seen.time);
    let mut sample = |kind, values: Option<[f32; 3]>, unit: f64| {
        let Some(values) = values else { return };
        let value = Sensed::triad(values, unit);
        each(Sample { kind, source: Source::only("mip"), t, value, packet: Carrier::default() });
    };
    sample(SensorKind::Gyro, seen.gyro, 1.0);
    sample(SensorKind::Accel, seen.accel, STANDARD_GRAVITY);
    sample(SensorKind::Mag, seen.mag, MICROTESLA_A_GAUSS);
}
