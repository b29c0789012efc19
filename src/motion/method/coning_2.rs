//! Two increments with a coning term.

use super::{BOTH, Input, Method, MethodKind, Quaternion, Real, Triple};

pub(super) static KIND: MethodKind = MethodKind::of::<Coning2, 2>(
    "coning-2",
    "one exponential from two increments and their coning term",
    4,
    Input::Increments(2),
    BOTH,
    18,
);

/// `q ← q ⊗ exp(a + b + 2/3·a×b)`.
///
/// Order 4, and so is its drift under coning. Two increments, one quaternion product, a sine and a cosine a step,
/// which is two samples long. Source: R. Miller, *A new strapdown attitude algorithm*, J. Guidance, Control, and
/// Dynamics 6 (1983); M. Ignagni, *Optimal strapdown attitude integration algorithms*, ibid. 13 (1990).
#[derive(Debug)]
pub struct Coning2;

impl Method<2> for Coning2 {
    fn turn<R: Real>(q: Quaternion<R>, _: R, &[a, b]: &[Triple<R>; 2]) -> Quaternion<R> {
        q * (a + b + a.cross(b) * R::of(2.0 / 3.0)).exp()
    }
}
