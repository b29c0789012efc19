//! Wall and virtual clocks: the only place that knows the time or sleeps until it.

mod wall;

pub use wall::{Pacing, WallClock};

/// A clock that can be waited on, in nanoseconds from a start of its own; it never goes back.
pub trait Clock: Send {
    /// Now, ns.
    fn now(&self) -> i64;

    /// Returns at `t` or as soon after as it can; at once when `t` has passed.
    fn wait_until(&mut self, t: i64);
}

/// A clock for tests: waiting takes no time, and each look at it takes what the test says.
#[derive(Clone, Debug, Default)]
pub struct VirtualClock {
    now: std::cell::Cell<i64>,
    /// How long after its time each wait ends, in turn and over again, ns.
    pub wakes_late: Vec<i64>,
    waits: usize,
}

impl VirtualClock {
    /// That wakes these times late, in turn.
    pub fn waking_late(late: impl Into<Vec<i64>>) -> VirtualClock {
        VirtualClock { wakes_late: late.into(), ..VirtualClock::default() }
    }
}

impl Clock for VirtualClock {
    fn now(&self) -> i64 {
        self.now.get()
    }

    fn wait_until(&mut self, t: i64) {
        if t <= self.now.get() {
            return;
        }
        let late = self.wakes_late.get(self.waits % self.wakes_late.len().max(1)).copied().unwrap_or(0);
        self.waits += 1;
        self.now.set(t + late);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_virtual_clock_jumps_and_never_goes_back() {
        let mut clock = VirtualClock::waking_late([0, 7]);
        for (t, now) in [(100, 100), (200, 207), (150, 207), (300, 300)] {
            clock.wait_until(t);
            assert_eq!(clock.now(), now);
        }
    }

    #[test]
    fn a_wall_clock_never_wakes_early() {
        let mut clock = WallClock::start(Pacing::default());
        for step in [1_000, 100_000, 2_000_000] {
            let t = clock.now() + step;
            clock.wait_until(t);
            assert!(clock.now() >= t, "{step} ns");
        }
    }
}
