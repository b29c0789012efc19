//! What follows for a part from its changes of readings and of filters' errors.

use super::paired::{Finding, Paired};
use super::parts::Part;
use super::readings::{A_TENTH, Change, HALF_A_COUNT};
use super::scores::{self, Scores};
use crate::sensor::SensorKind;
use crate::study::filters::Subject;
use serde::{Serialize, Serializer};
use std::fmt;

/// A change of a filter's RMS error below this share of the error goes unnoticed: figures of filters are compared and
/// published with two digits, so two per cent is less than anyone acts on.
pub const MARGIN: f64 = 0.02;
/// Or below this, degrees: less than the best mounting of a part, and than any filter here reaches on a part's noise.
pub const MARGIN_DEG: f64 = 0.01;

/// Whether a scene needs a part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// A filter's error changes by more than its margin; or the readings show it, and no filter could tell.
    Needed,
    /// No filter notices, and the largest change is below half a count.
    BelowResolution,
    /// No filter notices, and the largest change is below a tenth of the noise of a sample.
    BelowNoise,
    /// The readings show it, but no filter's error changes by more than its margin.
    NotNoticed,
    /// Too few seeds to tell.
    Undecided,
}

impl Verdict {
    /// Every one, the gravest first.
    pub const ALL: [Verdict; 5] = [
        Verdict::Needed,
        Verdict::Undecided,
        Verdict::NotNoticed,
        Verdict::BelowNoise,
        Verdict::BelowResolution,
    ];

    /// Of a part's change of readings, where it is known, and what each filter that reads its sensor says.
    pub fn of(part: Part, change: Option<&Change>, filters: &[FilterChange]) -> Verdict {
        let any = |finding| filters.iter().any(|filter| filter.finding == finding);
        let below = change.filter(|change| !change.beside).and_then(|change| {
            let counts = change.counts.filter(|_| !part.is_term("resolution"));
            let noise = change.noise.filter(|_| !part.is_term("white_noise"));
            let resolved = counts.is_some_and(|[_, most]| most < HALF_A_COUNT);
            let drowned = noise.is_some_and(|[_, most]| most < A_TENTH);
            resolved.then_some(Verdict::BelowResolution).or_else(|| drowned.then_some(Verdict::BelowNoise))
        });
        if any(Finding::Different) {
            return Verdict::Needed;
        }
        if any(Finding::Undecided) {
            return Verdict::Undecided;
        }
        below.unwrap_or(if filters.is_empty() { Verdict::Needed } else { Verdict::NotNoticed })
    }

    /// Whether the part may be left out.
    pub fn may_go(self) -> bool {
        !matches!(self, Verdict::Needed | Verdict::Undecided)
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Verdict::Needed => "needed",
            Verdict::BelowResolution => "below resolution",
            Verdict::BelowNoise => "below noise",
            Verdict::NotNoticed => "not noticed by any filter",
            Verdict::Undecided => "undecided",
        })
    }
}

impl Serialize for Verdict {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// How much more a filter is wrong without a part.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FilterChange {
    /// As users call it: `vqf`, `vqf-6d`.
    pub filter: String,
    /// Its RMS error on the whole scene, degrees: the mean over the seeds.
    pub rms_deg: f64,
    /// What is more without, degrees.
    #[serde(flatten)]
    pub change: Paired,
    /// Changes within ± this go unnoticed, degrees.
    pub margin_deg: f64,
    /// What follows.
    pub finding: Finding,
    /// About how many seeds would decide it; `None` where it is decided.
    pub seeds_to_decide: Option<f64>,
}

impl FilterChange {
    fn new(filter: String, with: &[f64], without: &[f64]) -> Option<FilterChange> {
        let change = Paired::of(with, without)?;
        let rms_deg = with.iter().sum::<f64>() / with.len() as f64;
        let margin_deg = MARGIN_DEG.max(MARGIN * rms_deg);
        let finding = change.finding(margin_deg);
        let open = finding == Finding::Undecided;
        let seeds_to_decide = open.then(|| change.pairs_to_decide(margin_deg));
        Some(FilterChange { filter, rms_deg, change, margin_deg, finding, seeds_to_decide })
    }

    /// The largest change that its interval allows, in margins: at most 1 is not noticed.
    pub fn margins(&self) -> f64 {
        self.change.bound() / self.margin_deg
    }
}

