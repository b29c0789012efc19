//! When a port was pulled out, and what that cost.

use crate::report;

/// When a port was pulled out.
#[derive(Clone, Debug, Default)]
pub(super) struct Gaps {
    pub count: u64,
    pub total_ns: i64,
    /// Packets dropped meanwhile, and the samples in them.
    pub dropped: u64,
    pub samples: u64,
    /// When it was found gone, while it is.
    since: Option<i64>,
}

impl Gaps {
    /// The port was found gone.
    pub(super) fn begin(&mut self, now: i64) {
        if self.since.is_none() {
            self.since = Some(now);
            self.count += 1;
        }
    }

    /// Counts a packet and its samples that were lost, if that is why.
    pub(super) fn lost(&mut self, samples: u64) {
        if self.since.is_some() {
            self.dropped += 1;
            self.samples += samples;
        }
    }

    /// It took a packet again, or nothing more is to be sent.
    pub(super) fn end(&mut self, now: i64) {
        if let Some(since) = self.since.take() {
            self.total_ns += now - since;
        }
    }

    /// As in a report; `None` where it never happened.
    pub(super) fn report(&self) -> Option<report::Gaps> {
        (self.count > 0).then_some(report::Gaps {
            count: self.count,
            total_s: self.total_ns as f64 * 1e-9,
            dropped: self.dropped,
            samples: self.samples,
        })
    }
}
