//! Sixteen xoshiro256++ generators side by side, one step of all at a time.
//!
//! The state is kept word by word, so that the compiler steps two, four or eight lanes with one instruction. Whole
//! numbers come out the same whichever it chooses.

use rand::Rng;

/// Generators.
pub(crate) const LANES: usize = 16;

/// The state of sixteen xoshiro256++ (Blackman & Vigna, ACM TOMS 47(4), 2021): word `k` of lane `j` is `[k][j]`.
#[derive(Clone, Debug)]
pub(crate) struct Lanes([[u64; LANES]; 4]);

impl Lanes {
    /// Lane after lane from four words each of `seeds`.
    pub(crate) fn new(seeds: &mut impl Rng) -> Lanes {
        let mut state = [[0; LANES]; 4];
        for lane in 0..LANES {
            state.iter_mut().for_each(|word| word[lane] = seeds.next_u64());
        }
        Lanes(state)
    }

    /// The next words, a multiple of [`LANES`]: the first of every lane, then the second of every lane, and so on.
    #[inline(always)]
    pub(crate) fn fill<const WORDS: usize>(&mut self, words: &mut [u64; WORDS]) {
        const { assert!(WORDS.is_multiple_of(LANES)) }
        let [a, b, c, d] = &mut self.0;
        for words in words.as_chunks_mut::<LANES>().0 {
            for j in 0..LANES {
                words[j] = a[j].wrapping_add(d[j]).rotate_left(23).wrapping_add(a[j]);
                let shifted = b[j] << 17;
                c[j] ^= a[j];
                d[j] ^= b[j];
                b[j] ^= c[j];
                a[j] ^= d[j];
                c[j] ^= shifted;
                d[j] = d[j].rotate_left(45);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_xoshiro::{SplitMix64, Xoshiro256PlusPlus};

    #[test]
    fn each_lane_is_the_generator_of_another_make() {
        let mut lanes = Lanes::new(&mut SplitMix64::seed_from_u64(5));
        let mut seeds = SplitMix64::seed_from_u64(5);
        let mut others: [_; LANES] = std::array::from_fn(|_| {
            let state = [(); 4].map(|()| seeds.next_u64().to_le_bytes());
            let mut seed = [0; 32];
            seed.copy_from_slice(state.as_flattened());
            Xoshiro256PlusPlus::from_seed(seed)
        });
        let mut words = [0; 4 * LANES];
        for _ in 0..100 {
            lanes.fill(&mut words);
            for (i, word) in words.iter().enumerate() {
                assert_eq!(*word, others[i % LANES].next_u64());
            }
        }
    }
}
