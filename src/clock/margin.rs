//! How long before its deadline a wait stops sleeping and spins: learnt from the machine's own wake-ups.

/// What the margin follows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Policy {
    /// The wake-ups seen.
    Adaptive,
    /// Nothing: always this long, ns. For comparison; 0 is a bare sleep.
    Fixed(i64),
}

/// The time from the end of a sleep to what was slept for, ns.
///
/// A quantile of the sleep's own wake lateness, tracked by stochastic approximation (H. Robbins and S. Monro, *A
/// Stochastic Approximation Method*, Ann. Math. Statist. 22, 1951) with a constant gain g, so that it follows a
/// machine that changes: after a wake that was later than the margin it grows by g·q, after any other it shrinks by
/// g·(1 − q), which balance where a share q of the wakes is in time.
#[derive(Clone, Copy, Debug)]
pub struct Margin {
    policy: Policy,
    ns: f64,
}

impl Margin {
    /// What it is never below and never above, ns. A virtual machine's timer is rarely better than the one; and the
    /// other bounds what is spun away where a machine wakes at any time it likes: 8 % of a core at 1 kHz.
    pub const BOUNDS: (f64, f64) = (15_000.0, 80_000.0);
    /// The share of wakes that it is to cover: of the others the caller is late by what is left of theirs.
    const QUANTILE: f64 = 0.99;
    /// The gain, ns: from the upper bound to the lower in 3300 punctual wakes, back in 33 late ones.
    const GAIN: f64 = 2_000.0;

    /// That begins as long as a usual machine needs.
    pub fn new(policy: Policy) -> Margin {
        Margin { policy, ns: 60_000.0 }
    }

    /// How long it is now, ns.
    pub fn ns(&self) -> i64 {
        match self.policy {
            Policy::Adaptive => self.ns as i64,
            Policy::Fixed(ns) => ns,
        }
    }

    /// How much of a wait of `ns` is to be spun: the margin, and never more than half, so that a thread of real-time
    /// priority leaves at least half of its waiting to others. (The kernel stops real-time threads altogether at
    /// 95 % of a second, for 50 ms.)
    pub fn of_wait(&self, ns: i64) -> i64 {
        self.ns().min(ns / 2)
    }

    /// Learns from a sleep that ended this late, ns.
    pub fn learn(&mut self, late: i64) {
        let covered = late as f64 <= self.ns;
        self.ns += Margin::GAIN * (Margin::QUANTILE - f64::from(u8::from(covered)));
        self.ns = self.ns.clamp(Margin::BOUNDS.0, Margin::BOUNDS.1);
    }
}
