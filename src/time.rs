//! Scene time and exact rates.
//!
//! Time is an integer count of nanoseconds and a rate is a fraction, so the k-th tick is computed from k and
//! never accumulated: it is exact after days, at 1 kHz as at 1125 Hz or 400/3 Hz.
//!
//! ```
//! use ratetable::time::{Rate, SimTime};
//!
//! let rate = Rate::new(400, 3).ok_or("no rate")?;
//! assert_eq!(rate.tick(400), SimTime(3_000_000_000), "exact after days, too");
//! # Ok::<(), &str>(())
//! ```

use crate::double::Double;
use std::fmt;

/// Nanoseconds in a second.
pub const NANOS: i64 = 1_000_000_000;

/// A time in nanoseconds since the scene's start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct SimTime(pub i64);

impl SimTime {
    /// The scene's start.
    pub const ZERO: SimTime = SimTime(0);
    /// Later than every tick: a scene played `forever` ends here.
    pub const FOREVER: SimTime = SimTime(i64::MAX);

    /// Seconds, rounded to the nearest double.
    pub fn seconds(self) -> f64 {
        self.0 as f64 / NANOS as f64
    }

    /// Seconds as a hi + lo pair: exact to 10⁻³¹ of itself.
    pub fn exact_seconds(self) -> Double {
        /// 10⁻⁹ and what its nearest double leaves of it.
        const NANO: Double = Double::new(1e-9, -6.228_159_145_777_985e-26);
        Double::from(self.0) * NANO
    }
}

impl std::ops::Add for SimTime {
    type Output = SimTime;
    fn add(self, other: SimTime) -> SimTime {
        SimTime(self.0.saturating_add(other.0))
    }
}

impl std::ops::Sub for SimTime {
    type Output = SimTime;
    fn sub(self, other: SimTime) -> SimTime {
        SimTime(self.0.saturating_sub(other.0))
    }
}

impl fmt::Display for SimTime {
    /// Seconds with at most nine decimals and no trailing zeros: `12.5 s`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (sign, ns) = (if self.0 < 0 { "-" } else { "" }, self.0.unsigned_abs());
        let (whole, rest) = (ns / NANOS as u64, ns % NANOS as u64);
        if rest == 0 {
            return write!(f, "{sign}{whole} s");
        }
        let digits = format!("{rest:09}");
        write!(f, "{sign}{whole}.{} s", digits.trim_end_matches('0'))
    }
}

/// An exact rate in hertz: the fraction `numerator / denominator`, reduced, above zero.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Rate {
    numerator: u64,
    denominator: u64,
    /// Nanoseconds from tick to tick where that is a whole number, else 0.
    whole_ns: u64,
}

impl Rate {
    /// The rate `numerator / denominator` Hz, or `None` if either is zero.
    pub fn new(numerator: u64, denominator: u64) -> Option<Rate> {
        if numerator == 0 || denominator == 0 {
            return None;
        }
        let divisor = gcd(numerator, denominator);
        Some(Rate::reduced(numerator / divisor, denominator / divisor))
    }

    /// A whole number of hertz, above zero.
    pub const fn hz(hertz: u32) -> Rate {
        assert!(hertz > 0);
        Rate::reduced(hertz as u64, 1)
    }

    const fn reduced(numerator: u64, denominator: u64) -> Rate {
        // Beyond the range of numbers there is the general way.
        let whole_ns = match denominator.checked_mul(NANOS as u64) {
            Some(ns) if ns.is_multiple_of(numerator) => ns / numerator,
            _ => 0,
        };
        Rate { numerator, denominator, whole_ns }
    }

    /// `numerator / denominator` times this one; `None` where that is zero or beyond the range of numbers.
    pub fn times(self, numerator: u64, denominator: u64) -> Option<Rate> {
        Rate::new(self.numerator.checked_mul(numerator)?, self.denominator.checked_mul(denominator)?)
    }

    /// Hertz, rounded to the nearest double.
    pub fn as_hz(self) -> f64 {
        self.numerator as f64 / self.denominator as f64
    }

    /// The nominal time between two ticks in seconds.
    pub fn period(self) -> f64 {
        self.denominator as f64 / self.numerator as f64
    }

    /// When tick `k` is due after tick 0: `round(k * denominator * 10⁹ / numerator)` ns, halves up.
    pub fn tick(self, k: u64) -> SimTime {
        if self.whole_ns > 0 {
            let ns = k.saturating_mul(self.whole_ns);
            return SimTime(i64::try_from(ns).unwrap_or(i64::MAX));
        }
        let (p, q) = (i128::from(self.numerator), i128::from(self.denominator));
        let scaled = i128::from(k) * q * i128::from(NANOS);
        let ns = (2 * scaled + p).div_euclid(2 * p);
        SimTime(i64::try_from(ns).unwrap_or(i64::MAX))
    }

