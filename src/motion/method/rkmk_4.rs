//! Runge, Kutta and Munthe-Kaas: the classical method applied to the rotation vector.

use super::{DOUBLE, Input, Method, MethodKind, Quaternion, Real, Triple};

pub(super) static KIND: MethodKind = MethodKind::of::<Rkmk4, 3>(
    "rkmk-4",
    "classical Runge-Kutta on the rotation vector, one exponential",
    4,
    Input::Rate(&[0.0, 0.5, 1.0]),
    DOUBLE,
    38,
);

/// The classical Runge-Kutta method on the rotation vector's equation `φ̇ = w + ½·φ×w + 1/12·φ×(φ×w)`, then `q ← q
/// ⊗ exp(φ)`. The omitted terms of the series, from φ⁴ on, are beyond the order.
///
/// Order 4, exact at constant rate. Two new rates, one quaternion product, a sine and a cosine a step. Source: H.
/// Munthe-Kaas, *High order Runge-Kutta methods on manifolds*, Applied Numerical Mathematics 29 (1999); the
/// equation with body rates is J. Bortz's (1971).
#[derive(Debug)]
pub struct Rkmk4;

impl Method<3> for Rkmk4 {
    fn turn<R: Real>(q: Quaternion<R>, h: R, &[left, middle, right]: &[Triple<R>; 3]) -> Quaternion<R> {
        let bortz = |phi: Triple<R>, w: Triple<R>| {
            let once = phi.cross(w);
            (w + once * R::of(0.5) + phi.cross(once) * R::of(1.0 / 12.0)) * h
        };
        let a = left * h;
        let b = bortz(a * R::of(0.5), middle);
        let c = bortz(b * R::of(0.5), middle);
        let d = bortz(c, right);
        q * ((a + (b + c) * R::of(2.0) + d) * R::of(1.0 / 6.0)).exp()
    }
}
