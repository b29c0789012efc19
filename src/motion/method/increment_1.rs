//! The exponential of one increment.

use super::{DOUBLE, Input, Method, MethodKind, Quaternion, Real, Triple};

pub(super) static KIND: MethodKind = MethodKind::of::<Increment1, 1>(
    "increment-1",
    "turns by the integral of the rate",
    2,
    Input::Increments(1),
    DOUBLE,
    15,
);

/// `q ← q ⊗ exp(a)`, where a is the integral of the rate over the step.
///
/// Order 2, exact while the axis of rotation does not turn. Under coning of half-angle a at W rad/s it drifts by
/// `½·W·sin²(a)·(1 − sin(Wh)/(Wh))` rad/s. One increment, one quaternion product, a sine and a cosine a step.
/// Source: P. Savage, *Strapdown inertial navigation integration algorithm design part 1*, J. Guidance, Control,
/// and Dynamics 21 (1998), without its coning term.
#[derive(Debug)]
pub struct Increment1;

impl Method<1> for Increment1 {
    fn turn<R: Real>(q: Quaternion<R>, _: R, &[a]: &[Triple<R>; 1]) -> Quaternion<R> {
        q * a.exp()
    }
}
