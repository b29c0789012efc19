//! A polynomial through eight increments, and the attitude that follows from it.

use super::{DOUBLE, Input, Method, MethodKind, Quaternion, Real, Triple};

/// Increments in a step.
const N: usize = 8;
/// The most terms of the attitude's series: enough for about 70 rad a step in double precision.
const TERMS: usize = 96;

pub(super) static KIND: MethodKind = MethodKind::of::<PolynomialFit, N>(
    "polynomial-fit",
    "the exact attitude of the polynomial through eight increments (as QuatFIter)",
    10,
    Input::Increments(N),
    DOUBLE,
    463,
);

/// Fits the polynomial of degree 7 whose integrals are the eight increments, and solves `Q̇ = ½·Q⊗w` for it: `q ← q
/// ⊗ Q(−1)* ⊗ Q(1)`, with time in [−1, 1] and Q(0) = 1.
///
/// Q is the limit of Picard's iteration `Q ← 1 + ½∫Q⊗w`. For a polynomial w the limit is a power series in which
/// each coefficient follows from earlier ones, `Q_{k+1} = Σ_j Q_{k−j}⊗w_j / (2(k+1))`. One pass therefore reaches
/// it; the pass ends when eight coefficients in a row are negligible.
///
/// Order 10: the fit's remainder is of order 8, its integral vanishes at every sample, and the lowest remaining
/// term is odd about the middle. Eight increments, some 100 to 200 quaternion products a step, which is eight
/// samples long; no sine. Source: Y. Wu, *RodFIter: attitude reconstruction from inertial measurement by functional
/// iteration*, IEEE Trans. Aerospace and Electronic Systems 54 (2018); Y. Wu, G. Yan, *Attitude reconstruction from
/// inertial measurements: QuatFIter and its comparison with RodFIter*, ibid. 55 (2019). They iterate Chebyshev
/// coefficients.
#[derive(Debug)]
pub struct PolynomialFit;

impl Method<N> for PolynomialFit {
    fn turn<R: Real>(q: Quaternion<R>, _: R, increments: &[Triple<R>; N]) -> Quaternion<R> {
        let (before, after) = half_turns(&fit(increments));
        (q * before.conjugate() * after).normalised()
    }
}

/// The coefficients of w by powers of time over [−1, 1]. Only the deviations from the mean go through the matrix,
/// so that a constant rate is exact.
fn fit<R: Real>(increments: &[Triple<R>; N]) -> [Triple<R>; N] {
    let [first, rest @ ..] = increments;
    let mean = rest.iter().fold(*first, |sum, &a| sum + a) * R::of(1.0 / N as f64);
    let departures = increments.map(|a| a - mean);
    let mut coefficients = FIT.map(|row| {
        let [first, rest @ ..] = row.map(R::of);
        let terms = rest.into_iter().zip(&departures[1..]);
        terms.fold(departures[0] * first, |sum, (weight, &departure)| sum + departure * weight)
    });
    coefficients[0] = coefficients[0] + mean * R::of(N as f64 / 2.0);
    coefficients
}

/// Q(−1) and Q(1), as sums of the even and the odd terms of the series.
fn half_turns<R: Real>(w: &[Triple<R>; N]) -> (Quaternion<R>, Quaternion<R>) {
    let negligible = R::of(0.01) * R::EPSILON;
    let mut series = [Quaternion::<R>::identity(); TERMS];
    let nothing = series[0] * R::of(0.0);
    let (mut even, mut odd) = (series[0], nothing);
    let mut quiet = 0;
    for k in 1..TERMS {
        let products = w.iter().zip(series[..k].iter().rev()).map(|(&w, &q)| q.derivative(w));
        let term = products.fold(nothing, |sum, product| sum + product) * R::of(1.0 / k as f64);
        series[k] = term;
        let sum = if k % 2 == 0 { &mut even } else { &mut odd };
        *sum = *sum + term;
        quiet = if term.norm() < negligible { quiet + 1 } else { 0 };
        if quiet == N {
            break;
        }
    }
    (even + odd * R::of(-1.0), even + odd)
}

/// Row j, column m: the contribution of increment m to the coefficient of tʲ.
static FIT: [[f64; N]; N] = fit_matrix();

/// Interpolates the integral of w from −1 at y = −4, …, 4 = 4t, where it is the sum of the increments so far, and
/// differentiates it. Lagrange's polynomials there have integer coefficients over 8!, so each entry is rounded
/// once.
const fn fit_matrix() -> [[f64; N]; N] {
    let mut matrix = [[0.0; N]; N];
    let mut j = 0;
    while j < N {
        // The sum of increments at node k includes increment m if k > m: sum from the last node down.
        let mut sum = 0;
        let mut m = N;
        while m > 0 {
            sum += lagrange(m)[j + 1];
            m -= 1;
            let scale = 4_i64.pow(j as u32 + 1) * (j as i64 + 1);
            matrix[j][m] = (sum * scale) as f64 / 40_320.0;
        }
        j += 1;
    }
    matrix
}

/// 8! times the coefficients of the polynomial that is 1 at y = k − 4 and 0 at the other nodes.
const fn lagrange(k: usize) -> [i64; N + 1] {
    let mut coefficients = [0; N + 1];
    coefficients[0] = 1;
    let (mut denominator, mut node) = (1, 0);
    while node <= N {
        if node != k {
            let y = node as i64 - 4;
            denominator *= k as i64 - node as i64;
            let mut power = N;
            while power > 0 {
                coefficients[power] = coefficients[power - 1] - y * coefficients[power];
                power -= 1;
            }
            coefficients[0] *= -y;
        }
        node += 1;
    }
    let mut power = 0;
    while power <= N {
        coefficients[power] *= 40_320 / denominator;
        power += 1;
    }
    coefficients
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    #[test]
    fn the_fit_gives_back_a_polynomial_from_its_integrals() {
        let given: [f64; N] = [0.3, -1.0, 2.0, 0.5, -0.25, 4.0, 1.5, -3.0];
        let integral = |t: f64| (0..N).map(|j| given[j] * t.powi(j as i32 + 1) / (j + 1) as f64).sum::<f64>();
        let increments = std::array::from_fn(|k| {
            let edge = |k: usize| integral(k as f64 / 4.0 - 1.0);
            Triple::<f64>::from(DVec3::new(edge(k + 1) - edge(k), 0.0, 0.0))
        });
        for (found, given) in fit(&increments).iter().zip(given) {
            assert!((found.x - given).abs() < 1e-12, "{} for {given}", found.x);
        }
    }

    #[test]
    fn the_series_of_a_constant_rate_is_the_exponential() {
        for angle in [1e-12, 0.1, 3.0, 20.0] {
            let turn = Triple::<f64>::from(DVec3::new(0.6, -0.48, 0.64) * angle);
            let stepped = PolynomialFit::turn(Quaternion::identity(), 1.0, &[turn * (1.0 / 8.0); N]);
            let off = (stepped + turn.exp() * -1.0).norm();
            assert!(off < 1e-15 * (1.0 + libm::exp(angle / 4.0)), "{angle}: {off}");
        }
    }
}
