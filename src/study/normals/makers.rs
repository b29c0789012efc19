//! What makes normal numbers: generators side by side, and what turns their words into numbers.

use crate::os;
use crate::random::Stream;
use crate::random::box_muller::PAIRS;
use crate::random::lanes::Lanes;
use rand::{Rng, SeedableRng};
use rand_xoshiro::SplitMix64;

/// Numbers that are made at once.
pub(super) const CHUNK: usize = 2 * PAIRS;

/// Makes normal numbers.
pub(super) trait Maker {
    /// The next.
    fn fill(&mut self, numbers: &mut [f64; CHUNK]);
}

/// Turns so many words into normal numbers.
pub(super) trait Convert<const WORDS: usize> {
    /// The numbers of `words`; a rare one takes more bits from `rest`. Marked `#[inline(always)]`, for wider vectors.
    fn convert(&self, words: &[u64; WORDS], numbers: &mut [f64; CHUNK], rest: &mut Stream);
}

/// Numbers from the words of generators side by side.
pub(super) struct FromWords<const WORDS: usize, C> {
    lanes: Lanes,
    rest: Stream,
    convert: C,
}

/// From a seed, as [`Normals`](crate::random::Normals) has it.
pub(super) fn from<const WORDS: usize, C: Convert<WORDS> + 'static>(seed: u64, convert: C) -> Box<dyn Maker> {
    let mut seeds = SplitMix64::seed_from_u64(seed);
    let lanes = Lanes::new(&mut seeds);
    Box::new(FromWords { lanes, rest: Stream::seed_from_u64(seeds.next_u64()), convert })
}

impl<const WORDS: usize, C: Convert<WORDS>> Maker for FromWords<WORDS, C> {
    fn fill(&mut self, numbers: &mut [f64; CHUNK]) {
        os::widest(
            #[inline(always)]
            || {
                let mut words = [0; WORDS];
                self.lanes.fill(&mut words);
                self.convert.convert(&words, numbers, &mut self.rest);
            },
        );
    }
}
