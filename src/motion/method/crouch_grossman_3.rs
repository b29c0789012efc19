//! Crouch and Grossman's three-stage method.

use super::{DOUBLE, Input, Method, MethodKind, Quaternion, Real, Triple};

pub(super) static KIND: MethodKind = MethodKind::of::<CrouchGrossman3, 3>(
    "crouch-grossman-3",
    "three exponentials in sequence",
    3,
    Input::Rate(&[0.0, 3.0 / 4.0, 17.0 / 24.0]),
    DOUBLE,
    44,
);

/// `q ← q ⊗ exp(b₁h·w(t)) ⊗ exp(b₂h·w(t + ¾h)) ⊗ exp(b₃h·w(t + 17/24·h))` with b = (13/51, −2/3, 24/17).
///
/// Order 3, exact at constant rate. Three rates, three quaternion products, three sines and cosines a step.
/// Source: P. E. Crouch, R. Grossman, *Numerical integration of ordinary differential equations on manifolds*,
/// J. Nonlinear Science 3 (1993); E. Hairer, C. Lubich, G. Wanner, *Geometric Numerical Integration*, IV.8.
#[derive(Debug)]
pub struct CrouchGrossman3;

impl Method<3> for CrouchGrossman3 {
    fn turn<R: Real>(q: Quaternion<R>, h: R, &[a, b, c]: &[Triple<R>; 3]) -> Quaternion<R> {
        let stage = |w: Triple<R>, weight: f64| (w * (R::of(weight) * h)).exp();
        q * stage(a, 13.0 / 51.0) * stage(b, -2.0 / 3.0) * stage(c, 24.0 / 17.0)
    }
}
