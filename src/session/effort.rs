//! CPU use of the pacing thread.

use crate::os;
use std::time::Duration;

/// The share of a core that the calling thread uses, without pauses.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Effort {
    used: Duration,
    spent: i64,
    since: Option<(Duration, i64)>,
}

impl Effort {
    /// Counts from `now` (ns).
    pub(super) fn resume(&mut self, now: i64) {
        self.since = Some((os::thread_cpu_time(), now));
    }

    /// Counts up to `now` (ns).
    pub(super) fn pause(&mut self, now: i64) {
        if let Some((used, began)) = self.since.take() {
            self.used += os::thread_cpu_time().saturating_sub(used);
            self.spent += now - began;
        }
    }

    /// The share of a core; `None` before anything is counted.
    pub(super) fn share(&self) -> Option<f64> {
        (self.spent > 0).then(|| self.used.as_secs_f64() / (self.spent as f64 * 1e-9))
    }
}
