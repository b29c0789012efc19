//! The polynomial through a step's increments, in Legendre polynomials over the step.

use super::{Real, Triple};

/// The coefficients `l_n` of `w(t) = Σ l_n·P_n(t)`, t in [−1, 1], whose integrals over the `N` equal parts are the
/// increments: the first `K` of them, in units of the increments. `N` is even.
///
/// Even coefficients are sums over pairs of increments at the same distance from the middle, odd ones differences.
#[inline(always)]
pub(super) fn fit<R: Real, const N: usize, const K: usize>(
    rows: &[[f64; N]; N],
    increments: &[Triple<R>; N],
) -> [Triple<R>; K] {
    let other = |m: usize| increments[N - 1 - m];
    let sums: [_; N] = std::array::from_fn(|m| increments[m] + other(m));
    let differences: [_; N] = std::array::from_fn(|m| increments[m] - other(m));
    std::array::from_fn(|n| {
        let pairs = if n.is_multiple_of(2) { &sums } else { &differences };
        let first = pairs[0] * R::of(rows[n][0]);
        (1..N / 2).fold(first, |sum, m| sum + pairs[m] * R::of(rows[n][m]))
    })
}

/// Row n, column m: the contribution of increment m to `l_n`, for `N` increments, at most eight.
///
/// Interpolates the integral of w at the ends of the increments, where it is the sum of those so far, differentiates,
/// and rewrites the powers of t as Legendre polynomials. All in integers, so that each entry is rounded once.
pub(super) const fn rows<const N: usize>() -> [[f64; N]; N] {
    let mut rows = [[0.0; N]; N];
    let scale = (1 << N) as f64 * product(N, 1) as f64 * HIGHEST as f64;
    let mut n = 0;
    while n < N {
        // The sum of increments at node k includes increment m if k > m: sum from the last node down.
        let mut sum = 0;
        let mut m = N;
        while m > 0 {
            sum += slope(m, n, N);
            m -= 1;
            rows[n][m] = sum as f64 / scale;
        }
        n += 1;
    }
    rows
}

/// 15!!, a multiple of every odd denominator.
const HIGHEST: i128 = product(15, 2);

/// `n·(n − step)·(n − 2·step)…` down to 1.
const fn product(n: usize, step: usize) -> i128 {
    let (mut product, mut factor) = (1, n);
    while factor > 1 {
        product *= factor as i128;
        factor = factor.saturating_sub(step);
    }
    product
}

/// The coefficient at `P_n` of the slope of Lagrange's polynomial of node k, times 2ᴺ·N!·15!!.
const fn slope(k: usize, n: usize, intervals: usize) -> i128 {
    let lagrange = lagrange(k, intervals);
    let (mut sum, mut power) = (0, n + 1);
    while power <= intervals {
        // With y = N·t, the slope of yᵖ is p·Nᵖ·tᵖ⁻¹.
        let slope = power as i128 * (intervals as i128).pow(power as u32);
        sum += lagrange[power] * slope * legendre(power - 1, n);
        power += 2;
    }
    sum
}

/// The coefficient at `P_n` of tʲ, times 15!!: `(2n + 1)·j! / ((j − n)!!·(j + n + 1)!!)`; j − n is even.
const fn legendre(j: usize, n: usize) -> i128 {
    let whole = product(j, 1) / product(j - n, 2);
    (2 * n as i128 + 1) * whole * (HIGHEST / product(j + n + 1, 2))
}

