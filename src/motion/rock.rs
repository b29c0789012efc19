//! Rocking: a sinusoidal angular rate about one fixed axis, as on an oscillating rate table.
//!
//! `w(t) = n·A·sin(Wt + p)` about the unit axis n, so the angle turned is the integral `A/W·(cos p − cos(Wt + p)) =
//! 2A/W·sin(Wt/2 + p)·sin(Wt/2)` and `q(t) = q₀ ⊗ exp(n·angle)` (IEEE Std 1431-2004 calls the test an angular
//! oscillation). The phase is a hi + lo pair; the product of sines does not cancel.

use super::{Built, Context, Kinematics, Motion, MotionKind};
use crate::double::Double;
use crate::geometry::{Attitude, Body, Vector, exp};
use crate::keys::{KeyError, Name, Values};
use crate::quantity::{Kind, Sign};
use glam::DVec3;
use std::f64::consts::TAU;

const AXIS: Name<&str> = Name::new("axis");
const AMPLITUDE: Name<f64> = Name::new("amplitude");
const FREQUENCY: Name<Double> = Name::new("frequency");
const PHASE: Name<Double> = Name::new("phase");

pub(super) static KIND: MotionKind = MotionKind {
    name: "rock",
    about: "rocks back and forth: a sine of angular rate about one body axis",
    keys: &[
        AXIS.word(&["roll", "pitch", "yaw"], "the body axis to turn about: x, y or z"),
        AMPLITUDE.scalar(Kind::ANGULAR_RATE, "the largest angular rate"),
        FREQUENCY.scalar(Kind::FREQUENCY.signed(Sign::Positive), "full swings per second"),
        PHASE.scalar(Kind::ANGLE, "of the rate's sine at the start").or("0 deg"),
    ],
    has_length: false,
    build,
};

#[derive(Debug)]
struct Rock {
    axis: DVec3,
    /// rad/s.
    amplitude: f64,
    /// Full swings a second.
    turns: Double,
    /// Rad.
    phase: Double,
}

fn build(values: &Values, context: &Context) -> Built {
    let (Some(amplitude), Some(turns)) = (values.get(AMPLITUDE), values.get(FREQUENCY)) else {
        return Err(KeyError::new(
            "kind",
            "`rock` needs both `amplitude`, such as \"20 deg/s\", and `frequency`, such as \"0.5 Hz\"",
        ));
    };
    let axis = match values.get(AXIS) {
        Some("pitch") => DVec3::Y * context.axes.body_sign(),
        Some("yaw") => DVec3::Z * context.axes.body_sign(),
        _ => DVec3::X,
    };
    Ok(Box::new(Rock { axis, amplitude, turns, phase: values.get(PHASE).unwrap_or_default() }))
}

impl Rock {
    /// The angle turned since the start and its rate: rad and rad/s.
    fn swing(&self, t: Double) -> (f64, f64) {
        let half = self.turns * t * Double::PI;
        let (width, _) = half.sin_cos();
        let (middle, _) = (half + self.phase).sin_cos();
        let (sine, _) = (half + half + self.phase).sin_cos();
        let frequency = TAU * self.turns.to_f64();
        (2.0 * self.amplitude / frequency * middle * width, self.amplitude * sine)
    }
}

impl Motion for Rock {
    fn at(&self, start: Attitude, t: Double) -> Kinematics {
        let (angle, rate) = self.swing(t);
        Kinematics {
            attitude: start.turned(exp(self.axis * angle)),
            rate: Vector::<Body>::from_vec(self.axis * rate),
            acceleration: Vector::ZERO,
        }
    }

    fn fastest(&self) -> f64 {
        (TAU * self.turns.to_f64()).max(self.amplitude.abs())
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::rate_is_the_derivative_of_attitude;
    use super::*;
    use crate::time::{NANOS, SimTime};

    fn rock(axis: DVec3, speed: f64, hertz: f64, degrees: f64) -> Rock {
        let phase = Double::from(degrees) * Double::PI_OVER_180;
        Rock { axis, amplitude: speed, turns: Double::from(hertz), phase }
    }

    #[test]
    fn its_rate_is_the_derivative_of_its_attitude() {
        let start = Attitude::from_quat(exp(DVec3::new(0.3, -0.7, 1.1)));
        for (axis, speed, hertz, phase) in
            [(DVec3::X, 0.7, 0.5, 0.0), (-DVec3::Y, 3.0, 2.0, 90.0), (DVec3::Z, 30.0, 0.1, 200.0)]
        {
            let motion = rock(axis, speed, hertz, phase);
            rate_is_the_derivative_of_attitude(&motion, start, SimTime(2 * NANOS));
        }
    }

    #[test]
    fn it_swings_between_zero_and_twice_amplitude_over_frequency() {
        let motion = rock(DVec3::X, 2.0, 0.5, 0.0);
        let (angle, rate) = motion.swing(Double::from(1.0));
        assert!((angle - 4.0 / std::f64::consts::PI).abs() < 1e-15 && rate.abs() < 1e-15);
        assert_eq!(motion.swing(Double::ZERO), (0.0, 0.0));
    }

    #[test]
    fn a_day_later_it_is_where_it_began() {
        // 0.1 Hz as a decimal: 8640 swings.
        let turns = Double::from_decimal("0.1").unwrap_or_default();
        let motion = Rock { turns, ..rock(DVec3::Y, 1.0, 1.0, 37.0) };
        let (angle, rate) = motion.swing(Double::from(86_400.0));
        assert!(angle.abs() < 1e-13, "{angle}");
        assert!((rate - motion.swing(Double::ZERO).1).abs() < 1e-13, "{rate}");
    }
}
