//! How long before its deadline a wait stops sleeping and spins: learnt from the machine's own wake-ups.

/// How the margin is set.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Policy {
    /// From the observed wake-ups.
    Adaptive,
    /// Always this long, ns. For comparison; 0 is a bare sleep.
    Fixed(i64),
}

/// The time from the end of a sleep to the deadline, ns.
///
/// It tracks a quantile q of the sleep's lateness by stochastic approximation (H. Robbins and S. Monro, *A
/// Stochastic Approximation Method*, Ann. Math. Statist. 22, 1951). The gain g is constant, so it follows a machine
/// that changes: after a wake-up later than the margin it grows by g·q, after any other it shrinks by g·(1 − q).
/// The two balance where a share q of the wake-ups is on time.
#[derive(Clone, Copy, Debug)]
pub struct Margin {
    policy: Policy,
    ns: f64,
}

impl Margin {
    /// Its bounds, ns. A virtual machine's timer is rarely better than the lower one. The upper one limits the
    /// spinning on a machine that wakes at arbitrary times: 8 % of a core at 1 kHz.
    pub const BOUNDS: (f64, f64) = (15_000.0, 80_000.0);
    /// The share of wake-ups to cover. For the others the caller is late by what exceeds the margin.
    const QUANTILE: f64 = 0.99;
    /// The gain, ns: from the upper bound to the lower in 3300 punctual wake-ups, back in 33 late ones.
    const GAIN: f64 = 2_000.0;

    /// A margin that starts at what a usual machine needs.
    pub fn new(policy: Policy) -> Margin {
        Margin { policy, ns: 60_000.0 }
    }

    /// Its present length, ns.
    pub fn ns(&self) -> i64 {
        match self.policy {
            Policy::Adaptive => self.ns as i64,
            Policy::Fixed(ns) => ns,
        }
    }

    /// How much of a wait of `ns` to spin: the margin, but at most half, so that a real-time thread leaves at least
    /// half of its waiting time to others. (The kernel stops real-time threads altogether at 95 % of a second, for
    /// 50 ms.)
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
