//! Waits that end on time: an absolute sleep until shortly before, then a short bounded spin.

use super::{Clock, Margin, Policy};

/// How long it goes without a sleep, and then rests, ns.
struct Rest {
    after: i64,
    length: i64,
}

/// Of a thread that is too late to sleep, packet after packet: it never reaches the kernel's limit for real-time threads
/// (95 % of a second, then a gap of 50 ms).
const BEHIND: Rest = Rest { after: 20_000_000, length: 2_000_000 };
/// Of a thread that is in time, but whose waits are too short for a sleep: it takes some 75 % of a core, and more than half
/// of its waits end on time.
const IN_TIME: Rest = Rest { after: 200_000, length: 60_000 };

/// A clock whose waits end on time, as far as its sleeps allow.
#[derive(Clone, Debug)]
pub struct Precise<C> {
    clock: C,
    margin: Margin,
    /// When it slept last, ns.
    slept: i64,
}

impl<C: Clock> Precise<C> {
    /// Wraps a clock whose sleeps end late.
    pub fn new(clock: C, policy: Policy) -> Precise<C> {
        let slept = clock.now();
        Precise { clock, margin: Margin::new(policy), slept }
    }

    /// The present margin.
    pub fn margin(&self) -> Margin {
        self.margin
    }

    /// The wrapped clock.
    pub fn inner(&self) -> &C {
        &self.clock
    }
}

impl<C: Clock> Clock for Precise<C> {
    fn now(&self) -> i64 {
        self.clock.now()
    }

    fn sleep_until(&mut self, t: i64) {
        self.clock.sleep_until(t);
        self.slept = self.clock.now();
    }

    fn doze_until(&mut self, t: i64) {
        self.clock.doze_until(t);
        self.slept = self.clock.now();
    }

    fn spin_until(&mut self, t: i64) {
        self.clock.spin_until(t);
    }

    fn wait_until(&mut self, t: i64) {
        let now = self.clock.now();
        let wait = t - now;
        let wake = t - self.margin.of_wait(wait);
        if wake > now {
            self.sleep_until(wake);
            self.margin.learn(self.slept - wake, wait);
        } else {
            let Rest { after, length } = if wait > 0 { IN_TIME } else { BEHIND };
            if now - self.slept > after {
                self.sleep_until(now + length);
                self.margin.doubt();
            }
        }
        self.clock.spin_until(t);
    }
}
