//! Vectors and quaternions generic over precision: `glam` has a separate family of types for each.

use super::Real;
use glam::{DQuat, DVec3};
use std::ops::{Add, Mul, Sub};

/// Three components along the body's axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triple<R> {
    /// Along x.
    pub x: R,
    /// Along y.
    pub y: R,
    /// Along z.
    pub z: R,
}

/// A Hamilton quaternion `w + v`, not necessarily of unit norm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quaternion<R> {
    /// The scalar part.
    pub w: R,
    /// The vector part.
    pub v: Triple<R>,
}

impl<R: Real> Triple<R> {
    /// The inner product.
    pub fn dot(self, other: Self) -> R {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    /// The vector product.
    pub fn cross(self, other: Self) -> Self {
        Triple {
            x: self.y * other.z - self.z * other.y,
            y: self.z * other.x - self.x * other.z,
            z: self.x * other.y - self.y * other.x,
        }
    }

    /// The Euclidean length.
    pub fn length(self) -> R {
        self.dot(self).sqrt()
    }

    /// Whether no component is infinite or NaN.
    pub fn is_finite(self) -> bool {
        self.x.is_finite() && self.y.is_finite() && self.z.is_finite()
    }

    /// The quaternion of the rotation vector (rad): `[cos(|v|/2), sin(|v|/2)·v/|v|]`.
    ///
    /// Accurate to a few units in the last place, from angles so small that their square underflows to the largest
    /// whose square does not overflow.
    pub fn exp(self) -> Quaternion<R> {
        let half = R::of(0.5) * self.length();
        let (sine, cosine) = half.sin_cos();
        let sinc = if half < R::TINY { R::of(1.0) } else { sine / half };
        Quaternion { w: cosine, v: self * (R::of(0.5) * sinc) }
    }
}

impl<R: Real> Quaternion<R> {
    /// No rotation.
    pub fn identity() -> Self {
        Quaternion { w: R::of(1.0), v: Triple::from(DVec3::ZERO) }
    }

    /// `w - v`: the inverse of a unit quaternion.
    pub fn conjugate(self) -> Self {
        Quaternion { w: self.w, v: self.v * R::of(-1.0) }
    }

    /// The Euclidean norm.
    pub fn norm(self) -> R {
        (self.w * self.w + self.v.dot(self.v)).sqrt()
    }

    /// The unit quaternion of the same direction.
    pub fn normalised(self) -> Self {
        self * (R::of(1.0) / self.norm())
    }

    /// Whether no component is infinite or NaN.
    pub fn is_finite(self) -> bool {
        self.w.is_finite() && self.v.is_finite()
    }

    /// Whether every component is zero: no attitude.
    pub fn is_null(self) -> bool {
        self == self * R::of(-1.0)
    }

    /// `½·q ⊗ w`: the rate of change of the attitude at the body's angular rate `w`.
    pub fn derivative(self, w: Triple<R>) -> Self {
        let w = w * R::of(0.5);
        Quaternion { w: R::of(0.0) - self.v.dot(w), v: w * self.w + self.v.cross(w) }
    }
}

impl<R: Real> Add for Triple<R> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Triple { x: self.x + other.x, y: self.y + other.y, z: self.z + other.z }
    }
}
impl<R: Real> Sub for Triple<R> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Triple { x: self.x - other.x, y: self.y - other.y, z: self.z - other.z }
    }
}
impl<R: Real> Mul<R> for Triple<R> {
    type Output = Self;
    fn mul(self, factor: R) -> Self {
        Triple { x: self.x * factor, y: self.y * factor, z: self.z * factor }
    }
}
impl<R: Real> Add for Quaternion<R> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Quaternion { w: self.w + other.w, v: self.v + other.v }
    }
}
impl<R: Real> Mul<R> for Quaternion<R> {
    type Output = Self;
    fn mul(self, factor: R) -> Self {
        Quaternion { w: self.w * factor, v: self.v * factor }
    }
}
impl<R: Real> Mul for Quaternion<R> {
    type Output = Self;
    /// The Hamilton product.
    fn mul(self, other: Self) -> Self {
        Quaternion {
            w: self.w * other.w - self.v.dot(other.v),
            v: other.v * self.w + self.v * other.w + self.v.cross(other.v),
        }
    }
}

impl<R: Real> From<DVec3> for Triple<R> {
    fn from(v: DVec3) -> Self {
        Triple { x: R::of(v.x), y: R::of(v.y), z: R::of(v.z) }
    }
}
impl<R: Real> From<DQuat> for Quaternion<R> {
    fn from(q: DQuat) -> Self {
        Quaternion { w: R::of(q.w), v: Triple { x: R::of(q.x), y: R::of(q.y), z: R::of(q.z) } }
    }
}
impl<R: Real> From<Quaternion<R>> for DQuat {
    fn from(q: Quaternion<R>) -> Self {
        DQuat::from_xyzw(q.v.x.double(), q.v.y.double(), q.v.z.double(), q.w.double())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{exp, log};

    #[test]
    fn the_exponential_is_that_of_geometry_at_any_angle() {
        for angle in [0.0, 1e-300, 1e-170, 1e-9, 1e-8, 1e-3, 1.0, 2.9, 6.3, 1e3, 1e9] {
            let v = DVec3::new(0.6, -0.48, 0.64) * angle;
            let q = DQuat::from(Triple::<f64>::from(v).exp());
            assert!((q - exp(v)).length() < 4e-16 + 2e-16 * angle, "{angle}");
            if angle < 3.0 {
                assert!((log(q) - v).length() <= 4e-16 * angle, "{angle}");
            }
            if angle < 1e3 {
                let q = DQuat::from(Triple::<f32>::from(v).exp());
                assert!((q - exp(v)).length() < 3e-7 + 1e-7 * angle, "{angle} in f32");
            }
        }
    }

    #[test]
    fn the_product_is_hamiltons() {
        let (a, b) = (exp(DVec3::new(0.3, -1.2, 0.5)), exp(DVec3::new(2.0, 0.1, -0.9)));
        let product = Quaternion::<f64>::from(a) * Quaternion::from(b);
        assert!((DQuat::from(product) - a * b).length() < 1e-15);
        let still = Quaternion::<f64>::from(a) * Quaternion::from(a).conjugate();
        assert!((DQuat::from(still) - DQuat::IDENTITY).length() < 1e-15);
    }
}