/// Of every filter that reads the sensor, if one is meant.
pub fn filter_changes(
    runs: &[Subject],
    sensor: Option<SensorKind>,
    with: &Scores,
    without: &Scores,
) -> Vec<FilterChange> {
    let of = |(i, run): (usize, &Subject)| FilterChange::new(run.name(), &with.of(i), &without.of(i));
    runs.iter().enumerate().filter(|(_, run)| scores::reads(run, sensor)).filter_map(of).collect()
}

/// The filter that decides: the one with the largest change in margins, of those with the gravest finding.
pub fn worst(filters: &[FilterChange]) -> Option<&FilterChange> {
    let grave = |filter: &FilterChange| match filter.finding {
        Finding::Same => 0,
        Finding::Undecided => 1,
        Finding::Different => 2,
    };
    let order = |a: &&FilterChange, b: &&FilterChange| {
        grave(a).cmp(&grave(b)).then(a.margins().total_cmp(&b.margins()))
    };
    filters.iter().max_by(order)
}

#[cfg(test)]
mod tests {
    use super::super::parts::What;
    use super::*;

    fn part(name: &'static str) -> Part {
        Part { sensor: Some(SensorKind::Gyro), what: What::Term(name) }
    }

    fn filter(size: f64, spread: f64) -> FilterChange {
        let without = [1.0 + size + spread, 1.0 + size - spread, 1.0 + size];
        FilterChange::new("vqf".into(), &[1.0; 3], &without).unwrap()
    }

    fn change(counts: f64, noise: f64) -> Change {
        let both = |most: f64| Some([most / 2.0, most]);
        Change { sensor: SensorKind::Gyro, counts: both(counts), noise: both(noise), beside: false }
    }

    #[test]
    fn the_margin_is_a_share_of_the_error_or_a_hundredth_of_a_degree() {
        assert!((filter(0.0, 0.0).margin_deg - 0.02).abs() < 1e-15);
        let small = FilterChange::new("vqf".into(), &[0.1, 0.1], &[0.1, 0.1]).unwrap();
        assert_eq!(small.margin_deg, 0.01);
    }

    #[test]
    fn a_filter_that_notices_wins_over_readings_that_do_not_show_it() {
        let tiny = change(0.1, 0.01);
        let of = |part, change: &Change, filters: &[FilterChange]| Verdict::of(part, Some(change), filters);
        let (same, different, open) = (filter(0.0, 0.001), filter(0.5, 0.001), filter(0.0, 0.5));
        assert_eq!(of(part("bias"), &tiny, &[same.clone(), different.clone()]), Verdict::Needed);
        assert_eq!(of(part("bias"), &tiny, &[same.clone(), open.clone()]), Verdict::Undecided);
        assert_eq!(of(part("bias"), &tiny, &[open.clone(), different]), Verdict::Needed);
        assert!(open.seeds_to_decide.unwrap() > 3.0 && same.seeds_to_decide.is_none());
        for (change, verdict) in [
            (tiny, Verdict::BelowResolution),
            (change(0.49, 5.0), Verdict::BelowResolution),
            (change(0.51, 0.09), Verdict::BelowNoise),
            (change(0.51, 0.11), Verdict::NotNoticed),
            (Change { beside: true, ..tiny }, Verdict::NotNoticed),
        ] {
            assert_eq!(of(part("bias"), &change, std::slice::from_ref(&same)), verdict, "{change:?}");
        }
    }

    #[test]
    fn noise_is_not_set_against_itself_nor_rounding_and_what_no_filter_reads_is_judged_by_readings() {
        let no = |part, change: &Change| Verdict::of(part, Some(change), &[]);
        assert_eq!(no(part("white_noise"), &change(3.0, 0.01)), Verdict::Needed);
        assert_eq!(no(part("resolution"), &change(0.4, 3.0)), Verdict::Needed);
        assert_eq!(no(part("resolution"), &change(0.4, 0.05)), Verdict::BelowNoise);
        assert_eq!(no(part("bias"), &change(3.0, 1.0)), Verdict::Needed);
        assert_eq!(no(part("bias"), &change(0.3, 1.0)), Verdict::BelowResolution);
        assert_eq!(Verdict::of(part("bias"), None, &[]), Verdict::Needed);
    }

    #[test]
    fn the_filter_that_decides_is_the_one_shown() {
        let of = |name: &str, size, spread| FilterChange { filter: name.into(), ..filter(size, spread) };
        // A wide interval allows more than a narrow one that is surely outside.
        let all = [of("same", 0.001, 0.0), of("open", 0.0, 9.0), of("different", 0.05, 0.001)];
        assert_eq!(worst(&all).unwrap().filter, "different");
        assert_eq!(worst(&all[..2]).unwrap().filter, "open");
        assert_eq!(worst(&[]), None);
    }
}
