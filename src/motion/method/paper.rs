//! The step of Assad and Serikov, as printed.

use super::{BOTH, Input, Method, MethodKind, Quaternion, Real, Triple};

pub(super) static KIND: MethodKind = MethodKind::of::<Paper, 2>(
    "paper",
    "Assad & Serikov 2024 as printed: cos(θ/2) with w·dt/2, not renormalised",
    2,
    Input::Rate(&[0.0, 1.0]),
    BOTH,
    14,
);

/// `q ← q ⊗ [cos(θ/2), w_c·h/2]` with `w_c = (w(t) + w(t+h))/2`, `θ = h·|w_c|`: the exponential of the averaged
/// rate without its factor `sin(θ/2)/(θ/2)` on the vector part.
///
/// Order 2. Each step the norm grows by (θ/2)⁴/6 and the angle errs by θ³/24. One new rate (the other was the
/// last step's), one quaternion product, one cosine a step. Source: A. Assad, S. A. Serikov, *Modeling sensors of UAV
/// for generating dataset of simulated experiments to evaluate attitude estimation algorithms*, SPbPU 2024,
/// doi 10.18720/SPBPU/2/id24-105: `q_{k+1} = (cos(θ/2)·I₄ + ½·Ω(w_c)·dt)·q_k`.
#[derive(Debug)]
pub struct Paper;

impl Method<2> for Paper {
    fn turn<R: Real>(q: Quaternion<R>, h: R, &[a, b]: &[Triple<R>; 2]) -> Quaternion<R> {
        let half = (a + b) * (R::of(0.25) * h);
        q * Quaternion { w: half.length().sin_cos().1, v: half }
    }
}
