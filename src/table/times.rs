//! The times of a table's rows, with every digit, and what unit they can be in.

use std::fmt;
use std::str::FromStr;

/// A unit that logs count time in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum TimeUnit {
    /// Seconds.
    S,
    /// Milliseconds.
    Ms,
    /// Microseconds.
    Us,
    /// Nanoseconds.
    Ns,
}

impl TimeUnit {
    /// Every one, the longest first.
    pub const ALL: [TimeUnit; 4] = [TimeUnit::S, TimeUnit::Ms, TimeUnit::Us, TimeUnit::Ns];

    /// How many nanoseconds it is.
    pub const fn ns(self) -> i64 {
        match self {
            TimeUnit::S => 1_000_000_000,
            TimeUnit::Ms => 1_000_000,
            TimeUnit::Us => 1000,
            TimeUnit::Ns => 1,
        }
    }

    /// As spelled: `s`, `ms`, `us`, `ns`.
    pub const fn name(self) -> &'static str {
        match self {
            TimeUnit::S => "s",
            TimeUnit::Ms => "ms",
            TimeUnit::Us => "us",
            TimeUnit::Ns => "ns",
        }
    }
}

impl fmt::Display for TimeUnit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for TimeUnit {
    type Err = String;

    fn from_str(text: &str) -> Result<TimeUnit, String> {
        let unit = TimeUnit::ALL.into_iter().find(|unit| unit.name() == text);
        unit.ok_or_else(|| format!("`{text}` is not a unit of time here: write s, ms, us or ns"))
    }
}

/// Ticks in one unit of a column's time.
pub const TICKS: i128 = 1_000_000_000;
/// The shortest and the longest step that a log has: 40 kHz and 0.2 Hz, in ns.
const STEPS: std::ops::RangeInclusive<i128> = 25_000..=5_000_000_000;
/// The dates that a clock may show, s since 1970: the years 2000 to 2100.
const DATES: std::ops::Range<i128> = 946_684_800..4_102_444_800;

/// Times of rows, in order but for the breaks.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Times {
    /// In 1e-9 of the column's unit.
    pub ticks: Vec<i128>,
    /// The unit, where the file says it.
    pub unit: Option<TimeUnit>,
    /// The rows at which a new clock begins: its time is before that of the row above and goes on from there.
    pub breaks: Vec<usize>,
}

impl Times {
    /// Times that are known in ns.
    pub fn of_ns(times: impl IntoIterator<Item = i64>) -> Times {
        let ticks = times.into_iter().map(|ns| i128::from(ns) * TICKS).collect();
        Times { ticks, unit: Some(TimeUnit::Ns), breaks: Vec::new() }
    }

    /// In ns, were they counted in `unit`: rounded where they are finer, `None` where they are beyond 292 years.
    pub fn in_ns(&self, unit: TimeUnit) -> Option<Vec<i64>> {
        self.scaled(unit.ns())
    }

    /// In ns, were one of their units so many of them.
    pub fn scaled(&self, ns_in_unit: i64) -> Option<Vec<i64>> {
        self.ticks.iter().map(|ticks| scaled(*ticks, ns_in_unit)).collect()
    }

    /// The units in which the rows come at a rate that a log has, 0.2 Hz to 40 kHz, the longest first; where the file
    /// says the unit, that alone. A time with a fraction is in no nanoseconds.
    pub fn plausible(&self) -> Vec<TimeUnit> {
        if let Some(unit) = self.unit {
            return vec![unit];
        }
        let Some(step) = self.median_step() else { return TimeUnit::ALL.to_vec() };
        let is_whole = self.is_whole();
        let fits = |unit: &TimeUnit| {
            let ns = step.saturating_mul(i128::from(unit.ns())) / TICKS;
            STEPS.contains(&ns) && (is_whole || *unit != TimeUnit::Ns)
        };
        TimeUnit::ALL.into_iter().filter(fits).collect()
    }

    /// The unit that is likeliest, and whether no other could be meant: the one that is said; the one in which the
    /// times are dates of this century; seconds where they have a fraction; else by how far apart the rows are.
    pub fn guess(&self) -> (TimeUnit, bool) {
        let plausible = self.plausible();
        let is_plausible = |unit: TimeUnit| plausible.contains(&unit);
        if let [unit] = plausible[..] {
            return (unit, true);
        }
        if let Some(unit) = self.date().filter(|unit| is_plausible(*unit)) {
            return (unit, true);
        }
        if !self.is_whole() && is_plausible(TimeUnit::S) {
            return (TimeUnit::S, true);
        }
        let step = self.median_step().unwrap_or(TICKS);
        let unit = match step / TICKS {
            _ if !self.is_whole() => TimeUnit::S,
            50_000.. => TimeUnit::Ns,
            50.. => TimeUnit::Us,
            2.. => TimeUnit::Ms,
            _ => TimeUnit::S,
        };
        (if is_plausible(unit) { unit } else { plausible.first().copied().unwrap_or(unit) }, false)
    }

    /// The unit in which the first time is a date of this century, s since 1970.
    fn date(&self) -> Option<TimeUnit> {
        let first = *self.ticks.first()?;
        let seconds = |unit: TimeUnit| first / TICKS / i128::from(TICKS as i64 / unit.ns());
        TimeUnit::ALL.into_iter().find(|unit| DATES.contains(&seconds(*unit)))
    }

    fn is_whole(&self) -> bool {
        self.ticks.iter().all(|ticks| ticks % TICKS == 0)
    }

