//! Wall and virtual clocks: the only place that reads the time or sleeps.
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

/// A clock to wait on, in nanoseconds from its own start; it never goes back.
pub trait Clock: Send {
    /// Now, ns.
    fn now(&self) -> i64;

    /// Sleeps until `t`; wakes as late as the system makes it. Returns at once if `t` has passed.
    fn sleep_until(&mut self, t: i64);

    /// Like [`Clock::sleep_until`], but another thread may end it early by unparking this one.
    fn doze_until(&mut self, t: i64) {
        self.sleep_until(t);
    }

    /// Spins until `t`; returns at once if it has passed.
    fn spin_until(&mut self, t: i64) {
        while self.now() < t {
            std::hint::spin_loop();
        }
    }

    /// Returns at `t` or as soon after as possible; at once if `t` has passed.
    fn wait_until(&mut self, t: i64) {
        self.sleep_until(t);
    }
}

/// A clock for tests: waiting takes no time, and a sleep ends as late as the test says.
#[derive(Clone, Debug, Default)]
pub struct VirtualClock {
    now: i64,
    /// The lateness of each sleep, in turn and repeated, ns.
    pub wakes_late: Vec<i64>,
    /// Number of sleeps so far.
    pub sleeps: usize,
    /// Time spent spinning so far, ns.
    pub spun: i64,
}

impl VirtualClock {
    /// A clock whose sleeps end this late, in turn.
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
