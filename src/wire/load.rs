//! What a protocol needs of a link.

use super::{Now, Protocol, Setup, at_rest, encoder};
use crate::earth::Place;
use crate::geometry::Vector;
use crate::schedule::{Schedule, Ticks};
use crate::sensor::{Fix, Measured, Measurement, Position, Reading, Shape};
use crate::time::{NANOS, SimTime};

/// Bytes and packets a second, measured by encoding ten seconds of the scene's own ticks. Text is as long as its
/// numbers; these have as many digits as noise has.
pub fn load(protocol: Protocol, setup: &Setup<'_>) -> (f64, f64) {
    const DIGITS: f64 = -0.012_345_678_901_234_568;
    let value = Vector::new(DIGITS, DIGITS, DIGITS);
    let position = Place { latitude: DIGITS, longitude: DIGITS, altitude: DIGITS };
    let velocity = Vector::new(DIGITS, DIGITS, DIGITS);
    let fix = Fix { position, velocity };
    let seconds = 10;
    let ticks = setup.sensors.iter().map(|sensor| Ticks { rate: sensor.clock(), phase: sensor.phase });
    let mut encoder = encoder(protocol, setup);
    let (mut packets, mut bytes, mut count) = (Vec::new(), 0, 0);
    let mut readings = Vec::new();
    for due in Schedule::new(ticks, SimTime(seconds * NANOS)) {
        readings.clear();
        let sensors = setup.sensors.iter().enumerate().filter(|(i, _)| due.sensors >> i & 1 == 1);
        readings.extend(sensors.map(|(i, plan)| Reading {
            measurement: match plan.kind.shape() {
                Shape::Triad => Measurement::Triad(Measured { value, ..Measured::default() }),
                Shape::Pressure => Measurement::Pressure(Measured { value: DIGITS, ..Measured::default() }),
                Shape::Position => {
                    Measurement::Position(Position { displacement: Measured::default(), fix, true_fix: fix })
                }
            },
            ..Reading::zero(i, plan.kind)
        }));
        packets.clear();
        encoder.encode(&Now { t: due.t, truth: &at_rest(due.t), readings: &readings }, &mut packets);
        count += packets.len();
        bytes += packets.iter().map(|packet| packet.bytes().len()).sum::<usize>();
    }
    (bytes as f64 / seconds as f64, count as f64 / seconds as f64)
}