    /// Of the steps forward, in ticks.
    fn median_step(&self) -> Option<i128> {
        let steps = self.ticks.windows(2).map(|pair| pair[1].saturating_sub(pair[0]));
        let mut steps: Vec<i128> = steps.filter(|step| *step > 0).collect();
        let middle = steps.len().checked_sub(1)? / 2;
        Some(*steps.select_nth_unstable(middle).1)
    }
}

/// Ticks of a unit of so many ns as ns.
pub(super) fn scaled(ticks: i128, ns_in_unit: i64) -> Option<i64> {
    let scaled = ticks.checked_mul(i128::from(ns_in_unit))?;
    let (whole, rest) = (scaled / TICKS, scaled % TICKS);
    let up = i128::from(2 * rest.abs() >= TICKS) * rest.signum();
    i64::try_from(whole + up).ok()
}

/// A decimal number as ticks, rounded only where it is finer: a count of seconds since 1970 keeps all its digits, which
/// a double does not. `None` where it is no number, or beyond 10²⁹.
pub fn decimal(text: &str) -> Option<i128> {
    if let Ok(whole) = text.parse::<i64>() {
        return Some(i128::from(whole) * TICKS);
    }
    let (mantissa, exponent) = match text.split_once(['e', 'E']) {
        Some((mantissa, exponent)) => (mantissa, exponent.parse::<i32>().ok()?),
        None => (text, 0),
    };
    let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    if !fraction.bytes().all(|byte| byte.is_ascii_digit()) || fraction.len() > 30 {
        return None;
    }
    // Digits beyond a nanosecond of a nanosecond are nothing.
    let digits: i128 = format!("{whole}{fraction}").parse().ok()?;
    let power = exponent.checked_sub(fraction.len() as i32)?.checked_add(9)?;
    let ten = 10i128.checked_pow(power.unsigned_abs());
    if power >= 0 {
        return digits.checked_mul(ten?);
    }
    let Some(ten) = ten else { return Some(0) };
    let rest = digits % ten;
    Some(rest.signum() * i128::from(rest.unsigned_abs() >= ten.unsigned_abs().div_ceil(2)) + digits / ten)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn times(list: &[&str]) -> Times {
        let ticks = list.iter().map(|text| decimal(text).unwrap()).collect();
        Times { ticks, unit: None, breaks: Vec::new() }
    }

    #[test]
    fn a_time_keeps_every_digit_down_to_a_nanosecond() {
        let s = TimeUnit::S.ns();
        for (text, unit, ns) in [
            ("1700000000.123456789", s, 1_700_000_000_123_456_789),
            ("1700000000123456", 1000, 1_700_000_000_123_456_000),
            ("-0.5", s, -500_000_000),
            ("+2", s, 2_000_000_000),
            ("1.5e-3", s, 1_500_000),
            ("1e3", 1, 1000),
            ("0.00000000051", s, 1),
            ("0.00000000049", s, 0),
            ("1.25", 60 * s, 75 * s),
            ("1e-300", 1, 0),
            ("1403636579763555584", 1, 1_403_636_579_763_555_584),
        ] {
            assert_eq!(scaled(decimal(text).unwrap(), unit), Some(ns), "{text}");
        }
        for text in ["", ".", "-", "nan", "inf", "1.2.3", "1e", "0x10", "1.-5", "1e300", "12:30:00"] {
            assert_eq!(decimal(text), None, "{text}");
        }
        assert_eq!(scaled(decimal("1e12").unwrap(), s), None, "beyond 292 years");
    }

    #[test]
    fn a_unit_is_plausible_where_the_rate_is_that_of_a_log() {
        use TimeUnit::{Ms, Ns, S, Us};
        for (list, plausible, guess) in [
            (&["0.0", "0.01", "0.02"][..], vec![S], (S, true)),
            (&["0", "10", "20"], vec![Ms], (Ms, true)),
            (&["0", "10000", "20000"], vec![Us], (Us, true)),
            (&["0", "10000000", "20000000"], vec![Ns], (Ns, true)),
            // 10 Hz in ms or 10 kHz in us: nobody can tell.
            (&["0", "100", "200"], vec![Ms, Us], (Us, false)),
            (&["7", "8", "9"], vec![S, Ms], (S, false)),
            // 10 Hz in us is 10 kHz in ns, but the first time is a date in us.
            (&["1700000000000000", "1700000000100000", "1700000000200000"], vec![Us, Ns], (Us, true)),
            (&["0", "0.1", "0.2"], vec![S, Ms], (S, true)),
            (&["0.0", "10.5", "20.5"], vec![Ms], (Ms, true)),
        ] {
            assert_eq!((times(list).plausible(), times(list).guess()), (plausible, guess), "{list:?}");
        }
        let said = Times { unit: Some(Ms), ..times(&["7", "8", "9"]) };
        assert_eq!((said.plausible(), said.guess()), (vec![Ms], (Ms, true)));
    }

    #[test]
    fn a_unit_is_written_as_it_is_read() {
        for unit in TimeUnit::ALL {
            assert_eq!(unit.to_string().parse(), Ok(unit));
        }
        assert!("min".parse::<TimeUnit>().unwrap_err().contains("s, ms, us or ns"));
    }

    proptest::proptest! {
        #[test]
        fn no_text_of_a_time_panics(text in "[-+0-9.eE]{0,40}") {
            if let Some(ticks) = decimal(&text) {
                for unit in TimeUnit::ALL {
                    let _ = scaled(ticks, unit.ns());
                }
            }
        }
    }
}
