//! Euler angles in any of the twelve sequences, exact through their singularities.
//!
//! From a quaternion by the direct method of E. Bernardes and S. Viollet, *Quaternion to Euler angles conversion: a
//! direct, general and computationally efficient method*, PLoS ONE 17(11) e0276302, 2022: the half sum and the half
//! difference of the outer angles come from two arc tangents, the middle angle from the two amplitudes. The middle
//! angle is taken from both amplitudes rather than from an arc cosine, which is good at any angle.

use super::euler::{LOCK, polar, wrap};
use glam::DQuat;
use std::f64::consts::{FRAC_PI_2, PI};
use std::fmt;

/// Three axes to turn about one after another, each in the axes that the turns before it left: `ZYX` is yaw, pitch,
/// roll, `q = qz ⊗ qy ⊗ qx`. About fixed axes the same rotation is the reversed sequence of the reversed angles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EulerSequence([usize; 3]);

const X: usize = 0;
const Y: usize = 1;
const Z: usize = 2;

impl EulerSequence {
    /// Every sequence: six of three different axes (Tait-Bryan), six that end about the axis they begin with.
    pub const ALL: [EulerSequence; 12] = [
        EulerSequence([X, Y, Z]),
        EulerSequence([X, Z, Y]),
        EulerSequence([Y, X, Z]),
        EulerSequence([Y, Z, X]),
        EulerSequence([Z, X, Y]),
        EulerSequence([Z, Y, X]),
        EulerSequence([X, Y, X]),
        EulerSequence([X, Z, X]),
        EulerSequence([Y, X, Y]),
        EulerSequence([Y, Z, Y]),
        EulerSequence([Z, X, Z]),
        EulerSequence([Z, Y, Z]),
    ];

    /// The sequence of a name such as `ZYX`, in either case.
    pub fn from_name(name: &str) -> Option<EulerSequence> {
        Self::ALL.into_iter().find(|sequence| sequence.to_string().eq_ignore_ascii_case(name))
    }

    /// Whether it ends about the axis it begins with.
    pub fn is_proper(self) -> bool {
        self.0[0] == self.0[2]
    }

    /// The rotation of three angles (rad), in the order of the axes.
    pub fn to_quat(self, angles: [f64; 3]) -> DQuat {
        self.0.into_iter().zip(angles).fold(DQuat::IDENTITY, |q, (axis, angle)| {
            let (sine, cosine) = libm::sincos(0.5 * angle);
            let mut v = [0.0; 3];
            v[axis] = sine;
            q * DQuat::from_xyzw(v[0], v[1], v[2], cosine)
        })
    }

    /// The angles (rad) of a unit quaternion, in the order of the axes: the outer two in (−π, π], the middle one in
    /// [−π/2, π/2] for three different axes and in [0, π] for a proper sequence.
    ///
    /// At a singularity, which is an end of the middle angle's range, the outer two turn about one line. There the
    /// third is 0 and the first carries both, so that the three still give back the same rotation.
    pub fn angles(self, q: DQuat) -> [f64; 3] {
        let [k, j, i] = self.0;
        let v = [q.x, q.y, q.z];
        let (third, sign) =
            if self.is_proper() { (3 - i - j, parity(i, j, 3 - i - j)) } else { (k, parity(i, j, k)) };
        let (b, d) = (v[i], v[third] * sign);
        let (w, b, c, d) =
            if self.is_proper() { (q.w, b, v[j], d) } else { (q.w - v[j], b + d, v[j] + q.w, d - b) };
        let ((sum_amplitude, half_sum), (difference_amplitude, half_difference)) = (polar(w, b), polar(c, d));
        let (first, middle, last) = if difference_amplitude < LOCK {
            (2.0 * half_sum, 0.0, 0.0)
        } else if sum_amplitude < LOCK {
            (2.0 * half_difference, PI, 0.0)
        } else {
            let middle = 2.0 * libm::atan2(difference_amplitude, sum_amplitude);
            (half_sum + half_difference, middle, half_sum - half_difference)
        };
        if self.is_proper() {
            [wrap(first), middle, wrap(last)]
        } else {
            [wrap(first * sign), middle - FRAC_PI_2, wrap(last)]
        }
    }
}

