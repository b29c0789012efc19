//! A polynomial through eight increments, and the attitude that follows from it.

use super::legendre::{fit, rows};
use super::{DOUBLE, Input, Method, MethodKind, Quaternion, Real, Triple};

/// Increments in a step.
const N: usize = 8;

pub(super) static KIND: MethodKind = MethodKind::of::<PolynomialFit, N>(
    "polynomial-fit",
    "one exponential from the polynomial through eight increments",
    10,
    Input::Increments(N),
    DOUBLE,
    69,
);

/// Fits the polynomial of degree 7 whose integrals are the eight increments, `w(t) = Σ l_n·P_n(t)` in Legendre
/// polynomials over the step, and turns by the exponential of its Magnus series:
///
/// `q ← q ⊗ exp(2·l0 + Σ 2/(4(n + 1)² − 1)·l_n × l_{n+1} + products of three and more)`.
///
/// Products of two are complete: neighbours alone remain, because Legendre polynomials are orthogonal. A product of
/// more grows with the step to the power of its grade, the sum of n + 1 over its factors; even grades vanish, and all
/// up to grade 9 are there. Nested products of vectors reduce to inner products times `l_n` or times `l_m × l_n`,
/// which the two functions below add up. Their fractions follow from the logarithm of the time-ordered product of
/// the attitude's equation, in exact arithmetic.
///
/// Order 10: the fit's remainder is of order 8, its integral vanishes at every sample, and the lowest remaining
/// term is odd about the middle. Eight increments, one quaternion product, a sine and a cosine a step, which is eight
/// samples long. Source of the series: W. Magnus, *On the exponential solution of differential equations for a linear
/// operator*, Comm. Pure Appl. Math. 7 (1954); S. Blanes, F. Casas, J. A. Oteo, J. Ros, *The Magnus expansion and some
/// of its applications*, Physics Reports 470 (2009).
///
/// QuatFIter (Y. Wu, G. Yan, arXiv 1901.03468) and RodFIter, the method of patent application US 2021/0048297, start
/// from the same fit and iterate an integral equation on Chebyshev coefficients of the quaternion or the Rodrigues
/// vector, which they truncate at every iteration. Here nothing iterates, and there are no coefficients of the
/// attitude.
#[derive(Debug)]
pub struct PolynomialFit;

impl Method<N> for PolynomialFit {
    fn turn<R: Real>(q: Quaternion<R>, _: R, increments: &[Triple<R>; N]) -> Quaternion<R> {
        q * rotation(&fit(&ROWS, increments)).exp()
    }
}

static ROWS: [[f64; N]; N] = rows();

/// The rotation vector over the step.
#[inline(always)]
fn rotation<R: Real>(l: &[Triple<R>; N]) -> Triple<R> {
    along(l) + across(l)
}

/// Products of an odd number of factors: inner products times `l_n`.
#[inline(always)]
fn along<R: Real>(l: &[Triple<R>; N]) -> Triple<R> {
    let r = R::of;
    let d = |i: usize, j: usize| l[i].dot(l[j]);
    let a = d(0, 0);
    let first = r(2.0)
        + r(2.0 / 15.0) * (d(0, 2) - d(1, 1))
        + r(2.0 / 105.0) * (d(1, 3) - d(2, 2))
        + r(2.0 / 315.0) * (d(2, 4) - d(3, 3))
        + a * (r(4.0 / 315.0) * d(0, 2) - r(16.0 / 945.0) * d(1, 1) - r(2.0 / 945.0) * d(0, 4)
            + r(8.0 / 945.0) * d(1, 3)
            - r(2.0 / 315.0) * d(2, 2)
            + a * (r(2.0 / 1575.0) * d(0, 2) - r(2.0 / 945.0) * d(1, 1)))
        + d(0, 1)
            * (d(0, 1) * (r(4.0 / 945.0) + r(4.0 / 4725.0) * a) - r(2.0 / 945.0) * d(0, 3)
                + r(2.0 / 135.0) * d(1, 2))
        + d(0, 2) * (r(2.0 / 315.0) * d(0, 2) - r(4.0 / 189.0) * d(1, 1))
        + r(2.0 / 945.0) * d(1, 1) * d(1, 1);
    let second = r(2.0 / 15.0) * d(0, 1)
        + r(4.0 / 105.0) * (d(0, 3) - d(1, 2))
        + r(2.0 / 315.0) * (d(1, 4) - d(2, 3))
        + a * (r(4.0 / 315.0) * d(0, 1) + r(2.0 / 945.0) * d(0, 3) - r(2.0 / 105.0) * d(1, 2)
            + r(2.0 / 1575.0) * a * d(0, 1))
        + d(0, 1) * (r(2.0 / 105.0) * d(0, 2) - r(2.0 / 945.0) * d(1, 1));
    let third = r(2.0 / 105.0) * (d(0, 2) + r(2.0) * d(1, 1) + d(0, 4) - d(1, 3))
        - r(2.0 / 135.0) * d(0, 1) * d(0, 1)
        - a * (r(2.0 / 15.0) - r(4.0 / 189.0) * d(1, 1) + a * (r(4.0 / 315.0) + r(2.0 / 1575.0) * a));
    let fourth =
        r(2.0 / 315.0) * d(0, 3) + r(8.0 / 315.0) * d(1, 2) - d(0, 1) * (r(2.0 / 35.0) + r(8.0 / 945.0) * a);
    let fifth = r(2.0 / 945.0) * a * a - r(8.0 / 315.0) * d(0, 2) - r(2.0 / 315.0) * d(1, 1);
    l[0] * first + l[1] * second + l[2] * third + l[3] * fourth + l[4] * fifth
}

