//! Box and Muller's pairs with polynomials of several lengths, and in single precision.

use super::makers::{CHUNK, Convert};
use crate::random::Stream;
use crate::random::box_muller::{self, PAIRS, Polynomials};
use rand::SeedableRng;

/// Pairs by these polynomials.
pub(super) struct Pairs<P>(pub P);

impl<P: Polynomials> Convert<PAIRS> for Pairs<P> {
    #[inline(always)]
    fn convert(&self, words: &[u64; PAIRS], numbers: &mut [f64; CHUNK], rest: &mut Stream) {
        box_muller::convert::<P>(words, numbers, rest);
    }
}

impl<P: Default> Default for Pairs<P> {
    fn default() -> Self {
        Pairs(P::default())
    }
}

/// A coefficient of each fewer than the standard.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Low;

impl Polynomials for Low {
    const LOGARITHM: &'static [f64] = &[0.666_534_276_439_471_7, 0.412_874_721_223_597_6];
    const SINE: &'static [f64] =
        &[-0.166_666_506_692_365_56, 0.008_331_978_660_849_502, -0.000_194_956_360_072_109_4];
    const COSINE: &'static [f64] = &[0.041_661_278_607_131_26, -0.001_365_244_985_898_041_6];
}

/// One more.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct High;

impl Polynomials for High {
    const LOGARITHM: &'static [f64] = &[
        0.666_666_650_852_819_6,
        0.400_004_338_736_512_4,
        0.285_320_668_102_944_2,
        0.236_687_899_242_699_34,
    ];
    const SINE: &'static [f64] = &[
        -0.166_666_666_279_996_6,
        0.008_333_328_238_768_98,
        -0.000_198_390_437_844_644_1,
        2.716_014_128_284_434_5e-6,
    ];
    const COSINE: &'static [f64] = &[
        0.041_666_666_622_828_64,
        -0.001_388_888_375_344_524_5,
        0.000_024_799_520_015_809_63,
        -2.721_023_823_996_819e-7,
    ];
}

/// As many as a double can tell from more.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Full;

impl Polynomials for Full {
    const LOGARITHM: &'static [f64] = &[
        0.666_666_666_665_138_6,
        0.400_000_000_810_581_4,
        0.285_714_131_925_758_4,
        0.222_236_159_513_962_5,
        0.181_165_987_113_369_4,
        0.168_965_772_426_026_6,
    ];
    const SINE: &'static [f64] = &[
        -0.166_666_666_666_060_87,
        0.008_333_333_321_928_566,
        -0.000_198_412_623_681_135_4,
        2.755_509_931_043_569_5e-6,
        -2.474_548_654_257_779e-8,
    ];
    const COSINE: &'static [f64] = &[
        0.041_666_666_666_602_26,
        -0.001_388_888_887_827_423_3,
        0.000_024_801_580_971_622_65,
        -2.755_556_712_172_604_4e-7,
        2.064_773_726_888_563e-9,
    ];
}

/// Pairs in single precision: eight at once where doubles are four, 24 bits a number, and a tail that ends at 6.6 σ.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Single;

impl Convert<PAIRS> for Single {
    #[inline(always)]
    fn convert(&self, words: &[u64; PAIRS], numbers: &mut [f64; CHUNK], _: &mut Stream) {
        let (mut upper, mut lower) = ([0; PAIRS], [0; PAIRS]);
        for ((&word, upper), lower) in words.iter().zip(&mut upper).zip(&mut lower) {
            (*upper, *lower) = ((word >> 32) as u32, word as u32);
        }
        let (mut first, mut second) = ([0.0; PAIRS], [0.0; PAIRS]);
        for j in 0..PAIRS {
            let radius = radius(upper[j]);
            let (x, y) = direction(lower[j]);
            (first[j], second[j]) = (radius * x, radius * y);
        }
        for j in 0..PAIRS {
            (numbers[j], numbers[PAIRS + j]) = (f64::from(first[j]), f64::from(second[j]));
        }
    }
}

/// As [`box_muller::radius`], of a half word.
#[inline(always)]
fn radius(half: u32) -> f32 {
    const ROOT_HALF: u32 = 0x3f35_04f3;
    const EXPONENT: u32 = 0xff80_0000;
    let u = ((half >> 1) as i32 as f32 + 0.5) * (1.0 / 2_147_483_648.0);
    let exponent = u.to_bits().wrapping_sub(ROOT_HALF) & EXPONENT;
    let m = f32::from_bits(u.to_bits().wrapping_sub(exponent));
    let k = (exponent as i32 >> 23) as f32;
    let s = (m - 1.0) / (m + 1.0);
    let z = s * s;
    let p = ((0.299_612_64 * z + 0.399_736_05) * z + 0.666_668_2) * z + 2.0;
    (k * (-2.0 * std::f32::consts::LN_2) - s * p * 2.0).max(0.0).sqrt()
}

/// As [`box_muller::direction`].
#[inline(always)]
fn direction(half: u32) -> (f32, f32) {
    let a = ((half >> 1) as i32 as f32 - 1_073_741_824.0) * (std::f32::consts::FRAC_PI_2 / 2_147_483_648.0);
    let z = a * a;
    let sine = (((-1.949_563_6e-4 * z + 8.331_979e-3) * z - 0.166_666_5) * z + 1.0) * a;
    let cosine = (((2.443_845_2e-5 * z - 1.388_736_8e-3) * z + 4.166_664_7e-2) * z - 0.5) * z + 1.0;
    let cosine = f32::from_bits(cosine.to_bits() ^ half << 31);
    if half & 2 == 0 { (cosine, sine) } else { (sine, cosine) }
}

/// The largest difference from the exact transform of the same bits, σ: over a million words at random and a hundred
/// thousand from small to great.
pub(super) fn error<C: Convert<PAIRS> + Default>() -> f64 {
    use rand::Rng;
    let convert = C::default();
    let (mut random, mut rest) = (Stream::seed_from_u64(1), Stream::seed_from_u64(2));
    let mut worst = 0.0;
    for chunk in 0..36_000u64 {
        let word = |j: usize| match chunk < 32_000 {
            true => random.next_u64(),
            // u from next to 0 to next to 1, at a random angle.
            false => {
                ((chunk - 32_000) * PAIRS as u64 + j as u64).wrapping_mul(33_554_432) << 32
                    | random.next_u64() >> 32
            }
        };
        let words: [u64; PAIRS] = std::array::from_fn(word);
        let mut numbers = [0.0; CHUNK];
        convert.convert(&words, &mut numbers, &mut rest);
        for (j, &word) in
            words.iter().enumerate().filter(|(_, word)| box_muller::upper(**word) >= box_muller::TAIL)
        {
            let (x, y) = exactly(word);
            worst = f64::max(worst, (numbers[j] - x).abs().max((numbers[PAIRS + j] - y).abs()));
        }
    }
    worst
}

/// The pair of a word by the library's logarithm, sine and cosine.
fn exactly(word: u64) -> (f64, f64) {
    const PART: f64 = 1.0 / 4_294_967_296.0;
    let radius = libm::sqrt(-2.0 * libm::log(box_muller::upper(word)));
    let angle = (((word & 0xffff_ffff) as f64 + 0.5) * PART - 0.5) * std::f64::consts::FRAC_PI_2;
    let sign = if word & 1 == 0 { 1.0 } else { -1.0 };
    let (x, y) = (sign * libm::cos(angle), libm::sin(angle));
    if word & 2 == 0 { (radius * x, radius * y) } else { (radius * y, radius * x) }
}
