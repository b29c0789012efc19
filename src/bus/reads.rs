//! How a driver reads a sensor: how often, which samples twice, and which not at all.

use crate::time::SimTime;
use ratetable_protocols::chip::Tally;

/// What a driver has read of a sensor since the scene began.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reads {
    /// What became of its samples.
    pub tally: Tally,
    /// When samples were read first and last, and how many came with the first read.
    span: Option<(SimTime, SimTime, u64)>,
    /// What was counted before the scene.
    before: Tally,
}

impl Reads {
    /// Counts from here on.
    pub(super) fn begin(&mut self, now: Tally) {
        *self = Reads { before: now, ..Reads::default() };
    }

    /// Takes the chip's counts at a time of the scene.
    pub(super) fn look(&mut self, t: SimTime, now: Tally) {
        let since = |now: u64, before: u64| now.saturating_sub(before);
        let tally = Tally {
            made: since(now.made, self.before.made),
            read: since(now.read, self.before.read),
            again: since(now.again, self.before.again),
            missed: since(now.missed, self.before.missed),
            overflowed: since(now.overflowed, self.before.overflowed),
        };
        if tally.read > self.tally.read {
            let (first, _, with_first) = self.span.unwrap_or((t, t, tally.read));
            self.span = Some((first, t, with_first));
        }
        self.tally = tally;
    }

    /// Samples read a second, from the first read to the last; `None` of fewer than two reads.
    pub fn hz(&self) -> Option<f64> {
        let (first, last, with_first) = self.span?;
        let span = (last - first).seconds();
        (span > 0.0).then(|| (self.tally.read - with_first) as f64 / span)
    }

    /// Samples that wait in the chip.
    pub fn waiting(&self) -> u64 {
        let Tally { made, read, missed, overflowed, .. } = self.tally;
        made.saturating_sub(read + missed + overflowed)
    }
}
