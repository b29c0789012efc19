//! A polynomial through four increments, and the attitude that follows from it.

use super::legendre::{fit, rows};
use super::{DOUBLE, Input, Method, MethodKind, Quaternion, Real, Triple};

/// Increments in a step.
const N: usize = 4;

pub(super) static KIND: MethodKind = MethodKind::of::<PolynomialFit4, N>(
    "polynomial-fit-4",
    "one exponential from the polynomial through four increments",
    6,
    Input::Increments(N),
    DOUBLE,
    30,
);

/// Fits the polynomial of degree 3 whose integrals are the four increments, `w(t) = Σ l_n·P_n(t)` in Legendre
/// polynomials over the step, and turns by the exponential of its Magnus series up to grade 5, with `c = l0 × l1`:
///
/// `q ← q ⊗ exp(2·l0 + 2/3·c + 2/15·(l1 × (l2 − c) + l0 × (l0 × (l2 − c/3))))`.
///
/// Order 6, as [`PolynomialFit`](super::PolynomialFit) of half as many increments; a jump of the rate falls inside
/// half as many of its steps. Four increments, one quaternion product, a sine and a cosine a step, which is four
/// samples long. Sources: as there.
#[derive(Debug)]
pub struct PolynomialFit4;

impl Method<N> for PolynomialFit4 {
    fn turn<R: Real>(q: Quaternion<R>, _: R, increments: &[Triple<R>; N]) -> Quaternion<R> {
        q * rotation(&fit(&ROWS, increments)).exp()
    }
}

static ROWS: [[f64; N]; N] = rows();

/// The rotation vector over the step.
#[inline(always)]
fn rotation<R: Real>(&[l0, l1, l2]: &[Triple<R>; 3]) -> Triple<R> {
    let c = l0.cross(l1);
    let five = l1.cross(l2 - c) + l0.cross(l0.cross(l2 - c * R::of(1.0 / 3.0)));
    l0 * R::of(2.0) + c * R::of(2.0 / 3.0) + five * R::of(2.0 / 15.0)
}

#[cfg(test)]
mod tests {
    use super::super::legendre::tests::local_order;
    use super::*;
    use glam::DVec3;

    #[test]
    fn the_rotation_is_that_of_the_polynomial_up_to_grade_five() {
        let of = |l: &[DVec3]| {
            let v = rotation(&[l[0], l[1], l[2]].map(Triple::<f64>::from));
            DVec3::new(v.x, v.y, v.z)
        };
        let order = local_order(N, 0, 0.1, of);
        assert!((order - 7.0).abs() < 0.3, "{order}");
        let order = local_order(N, 0, 0.1, |l| of(l) + l[1].cross(l[2]) * 0.02);
        assert!((order - 5.0).abs() < 0.3, "{order}");
    }
}
