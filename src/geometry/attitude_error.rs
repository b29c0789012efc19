//! One estimate's error, split into inclination and heading.

use super::Attitude;
use std::f64::consts::{PI, TAU};

/// One estimate's error, rad.
///
/// Laidig & Seel, *VQF*, Information Fusion 91, 2023: *inclination* is the part that gravity shows, *heading* the
/// remaining turn about the vertical. With `e = q_estimate ⊗ q_truth*` in nav axes, heading is `2·atan2(e_z, e_w)`
/// and inclination `2·atan2(√(e_x² + e_y²), √(e_w² + e_z²))`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AttitudeError {
    /// The total rotation, in [0, π].
    pub total: f64,
    /// The part that tilts, in [0, π].
    pub inclination: f64,
    /// The part about the vertical, in [−π, π], positive where the estimate is too far clockwise.
    pub heading: f64,
}

impl AttitudeError {
    /// The error of an estimate against the truth at the same time.
    pub fn between(truth: Attitude, estimate: Attitude) -> AttitudeError {
        let e = estimate.q * truth.q.conjugate();
        let heading = 2.0 * libm::atan2(e.z, e.w);
        AttitudeError {
            total: truth.angle_to(estimate),
            inclination: 2.0 * libm::atan2(libm::hypot(e.x, e.y), libm::hypot(e.w, e.z)),
            heading: heading
                - TAU * libm::round(heading / TAU).clamp(-1.0, 1.0) * f64::from(heading.abs() > PI),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Euler, exp};
    use super::*;
    use glam::DVec3;
    use proptest::prelude::*;

    fn attitude(roll: f64, pitch: f64, yaw: f64) -> Attitude {
        Attitude::from_quat(Euler { roll, pitch, yaw }.to_quat())
    }

    proptest! {
        #[test]
        fn a_turn_about_the_vertical_is_heading_and_nothing_else(
            roll in -3.0..3.0f64, pitch in -1.5..1.5f64, yaw in -3.0..3.0f64, turn in -3.1..3.1f64,
        ) {
            let truth = attitude(roll, pitch, yaw);
            let estimate = Attitude::from_quat(exp(DVec3::Z * turn) * truth.q);
            for estimate in [estimate, Attitude::from_quat(-estimate.q)] {
                let error = AttitudeError::between(truth, estimate);
                prop_assert!((error.heading - turn).abs() < 1e-12 && error.inclination < 1e-7, "{error:?}");
                prop_assert!((error.total - turn.abs()).abs() < 1e-12);
            }
        }

        #[test]
        fn a_tilt_is_inclination_and_nothing_else(
            yaw in -3.0..3.0f64, tilt in 0.0..3.0f64, way in -3.0..3.0f64,
        ) {
            let truth = attitude(0.3, -0.2, yaw);
            let axis = DVec3::new(libm::cos(way), libm::sin(way), 0.0);
            let error = AttitudeError::between(truth, Attitude::from_quat(exp(axis * tilt) * truth.q));
            prop_assert!((error.inclination - tilt).abs() < 1e-12 && error.heading.abs() < 1e-12, "{error:?}");
        }
    }
}
