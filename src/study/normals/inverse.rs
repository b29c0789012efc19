//! The inverse of the distribution function by piecewise polynomials over the octaves of a uniform number.
//!
//! A word's lowest bit is the sign, its highest 52 a number f evenly in (0, 1). Each octave of f, from ½ to 1, ¼ to ½
//! and so on, is cut into parts of one width, in each of which −Φ⁻¹(f/2) is the polynomial through the Chebyshev nodes
//! of the part. Beyond the table, once in 2¹⁴ numbers, Φ⁻¹ itself is solved by Newton's steps, with 53 bits more.

use super::histogram::below;
use super::makers::{CHUNK, Convert};
use crate::double::polynomial;
use crate::random::Stream;
use rand::Rng;

/// Octaves of the table.
const OCTAVES: usize = 14;
/// Where the table ends.
const END: f64 = 1.0 / (1u64 << OCTAVES) as f64;
const ONE: u64 = 0x3ff0_0000_0000_0000;

/// So many coefficients a part (the degree and 1), 2 to the power `BITS` parts an octave.
pub(super) struct Inverse<const COEFFICIENTS: usize, const BITS: usize> {
    /// From the part with the smallest f; the lowest power first.
    parts: Vec<[f64; COEFFICIENTS]>,
}

/// The f at t from −1 to 1 across a part.
fn place(part: usize, t: f64, bits: usize) -> f64 {
    let (octave, within) = (part >> bits, part & ((1 << bits) - 1));
    let across = (within as f64 + 0.5 * (t + 1.0)) / (1u64 << bits) as f64;
    libm::ldexp(1.0 + across, octave as i32 - OCTAVES as i32)
}

/// −Φ⁻¹(f/2), by Newton's steps on the logarithm of the distribution function.
pub(super) fn exact(f: f64) -> f64 {
    let (p, mut x) = (0.5 * f, libm::sqrt(-2.0 * libm::log(0.5 * f)).min(-2.0 * libm::log(0.5 * f) / 1.4));
    for _ in 0..60 {
        let tail = below(-x);
        let density = libm::exp(-0.5 * x * x) / libm::sqrt(std::f64::consts::TAU);
        let step = tail * libm::log(tail / p) / density;
        x += step;
        if step.abs() < 1e-16 * x.abs() {
            break;
        }
    }
    x
}

/// The polynomial, lowest power first, through `of` at the Chebyshev nodes of (−1, 1): Newton's divided differences,
/// multiplied out.
fn fitted<const COUNT: usize>(of: impl Fn(f64) -> f64) -> [f64; COUNT] {
    let nodes: [f64; COUNT] =
        std::array::from_fn(|k| libm::cos(std::f64::consts::PI * (k as f64 + 0.5) / COUNT as f64));
    let mut differences = nodes.map(of);
    for order in 1..COUNT {
        for k in (order..COUNT).rev() {
            differences[k] = (differences[k] - differences[k - 1]) / (nodes[k] - nodes[k - order]);
        }
    }
    let mut coefficients = [0.0; COUNT];
    for k in (0..COUNT).rev() {
        // Times (t − node k), and the next difference.
        for power in (1..COUNT).rev() {
            coefficients[power] = coefficients[power - 1] - nodes[k] * coefficients[power];
        }
        coefficients[0] = differences[k] - nodes[k] * coefficients[0];
    }
    coefficients
}

impl<const COEFFICIENTS: usize, const BITS: usize> Inverse<COEFFICIENTS, BITS> {
    pub fn new() -> Self {
        let part = |part| fitted(|t| exact(place(part, t, BITS)));
        Inverse { parts: (0..OCTAVES << BITS).map(part).collect() }
    }

    /// A word's number, with its sign; only where f is within the table.
    #[inline(always)]
    fn number(&self, word: u64) -> f64 {
        /// Of the exponent's bits where the table begins.
        const FIRST: usize = 1023 - OCTAVES;
        let bits = fraction(word).to_bits();
        let part = (bits >> (52 - BITS)) as usize - (FIRST << BITS);
        let t = (f64::from_bits(bits << (12 + BITS) >> 12 | ONE) - 1.5) * 2.0;
        // Its bounds are checked: what is beyond the table does not come here.
        let size = polynomial(&self.parts[part], t);
        f64::from_bits(size.to_bits() ^ word << 63)
    }

    /// The largest difference from the exact transform in the table, σ: at 33 places in every part.
    pub fn error() -> f64 {
        let inverse = Self::new();
        let places =
            (0..OCTAVES << BITS).flat_map(|part| (0..33).map(move |k| (part, f64::from(k) / 16.0 - 1.0)));
        let error = |(part, t): (usize, f64)| {
            (polynomial(&inverse.parts[part], t) - exact(place(part, t, BITS))).abs()
        };
        places.map(error).fold(0.0, f64::max)
    }

    #[cfg(test)]
    pub fn damage(&mut self, part: usize, by: f64) {
        self.parts[part][0] += by;
    }
}

/// Evenly in (0, 1) from a word's highest 52 bits.
#[inline(always)]
fn fraction(word: u64) -> f64 {
    const HALF_PART: f64 = 1.0 / 9_007_199_254_740_992.0;
    f64::from_bits(word >> 12 | ONE) - (1.0 - HALF_PART)
}

impl<const COEFFICIENTS: usize, const BITS: usize> Convert<CHUNK> for Inverse<COEFFICIENTS, BITS> {
    #[inline(always)]
    fn convert(&self, words: &[u64; CHUNK], numbers: &mut [f64; CHUNK], rest: &mut Stream) {
        let beyond = words.iter().fold(false, |beyond, &word| beyond | (fraction(word) < END));
        if beyond {
            for (&word, number) in words.iter().zip(numbers) {
                *number = if fraction(word) < END { tail(word, rest) } else { self.number(word) };
            }
        } else {
            words.iter().zip(numbers).for_each(|(&word, number)| *number = self.number(word));
        }
    }
}

/// Beyond the table, with 53 bits more.
#[cold]
#[inline(never)]
fn tail(word: u64, rest: &mut Stream) -> f64 {
    const PART: f64 = 1.0 / 9_007_199_254_740_992.0;
    let more = ((rest.next_u64() >> 11) as f64 + 0.5) * PART;
    let f = ((word >> 12) as f64 + more) * (2.0 * PART);
    f64::from_bits(exact(f).to_bits() ^ word << 63)
}
