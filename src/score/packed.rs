//! Many attitudes in little memory: 16 bytes each instead of 32.

use crate::geometry::Attitude;
use glam::DQuat;

/// Bits for each of the three stored components.
const BITS: u32 = 42;
/// The bound of a stored component: one that is not the largest is at most 1/√2.
const LARGEST: f64 = std::f64::consts::FRAC_1_SQRT_2;
/// Steps from 0 to the bound.
const STEPS: f64 = ((1u64 << (BITS - 1)) - 1) as f64;

/// A rotation as its three smaller components, 42 bits each, and the index of the omitted one: accurate to 3·10⁻¹³
/// rad. The sign of the quaternion, which does not affect the rotation, is not stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Packed(u128);

impl Packed {
    /// Packs a quaternion of unit length.
    pub fn new(q: DQuat) -> Packed {
        let c = q.to_array();
        let largest = (0..4).fold(0, |best, i| if c[i].abs() > c[best].abs() { i } else { best });
        let sign = c[largest].signum();
        let mut bits = largest as u128;
        for i in (0..4).filter(|&i| i != largest) {
            let step = libm::round(sign * c[i] / LARGEST * STEPS).clamp(-STEPS, STEPS) as i64;
            bits = bits << BITS | u128::from(step as u64 & ((1 << BITS) - 1));
        }
        Packed(bits)
    }

    /// The rotation; its largest component is positive.
    pub fn quat(self) -> DQuat {
        let mut bits = self.0;
        let largest = (bits >> (3 * BITS)) as usize & 3;
        let (mut c, mut left) = ([0.0; 4], 1.0);
        for i in (0..4).rev().filter(|&i| i != largest) {
            let raw = ((bits as u64) << (64 - BITS)) as i64 >> (64 - BITS);
            c[i] = raw as f64 / STEPS * LARGEST;
            left -= c[i] * c[i];
            bits >>= BITS;
        }
        c[largest] = libm::sqrt(left.max(0.0));
        DQuat::from_array(c)
    }

    /// The rotation as an attitude.
    pub fn attitude(self) -> Attitude {
        Attitude::from_quat(self.quat())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{angle_between, exp};
    use glam::DVec3;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_rotation_comes_back_to_a_picoradian(x in -4.0..4.0f64, y in -4.0..4.0f64, z in -4.0..4.0f64) {
            let q = exp(DVec3::new(x, y, z));
            for q in [q, -q] {
                prop_assert!(angle_between(Packed::new(q).quat(), q) < 1e-12);
            }
        }
    }

    #[test]
    fn right_angles_and_ties_come_back() {
        let half = std::f64::consts::FRAC_1_SQRT_2;
        for c in
            [[0.0, 0.0, 0.0, 1.0], [0.0, 0.0, -1.0, 0.0], [half, -half, 0.0, 0.0], [0.5, -0.5, 0.5, -0.5]]
        {
            let q = DQuat::from_array(c);
            assert!(angle_between(Packed::new(q).quat(), q) < 1e-12, "{c:?}");
        }
    }
}
