//! The number types of a method.

use std::fmt::Debug;
use std::ops::{Add, Div, Mul, Neg, Sub};

use super::{MethodKind, Run};

/// Single or double precision: the operations that a method needs of a number.
///
/// Elementary functions come from `libm`, so that a result does not depend on the machine.
pub trait Real:
    Copy
    + Debug
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + Send
    + Sync
    + 'static
{
    /// Its name in the study's `precision` column.
    const NAME: &'static str;
    /// Below it `sin(x)/x` rounds to 1: the next term, x²/6, is under half a unit in the last place.
    const TINY: Self;
    /// The distance from 1 to the next number.
    const EPSILON: Self;

    /// The nearest number of this precision; the compiler folds a constant `x`.
    fn of(x: f64) -> Self;
    /// The same number in double precision.
    fn double(self) -> f64;
    /// The square root.
    fn sqrt(self) -> Self;
    /// Sine and cosine of an angle in radians.
    fn sin_cos(self) -> (Self, Self);
    /// Whether it is neither infinite nor NaN.
    fn is_finite(self) -> bool;
    /// The function that runs `method` in this precision.
    fn runner(method: &MethodKind) -> Run<Self>;
}

impl Real for f64 {
    const NAME: &'static str = "f64";
    const TINY: f64 = 1e-8;
    const EPSILON: f64 = f64::EPSILON;

    fn of(x: f64) -> f64 {
        x
    }
    fn double(self) -> f64 {
        self
    }
    fn sqrt(self) -> f64 {
        libm::sqrt(self)
    }
    fn sin_cos(self) -> (f64, f64) {
        libm::sincos(self)
    }
    fn is_finite(self) -> bool {
        self.is_finite()
    }
    fn runner(method: &MethodKind) -> Run<f64> {
        method.double
    }
}

impl Real for f32 {
    const NAME: &'static str = "f32";
    const TINY: f32 = 3e-4;
    const EPSILON: f32 = f32::EPSILON;

    fn of(x: f64) -> f32 {
        x as f32
    }
    fn double(self) -> f64 {
        f64::from(self)
    }
    fn sqrt(self) -> f32 {
        libm::sqrtf(self)
    }
    fn sin_cos(self) -> (f32, f32) {
        libm::sincosf(self)
    }
    fn is_finite(self) -> bool {
        self.is_finite()
    }
    fn runner(method: &MethodKind) -> Run<f32> {
        method.single
    }
}
