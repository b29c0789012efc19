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
    /// What was counted when this was looked at last.
    seen: Tally,
    /// Samples from before the scene that wait in the chip: what comes of them first is not counted.
    old: u64,
}

impl Reads {
    /// Counts from here on.
    pub(super) fn begin(&mut self, now: Tally) {
        *self = Reads { seen: now, old: waiting(now), ..Reads::default() };
    }

    /// Takes the chip's counts at a time of the scene.
    pub(super) fn look(&mut self, t: SimTime, now: Tally) {
        let since = |now: u64, before: u64| now.saturating_sub(before);
        // Samples leave a chip in order, so that those from before the scene leave it first.
        let mut leave = |now: u64, before: u64| {
            let left = since(now, before);
            let old = left.min(self.old);
            self.old -= old;
            left - old
        };
        let read = leave(now.read, self.seen.read);
        let missed = leave(now.missed, self.seen.missed);
        let overflowed = leave(now.overflowed, self.seen.overflowed);
        let tally = &mut self.tally;
        tally.made += since(now.made, self.seen.made);
        tally.read += read;
        tally.again += since(now.again, self.seen.again);
        tally.missed += missed;
        tally.overflowed += overflowed;
        if read > 0 {
            let (first, _, with_first) = self.span.unwrap_or((t, t, tally.read));
            self.span = Some((first, t, with_first));
        }
        self.seen = now;
    }

    /// Samples read a second, from the first read to the last; `None` of fewer than two reads.
    pub fn hz(&self) -> Option<f64> {
        let (first, last, with_first) = self.span?;
        let span = (last - first).seconds();
        (span > 0.0).then(|| (self.tally.read - with_first) as f64 / span)
    }

    /// Samples of the scene that wait in the chip.
    pub fn waiting(&self) -> u64 {
        waiting(self.tally)
    }
}

fn waiting(Tally { made, read, missed, overflowed, .. }: Tally) -> u64 {
    made.saturating_sub(read + missed + overflowed)
}
