//! Three increments with Miller's coning term.

use super::{DOUBLE, Input, Method, MethodKind, Quaternion, Real, Triple};

pub(super) static KIND: MethodKind = MethodKind::of::<Coning3, 3>(
    "coning-3",
    "one exponential from three increments and Miller's coning term",
    4,
    Input::Increments(3),
    DOUBLE,
    19,
);

/// `q ← q ⊗ exp(a + b + c + 9/20·a×c + 27/40·b×(c − a))`.
///
/// Order 4 on smooth motion; its drift under coning is of order 6, for which the two coefficients were chosen.
/// Three increments, one quaternion product, a sine and a cosine a step, which is three samples long. Source:
/// R. Miller, *A new strapdown attitude algorithm*, J. Guidance, Control, and Dynamics 6 (1983).
#[derive(Debug)]
pub struct Coning3;

impl Method<3> for Coning3 {
    fn turn<R: Real>(q: Quaternion<R>, _: R, &[a, b, c]: &[Triple<R>; 3]) -> Quaternion<R> {
        let coning = a.cross(c) * R::of(9.0 / 20.0) + b.cross(c - a) * R::of(27.0 / 40.0);
        q * (a + b + c + coning).exp()
    }
}
