//! Events once a second.

use crate::time::{NANOS, SimTime};

/// An event once a second from t = 0, in scene time.
#[derive(Debug, Default)]
pub(super) struct EverySecond {
    next: SimTime,
}

impl EverySecond {
    /// Every whole second up to `t` that it has not yielded yet.
    pub fn due(&mut self, t: SimTime) -> impl Iterator<Item = SimTime> + use<> {
        let first = self.next;
        let count = if t >= first { (t - first).0 / NANOS + 1 } else { 0 };
        self.next = SimTime(first.0 + count * NANOS);
        (0..count).map(move |i| SimTime(first.0 + i * NANOS))
    }
}
