//! The unit of times whose name has none: one that gives a plausible row rate and duration, and an overlap of truth and
//! estimate. If two fit, the user must choose.

use super::Refusal;
use crate::table::{TimeUnit, Times};

/// A file lasts this long at the least, or a good part of what the longest of its units makes it last, ns.
const SHORTEST: i128 = 500_000_000;
/// Two files fit if they overlap by this share of the shorter,
const OVERLAP: f64 = 0.1;
/// and by this share of what the best units make of it.
const OF_BEST: f64 = 0.1;

/// A file's times and what they may be counted in.
#[derive(Clone, Copy)]
pub(super) struct Unit<'a> {
    /// What messages call the file.
    pub name: &'a str,
    /// Its column.
    pub column: &'a str,
    pub times: &'a Times,
    /// The unit that `--time-unit` says.
    pub told: Option<TimeUnit>,
}

impl Unit<'_> {
    /// The units that are plausible by the file alone.
    fn candidates(&self) -> Vec<TimeUnit> {
        if let Some(unit) = self.times.unit.or(self.told) {
            return vec![unit];
        }
        if let (unit, true) = self.times.guess() {
            return vec![unit];
        }
        let units = self.times.plausible();
        let lasts = |unit: &TimeUnit| self.span(*unit).map_or(0, |(first, last)| last - first);
        let longest = units.iter().map(lasts).max().unwrap_or(0);
        units.into_iter().filter(|unit| lasts(unit) >= SHORTEST.min(longest / 2)).collect()
    }

    /// The first and the last time, ns.
    fn span(&self, unit: TimeUnit) -> Option<(i128, i128)> {
        let ns = |ticks: &i128| ticks.saturating_mul(i128::from(unit.ns())) / crate::table::TICKS;
        Some((ns(self.times.ticks.first()?), ns(self.times.ticks.last()?)))
    }

    fn ask(&self, units: &[TimeUnit]) -> Refusal {
        let units: Vec<_> = units.iter().map(TimeUnit::to_string).collect();
        let (name, column) = (self.name, self.column);
        Refusal(match units.is_empty() {
            true => format!(
                "{name}: its column `{column}` has no unit, and no unit gives its rows a plausible rate: give --time-unit s, ms, us or ns"
            ),
            false => format!(
                "{name}: its column `{column}` has no unit and could be in {}: choose with --time-unit",
                units.join(" or ")
            ),
        })
    }
}

/// How much of the shorter of two spans both share, and for how long, ns.
fn overlap(a: (i128, i128), b: (i128, i128)) -> (f64, i128) {
    let shared = (a.1.min(b.1) - a.0.max(b.0)).max(0);
    let shorter = (a.1 - a.0).min(b.1 - b.0).max(1);
    (shared as f64 / shorter as f64, shared)
}