/// +1 where the axes follow one another as x, y, z do, −1 where they go the other way.
fn parity(i: usize, j: usize, k: usize) -> f64 {
    if (j + 3 - i) % 3 == 1 && (k + 3 - j) % 3 == 1 { 1.0 } else { -1.0 }
}

impl fmt::Display for EulerSequence {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|&axis| f.write_str(["X", "Y", "Z"][axis]))
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Euler, angle_between, exp};
    use super::*;
    use glam::DVec3;
    use proptest::prelude::*;

    /// The two ends of the middle angle's range.
    fn ends(sequence: EulerSequence) -> [f64; 2] {
        if sequence.is_proper() { [0.0, PI] } else { [-FRAC_PI_2, FRAC_PI_2] }
    }

    fn any_sequence() -> impl Strategy<Value = EulerSequence> {
        prop::sample::select(EulerSequence::ALL.to_vec())
    }

    proptest! {
        #[test]
        fn angles_survive_the_round_trip(
            sequence in any_sequence(), first in -3.1..3.1f64, share in 0.03..0.97f64, last in -3.1..3.1f64,
        ) {
            let [low, high] = ends(sequence);
            let angles = [first, low + share * (high - low), last];
            let back = sequence.angles(sequence.to_quat(angles));
            for i in 0..3 {
                prop_assert!((back[i] - angles[i]).abs() < 1e-13, "{sequence}: {back:?} against {angles:?}");
            }
        }

        #[test]
        fn any_rotation_survives(sequence in any_sequence(), v in prop::array::uniform3(-1.8..1.8f64)) {
            let q = exp(DVec3::from_array(v));
            prop_assert!(angle_between(sequence.to_quat(sequence.angles(q)), q) < 1e-14);
        }

        #[test]
        fn the_rotation_survives_at_and_near_both_singularities(
            sequence in any_sequence(), first in -3.1..3.1f64, last in -3.1..3.1f64, upper in any::<bool>(),
            gap in prop_oneof![Just(0.0), Just(1e-15), Just(1e-12), 0.0..1e-12f64, 0.0..1e-6f64],
        ) {
            let [low, high] = ends(sequence);
            let q = sequence.to_quat([first, if upper { high - gap } else { low + gap }, last]);
            let angles = sequence.angles(q);
            prop_assert!(angle_between(sequence.to_quat(angles), q) < 1e-12, "{sequence}: {angles:?}");
            prop_assert!((low..=high).contains(&angles[1]));
            if gap == 0.0 {
                prop_assert_eq!((angles[1], angles[2]), (if upper { high } else { low }, 0.0));
            }
        }

        #[test]
        fn zyx_is_yaw_pitch_and_roll(v in prop::array::uniform3(-1.8..1.8f64), locked in any::<bool>()) {
            let free = exp(DVec3::from_array(v));
            let lock = Euler { roll: v[0], pitch: FRAC_PI_2, yaw: v[2] }.to_quat();
            let q = if locked { lock } else { free };
            let [yaw, pitch, roll] = EulerSequence([Z, Y, X]).angles(q);
            let euler = Euler::from_quat(q);
            let near = |a: f64, b: f64| (a - b).abs() < 1e-14;
            prop_assert!(near(yaw, euler.yaw) && near(pitch, euler.pitch) && near(roll, euler.roll));
        }
    }

    #[test]
    fn a_turn_about_one_axis_is_that_angle() {
        for sequence in EulerSequence::ALL.into_iter().filter(|sequence| !sequence.is_proper()) {
            for place in 0..3 {
                let mut angles = [0.0; 3];
                angles[place] = 0.4;
                let mut v = DVec3::ZERO;
                v[sequence.0[place]] = 0.4;
                let back = sequence.angles(exp(v));
                assert!((0..3).all(|i| (back[i] - angles[i]).abs() < 1e-15), "{sequence}: {back:?}");
            }
        }
    }

    #[test]
    fn names_read_back() {
        for sequence in EulerSequence::ALL {
            assert_eq!(EulerSequence::from_name(&sequence.to_string().to_lowercase()), Some(sequence));
        }
        assert_eq!(EulerSequence::from_name("XXY"), None);
    }
}
