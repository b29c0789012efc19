//! Detects a reader that has left, in a run where nothing moves without a reader.

use super::open::OpenOutput;
use std::time::Duration;
use tokio::time::Instant;

/// How long no packet has moved because a reader is gone.
pub(super) struct Absence {
    /// A reader that is away this long has left for good.
    limit: Duration,
    packets: u64,
    since: Instant,
}

impl Absence {
    pub(super) fn new(limit: Duration) -> Absence {
        Absence { limit, packets: 0, since: Instant::now() }
    }

    /// Whether a reader has left for good, given the number of packets sent so far. Marks its output.
    pub(super) fn look(&mut self, packets: u64, outputs: &mut [OpenOutput]) -> bool {
        let still = packets == self.packets;
        let left = outputs.iter_mut().find(|it| still && it.link.peer_has_left());
        match left {
            None => (self.packets, self.since) = (packets, Instant::now()),
            Some(output) => output.abandoned = self.since.elapsed() >= self.limit,
        }
        outputs.iter().any(|it| it.abandoned)
    }
}
