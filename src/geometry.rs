//! Vectors and rotations whose frame is in their type, and Euler angles.
//!
//! A `Vector<Nav>` cannot be added to a `Vector<Body>`, and a [`Rotation`] says which frame it takes to which:
//! a wrong frame does not compile. Inside the program there are only three frames: [`Nav`] (North-East-Down),
//! [`Body`] (Forward-Right-Down) and [`Chip`] (the axes printed on a part). [`Axes`] is the border to how a
//! scene and a dataset write them.
//!
//! ```compile_fail
//! use ratetable::geometry::{Body, Nav, Vector};
//! let force = Vector::<Body>::new(0.0, 0.0, -9.8) + Vector::<Nav>::new(0.0, 0.0, 9.8);
//! ```

mod attitude_error;
mod axes;
mod euler;
mod euler_sequence;
mod rotation;

pub use attitude_error::AttitudeError;
pub use axes::Axes;
pub use euler::Euler;
pub use euler_sequence::EulerSequence;
pub use rotation::{Attitude, Rotation, angle_between, exp, log, rotate};

use glam::DVec3;
use std::fmt;
use std::marker::PhantomData;
use std::ops::{Add, AddAssign, Mul, Neg, Sub};

/// Local level: x North, y East, z Down.
pub enum Nav {}
/// The vehicle: x Forward, y Right, z Down.
pub enum Body {}
/// The axes printed on a part.
pub enum Chip {}

/// Three components in the frame `F`, in SI units (a magnetic field in µT).
pub struct Vector<F> {
    /// The components along the frame's x, y and z.
    pub v: DVec3,
    frame: PhantomData<fn() -> F>,
}

impl<F> Vector<F> {
    /// The null vector.
    pub const ZERO: Vector<F> = Vector::from_vec(DVec3::ZERO);

    /// From components along x, y and z.
    pub const fn new(x: f64, y: f64, z: f64) -> Self {
        Self::from_vec(DVec3::new(x, y, z))
    }

    /// From components whose frame is known to be `F`.
    pub const fn from_vec(v: DVec3) -> Self {
        Vector { v, frame: PhantomData }
    }

    /// The Euclidean length, in the vector's unit.
    pub fn length(self) -> f64 {
        self.v.length()
    }
}

impl<F> Clone for Vector<F> {
    fn clone(&self) -> Self {
        *self
    }
}
impl<F> Copy for Vector<F> {}
impl<F> PartialEq for Vector<F> {
    fn eq(&self, other: &Self) -> bool {
        self.v == other.v
    }
}
impl<F> Default for Vector<F> {
    fn default() -> Self {
        Self::ZERO
    }
}
impl<F> fmt::Debug for Vector<F> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "[{}, {}, {}]", self.v.x, self.v.y, self.v.z)
    }
}
impl<F> Add for Vector<F> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self::from_vec(self.v + other.v)
    }
}
impl<F> AddAssign for Vector<F> {
    fn add_assign(&mut self, other: Self) {
        self.v += other.v;
    }
}
impl<F> Sub for Vector<F> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self::from_vec(self.v - other.v)
    }
}
impl<F> Neg for Vector<F> {
    type Output = Self;
    fn neg(self) -> Self {
        Self::from_vec(-self.v)
    }
}
impl<F> Mul<f64> for Vector<F> {
    type Output = Self;
    fn mul(self, factor: f64) -> Self {
        Self::from_vec(self.v * factor)
    }
}
