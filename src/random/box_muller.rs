//! Words of 64 random bits into pairs of normal numbers, by arithmetic alone.
//!
//! Box and Muller (*A Note on the Generation of Random Normal Deviates*, Ann. Math. Stat. 29(2), 1958): for u and v
//! evenly in (0, 1), `√(−2·ln u)·cos 2πv` and `√(−2·ln u)·sin 2πv` are independent standard normal numbers. A word's
//! upper half is u, its lower half v. Logarithm, sine and cosine are minimax polynomials (Remez exchange) on the range
//! to which the bits of a number bring it without a branch, so that the compiler does two, four or eight pairs at
//! once. Sums, products, quotients and square roots round alike at any width: so do the numbers.
//!
//! Where u is below 2⁻¹², once in four thousand pairs, 53 more bits follow its 32: the tail has the normal density to
//! where a double ends it, 10.8 σ.

use super::Stream;
use crate::double::polynomial;
use rand::Rng;

/// Pairs that are made at once.
pub(crate) const PAIRS: usize = 32;

/// How exact the polynomials are: their coefficients, from the lowest power.
pub(crate) trait Polynomials {
    /// `ln m = 2s + s³·p(s²)`, s = (m − 1)/(m + 1), m from √½ to √2.
    const LOGARITHM: &'static [f64];
    /// `sin a = a + a³·p(a²)`, a within an eighth of a turn.
    const SINE: &'static [f64];
    /// `cos a = 1 − a²/2 + a⁴·p(a²)`.
    const COSINE: &'static [f64];
}

/// Those of every scene: a number is within 4·10⁻¹⁰ of the exact one.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Standard;

impl Polynomials for Standard {
    const LOGARITHM: &'static [f64] =
        &[0.666_668_167_019_418_1, 0.399_736_035_736_938_56, 0.299_612_632_317_667_4];
    const SINE: &'static [f64] = &[
        -0.166_666_666_279_996_6,
        0.008_333_328_238_768_98,
        -0.000_198_390_437_844_644_1,
        2.716_014_128_284_434_5e-6,
    ];
    const COSINE: &'static [f64] =
        &[0.041_666_646_866_599_97, -0.001_388_736_752_295_128_5, 0.000_024_438_452_339_355_424];
}

/// The numbers that `words` lead to: a word's pair is so many apart as there are words. `rest` gives the further bits
/// of a tail.
#[inline(always)]
pub(crate) fn convert<P: Polynomials>(
    words: &[u64; PAIRS],
    normals: &mut [f64; 2 * PAIRS],
    rest: &mut Stream,
) {
    let (first, second) = normals.split_at_mut(PAIRS);
    let mut tails = false;
    for ((&word, first), second) in words.iter().zip(&mut *first).zip(&mut *second) {
        let u = upper(word);
        tails |= u < TAIL;
        let radius = radius::<P>(u);
        let (x, y) = direction::<P>(word);
        (*first, *second) = (radius * x, radius * y);
    }
    if tails {
        settle::<P>(words, first, second, rest);
    }
}

/// Below this, u needs more than its 32 bits.
pub(crate) const TAIL: f64 = 1.0 / 4096.0;

#[cold]
#[inline(never)]
fn settle<P: Polynomials>(words: &[u64; PAIRS], first: &mut [f64], second: &mut [f64], rest: &mut Stream) {
    const PART: f64 = 1.0 / 9_007_199_254_740_992.0;
    for ((&word, first), second) in words.iter().zip(first).zip(second) {
        if upper(word) < TAIL {
            let more = ((rest.next_u64() >> 11) as f64 + 0.5) * PART;
            let u = ((word >> 32) as f64 + more) * (1.0 / 4_294_967_296.0);
            let radius = libm::sqrt(-2.0 * libm::log(u));
            let (x, y) = direction::<P>(word);
            (*first, *second) = (radius * x, radius * y);
        }
    }
}

/// The bits of 1; with others below the exponent, of a number in \[1, 2).
const ONE: u64 = 0x3ff0_0000_0000_0000;

/// A word's upper half, evenly in (0, 1): in the middles of 2³² parts.
#[inline(always)]
pub(crate) fn upper(word: u64) -> f64 {
    const HALF_PART: f64 = 1.0 / 8_589_934_592.0;
    f64::from_bits(word >> 32 << 20 | ONE) - (1.0 - HALF_PART)
}

/// `√(−2·ln u)` for u in (0, 1).
///
/// u = 2ᵏ·m with m from √½ to √2; k and m are read from the bits of u.
#[inline(always)]
pub(crate) fn radius<P: Polynomials>(u: f64) -> f64 {
    const ROOT_HALF: u64 = 0x3fe6_a09e_667f_3bcd;
    const FRACTION: u64 = 0x000f_ffff_ffff_ffff;
    /// With whole numbers in its lowest bits, a double that is 2⁵² more than they.
    const WHOLE: u64 = 0x4330_0000_0000_0000;
    // Keeps the exponent above zero.
    let shifted = u.to_bits().wrapping_sub(ROOT_HALF).wrapping_add(64 << 52);
    let k = f64::from_bits(shifted >> 52 | WHOLE) - (4_503_599_627_370_496.0 + 64.0);
    let m = f64::from_bits((shifted & FRACTION) + ROOT_HALF);
    let s = (m - 1.0) / (m + 1.0);
    let z = s * s;
    (k * (-2.0 * std::f64::consts::LN_2) + s * (polynomial(P::LOGARITHM, z) * z + 2.0) * -2.0).sqrt()
}

/// Cosine and sine of an angle evenly around the circle, from a word's lower half: an angle within an eighth of a turn
/// of the x axis, turned over and to the y axis by the lowest two bits.
#[inline(always)]
pub(crate) fn direction<P: Polynomials>(word: u64) -> (f64, f64) {
    const HALF_PART: f64 = 1.0 / 8_589_934_592.0;
    // Symmetric about zero.
    let a = (f64::from_bits(word << 32 >> 12 | ONE) - (1.5 - HALF_PART)) * std::f64::consts::FRAC_PI_2;
    let z = a * a;
    let sine = (polynomial(P::SINE, z) * z + 1.0) * a;
    let cosine = (polynomial(P::COSINE, z) * z - 0.5) * z + 1.0;
    let cosine = f64::from_bits(cosine.to_bits() ^ word << 63);
    if word & 2 == 0 { (cosine, sine) } else { (sine, cosine) }
}