/// 2ᴺ·N! times the coefficients of the polynomial that is 1 at y = 2k − N and 0 at the other nodes −N, 2 − N, …, N.
const fn lagrange(k: usize, intervals: usize) -> [i128; 9] {
    let mut coefficients = [0; 9];
    coefficients[0] = 1;
    let mut node = 0;
    while node <= intervals {
        if node != k {
            let y = 2 * node as i128 - intervals as i128;
            let mut power = intervals;
            while power > 0 {
                coefficients[power] = coefficients[power - 1] - y * coefficients[power];
                power -= 1;
            }
            coefficients[0] *= -y;
        }
        node += 1;
    }
    // The denominator is 2ᴺ·k!·(N − k)!, negative for an odd N − k.
    let binomial = product(intervals, 1) / (product(k, 1) * product(intervals - k, 1));
    let sign = if (intervals - k).is_multiple_of(2) { binomial } else { -binomial };
    let mut power = 0;
    while power <= intervals {
        coefficients[power] *= sign;
        power += 1;
    }
    coefficients
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::motion::method::{Magnus4, Method, Quaternion};
    use glam::{DQuat, DVec3};

    /// `Σ l_n·P_n(t)`.
    fn value(l: &[DVec3], t: f64) -> DVec3 {
        let (mut last, mut p, mut sum) = (1.0, t, l[0]);
        for (n, l) in (1..).zip(&l[1..]) {
            sum += *l * p;
            let n = f64::from(n);
            (last, p) = (p, ((2.0 * n + 1.0) * t * p - n * last) / (n + 1.0));
        }
        sum
    }

    /// The attitude after the rate `Σ l_n·P_n(t)` from t = −1 to 1, in steps of a method that knows nothing of it.
    pub fn attitude(l: &[DVec3]) -> DQuat {
        const STEPS: i32 = 2000;
        let h = 2.0 / f64::from(STEPS);
        let turn = |q, step: i32| {
            let rate = |part: f64| Triple::from(value(l, -1.0 + h * (f64::from(step) + part)));
            let away = 3.0_f64.sqrt() / 6.0;
            Magnus4::turn(q, h, &[rate(0.5 - away), rate(0.5 + away)])
        };
        DQuat::from((0..STEPS).fold(Quaternion::<f64>::identity(), turn)).normalize()
    }

    /// Vectors without a pattern; each `set` has its own.
    pub fn vectors(count: usize, set: usize) -> impl Iterator<Item = DVec3> {
        let part = move |n: usize, k: usize| libm::sin((31 * set + 7 * n + 3 * k + 1) as f64 * 1.7);
        (0..count).map(move |n| DVec3::new(part(n, 0), part(n, 1), part(n, 2)))
    }

    /// The power of the step length with which the error of `rotation` falls in one step: `l_n` goes with the
    /// power n + 1.
    pub fn local_order(count: usize, set: usize, step: f64, rotation: impl Fn(&[DVec3]) -> DVec3) -> f64 {
        let off = |step: f64| {
            let l = vectors(count, set).zip(1..).map(|(v, n)| v * libm::pow(step, f64::from(n)));
            let l: Vec<DVec3> = l.collect();
            (crate::geometry::exp(rotation(&l)).inverse() * attitude(&l)).xyz().length()
        };
        libm::log2(off(step) / off(0.5 * step))
    }

    fn gives_back<const N: usize>() {
        let given: Vec<DVec3> =
            (0..N).map(|n| DVec3::new(1.0 - n as f64, libm::sin(n as f64), 0.3)).collect();
        // Gauss points of third degree in 64 parts of each increment integrate it to rounding.
        let integral = |from: f64, to: f64| {
            let part = (to - from) / 64.0;
            let at = |i: i32| from + part * (f64::from(i) + 0.5);
            let away = part * 15.0_f64.sqrt() / 10.0;
            let gauss = |t: f64| {
                (value(&given, t - away) * 5.0 + value(&given, t) * 8.0 + value(&given, t + away) * 5.0)
                    / 18.0
            };
            (0..64).map(|i| gauss(at(i)) * part).sum::<DVec3>()
        };
        let edge = |m: usize| 2.0 * m as f64 / N as f64 - 1.0;
        let increments = std::array::from_fn(|m| Triple::<f64>::from(integral(edge(m), edge(m + 1))));
        let found: [Triple<f64>; N] = fit(&rows::<N>(), &increments);
        for (found, given) in found.iter().zip(given) {
            let off = DVec3::new(found.x, found.y, found.z) - given;
            assert!(off.length() < 1e-12, "{found:?} for {given}");
        }
    }

    #[test]
    fn the_fit_gives_back_a_polynomial_from_its_integrals() {
        gives_back::<2>();
        gives_back::<4>();
        gives_back::<8>();
    }
}
