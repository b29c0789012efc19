//! `mavlink`, versions 1 and 2: HIL_SENSOR, one sample for each sensor that it says is new.

use super::{Counts, Sample, Source};
use crate::geometry::Vector;
use crate::sensor::SensorKind;
use crate::time::SimTime;
use crate::wire::mavlink::{MASKS, MICROTESLA_A_GAUSS};
use ratetable_protocols::mavlink::{Decoder, Message, Received, hil_sensor};
use ratetable_protocols::{Error, Losses};
use std::collections::BTreeMap;

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
        counts.lost += u64::from(self.0.entry(sender).or_default().observe(header.seq));
        match message {
            Some(Message::HilSensor(seen)) => hil_sensor(sender, &seen, each),
            Some(other) => counts.foreign(other.name()),
            None => counts.foreign(&format!("message {id}")),
        }
    }
}

fn hil_sensor([system, component]: [u8; 2], seen: &hil_sensor::Repr, each: &mut impl FnMut(Sample)) {
    let t = i64::try_from(seen.time_usec).ok().and_then(|us| us.checked_mul(1000)).map(SimTime);
    let source = Source { message: "hil_sensor", set: [system, component, seen.id] };
    for (kind, values, unit) in [
        (SensorKind::Gyro, seen.gyro, 1.0),
        (SensorKind::Accel, seen.accel, 1.0),
        (SensorKind::Mag, seen.mag, MICROTESLA_A_GAUSS),
    ] {
        if seen.fields_updated & MASKS[kind as usize] != 0 {
            let [x, y, z] = values.map(|value| f64::from(value) * unit);
            let value = [x, y, z].iter().all(|value| value.is_finite()).then(|| Vector::new(x, y, z));
            each(Sample { kind, source, t, value });
        }
    }
}
