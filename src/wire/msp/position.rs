//! The satellite receiver's part of a simulator message.

use crate::geometry::Vector;
use crate::sensor::{Claims, Fix, SensorKind, SensorPlan};
use ratetable_protocols::msp::simulator;

/// A fix in space: INAV counts none, in the plane, in space from 0.
const IN_SPACE: u8 = 2;

/// The newest fix of the scene's receiver.
#[derive(Debug, Default)]
pub(super) struct Position {
    satellites: u8,
    fix: Option<Fix>,
    /// Whether no message has said it yet.
    is_new: bool,
}

impl Position {
    /// Of a receiver that has no fix yet.
    pub fn new(sensors: &[SensorPlan]) -> Position {
        let receiver = sensors.iter().find(|sensor| sensor.kind == SensorKind::Gps);
        let satellites = receiver.map_or(0, |receiver| Claims::of(&receiver.values).satellites);
        Position { satellites, ..Position::default() }
    }

    /// Takes a fix in, if there is one.
    pub fn take_in(&mut self, fix: Option<Fix>) {
        self.is_new |= fix.is_some();
        self.fix = fix.or(self.fix);
    }

    /// The vehicle stands where it is, which is news.
    pub fn stop(&mut self) {
        if let Some(fix) = &mut self.fix {
            fix.velocity = Vector::ZERO;
            self.is_new = true;
        }
    }

    /// Says it in a message: of a receiver without a fix nothing.
    pub fn put_into(&mut self, message: &mut simulator::Repr) {
        let Some(Fix { position, velocity }) = self.fix else { return };
        if std::mem::take(&mut self.is_new) {
            message.flags |= simulator::NEW_POSITION;
        }
        let [north, east, down] = velocity.v.to_array();
        let course = libm::atan2(east, north).to_degrees().rem_euclid(360.0);
        message.fix = IN_SPACE;
        message.satellites = self.satellites;
        message.latitude = whole(position.latitude.to_degrees() * 1e7) as i32;
        message.longitude = whole(position.longitude.to_degrees() * 1e7) as i32;
        message.altitude = whole(position.altitude * 100.0) as i32;
        message.ground_speed = whole(libm::hypot(north, east) * 100.0) as u16;
        // 359.96° is 0°.
        message.course = whole(course * 10.0) as u16 % 3600;
        message.velocity = [north, east, down].map(|speed| whole(speed * 100.0) as i16);
    }
}

/// The nearest whole number, halves away from zero; what does not fit is clipped as it is converted.
fn whole(x: f64) -> f64 {
    libm::round(x)
}