/// The units of the truth and of each estimate.
pub(super) fn choose(truth: &Unit<'_>, estimates: &[Unit<'_>]) -> Result<(TimeUnit, Vec<TimeUnit>), Refusal> {
    let of_truth = truth.candidates();
    let candidates: Vec<Vec<TimeUnit>> = estimates.iter().map(Unit::candidates).collect();
    let fitting: Vec<Vec<[TimeUnit; 2]>> = estimates
        .iter()
        .zip(&candidates)
        .map(|(estimate, units)| fits(truth, &of_truth, estimate, units))
        .collect();
    let agreed = |unit: &&TimeUnit| {
        fitting.iter().all(|pairs| pairs.is_empty() || pairs.iter().any(|pair| pair[0] == **unit))
    };
    let agreed: Vec<TimeUnit> = of_truth.iter().filter(agreed).copied().collect();
    let &[unit] = &agreed[..] else {
        return Err(truth.ask(if agreed.is_empty() { &of_truth } else { &agreed }));
    };
    let one = |((estimate, units), pairs): ((&Unit<'_>, &Vec<TimeUnit>), &Vec<[TimeUnit; 2]>)| {
        let mut fit: Vec<TimeUnit> =
            pairs.iter().filter(|pair| pair[0] == unit).map(|pair| pair[1]).collect();
        if fit.is_empty() {
            fit.clone_from(units);
        }
        match fit[..] {
            [unit] => Ok(unit),
            _ => Err(estimate.ask(&fit)),
        }
    };
    let units = estimates.iter().zip(&candidates).zip(&fitting).map(one).collect::<Result<_, _>>()?;
    Ok((unit, units))
}

/// The pairs of units in which two files overlap, of truth and estimate.
fn fits(
    truth: &Unit<'_>,
    of_truth: &[TimeUnit],
    estimate: &Unit<'_>,
    units: &[TimeUnit],
) -> Vec<[TimeUnit; 2]> {
    let pairs = of_truth.iter().flat_map(|ours| units.iter().map(|theirs| [*ours, *theirs]));
    let shared = |pair: &[TimeUnit; 2]| {
        let (ours, theirs) = (truth.span(pair[0])?, estimate.span(pair[1])?);
        let (share, _) = overlap(ours, theirs);
        let covers = overlap(ours, theirs).1 as f64 / (ours.1 - ours.0).max(1) as f64;
        (share >= OVERLAP).then_some(covers)
    };
    let found: Vec<_> = pairs.filter_map(|pair| Some((pair, shared(&pair)?))).collect();
    let best = found.iter().map(|(_, covers)| *covers).fold(0.0, f64::max);
    found.into_iter().filter(|(_, covers)| *covers >= OF_BEST * best).map(|(pair, _)| pair).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::TICKS;

    fn times(first: i64, step: i64, count: i64) -> Times {
        let ticks = (0..count).map(|k| i128::from(first + step * k) * TICKS).collect();
        Times { ticks, unit: None, breaks: Vec::new() }
    }

    fn unit<'a>(times: &'a Times, told: Option<TimeUnit>) -> Unit<'a> {
        Unit { name: "f.csv", column: "timestamp", times, told }
    }

    #[test]
    fn the_unit_is_that_in_which_rates_are_plausible_and_files_overlap() {
        use TimeUnit::{Ms, Ns, Us};
        let named = Times::of_ns((0..3000).map(|k| k * 10_000_000));
        for (truth, estimate, expected) in [
            // 100 Hz beside 10 Hz in us.
            (times(1_000_000, 10_000, 2001), times(1_000_000, 100_000, 201), (Us, Us)),
            // 10 Hz in ms.
            (times(1000, 100, 201), times(1200, 100, 201), (Ms, Ms)),
            // Four rows of 10 Hz in us.
            (times(1_000_000, 100_000, 4), times(1_000_000, 100_000, 4), (Us, Us)),
            // 10 Hz in ms for ten minutes, beside what is known: 10 kHz would cover a thousandth of it.
            (Times::of_ns((0..60_000).map(|k| k * 10_000_000)), times(0, 100, 6000), (Ns, Ms)),
            (named.clone(), times(5000, 10, 2000), (Ns, Ms)),
            // Another clock, at a rate that only one unit makes plausible.
            (named.clone(), times(900_000_000, 10_000, 2000), (Ns, Us)),
        ] {
            let found = choose(&unit(&truth, None), &[unit(&estimate, None)]).unwrap();
            assert_eq!(found, (expected.0, vec![expected.1]), "{:?}", estimate.ticks[0]);
        }
    }

    #[test]
    fn where_two_fit_the_user_is_asked_and_may_say() {
        // 4 Hz in ms for an hour, or 4 kHz in us for 3.6 s.
        let both = times(1000, 250, 14_400);
        let Refusal(why) = choose(&unit(&both, None), &[unit(&both, None)]).unwrap_err();
        assert!(why.contains("ms or us") && why.contains("--time-unit"), "{why}");
        let told = Some(TimeUnit::Ms);
        let found = choose(&unit(&both, told), &[unit(&both, told)]).unwrap();
        assert_eq!(found, (TimeUnit::Ms, vec![TimeUnit::Ms]));
    }
}
