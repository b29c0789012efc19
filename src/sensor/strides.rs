//! Functions of time at a sensor's ticks without a call of `libm` a sample.
//!
//! At every [`STRIDE`]th tick a function is computed afresh, in between by what one step and the next multiply it by:
//! so nothing accumulates, nothing depends on where blocks begin, and the compiler can do several samples at once.

use std::ops::Range;

/// Ticks from one fresh value to the next.
pub(super) const STRIDE: usize = 64;

/// A part of a block within one stride.
pub(super) struct Stride {
    /// The tick at which the stride begins.
    pub anchor: u64,
    /// How many ticks after that the part begins.
    pub offset: usize,
    /// Which samples of the block it is.
    pub samples: Range<usize>,
}

/// The strides over `n` samples from tick `k` on.
pub(super) fn strides(k: u64, n: usize) -> impl Iterator<Item = Stride> {
    let mut done = 0;
    std::iter::from_fn(move || {
        let offset = ((k + done as u64) % STRIDE as u64) as usize;
        let count = (STRIDE - offset).min(n - done);
        let stride = Stride { anchor: k + done as u64 - offset as u64, offset, samples: done..done + count };
        done += count;
        (count > 0).then_some(stride)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strides_cover_every_sample_once_and_begin_at_multiples() {
        for (k, n) in [(0, 0), (0, 1), (63, 2), (64, 64), (100, 1000), (5, 59), (5, 60)] {
            let mut next = 0;
            for stride in strides(k, n) {
                assert_eq!(stride.samples.start, next);
                assert!(!stride.samples.is_empty() && stride.anchor % STRIDE as u64 == 0);
                assert!(stride.offset + stride.samples.len() <= STRIDE);
                assert_eq!(stride.anchor + stride.offset as u64, k + next as u64);
                next = stride.samples.end;
            }
            assert_eq!(next, n, "{k} {n}");
        }
    }
}
