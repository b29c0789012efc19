//! The Magnus series to fourth order.

use super::{BOTH, Input, Method, MethodKind, Quaternion, Real, Triple};

/// √3.
const ROOT_3: f64 = 1.732_050_807_568_877_2;

pub(super) static KIND: MethodKind = MethodKind::of::<Magnus4, 2>(
    "magnus-4",
    "one exponential from the rates at two Gauss points",
    4,
    Input::Rate(&[0.5 - ROOT_3 / 6.0, 0.5 + ROOT_3 / 6.0]),
    BOTH,
    19,
);

/// `q ← q ⊗ exp(h/2·(w₁ + w₂) + √3/12·h²·w₁×w₂)`, w₁ and w₂ at the Gauss points `½ ∓ √3/6` of the step.
///
/// Order 4, exact at constant rate. Two rates, one quaternion product, a sine and a cosine a step. Source:
/// A. Iserles, S. Nørsett, *On the solution of linear differential equations in Lie groups*, Phil. Trans. R. Soc.
/// A 357 (1999); S. Blanes, F. Casas, J. Oteo, J. Ros, *The Magnus expansion and some of its applications*,
/// Physics Reports 470 (2009). Their matrices act from the left; here the commutator changes sign.
#[derive(Debug)]
pub struct Magnus4;

impl Method<2> for Magnus4 {
    fn turn<R: Real>(q: Quaternion<R>, h: R, &[a, b]: &[Triple<R>; 2]) -> Quaternion<R> {
        let twist = a.cross(b) * (R::of(ROOT_3 / 12.0) * h * h);
        q * ((a + b) * (R::of(0.5) * h) + twist).exp()
    }
}
