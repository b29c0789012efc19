//! Yaw-pitch-roll angles (ZYX), exact through gimbal lock.
//!
//! From a quaternion, the half sum and half difference of roll and yaw come from two arc tangents that stay
//! well conditioned at any pitch (Bernardes & Viollet, PLoS ONE 17(11) e0276302, 2022):
//!
//! ```text
//! (w − y, x + z) = √2·cos(pitch/2 + 45°) · (cos, sin)((roll + yaw)/2)
//! (w + y, x − z) = √2·sin(pitch/2 + 45°) · (cos, sin)((roll − yaw)/2)
//! ```

use glam::DQuat;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Roll, pitch and yaw in rad: the rotation `Rz(yaw)·Ry(pitch)·Rx(roll)`.
///
/// On output roll and yaw are in (−π, π] and pitch in [−π/2, π/2]. At gimbal lock (pitch = ±π/2) roll is 0 and
/// yaw carries the rest, so the three angles still give back the same rotation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Euler {
    /// About the body's x axis, rad.
    pub roll: f64,
    /// About the y axis after yawing, rad.
    pub pitch: f64,
    /// About the nav frame's z axis, rad.
    pub yaw: f64,
}

/// Roll and yaw cannot be told apart when one of the two amplitudes is below this: 10⁻¹³ is a thousand
/// roundings, and giving roll's share to yaw there moves the rotation by less than 10⁻¹¹ degrees.
pub(super) const LOCK: f64 = 1e-13;

impl Euler {
    /// The angles of a unit quaternion.
    pub fn from_quat(q: DQuat) -> Euler {
        let (sum_amplitude, half_sum) = polar(q.w - q.y, q.x + q.z);
        let (difference_amplitude, half_difference) = polar(q.w + q.y, q.x - q.z);
        let pitch = 2.0 * libm::atan2(difference_amplitude, sum_amplitude) - FRAC_PI_2;
        if sum_amplitude < LOCK {
            return Euler { roll: 0.0, pitch: FRAC_PI_2, yaw: wrap(-2.0 * half_difference) };
        }
        if difference_amplitude < LOCK {
            return Euler { roll: 0.0, pitch: -FRAC_PI_2, yaw: wrap(2.0 * half_sum) };
        }
        Euler { roll: wrap(half_sum + half_difference), pitch, yaw: wrap(half_sum - half_difference) }
    }

    /// The quaternion `qz(yaw) ⊗ qy(pitch) ⊗ qx(roll)`.
    pub fn to_quat(self) -> DQuat {
        let half = |angle: f64| (libm::sin(0.5 * angle), libm::cos(0.5 * angle));
        Self::quat_of_half_angles([half(self.roll), half(self.pitch), half(self.yaw)])
    }

    /// The same from (sine, cosine) of half of roll, pitch and yaw, for angles known better than a double holds.
    pub fn quat_of_half_angles(half: [(f64, f64); 3]) -> DQuat {
        let [(sr, cr), (sp, cp), (sy, cy)] = half;
        DQuat::from_xyzw(0.0, 0.0, sy, cy)
            * DQuat::from_xyzw(0.0, sp, 0.0, cp)
            * DQuat::from_xyzw(sr, 0.0, 0.0, cr)
    }
}

pub(super) fn polar(x: f64, y: f64) -> (f64, f64) {
    (libm::hypot(x, y), libm::atan2(y, x))
}

/// The same angle in (−π, π]. Adding 0 turns −0 into 0.
pub(super) fn wrap(angle: f64) -> f64 {
    let turns = libm::ceil((angle - PI) / TAU);
    angle - TAU * turns + 0.0
}

#[cfg(test)]
mod tests {
    use super::super::angle_between;
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn angles_survive_the_round_trip(roll in -3.1..3.1f64, pitch in -1.5..1.5f64, yaw in -3.1..3.1f64) {
            let back = Euler::from_quat(Euler { roll, pitch, yaw }.to_quat());
            prop_assert!((back.roll - roll).abs() < 1e-13 && (back.pitch - pitch).abs() < 1e-14);
            prop_assert!((back.yaw - yaw).abs() < 1e-13);
        }

        #[test]
        fn the_rotation_survives_at_and_near_gimbal_lock(
            roll in -3.1..3.1f64, yaw in -3.1..3.1f64,
            gap in prop_oneof![Just(0.0), Just(1e-15), Just(1e-12), 0.0..1e-6f64],
            up in any::<bool>(),
        ) {
            let pitch = (FRAC_PI_2 - gap) * if up { 1.0 } else { -1.0 };
            let q = Euler { roll, pitch, yaw }.to_quat();
            let angles = Euler::from_quat(q);
            prop_assert!(angle_between(angles.to_quat(), q) < 1e-12);
            prop_assert!(angles.pitch.abs() <= FRAC_PI_2);
            if gap == 0.0 {
                prop_assert_eq!(angles.roll, 0.0);
            }
        }
    }

    #[test]
    fn half_a_turn_is_plus_pi() {
        for angle in [PI, -PI, 3.0 * PI] {
            assert_eq!(wrap(angle), PI);
        }
        assert_eq!(wrap(0.5 + TAU), 0.5 + TAU - TAU);
    }

    #[test]
    fn each_angle_turns_about_its_own_axis_in_order() {
        let d = FRAC_PI_2;
        // Yaw 90° then pitch 30° then roll: forward points East and up by 30°.
        let q = Euler { roll: 0.7, pitch: d / 3.0, yaw: d }.to_quat();
        let forward = super::super::rotate(q, glam::DVec3::X);
        assert!((forward - glam::DVec3::new(0.0, libm::cos(d / 3.0), -libm::sin(d / 3.0))).length() < 1e-15);
    }
}
