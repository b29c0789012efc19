//! The step of Assad and Serikov, renormalised.

use super::{DOUBLE, Input, Method, MethodKind, Paper, Quaternion, Real, Triple};

pub(super) static KIND: MethodKind = MethodKind::of::<PaperNormalised, 2>(
    "paper-normalised",
    "the paper's step, renormalised after each",
    2,
    Input::Rate(&[0.0, 1.0]),
    DOUBLE,
    19,
);

/// [`Paper`]'s step divided by its norm: the norm no longer grows, but the angle still errs by θ³/24 a step.
///
/// Order 2. One new rate, one quaternion product, one cosine and a square root a step. Source: as [`Paper`].
#[derive(Debug)]
pub struct PaperNormalised;

impl Method<2> for PaperNormalised {
    fn turn<R: Real>(q: Quaternion<R>, h: R, inputs: &[Triple<R>; 2]) -> Quaternion<R> {
        Paper::turn(q, h, inputs).normalised()
    }
}
