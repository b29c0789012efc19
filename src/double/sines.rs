//! Sine and cosine of small angles by polynomials.

use super::Double;

/// Of sin x = x + x³·p(x²) within ±π/4, the lowest first: fdlibm's `k_sin.c` (Sun Microsystems 1993).
const SINE: [f64; 6] = [
    -1.666_666_666_666_663_2e-1,
    8.333_333_333_322_49e-3,
    -1.984_126_982_985_795e-4,
    2.755_731_370_707_006_8e-6,
    -2.505_076_025_340_686_3e-8,
    1.589_690_995_211_55e-10,
];
/// Of cos x = 1 − x²/2 + x⁴·p(x²), as in its `k_cos.c`.
const COSINE: [f64; 6] = [
    4.166_666_666_666_66e-2,
    -1.388_888_888_887_411e-3,
    2.480_158_728_947_673e-5,
    -2.755_731_435_139_066_3e-7,
    2.087_572_321_298_175e-9,
    -1.135_964_755_778_819_5e-11,
];

/// Sine and cosine of an angle within ±π/4 and a little, to less than a unit in the last place.
///
/// The minimax polynomials of fdlibm (`k_sin.c` and `k_cos.c`, Sun Microsystems 1993). Here the argument comes with
/// its tail already, and one reduction serves both: twice as fast as two calls that each reduce again.
pub(super) fn eighth_turn(angle: Double) -> (f64, f64) {
    let Double { hi: x, lo: tail } = angle;
    let square = x * x;
    let fourth = square * square;
    let cube = square * x;
    let r = SINE[1] + square * (SINE[2] + square * SINE[3]) + square * fourth * (SINE[4] + square * SINE[5]);
    let sin = x - ((square * (0.5 * tail - cube * r) - tail) - cube * SINE[0]);
    let r = square * (COSINE[0] + square * (COSINE[1] + square * COSINE[2]))
        + fourth * fourth * (COSINE[3] + square * (COSINE[4] + square * COSINE[5]));
    let half = 0.5 * square;
    let whole = 1.0 - half;
    let cos = whole + (((1.0 - whole) - half) + (square * r - x * tail));
    (sin, cos)
}

/// Sine and cosine of an angle within ±π/4, each to a unit in the last place: by the same polynomials, without a branch,
/// so that several are computed at once.
#[inline(always)]
pub(crate) fn small_sin_cos(x: f64) -> (f64, f64) {
    let square = x * x;
    let (sine, cosine) = (polynomial(&SINE, square), polynomial(&COSINE, square));
    (x + x * (square * sine), 1.0 + square * (square * cosine - 0.5))
}

/// The polynomial with these coefficients, the lowest first, by Horner's rule; product and sum are rounded each.
#[inline(always)]
pub(crate) fn polynomial(coefficients: &[f64], x: f64) -> f64 {
    match coefficients.split_last() {
        Some((highest, rest)) => rest.iter().rev().fold(*highest, |sum, coefficient| sum * x + coefficient),
        None => 0.0,
    }
}
