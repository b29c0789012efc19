//! The classical Runge-Kutta method on the quaternion's components.

use super::{DOUBLE, Input, Method, MethodKind, Quaternion, Real, Triple};

pub(super) static KIND: MethodKind = MethodKind::of::<Rk4, 3>(
    "rk4",
    "classical Runge-Kutta on the four components, renormalised",
    4,
    Input::Rate(&[0.0, 0.5, 1.0]),
    DOUBLE,
    41,
);

/// The classical Runge-Kutta method on `q̇ = ½·q⊗w(t)` with the true rate at the middle, then renormalised.
///
/// Order 4; at constant rate a step errs by (|w|h)⁵/1920. Two new rates, four quaternion products and a square root
/// a step. Source: W. Kutta, *Beitrag zur näherungsweisen Integration totaler Differentialgleichungen*, Z. Math.
/// Phys. 46 (1901).
#[derive(Debug)]
pub struct Rk4;

impl Method<3> for Rk4 {
    fn turn<R: Real>(q: Quaternion<R>, h: R, &[left, middle, right]: &[Triple<R>; 3]) -> Quaternion<R> {
        let half = R::of(0.5) * h;
        let a = q.derivative(left);
        let b = (q + a * half).derivative(middle);
        let c = (q + b * half).derivative(middle);
        let d = (q + c * h).derivative(right);
        (q + (a + (b + c) * R::of(2.0) + d) * (h * R::of(1.0 / 6.0))).normalised()
    }
}
