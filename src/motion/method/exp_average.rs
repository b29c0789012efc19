//! The exponential of the average of the two end rates.

use super::{BOTH, Input, Method, MethodKind, Quaternion, Real, Triple};

pub(super) static KIND: MethodKind = MethodKind::of::<ExpAverage, 2>(
    "exp-average",
    "turns by the mean of the rates at the step's ends: the paper's method with its sine",
    2,
    Input::Rate(&[0.0, 1.0]),
    BOTH,
    16,
);

/// `q ← q ⊗ exp(h·(w(t) + w(t+h))/2)`.
///
/// Order 2, exact at constant rate. One new rate, one quaternion product, a sine and a cosine a step. It is the
/// straightforward way to use samples of a gyroscope in a filter. Source: A. Iserles, H. Munthe-Kaas, S. Nørsett,
/// A. Zanna, *Lie-group methods*, Acta Numerica 9 (2000): the Magnus series' first term by the trapezoidal rule.
#[derive(Debug)]
pub struct ExpAverage;

impl Method<2> for ExpAverage {
    fn turn<R: Real>(q: Quaternion<R>, h: R, &[a, b]: &[Triple<R>; 2]) -> Quaternion<R> {
        q * ((a + b) * (R::of(0.5) * h)).exp()
    }
}
