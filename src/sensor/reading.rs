//! What a sensor says at a tick, typed by what it is: three body axes, a pressure, or a position.

use super::{REFERENCE_TEMPERATURE, SensorKind, Shape};
use crate::earth::Place;
use crate::geometry::{Body, Nav, Vector};

/// One sensor's output at one of its ticks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// Which of the plan's sensors.
    pub sensor: usize,
    /// What is sensed.
    pub kind: SensorKind,
    /// Which tick of that sensor.
    pub k: u64,
    /// What it says, and what it would say without errors; its variant is that of the kind's [`Shape`].
    pub measurement: Measurement,
    /// Whether the value left the range.
    pub clipped: bool,
    /// The part's temperature, °C.
    pub temperature: f64,
}

/// A quantity as a sensor measures it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Measurement {
    /// Of a gyroscope (rad/s), an accelerometer (m/s²) or a magnetometer (µT), in body axes (Forward-Right-Down).
    Triad(Measured<Vector<Body>>),
    /// Of a barometer or a pitot tube, Pa.
    Pressure(Measured<f64>),
    /// Of a GPS receiver.
    Position(Position),
}

/// A quantity with its errors and without.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Measured<T> {
    /// What the part reads.
    pub value: T,
    /// The error-free reading.
    pub truth: T,
    /// The bias in effect.
    pub bias: T,
}

/// A receiver's reading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Position {
    /// From the start, m along nav axes (North-East-Down).
    pub displacement: Measured<Vector<Nav>>,
    /// As read.
    pub fix: Fix,
    /// Without errors.
    pub true_fix: Fix,
}

/// Where, and how fast.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fix {
    /// WGS 84.
    pub position: Place,
    /// Over the ground, m/s along nav axes (North-East-Down).
    pub velocity: Vector<Nav>,
}

impl Reading {
    /// A reading of zero, where only its being there matters.
    pub fn zero(sensor: usize, kind: SensorKind) -> Reading {
        let measurement = match kind.shape() {
            Shape::Triad => Measurement::Triad(Measured::default()),
            Shape::Pressure => Measurement::Pressure(Measured::default()),
            Shape::Position => {
                let position = Place { latitude: 0.0, longitude: 0.0, altitude: 0.0 };
                let fix = Fix { position, velocity: Vector::ZERO };
                Measurement::Position(Position { displacement: Measured::default(), fix, true_fix: fix })
            }
        };
        Reading { sensor, kind, k: 0, measurement, clipped: false, temperature: REFERENCE_TEMPERATURE }
    }

    /// This reading with other body axes; unchanged where it has none.
    pub fn with_body(mut self, value: Vector<Body>) -> Reading {
        if let Measurement::Triad(triad) = &mut self.measurement {
            triad.value = value;
        }
        self
    }

    /// Body axes, of a gyroscope, an accelerometer or a magnetometer.
    pub const fn body(&self) -> Option<&Measured<Vector<Body>>> {
        match &self.measurement {
            Measurement::Triad(triad) => Some(triad),
            _ => None,
        }
    }

    /// Pa, of a barometer or a pitot tube.
    pub const fn pressure(&self) -> Option<&Measured<f64>> {
        match &self.measurement {
            Measurement::Pressure(pressure) => Some(pressure),
            _ => None,
        }
    }

    /// Where and how fast, of a GPS receiver.
    pub const fn position(&self) -> Option<&Position> {
        match &self.measurement {
            Measurement::Position(position) => Some(position),
            _ => None,
        }
    }
}
