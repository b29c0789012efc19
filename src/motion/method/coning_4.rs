//! Four increments with a coning term.

use super::{DOUBLE, Input, Method, MethodKind, Quaternion, Real, Triple};

pub(super) static KIND: MethodKind = MethodKind::of::<Coning4, 4>(
    "coning-4",
    "one exponential from four increments and their compressed coning term",
    3,
    Input::Increments(4),
    DOUBLE,
    18,
);

/// `q ← q ⊗ exp(a + b + c + d + (54·a + 92·b + 214·c)/105 × d)`.
///
/// Order 3 on smooth motion; its drift under narrow coning is of order 8. Under coning, products of increments the
/// same number of samples apart are equal, so they are gathered on d ("compressed"). That is exact there, but no
/// longer even in time, so a manoeuvre costs an order. Four increments, one quaternion product, a sine and a cosine
/// a step, which is four samples long. Source: M. Ignagni, *Efficient class of optimized coning compensation
/// algorithms*, J. Guidance, Control, and Dynamics 19 (1996).
#[derive(Debug)]
pub struct Coning4;

impl Method<4> for Coning4 {
    fn turn<R: Real>(q: Quaternion<R>, _: R, &[a, b, c, d]: &[Triple<R>; 4]) -> Quaternion<R> {
        let weighted = a * R::of(54.0 / 105.0) + b * R::of(92.0 / 105.0) + c * R::of(214.0 / 105.0);
        q * (a + b + c + d + weighted.cross(d)).exp()
    }
}
