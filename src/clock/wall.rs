//! The monotonic clock: an absolute sleep to shortly before the time, then a short bounded spin.

use super::Clock;
use rustix::thread::{ClockId, clock_nanosleep_absolute};
use rustix::time::{Timespec, clock_gettime};

/// How to wait.
#[derive(Clone, Copy, Debug)]
pub struct Pacing {
    /// How long before the time the sleep ends and the spin begins, ns. A wake-up of the scheduler is late by tens
    /// of microseconds; a spin is not, but it burns a core for as long: 60 µs is 6 % of it at 1 kHz.
    pub spin_ns: i64,
}

impl Default for Pacing {
    fn default() -> Self {
        Pacing { spin_ns: 60_000 }
    }
}

/// `CLOCK_MONOTONIC` from the moment it was started.
#[derive(Clone, Copy, Debug)]
pub struct WallClock {
    start: i64,
    pacing: Pacing,
}

impl WallClock {
    /// A clock that reads 0 now.
    pub fn start(pacing: Pacing) -> WallClock {
        WallClock { start: monotonic(), pacing }
    }
}

impl Clock for WallClock {
    fn now(&self) -> i64 {
        monotonic() - self.start
    }

    fn wait_until(&mut self, t: i64) {
        let wake = t - self.pacing.spin_ns;
        if wake > self.now() {
            sleep_until(self.start + wake);
        }
        while self.now() < t {
            std::hint::spin_loop();
        }
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
