//! The monotonic clock.

use super::Clock;
use rustix::thread::{ClockId, clock_nanosleep_absolute};
use rustix::time::{Timespec, clock_gettime};
use std::time::Duration;

/// `CLOCK_MONOTONIC` from its start; its waits are bare absolute sleeps.
#[derive(Clone, Copy, Debug)]
pub struct WallClock {
    start: i64,
}

impl WallClock {
    /// A clock that reads 0 now.
    pub fn start() -> WallClock {
        WallClock { start: monotonic() }
    }
}

impl Clock for WallClock {
    fn now(&self) -> i64 {
        monotonic() - self.start
    }

    fn sleep_until(&mut self, t: i64) {
        if t > self.now() {
            sleep_until(self.start + t);
        }
    }

    fn doze_until(&mut self, t: i64) {
        std::thread::park_timeout(Duration::from_nanos((t - self.now()).max(0) as u64));
    }
}

const NANOS: i64 = 1_000_000_000;

fn monotonic() -> i64 {
    let now = clock_gettime(ClockId::Monotonic);
    now.tv_sec * NANOS + now.tv_nsec
}

fn sleep_until(t: i64) {
    let request = Timespec { tv_sec: t.div_euclid(NANOS), tv_nsec: t.rem_euclid(NANOS) };
    // A signal ends the sleep early: sleep on to the same absolute time.
    while clock_nanosleep_absolute(ClockId::Monotonic, &request) == Err(rustix::io::Errno::INTR) {}
}
