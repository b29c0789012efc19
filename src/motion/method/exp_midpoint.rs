//! The exponential of the rate at the middle of the step.

use super::{DOUBLE, Input, Method, MethodKind, Quaternion, Real, Triple};

pub(super) static KIND: MethodKind = MethodKind::of::<ExpMidpoint, 1>(
    "exp-midpoint",
    "turns by the rate at the step's middle",
    2,
    Input::Rate(&[0.5]),
    DOUBLE,
    16,
);

/// `q ← q ⊗ exp(h·w(t + h/2))`, the Lie midpoint rule.
///
/// Order 2 with a quarter of [`ExpAverage`](super::ExpAverage)'s error under coning, exact at constant rate. One
/// rate, one quaternion product, a sine and a cosine a step. Source: A. Iserles, H. Munthe-Kaas, S. Nørsett,
/// A. Zanna, *Lie-group methods*, Acta Numerica 9 (2000): the Magnus series' first term by the midpoint rule.
#[derive(Debug)]
pub struct ExpMidpoint;

impl Method<1> for ExpMidpoint {
    fn turn<R: Real>(q: Quaternion<R>, h: R, &[w]: &[Triple<R>; 1]) -> Quaternion<R> {
        q * (w * h).exp()
    }
}
