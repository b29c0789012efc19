//! Constant angular rate: the paper's cases of one value, roll, pitch, yaw, and several values in turn.
//!
//! `q(t) = q₀ ⊗ exp(w·t/2)`. The phase `|w|·t/2` is a hi + lo pair: in plain doubles it errs by 1.07·10⁻⁹ degrees
//! after an hour at 2000 °/s.

use super::{Context, Kinematics, Motion, MotionKind};
use crate::double::Double;
use crate::geometry::{Attitude, Body, Vector};
use crate::keys::{KeyError, Name, Values};
use crate::quantity::Kind;
use glam::{DQuat, DVec3};

const ANGULAR_RATE: Name<[Double; 3]> = Name::new("angular_rate");
const ROLL: Name<Double> = Name::new("roll");
const PITCH: Name<Double> = Name::new("pitch");
const YAW: Name<Double> = Name::new("yaw");

pub(super) static KIND: MotionKind = MotionKind {
    name: "rotate",
    about: "turns at a constant angular rate, given as a vector or as roll, pitch or yaw",
    keys: &[
        ANGULAR_RATE.body_vector(Kind::ANGULAR_RATE, "about the body's x, y and z"),
        ROLL.scalar(Kind::ANGULAR_RATE, "about the body's x only"),
        PITCH.scalar(Kind::ANGULAR_RATE, "about the body's y only"),
        YAW.scalar(Kind::ANGULAR_RATE, "about the body's z only"),
    ],
    has_length: false,
    build,
};

#[derive(Debug)]
struct Rotate {
    axis: DVec3,
    /// Half the angular speed in rad/s.
    half_speed: Double,
    rate: Vector<Body>,
}

fn build(values: &Values, context: &Context) -> Result<Box<dyn Motion>, KeyError> {
    let short: Vec<_> =
        [ROLL, PITCH, YAW].into_iter().enumerate().filter(|(_, key)| values.has(*key)).collect();
    match (values.get(ANGULAR_RATE), &short[..]) {
        (Some(rate), []) => Ok(Box::new(Rotate::new(rate))),
        (None, &[(axis, key)]) => {
            let sign = if axis == 0 { 1.0 } else { context.axes.body_sign() };
            let mut rate = [Double::from(0.0); 3];
            rate[axis] = values.get(key).unwrap_or_default() * Double::from(sign);
            Ok(Box::new(Rotate::new(rate)))
        }
        (None, []) => Err(KeyError::new(
            "kind",
            "`rotate` needs `angular_rate`, or one of `roll`, `pitch` and `yaw`, such as roll = \"30 deg/s\"",
        )),
        (_, [.., (_, key)]) => Err(KeyError::new(
            *key,
            "`rotate` takes one of `angular_rate`, `roll`, `pitch` and `yaw`; for several axes at once use `angular_rate`",
        )),
    }
}

impl Rotate {
    fn new(rate: [Double; 3]) -> Rotate {
        let speed = rate.iter().fold(Double::from(0.0), |sum, &w| sum + w * w).sqrt();
        let axis = if speed.hi > 0.0 { rate.map(|w| (w / speed).to_f64()) } else { [0.0; 3] };
        Rotate {
            axis: DVec3::from_array(axis),
            half_speed: speed / Double::from(2.0),
            rate: Vector::from_vec(DVec3::from_array(rate.map(Double::to_f64))),
        }
    }
}

impl Motion for Rotate {
    fn at(&self, start: Attitude, t: Double) -> Kinematics {
        let (sine, cosine) = (self.half_speed * t).sin_cos();
        let b = self.axis * sine;
        Kinematics {
            attitude: start.turned(DQuat::from_xyzw(b.x, b.y, b.z, cosine)),
            rate: self.rate,
            acceleration: Vector::ZERO,
        }
    }

    fn constant_rate(&self) -> Option<Vector<Body>> {
        Some(self.rate)
    }

    fn fastest(&self) -> f64 {
        self.rate.length()
    }
}

#[cfg(test)]
pub(super) fn constant(rate: [f64; 3]) -> Box<dyn Motion> {
    Box::new(Rotate::new(rate.map(Double::from)))
}

#[cfg(test)]
mod tests {
    use super::super::tests::rate_is_the_derivative_of_attitude;
    use super::*;
    use crate::geometry::{angle_between, exp};
    use crate::time::{NANOS, SimTime};

    #[test]
    fn its_rate_is_the_derivative_of_its_attitude() {
        let start = Attitude::from_quat(exp(DVec3::new(0.3, -0.7, 1.1)));
        for rate in [[0.5, 0.0, 0.0], [0.3, -4.0, 35.0], [1e-9, 0.0, 0.0], [0.0; 3]] {
            rate_is_the_derivative_of_attitude(&*constant(rate), start, SimTime(3 * NANOS));
        }
    }

    #[test]
    fn a_whole_number_of_turns_comes_back_within_a_billionth_of_a_degree() {
        // 2000 deg/s for an hour is 20 000 turns exactly; the rate is the decimal, not its nearest double.
        let rate = Double::from(2000.0) * Double::PI_OVER_180;
        let end = Rotate::new([Double::from(0.0), rate, Double::from(0.0)])
            .at(Attitude::IDENTITY, Double::from(3600.0));
        assert!(angle_between(end.attitude.q, DQuat::IDENTITY).to_degrees() < 1e-12);
    }
}
