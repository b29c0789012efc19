//! Wall and virtual clocks: the only place that knows the time or sleeps until it.
//!
//! ```
//! use ratetable::clock::{Clock, VirtualClock};
//!
//! let mut clock = VirtualClock::default();
//! clock.wait_until(5_000_000);
//! assert_eq!(clock.now(), 5_000_000);
//! ```

mod margin;
mod precise;
#[cfg(test)]
mod tests;
mod wall;

pub use margin::{Margin, Policy};
pub use precise::Precise;
pub use wall::WallClock;

/// A clock that can be waited on, in nanoseconds from a start of its own; it never goes back.
pub trait Clock: Send {
    /// Now, ns.
    fn now(&self) -> i64;

    /// Gives the processor away until `t`; wakes as late as the system makes it. At once when `t` has passed.
    fn sleep_until(&mut self, t: i64);

    /// As [`Clock::sleep_until`], but another thread may end it early by unparking this one.
    fn doze_until(&mut self, t: i64) {
        self.sleep_until(t);
    }

    /// Keeps the processor until `t`; at once when it has passed.
    fn spin_until(&mut self, t: i64) {
        while self.now() < t {
            std::hint::spin_loop();
        }
    }

    /// Returns at `t` or as soon after as it can; at once when `t` has passed.
    fn wait_until(&mut self, t: i64) {
        self.sleep_until(t);
    }
}

/// A clock for tests: waiting takes no time, and a sleep ends as late as the test says.
#[derive(Clone, Debug, Default)]
pub struct VirtualClock {
    now: i64,
    /// How long after its time each sleep ends, in turn and over again, ns.
    pub wakes_late: Vec<i64>,
    /// Sleeps so far.
    pub sleeps: usize,
    /// Time spent spinning so far, ns.
    pub spun: i64,
}

impl VirtualClock {
    /// That wakes these times late, in turn.
    pub fn waking_late(late: impl Into<Vec<i64>>) -> VirtualClock {
        VirtualClock { wakes_late: late.into(), ..VirtualClock::default() }
    }
}

impl Clock for VirtualClock {
    fn now(&self) -> i64 {
        self.now
    }

    fn sleep_until(&mut self, t: i64) {
        if t <= self.now {
            return;
        }
        let late = self.wakes_late.get(self.sleeps % self.wakes_late.len().max(1)).copied().unwrap_or(0);
        self.sleeps += 1;
        self.now = t + late;
    }

    fn spin_until(&mut self, t: i64) {
        self.spun += (t - self.now).max(0);
        self.now = self.now.max(t);
    }
}
