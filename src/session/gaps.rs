//! When a port was unplugged, and what that cost.

use crate::report;

/// When a port was unplugged.
#[derive(Clone, Debug, Default)]
pub(super) struct Gaps {
    pub count: u64,
    pub total_ns: i64,
    /// Packets dropped while it was away, and their samples.
    pub dropped: u64,
    pub samples: u64,
    /// When it was found gone, while it is away.
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

    /// Counts a lost packet and its samples, if the port is away.
    pub(super) fn lost(&mut self, samples: u64) {
        if self.since.is_some() {
            self.dropped += 1;
            self.samples += samples;
        }
    }

    /// The port took a packet again, or the run is over.
    pub(super) fn end(&mut self, now: i64) {
        if let Some(since) = self.since.take() {
            self.total_ns += now - since;
        }
    }

    /// The entry for the report; `None` if it never happened.
    pub(super) fn report(&self) -> Option<report::Gaps> {
        (self.count > 0).then_some(report::Gaps {
            count: self.count,
            total_s: self.total_ns as f64 * 1e-9,
            dropped: self.dropped,
            samples: self.samples,
        })
    }
}