    /// Appends when ticks `first`, `first + 1` … are due after `phase`, so many of them, as [`Rate::tick`] has each.
    pub fn extend_ticks(self, phase: SimTime, first: u64, count: u64, times: &mut Vec<SimTime>) {
        let last = (first + count).checked_mul(self.whole_ns).and_then(|ns| i64::try_from(ns).ok());
        match last.and_then(|last| last.checked_add(phase.0)) {
            Some(_) if self.whole_ns > 0 => {
                times.extend((first..first + count).map(|k| SimTime(phase.0 + (k * self.whole_ns) as i64)));
            }
            _ => times.extend((first..first + count).map(|k| phase + self.tick(k))),
        }
    }

    /// How many ticks so many seconds hold, where that is a whole number: then the ticks after them are those after 0.
    pub fn whole_ticks(self, seconds: u64) -> Option<u64> {
        let ticks = self.numerator.checked_mul(seconds)?;
        ticks.is_multiple_of(self.denominator).then(|| ticks / self.denominator)
    }

    /// How many ticks fall in `[0, end)` when tick 0 is due at `phase`.
    pub fn ticks_before(self, phase: SimTime, end: SimTime) -> u64 {
        let span = i128::from(end.0) - i128::from(phase.0);
        if span <= 0 {
            return 0;
        }
        let (p, q) = (i128::from(self.numerator), i128::from(self.denominator));
        let mut k = (span * p / (q * i128::from(NANOS))) as u64;
        while phase + self.tick(k) >= end && k > 0 {
            k -= 1;
        }
        while phase + self.tick(k) < end && self.tick(k) < SimTime::FOREVER {
            k += 1;
        }
        k
    }
}

impl fmt::Display for Rate {
    /// As a scene spells it: `1000 Hz`, `400/3 Hz`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.denominator {
            1 => write!(f, "{} Hz", self.numerator),
            q => write!(f, "{}/{q} Hz", self.numerator),
        }
    }
}

fn gcd(a: u64, b: u64) -> u64 {
    if b == 0 { a } else { gcd(b, a % b) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_kth_tick_is_exact_after_days() {
        let day_s = 86_400;
        for (rate, per_day) in [
            (Rate::hz(1000), 1000 * day_s),
            (Rate::hz(1125), 1125 * day_s),
            (Rate::new(400, 3).unwrap(), 400 * day_s / 3),
            (Rate::hz(8000), 8000 * day_s),
        ] {
            for days in [1, 10, 100] {
                assert_eq!(rate.tick(per_day * days), SimTime((day_s * days) as i64 * NANOS), "{rate}");
            }
        }
    }

    #[test]
    fn a_tick_is_the_nearest_nanosecond_to_its_exact_time() {
        let rate = Rate::new(400, 3).unwrap();
        assert_eq!([0, 1, 2, 3].map(|k| rate.tick(k).0), [0, 7_500_000, 15_000_000, 22_500_000]);
        let rate = Rate::hz(1125);
        assert_eq!([1, 2, 9].map(|k| rate.tick(k).0), [888_889, 1_777_778, 8_000_000]);
    }

    #[test]
    fn many_ticks_are_those_one_by_one_to_the_end_of_time() {
        for rate in [Rate::hz(1000), Rate::hz(1125), Rate::new(400, 3).unwrap(), Rate::new(1, 1000).unwrap()]
        {
            for (phase, first) in [(0, 0), (1234, 5), (0, 9_223_372_000_000), (i64::MAX - 5_000_000, 0)] {
                let mut times = vec![SimTime(7)];
                rate.extend_ticks(SimTime(phase), first, 50, &mut times);
                let one_by_one = (first..first + 50).map(|k| SimTime(phase) + rate.tick(k));
                assert!(times.into_iter().eq([SimTime(7)].into_iter().chain(one_by_one)), "{rate} {phase}");
            }
        }
    }

    #[test]
    fn ticks_before_counts_what_iteration_counts() {
        for rate in [Rate::hz(1000), Rate::hz(1125), Rate::new(400, 3).unwrap(), Rate::hz(3)] {
            for phase in [0, 1, 333_333_333] {
                for end in [1, 888_889, 999_999_999, NANOS, NANOS + 1, 2_345_678_901] {
                    let by_hand = (0..).take_while(|&k| phase + rate.tick(k).0 < end).count() as u64;
                    assert_eq!(
                        rate.ticks_before(SimTime(phase), SimTime(end)),
                        by_hand,
                        "{rate} {phase} {end}"
                    );
                }
            }
        }
    }

    #[test]
    fn times_and_rates_read_as_a_scene_spells_them() {
        assert_eq!(SimTime(5 * NANOS).to_string(), "5 s");
        assert_eq!(SimTime(-1_500_000_000).to_string(), "-1.5 s");
        assert_eq!(SimTime(1).to_string(), "0.000000001 s");
        assert_eq!(Rate::new(1200, 9).unwrap().to_string(), "400/3 Hz");
    }
}
