//! `ilabs`: frames back to readings, a sample of each sensor in every frame, new or held. A frame tells whole
//! milliseconds of a week, which go on counting here where they begin again.

use super::{ACCEL, GYRO, MAG, MILLISECOND};
use crate::sensor::SensorKind;
use crate::time::SimTime;
use crate::wire::samples::{self, Carrier, Counts, Sample, Sensed, Source};
use crate::wire::wrap::{WEEK, unwrapped};
use ratetable_protocols::Error;
use ratetable_protocols::ilabs::{Decoder, data::Repr};

#[derive(Default)]
pub(super) struct Reader {
    decoder: Decoder,
    newest: Option<SimTime>,
}

impl samples::Reader for Reader {
    fn feed(&mut self, bytes: &[u8], counts: &mut Counts, each: &mut dyn FnMut(Sample)) {
        let Reader { decoder, newest } = self;
        decoder.feed(bytes, |received| take(received, newest, counts, each));
    }

    fn finish(&mut self, counts: &mut Counts, each: &mut dyn FnMut(Sample)) {
        let Reader { decoder, newest } = self;
        decoder.finish(|received| {
            if !matches!(received, Err(Error::Malformed | Error::Checksum)) {
                take(received, newest, counts, each);
            }
        });
    }
}

fn take(
    received: Result<Repr, Error>,
    newest: &mut Option<SimTime>,
    counts: &mut Counts,
    each: &mut dyn FnMut(Sample),
) {
    let told = match received {
        Ok(told) => told,
        // The sum of such a frame is right, and every driver drops it.
        Err(Error::UnknownType(id)) => {
            counts.packets += 1;
            return counts.foreign(&format!("frame with id {id:02x}"));
        }
        Err(Error::Length { .. }) => {
            counts.packets += 1;
            return counts.foreign("frame of another length than its ids");
        }
        Err(_) => return counts.refuse(),
    };
    counts.packets += 1;
    if (told.gyro, told.accel, told.mag) == (None, None, None) {
        return counts.foreign("frame without readings");
    }
    let t = told.time_ms.map(|ms| time(ms, *newest));
    *newest = t.or(*newest);
    let mut sample = |kind, counts: Option<[f64; 3]>, unit: f64| {
        let Some([right, forward, up]) = counts else { return };
        let value = Sensed::triad([forward, right, -up], unit);
        each(Sample { kind, source: Source::only("ilabs"), t, value, packet: Carrier::default() });
    };
    sample(SensorKind::Gyro, told.gyro.map(|counts| counts.map(f64::from)), GYRO);
    sample(SensorKind::Accel, told.accel.map(|counts| counts.map(f64::from)), ACCEL);
    sample(SensorKind::Mag, told.mag.map(|counts| counts.map(f64::from)), MAG);
}

/// Milliseconds of a week as a time, near the newest one.
fn time(ms: u32, newest: Option<SimTime>) -> SimTime {
    let of_week = i64::from(ms) * MILLISECOND;
    newest.map_or(SimTime(of_week), |newest| unwrapped(of_week, WEEK, newest))
}
