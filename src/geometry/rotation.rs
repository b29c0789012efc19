//! Rotations between frames: unit quaternions with exponential, logarithm and error angle of full precision.
//!
//! `glam` supplies the quaternion product. Its scaled-axis logarithm returns 0 below 2·10⁻⁸ rad and its
//! `angle_between` 0 at 10⁻⁸ rad, so those two are our own; so is [`rotate`], which leaves a vector along the
//! axis exactly as it was.

use super::{Body, Nav, Vector};
use glam::{DQuat, DVec3};
use std::fmt;
use std::marker::PhantomData;
use std::ops::Mul;

/// The rotation that takes vectors of frame `A` to frame `B`, as a Hamilton unit quaternion.
pub struct Rotation<A, B> {
    /// The quaternion `q` of `v_B = q ⊗ v_A ⊗ q*`.
    pub q: DQuat,
    frames: PhantomData<fn() -> (A, B)>,
}

/// The attitude `q_nb`: takes body vectors to nav.
pub type Attitude = Rotation<Body, Nav>;

impl<A, B> Rotation<A, B> {
    /// The frames' axes coincide.
    pub const IDENTITY: Self = Rotation::from_quat(DQuat::IDENTITY);

    /// From a unit quaternion whose frames are known to be `A` and `B`.
    pub const fn from_quat(q: DQuat) -> Self {
        Rotation { q, frames: PhantomData }
    }

    /// The vector seen in frame `B`.
    pub fn apply(self, v: Vector<A>) -> Vector<B> {
        Vector::from_vec(rotate(self.q, v.v))
    }

    /// The rotation back from `B` to `A`.
    pub fn inverse(self) -> Rotation<B, A> {
        Rotation::from_quat(self.q.conjugate())
    }

    /// Turned further by `turn`, a quaternion in `A`'s axes: `q ⊗ turn`.
    pub fn turned(self, turn: DQuat) -> Self {
        Self::from_quat(self.q * turn)
    }

    /// The angle in `[0, π]` rad by which the other rotation differs, exact for tiny angles.
    pub fn angle_to(self, other: Self) -> f64 {
        angle_between(self.q, other.q)
    }
}

impl<A, B> Clone for Rotation<A, B> {
    fn clone(&self) -> Self {
        *self
    }
}
impl<A, B> Copy for Rotation<A, B> {}
impl<A, B> PartialEq for Rotation<A, B> {
    fn eq(&self, other: &Self) -> bool {
        self.q == other.q
    }
}
impl<A, B> fmt::Debug for Rotation<A, B> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "[w {}, x {}, y {}, z {}]", self.q.w, self.q.x, self.q.y, self.q.z)
    }
}
impl<A, B, C> Mul<Rotation<A, B>> for Rotation<B, C> {
    type Output = Rotation<A, C>;
    fn mul(self, first: Rotation<A, B>) -> Rotation<A, C> {
        Rotation::from_quat(self.q * first.q)
    }
}

/// `q ⊗ v ⊗ q*` as `v + w·t + b × t` with `t = 2·b × v`: a vector along the axis comes back bit for bit.
pub fn rotate(q: DQuat, v: DVec3) -> DVec3 {
    let b = DVec3::new(q.x, q.y, q.z);
    let t = 2.0 * b.cross(v);
    v + q.w * t + b.cross(t)
}

/// The quaternion of the rotation vector `v` (rad): `[cos(|v|/2), sin(|v|/2)·v/|v|]`, exact for tiny angles.
pub fn exp(v: DVec3) -> DQuat {
    let half = 0.5 * v.length();
    // Below 10⁻⁸ rad the next term of sin(x)/x, x²/6, is under half a unit in the last place.
    let sinc = if half < 1e-8 { 1.0 } else { libm::sin(half) / half };
    let b = 0.5 * sinc * v;
    DQuat::from_xyzw(b.x, b.y, b.z, libm::cos(half))
}

/// The rotation vector (rad, length in `[0, π]`) of a unit quaternion: the inverse of [`exp`].
pub fn log(q: DQuat) -> DVec3 {
    let q = if q.w < 0.0 { -q } else { q };
    let b = DVec3::new(q.x, q.y, q.z);
    let sine = b.length();
    if sine == 0.0 {
        return DVec3::ZERO;
    }
    b * (2.0 * libm::atan2(sine, q.w) / sine)
}

/// The angle between two rotations in `[0, π]` rad: `2·atan2(|v|, |w|)` of their difference.
pub fn angle_between(a: DQuat, b: DQuat) -> f64 {
    let d = a.conjugate() * b;
    2.0 * libm::atan2(DVec3::new(d.x, d.y, d.z).length(), d.w.abs())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn any_vector(limit: f64) -> impl Strategy<Value = DVec3> {
        prop::array::uniform3(-limit..limit).prop_map(DVec3::from_array)
    }

    proptest! {
        #[test]
        fn log_undoes_exp_below_half_a_turn(v in any_vector(1.8)) {
            prop_assert!((log(exp(v)) - v).length() < 4e-15 * (1.0 + v.length()));
        }

        #[test]
        fn a_rotation_keeps_lengths_and_the_axis(v in any_vector(3.0), x in any_vector(10.0)) {
            let q = exp(v);
            prop_assert!((rotate(q, x).length() - x.length()).abs() < 1e-14 * (1.0 + x.length()));
            prop_assert!((rotate(q, v) - v).length() < 1e-15 * (1.0 + v.length()));
        }

        #[test]
        fn composition_is_application_in_turn(a in any_vector(3.0), b in any_vector(3.0), x in any_vector(5.0)) {
            let (a, b) = (exp(a), exp(b));
            prop_assert!((rotate(a * b, x) - rotate(a, rotate(b, x))).length() < 1e-14 * (1.0 + x.length()));
        }
    }

    #[test]
    fn tiny_angles_are_not_lost() {
        for angle in [1e-3, 1e-8, 1e-12, 1e-150] {
            let v = DVec3::new(0.0, angle, 0.0);
            assert!((log(exp(v)).y - angle).abs() <= 1e-15 * angle, "{angle}");
            assert!((angle_between(DQuat::IDENTITY, exp(v)) - angle).abs() <= 1e-15 * angle, "{angle}");
        }
    }

    #[test]
    fn a_vector_along_the_axis_is_untouched_to_the_last_bit() {
        let yaw = exp(DVec3::new(0.0, 0.0, std::f64::consts::FRAC_PI_2));
        assert_eq!(rotate(yaw, DVec3::new(0.0, 0.0, -9.80665)), DVec3::new(0.0, 0.0, -9.80665));
    }

    #[test]
    fn an_attitude_takes_body_to_nav() {
        // Yawed 90°, forward points East.
        let q = Attitude::from_quat(exp(DVec3::new(0.0, 0.0, std::f64::consts::FRAC_PI_2)));
        assert!((q.apply(Vector::new(1.0, 0.0, 0.0)).v - DVec3::Y).length() < 1e-15);
        assert!((q.inverse().apply(Vector::new(0.0, 1.0, 0.0)).v - DVec3::X).length() < 1e-15);
    }
}