/// Products of an even number of factors: inner products times `l_m × l_n`.
#[inline(always)]
fn across<R: Real>(l: &[Triple<R>; N]) -> Triple<R> {
    let r = R::of;
    let d = |i: usize, j: usize| l[i].dot(l[j]);
    let a = d(0, 0);
    let second = r(2.0 / 3.0) + r(4.0 / 63.0) * d(0, 2) - r(2.0 / 105.0) * (d(1, 1) + d(2, 2))
        + r(4.0 / 945.0) * d(0, 4)
        + r(2.0 / 135.0) * d(1, 3)
        + r(2.0 / 945.0) * d(0, 1) * d(0, 1)
        + a * (r(2.0 / 45.0) + r(44.0 / 4725.0) * d(0, 2) - r(4.0 / 945.0) * d(1, 1)
            + a * (r(4.0 / 945.0) + r(2.0 / 4725.0) * a));
    let third = r(2.0 / 315.0) * d(0, 3) + r(4.0 / 315.0) * d(1, 2)
        - d(0, 1) * (r(8.0 / 315.0) + r(8.0 / 1575.0) * a);
    let fourth = a * (r(-2.0 / 105.0) - r(2.0 / 945.0) * a) - r(8.0 / 945.0) * d(1, 1);
    let with_first = l[1] * second + l[2] * third + l[3] * fourth - l[4] * (r(2.0 / 189.0) * d(0, 1));
    let third = r(2.0 / 15.0) + a * (r(2.0 / 35.0) + r(8.0 / 945.0) * a)
        - r(4.0 / 315.0) * d(0, 2)
        - r(2.0 / 315.0) * d(1, 1);
    let with_second = l[2] * third + l[3] * (r(4.0 / 189.0) * d(0, 1)) - l[4] * (r(2.0 / 945.0) * a);
    let with_fourth = l[4] * r(2.0 / 63.0) - l[2] * (r(2.0 / 35.0) + r(2.0 / 315.0) * a);
    // Beyond grade 9 products of two only.
    let with_sixth = l[6] * r(2.0 / 143.0) - l[4] * r(2.0 / 99.0);
    l[0].cross(with_first)
        + l[1].cross(with_second)
        + l[3].cross(with_fourth)
        + l[5].cross(with_sixth)
        + l[6].cross(l[7] * r(2.0 / 195.0))
}

#[cfg(test)]
mod tests {
    use super::super::legendre::tests::{attitude, local_order, vectors};
    use super::*;
    use crate::geometry::exp;
    use glam::DVec3;

    fn found(l: &[DVec3]) -> DVec3 {
        let v = rotation(&std::array::from_fn(|n| Triple::<f64>::from(l[n])));
        DVec3::new(v.x, v.y, v.z)
    }

    #[test]
    fn the_rotation_is_that_of_the_polynomial_up_to_grade_nine() {
        for set in 0..8 {
            let order = local_order(N, set, 0.4, found);
            assert!((order - 11.0).abs() < 0.4, "{set}: {order}");
        }
        // Without one of the terms of grade 9 it is not.
        let wrong = |l: &[DVec3]| found(l) + l[0].cross(l[4]) * (l[0].dot(l[1]) * 2.0 / 189.0);
        let order = local_order(N, 0, 0.4, wrong);
        assert!((order - 9.0).abs() < 0.5, "{order}");
    }

    #[test]
    fn products_of_two_are_complete() {
        let l = vectors(N, 0).map(|v| v * 1e-4).collect::<Vec<_>>();
        let off = |rotation: DVec3| (exp(rotation).inverse() * attitude(&l)).xyz().length();
        assert!(off(found(&l)) < 2e-12, "{}", off(found(&l)));
        for (n, denominator) in (4..7).zip([99.0, 143.0, 195.0]) {
            assert!(off(found(&l) - l[n].cross(l[n + 1]) * 2.0 / denominator) > 1e-11, "{n}");
        }
    }

    #[test]
    fn a_constant_rate_turns_by_the_exponential() {
        for angle in [1e-12, 0.1, 3.0, 20.0] {
            let turn = Triple::<f64>::from(DVec3::new(0.6, -0.48, 0.64) * angle);
            let stepped = PolynomialFit::turn(Quaternion::identity(), 1.0, &[turn * (1.0 / 8.0); N]);
            let off = (stepped + turn.exp() * -1.0).norm();
            assert!(off < 1e-15 * (1.0 + libm::exp(angle / 4.0)), "{angle}: {off}");
        }
    }
}
