//! Euler's method.

use super::{BOTH, Input, Method, MethodKind, Quaternion, Real, Triple};

pub(super) static KIND: MethodKind = MethodKind::of::<Euler, 1>(
    "euler",
    "one linear step from the rate at its start, renormalised",
    1,
    Input::Rate(&[0.0]),
    BOTH,
    17,
);

/// `q ← (q + h·½·q⊗w(t)) / |…|`: the tangent at the step's start.
///
/// Order 1; order 2 at constant rate, where a step errs by (|w|h)³/12. One rate, one quaternion product and a
/// square root a step. Source: L. Euler, *Institutionum calculi integralis* I (1768); every flight code adds the
/// renormalising.
#[derive(Debug)]
pub struct Euler;

impl Method<1> for Euler {
    fn turn<R: Real>(q: Quaternion<R>, h: R, &[w]: &[Triple<R>; 1]) -> Quaternion<R> {
        (q + q.derivative(w) * h).normalised()
    }
}
