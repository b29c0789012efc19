//! Words of 64 random bits into normal numbers, exactly and mostly by one product.
//!
//! The ziggurat (Marsaglia & Tsang, *The Ziggurat Method for Generating Random Variables*, J. Stat. Software 5(8),
//! 2000): 512 layers of equal area lie over the density e^(−x²/2); a word's lowest 9 bits choose a layer and its
//! highest 52 a place across it, which are independent bits (Doornik, *An Improved Ziggurat Method to Generate Normal
//! Random Samples*, 2005). 99.7 % of the places lie below the density whatever the height, and are the answer. The
//! others draw a height, or one beyond the last layer: what comes out has the normal density to the last bit of its
//! place, out to 13 σ.

use super::makers::{CHUNK, Convert};
use crate::random::Stream;
use rand::Rng;

const LAYERS: usize = 512;

/// Where the tail begins: for which 512 layers of area R·f(R) + ∫ f from R on end at the density's top.
const R: f64 = 3.852_046_150_368_391;

/// Where each layer ends and how high it begins.
#[derive(Debug)]
pub(super) struct Table {
    /// Layer i is x\[i\] wide and lies below the density up to x\[i + 1\]. The lowest holds the tail too, and is as
    /// much wider than R.
    x: [f64; LAYERS + 1],
    /// The density at x\[i\], but for the lowest.
    y: [f64; LAYERS + 1],
}

impl Table {
    pub fn new() -> Table {
        let tail = libm::sqrt(std::f64::consts::FRAC_PI_2) * libm::erfc(R * std::f64::consts::FRAC_1_SQRT_2);
        let area = R * density(R) + tail;
        let (mut x, mut y) = ([0.0; LAYERS + 1], [0.0; LAYERS + 1]);
        (x[0], x[1]) = (area / density(R), R);
        (y[1], y[LAYERS]) = (density(R), 1.0);
        for i in 2..LAYERS {
            y[i] = y[i - 1] + area / x[i - 1];
            x[i] = libm::sqrt(-2.0 * libm::log(y[i]));
        }
        Table { x, y }
    }

    /// Where a word falls, settled or not.
    #[inline(always)]
    fn place(&self, word: u64) -> f64 {
        across(word) * self.x[layer(word)]
    }

    #[cold]
    #[inline(never)]
    fn settle(&self, words: &[u64; 8], normals: &mut [f64; 8], rest: &mut Stream) {
        for (&word, normal) in words.iter().zip(normals) {
            *normal = self.settled(word, rest);
        }
    }

    /// The number that a word leads to.
    fn settled(&self, mut word: u64, rest: &mut Stream) -> f64 {
        loop {
            let (layer, x) = (layer(word), self.place(word));
            if x.abs() < self.x[layer + 1] {
                return x;
            }
            if layer == 0 {
                return tail(rest).copysign(x);
            }
            let height = self.y[layer] + (self.y[layer + 1] - self.y[layer]) * unit(rest);
            if height < density(x) {
                return x;
            }
            // Anew, layer and all.
            word = rest.next_u64();
        }
    }
}

impl Convert<CHUNK> for Table {
    #[inline(always)]
    fn convert(&self, words: &[u64; CHUNK], numbers: &mut [f64; CHUNK], rest: &mut Stream) {
        let (words, numbers) = (words.as_chunks::<8>().0, numbers.as_chunks_mut::<8>().0);
        for (words, numbers) in words.iter().zip(numbers) {
            let mut unsettled = false;
            for j in 0..8 {
                numbers[j] = self.place(words[j]);
                unsettled |= numbers[j].abs() >= self.x[layer(words[j]) + 1];
            }
            if unsettled {
                self.settle(words, numbers, rest);
            }
        }
    }
}

/// From the lowest 9 bits.
#[inline(always)]
fn layer(word: u64) -> usize {
    word as usize % LAYERS
}

/// Evenly in (−1, 1) from the highest 52 bits: the odd multiples of 2⁻⁵¹, so that both signs are alike and 0 is none.
#[inline(always)]
fn across(word: u64) -> f64 {
    /// The bits of 2; with any below the exponent, of a number in [2, 4).
    const TWO: u64 = 0x4000_0000_0000_0000;
    f64::from_bits(word >> 12 | 1 | TWO) - 3.0
}

/// Evenly in (0, 1), in the middles of 2⁵³ parts.
fn unit(rest: &mut Stream) -> f64 {
    const PART: f64 = 1.0 / 9_007_199_254_740_992.0;
    ((rest.next_u64() >> 11) as f64 + 0.5) * PART
}

/// The normal density over that at 0.
fn density(x: f64) -> f64 {
    libm::exp(-0.5 * x * x)
}

/// From beyond R (Marsaglia, *Generating a Variable from the Tail of the Normal Distribution*, Technometrics 6(1),
/// 1964).
fn tail(rest: &mut Stream) -> f64 {
    loop {
        let beyond = -libm::log(unit(rest)) / R;
        if -2.0 * libm::log(unit(rest)) > beyond * beyond {
            return R + beyond;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Were R off in its last digits, the highest layer would not end at the top.
    #[test]
    fn the_layers_have_one_area_and_end_at_the_top() {
        let Table { x, y } = Table::new();
        let area = x[0] * y[1];
        for i in 1..LAYERS {
            assert!(x[i] < x[i - 1], "layer {i}");
            assert!((x[i] * (y[i + 1] - y[i]) / area - 1.0).abs() < 1e-9, "layer {i}");
        }
        let tail = libm::sqrt(std::f64::consts::FRAC_PI_2) * libm::erfc(R / libm::sqrt(2.0));
        assert!((area - R * y[1] - tail).abs() < 1e-15);
    }

    #[test]
    fn places_are_within_one_and_alike_on_both_sides() {
        let (low, high) = (across(0), across(u64::MAX));
        assert!(low > -1.0 && low == -high, "{low} {high}");
        assert_eq!(across(1 << 63), 1.0 / 2_251_799_813_685_248.0);
        assert_eq!(across((1 << 63) - 1), -across(1 << 63));
        assert_eq!((layer(u64::MAX), layer(512)), (511, 0));
    }
}
