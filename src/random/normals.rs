//! Normal numbers for the three axes of an error term.

use super::Stream;
use super::box_muller::{self, PAIRS, Standard};
use super::lanes::Lanes;
use crate::os;
use rand::{Rng, SeedableRng};
use rand_xoshiro::SplitMix64;
use std::ops::Range;

/// Numbers that are made at once.
const CHUNK: usize = 2 * PAIRS;

/// Standard normal numbers, independent on three axes, each axis from a seed of its own. They are made so many at a
/// time, and handed out in the same order however many are asked for at once.
#[derive(Clone, Debug)]
pub struct Normals {
    axes: [Option<Box<Axis>>; 3],
    ready: [[f64; CHUNK]; 3],
    used: usize,
}

impl Normals {
    /// From the axes' seeds; an axis without one has zeros, which cost nothing.
    pub(super) fn new(seeds: [Option<u64>; 3]) -> Normals {
        let axes = seeds.map(|seed| seed.map(|seed| Box::new(Axis::new(seed))));
        Normals { axes, ready: [[0.0; CHUNK]; 3], used: CHUNK }
    }

    /// How many of the axes have numbers.
    pub fn count(&self) -> usize {
        self.axes.iter().flatten().count()
    }

    /// The next of each axis.
    pub fn draw(&mut self) -> [f64; 3] {
        let mut next = [0.0; 3];
        self.runs(1, |_, run| next = run.map(|run| run.first().copied().unwrap_or_default()));
        next
    }

    /// Calls `each` with every value of three columns of one length and a number of its own: axis by axis, which is
    /// the quickest where values do not wait for one another.
    #[inline(always)]
    pub fn zip(&mut self, columns: [&mut [f64]; 3], mut each: impl FnMut(usize, &mut f64, f64)) {
        self.runs(
            columns[0].len(),
            #[inline(always)]
            |at, run| {
                for (axis, run) in run.into_iter().enumerate() {
                    columns[axis][at.clone()]
                        .iter_mut()
                        .zip(run)
                        .for_each(|(value, n)| each(axis, value, *n));
                }
            },
        );
    }

    /// Calls `take` with the next `count` of each axis in runs of the same length: where in the count each run is, and
    /// its numbers.
    #[inline(always)]
    pub fn runs(&mut self, count: usize, mut take: impl FnMut(Range<usize>, [&[f64]; 3])) {
        let mut done = 0;
        while done < count {
            if self.used == CHUNK {
                make(&mut self.axes, &mut self.ready);
                self.used = 0;
            }
            let from = self.used;
            let length = (CHUNK - from).min(count - done);
            take(done..done + length, self.ready.each_ref().map(|axis| &axis[from..from + length]));
            done += length;
            self.used += length;
        }
    }
}

/// The next of each axis.
#[inline(never)]
fn make(axes: &mut [Option<Box<Axis>>; 3], normals: &mut [[f64; CHUNK]; 3]) {
    os::widest(
        #[inline(always)]
        || {
            for (axis, normals) in axes.iter_mut().zip(normals) {
                if let Some(axis) = axis {
                    axis.fill(normals);
                }
            }
        },
    );
}

/// One axis: the lanes that every pair of numbers begins with, and a generator for the further bits of their tails.
#[derive(Clone, Debug)]
struct Axis {
    lanes: Lanes,
    rest: Stream,
}

impl Axis {
    /// splitmix64 spreads the seed over the states, as the generator's authors ask.
    fn new(seed: u64) -> Axis {
        let mut seeds = SplitMix64::seed_from_u64(seed);
        let lanes = Lanes::new(&mut seeds);
        Axis { lanes, rest: Stream::seed_from_u64(seeds.next_u64()) }
    }

    #[inline(always)]
    fn fill(&mut self, normals: &mut [f64; CHUNK]) {
        let mut words = [0; PAIRS];
        self.lanes.fill(&mut words);
        box_muller::convert::<Standard>(&words, normals, &mut self.rest);
    }
}

#[cfg(test)]
#[path = "normals_tests.rs"]
mod tests;
