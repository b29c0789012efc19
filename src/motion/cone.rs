//! Coning: the body's x axis moves round a cone while the body does not spin about it on average.
//!
//! `q(t) = q₀ ⊗ c(0)* ⊗ c(t)` with `c(t) = [cos(a/2), 0, sin(a/2)·cos Wt, sin(a/2)·sin Wt]`, half-angle a and cone
//! frequency W; `w(t) = [−2W·sin²(a/2), −W·sin a·sin Wt, W·sin a·cos Wt]` (Bortz 1971; Miller 1983). It is the
//! classical worst case of an attitude method: the mean of w is not zero although the attitude returns.

use super::{Kinematics, Motion, MotionKind};
use crate::double::Double;
use crate::geometry::{Attitude, Vector};
use crate::keys::{KeyError, Name};
use crate::quantity::{Kind, Sign};
use glam::DQuat;
use std::f64::consts::TAU;

const HALF_ANGLE: Name<Double> = Name::new("half_angle");
const FREQUENCY: Name<Double> = Name::new("frequency");

pub(super) static KIND: MotionKind = MotionKind {
    name: "cone",
    about: "coning: the x axis moves around a cone with a half-angle at a frequency",
    keys: &[
        HALF_ANGLE.scalar(Kind::ANGLE, "of the cone"),
        FREQUENCY.scalar(Kind::FREQUENCY.signed(Sign::NonNegative), "turns around the cone per second"),
    ],
    has_length: false,
    build: |values, context| {
        let (Some(half_angle), Some(frequency)) = (values.get(HALF_ANGLE), values.get(FREQUENCY)) else {
            return Err(KeyError::new(
                "kind",
                "`cone` needs both `half_angle`, such as \"5 deg\", and `frequency`, such as \"2 Hz\"",
            ));
        };
        Ok(Box::new(Cone::new(half_angle, frequency, context.axes.body_sign())))
    },
};

#[derive(Debug)]
pub(super) struct Cone {
    /// Sine and cosine of half the half-angle.
    half: (f64, f64),
    sin_angle: f64,
    /// Turns a second.
    turns: Double,
    /// rad/s.
    frequency: f64,
    /// The sign of the scene's y and z in our axes.
    sign: f64,
    warnings: Vec<String>,
}

impl Cone {
    pub(super) fn new(half_angle: Double, frequency: Double, sign: f64) -> Cone {
        Cone {
            half: (half_angle / Double::from(2.0)).sin_cos(),
            sin_angle: half_angle.sin_cos().0,
            turns: frequency,
            frequency: TAU * frequency.to_f64(),
            sign,
            warnings: other_cone(half_angle.to_f64()).into_iter().collect(),
        }
    }

    fn wobble(&self, sine: f64, cosine: f64) -> DQuat {
        let (s, c) = self.half;
        DQuat::from_xyzw(0.0, self.sign * s * cosine, self.sign * s * sine, c)
    }
}

/// The equivalent cone for an angle beyond half a turn.
fn other_cone(half_angle: f64) -> Option<String> {
    let (given, rest) = (half_angle.abs().to_degrees(), half_angle.abs() % TAU);
    let same = rest.min(TAU - rest).to_degrees();
    // Beyond rounding: 180 deg itself is a valid cone.
    (given > 180.0 + 1e-9).then(|| {
        format!(
            "a `cone` with a half_angle of {} deg equals one of {} deg: use a half-angle from 0 to 180 deg",
            tidy(given),
            tidy(same)
        )
    })
}

/// Degrees without the rounding of radians.
fn tidy(degrees: f64) -> f64 {
    libm::round(degrees * 1e9) / 1e9
}

impl Motion for Cone {
    fn warnings(&self) -> &[String] {
        &self.warnings
    }

    fn at(&self, start: Attitude, t: Double) -> Kinematics {
        let (sine, cosine) = (self.turns * t * Double::TAU).sin_cos();
        let (s, _) = self.half;
        let across = self.sign * self.frequency * self.sin_angle;
        Kinematics {
            attitude: start.turned(self.wobble(0.0, 1.0).conjugate() * self.wobble(sine, cosine)),
            rate: Vector::new(-2.0 * self.frequency * s * s, -across * sine, across * cosine),
            acceleration: Vector::ZERO,
        }
    }

    fn fastest(&self) -> f64 {
        self.frequency
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::rate_is_the_derivative_of_attitude;
    use super::*;
    use crate::geometry::{Axes, exp, rotate};
    use crate::time::{NANOS, SimTime};
    use glam::DVec3;

    fn cone(degrees: f64, hertz: f64, sign: f64) -> Cone {
        Cone::new(Double::from(degrees) * Double::PI_OVER_180, Double::from(hertz), sign)
    }

    #[test]
    fn its_rate_is_the_derivative_of_its_attitude() {
        let start = Attitude::from_quat(exp(DVec3::new(0.3, -0.7, 1.1)));
        for (degrees, hertz) in [(10.0, 0.37), (1.0, 10.0), (-20.0, 2.0), (0.0, 1.0)] {
            for sign in [1.0, -1.0] {
                rate_is_the_derivative_of_attitude(&cone(degrees, hertz, sign), start, SimTime(2 * NANOS));
            }
        }
    }

    #[test]
    fn the_x_axis_keeps_its_angle_to_the_cone_and_comes_back_after_a_turn() {
        let motion = cone(10.0, 2.0, 1.0);
        // c(0)* takes the cone's axis from body x: x stays at 10° from it.
        let axis = rotate(motion.wobble(0.0, 1.0).conjugate(), DVec3::X);
        for ms in 0..500 {
            let q = motion.at(Attitude::IDENTITY, SimTime(ms * 1_000_000).exact_seconds()).attitude;
            let angle = rotate(q.q, DVec3::X).angle_between(axis).to_degrees();
            assert!((angle - 10.0).abs() < 1e-9, "{angle} at {ms} ms");
        }
        let back = motion.at(Attitude::IDENTITY, Double::from(3600.0));
        assert!(back.attitude.angle_to(Attitude::IDENTITY) < 1e-15);
    }

    #[test]
    fn in_flu_axes_the_same_numbers_describe_the_mirrored_wobble() {
        let t = SimTime(137_000_000).exact_seconds();
        let (frd, flu) = (cone(5.0, 2.0, 1.0), cone(5.0, 2.0, -1.0));
        let (a, b) = (frd.at(Attitude::IDENTITY, t), flu.at(Attitude::IDENTITY, t));
        assert!((Axes::EnuFlu.body_out(b.rate) - a.rate.v).length() < 1e-15);
        let q = b.attitude.q;
        assert!(DQuat::from_xyzw(q.x, -q.y, -q.z, q.w).abs_diff_eq(a.attitude.q, 1e-15));
    }
}
