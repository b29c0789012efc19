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
///
/// Which share that is depends on the wait. A longer margin makes fewer wake-ups late, and costs its length in every
/// wait: a processor notices a few µs of every 125, and not of every 1000. So 1 − q is 30 µs over the wait, 3 % at 1 kHz,
/// but between 1 % and a quarter: more than half of the waits end on time at any rate.
#[derive(Clone, Copy, Debug)]
pub struct Margin {
    policy: Policy,
    ns: f64,
    /// The median of the lateness, ns, tracked likewise.
    usual: f64,
}

impl Margin {
    /// Its bounds, ns. The lower one is less than any system's timer needs. The upper one limits the spinning on a
    /// machine that wakes at arbitrary times: 8 % of a core at 1 kHz.
    pub const BOUNDS: (f64, f64) = (3_000.0, 80_000.0);
    /// The share of late wake-ups to accept, times the wait, ns. Then the caller is late by what exceeds the margin.
    const ACCEPTED: f64 = 30_000.0;
    /// The bounds of that share.
    const SHARES: (f64, f64) = (0.01, 0.25);
    /// The gain, ns: from the upper bound to the lower in 1300 punctual wake-ups at 1 kHz, back in 40 late ones.
    const GAIN: f64 = 2_000.0;

    /// A margin that starts at what a usual machine needs.
    pub fn new(policy: Policy) -> Margin {
        Margin { policy, ns: 60_000.0, usual: 0.0 }
    }

    /// Its present length, ns.
    pub fn ns(&self) -> i64 {
        match self.policy {
            Policy::Adaptive => self.ns as i64,
            Policy::Fixed(ns) => ns,
        }
    }

    /// How much of a wait of `ns` to spin: the margin, but at most seven eighths, so that a real-time thread leaves
    /// the rest to others. (The kernel stops real-time threads altogether at 95 % of a second, for 50 ms.) All of it
    /// where a sleep of an eighth would usually end too late.
    pub fn of_wait(&self, ns: i64) -> i64 {
        let most = ns / 8 * 7;
        if self.policy == Policy::Adaptive && most < self.usual as i64 {
            return ns;
        }
        self.ns().min(most)
    }

    /// Believes a little less, after a rest, that sleeps end too late for the waits of now: sooner or later one of them is
    /// tried, and tells. What a rest itself tells is of no use, for a longer sleep ends later.
    pub fn doubt(&mut self) {
        self.usual = (self.usual - Margin::GAIN / 8.0).max(0.0);
    }

    /// Learns from a sleep that ended this late in a wait of `wait`, both ns.
    pub fn learn(&mut self, late: i64, wait: i64) {
        let accepted = (Margin::ACCEPTED / wait.max(1) as f64).clamp(Margin::SHARES.0, Margin::SHARES.1);
        let toward = |quantile: f64, share: f64| {
            let covered = f64::from(u8::from(late as f64 <= quantile));
            (quantile + Margin::GAIN * (1.0 - share - covered)).min(Margin::BOUNDS.1)
        };
        self.ns = toward(self.ns, accepted).max(Margin::BOUNDS.0);
        self.usual = toward(self.usual, 0.5).max(0.0);
    }
}
