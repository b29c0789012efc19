//! The error of an estimate against the truth.

use crate::geometry::Attitude;
use crate::score::AttitudeError;
use glam::DVec3;

/// The error of an estimate, degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Off {
    /// The whole rotation.
    pub total_deg: f64,
    /// About the body's x axis, after the heading is corrected.
    pub roll_deg: f64,
    /// About the body's y axis, after the heading is corrected.
    pub pitch_deg: f64,
    /// About the vertical; positive where the estimate is too far clockwise.
    pub heading_deg: f64,
}

impl Off {
    /// The error `e = q_estimate ⊗ q_truth*` (nav axes) is a tilt followed by a turn about the vertical. The tilt's
    /// rotation vector in the true body frame has the roll and pitch errors as components.
    pub(super) fn between(truth: Attitude, estimate: Attitude) -> Off {
        let error = AttitudeError::between(truth, estimate);
        let heading = crate::geometry::exp(DVec3::Z * error.heading);
        let tilt = crate::geometry::log(heading.conjugate() * (estimate.q * truth.q.conjugate()));
        let tilt = crate::geometry::rotate(truth.q.conjugate(), tilt);
        Off {
            total_deg: error.total.to_degrees(),
            roll_deg: tilt.x.to_degrees(),
            pitch_deg: tilt.y.to_degrees(),
            heading_deg: error.heading.to_degrees(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Euler, exp};
    use proptest::prelude::*;

    proptest! {
        /// Errors applied one after another come out separately, at any attitude.
        #[test]
        fn roll_pitch_and_heading_errors_are_told_apart(
            roll in -3.0..3.0f64, pitch in -1.5..1.5f64, yaw in -3.0..3.0f64,
            tilt in -0.2..0.2f64, way in -3.0..3.0f64, turn in -3.0..3.0f64,
        ) {
            let truth = Euler { roll, pitch, yaw }.to_quat();
            let axis = DVec3::new(libm::cos(way), libm::sin(way), 0.0);
            let estimate = exp(DVec3::Z * turn) * exp(axis * tilt) * truth;
            let off = Off::between(Attitude::from_quat(truth), Attitude::from_quat(estimate));
            let body = crate::geometry::rotate(truth.conjugate(), axis * tilt);
            prop_assert!((off.heading_deg - turn.to_degrees()).abs() < 1e-9);
            prop_assert!((off.roll_deg - body.x.to_degrees()).abs() < 1e-6);
            prop_assert!((off.pitch_deg - body.y.to_degrees()).abs() < 1e-6);
        }
    }

    #[test]
    fn near_level_the_errors_are_differences_of_angles() {
        let at = |roll: f64, pitch: f64, yaw: f64| {
            let angles = [roll, pitch, yaw].map(f64::to_radians);
            Attitude::from_quat(Euler { roll: angles[0], pitch: angles[1], yaw: angles[2] }.to_quat())
        };
        let off = Off::between(at(2.0, -1.0, 80.0), at(2.5, -1.2, 83.0));
        for (value, expected) in [(off.roll_deg, 0.5), (off.pitch_deg, -0.2), (off.heading_deg, 3.0)] {
            assert!((value - expected).abs() < 0.01, "{off:?}");
        }
    }
}
