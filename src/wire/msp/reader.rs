//! `msp`: the simulator message back to readings, a sample of each sensor in every packet, new or held. It says no
//! time, and of the field only the direction, so that one has no value; nor has a fix, which is a sample where it is new.

use crate::earth::STANDARD_GRAVITY;
use crate::geometry::{Body, Vector};
use crate::sensor::SensorKind;
use crate::wire::msp::{ACCEL_SCALE, GYRO_SCALE, airspeed};
use crate::wire::samples::{self, Carrier, Counts, Sample, Sensed, Source};
use ratetable_protocols::Error;
use ratetable_protocols::msp::{
    Decoder, Direction, MAX_LEN, Message, Received, api_version, encode, simulator,
};

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

fn take(received: Result<Received, Error>, counts: &mut Counts, each: &mut dyn FnMut(Sample)) {
    let Ok(Received { direction, command, message }) = received else { return counts.refuse() };
    counts.packets += 1;
    let (seen, pitot) = match message {
        Some(Message::Simulator(seen)) => (seen, None),
        Some(Message::SimulatorAir(seen)) => (seen.readings, Some(airspeed::pressure(&seen))),
        _ => {
            let way = match direction {
                Direction::Request => "request",
                Direction::Reply => "reply",
                Direction::Refusal => "refusal",
            };
            return counts.foreign(&format!("{way} {command}"));
        }
    };
    let mut sample = |kind, value: Option<Sensed>| {
        each(Sample { kind, source: Source::only("msp"), t: None, value, packet: Carrier::default() })
    };
    sample(SensorKind::Gyro, Some(Sensed::Body(body(seen.gyro, 1f64.to_radians() / GYRO_SCALE))));
    sample(SensorKind::Accel, Some(Sensed::Body(body(seen.accel, STANDARD_GRAVITY / ACCEL_SCALE))));
    // A field of exactly nothing is a magnetometer that is not there.
    if seen.mag != simulator::Repr::default().mag {
        sample(SensorKind::Mag, None);
    }
    if seen.flags & simulator::NEW_POSITION != 0 {
        sample(SensorKind::Gps, None);
    }
    if let Some(pressure) = pitot {
        sample(SensorKind::Airspeed, Some(Sensed::Pressure(pressure)));
    }
}

/// From counts forward, left and up.
fn body([x, y, z]: [i16; 3], unit: f64) -> Vector<Body> {
    let [x, y, z] = [x, y, z].map(|count| f64::from(count) * unit);
    Vector::new(x, -y, -z)
}

/// The request for the identity.
pub(super) fn question() -> Vec<u8> {
    let mut buffer = [0; MAX_LEN];
    let len = encode(&Message::question(api_version::COMMAND), &mut buffer).unwrap_or(0);
    buffer[..len].to_vec()
}
