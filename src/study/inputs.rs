//! What a method reads, taken from a motion.

use super::motions::Path;
use crate::motion::method::{Input, Real, Triple};

/// The inputs of `steps` steps from step `first` on, a sample every `1/hz` seconds, into `inputs`.
///
/// Times are computed from the count of samples, so that the end of one step is the same number as the start of the
/// next; the rounding of increments' bounds then cancels in their sum.
pub(super) fn gather<R: Real>(
    path: &dyn Path,
    input: Input,
    hz: f64,
    first: u64,
    steps: u64,
    inputs: &mut Vec<Triple<R>>,
) {
    inputs.clear();
    match input {
        Input::Rate(fractions) => {
            // Where steps share a sample it is made once.
            let shared =
                fractions.len() > 1 && fractions.first() == Some(&0.0) && fractions.last() == Some(&1.0);
            for step in first..first + steps {
                let last = inputs.last().copied().filter(|_| shared);
                inputs.extend(last);
                let left = &fractions[usize::from(last.is_some())..];
                inputs.extend(left.iter().map(|&c| Triple::from(path.rate((step as f64 + c) / hz))));
            }
        }
        Input::Increments(count) => {
            let bound = |k: u64| k as f64 / hz;
            let samples = first * count as u64..(first + steps) * count as u64;
            inputs.extend(samples.map(|k| Triple::from(path.increment(bound(k), bound(k + 1)))));
        }
    }
}
