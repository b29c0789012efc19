//! What each part of a scene costs and does, so that nothing is modelled which the scene does not need.
//!
//! A part is what a key can leave out: an error term of a sensor, its faults, averaging, a force, the wind. For each the
//! study plays the scene with it and without: nanoseconds a sample, the change of the readings, and the change of the
//! attitude error of every built-in filter, paired over seeds. A part may go where no filter notices: the whole interval
//! of each filter's change lies within ± its margin. All that may go is then left out together, and the leaner scene has
//! to pass the same test on seeds of its own.
//!
//! ```
//! use ratetable::{scene::Plan, study::{all_cores, parsimony::{self, Effort}}};
//! use std::time::Instant;
//!
//! let scene = "duration = \"2 s\"\n[gyro]\nrate = \"50 Hz\"\nnoise_std = \"0.1 deg/s\"\n[accel]\nrate = \"50 Hz\"\n";
//! let plan = Plan::parse(scene, "", "short", &[])?;
//! let effort = Effort { seeds: 3, ..Effort::QUICK };
//! let start = Instant::now();
//! let found = parsimony::run(&plan, effort, all_cores(), &|| start.elapsed(), &|_, _| ())?;
//! assert_eq!((found.rows.len(), found.rows[0].term.as_str()), (1, "white_noise"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod costs;
mod lean;
mod paired;
mod parts;
mod readings;
mod scores;
mod variant;
mod verdicts;

pub use paired::{CONFIDENCE, Finding, Paired};
pub use verdicts::{FilterChange, MARGIN, MARGIN_DEG, Verdict};

use crate::parallel::{self, Progress};
use crate::scene::{Plan, SceneError};
use crate::time::{NANOS, SimTime};
use costs::Rounds;
use lean::{Candidate, Lean};
use parts::Part;
use readings::Change;
use scores::Trials;
use serde::Serialize;
use std::time::Duration;
use variant::{Base, Variant};

/// How much is played.
#[derive(Clone, Copy, Debug)]
pub struct Effort {
    /// Seeds for the filters, and as many again for the leaner scene; at least 2.
    pub seeds: u64,
    /// How much of a longer scene is played, s.
    pub seconds: i64,
    /// Rounds of the costs.
    pub rounds: usize,
    /// Ticks of a round.
    pub ticks: u64,
}

impl Effort {
    /// Minutes.
    pub const FULL: Effort = Effort { seeds: 48, seconds: 60, rounds: 100, ticks: 20_000 };
    /// Less than one.
    pub const QUICK: Effort = Effort { seeds: 8, seconds: 20, rounds: 10, ticks: 4_000 };
}

/// What a part costs and does: a line of `parsimony.csv`, whose columns the fields are.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// `gyro`, `accel` …, or `scene`.
    pub sensor: &'static str,
    /// The error term, or `faults`, `averaging`, `force 1`, `wind`.
    pub term: String,
    /// Nanoseconds that it adds to a sample of its sensor, or to a tick of the scene.
    pub ns_per_sample: f64,
    /// RMS change of the readings, in counts.
    pub rms_counts: Option<f64>,
    /// The largest.
    pub largest_counts: Option<f64>,
    /// RMS change of the readings, as a part of the white noise of a sample.
    pub rms_of_noise: Option<f64>,
    /// The largest.
    pub largest_of_noise: Option<f64>,
    /// The filter that decides; `None` where none reads the sensor.
    pub filter: Option<String>,
    /// What its RMS attitude error is more without the part, degrees.
    pub change_deg: Option<f64>,
    /// Its standard error.
    pub standard_error_deg: Option<f64>,
    /// Half the interval of that change, degrees.
    pub interval_deg: Option<f64>,
    /// Changes within ± this go unnoticed, degrees.
    pub margin_deg: Option<f64>,
    /// The largest effect in what would just be noticed: the far end of the interval in margins; where no filter reads
    /// the sensor, the largest change of a reading in half counts or tenths of the noise.
    pub times_noticed: Option<f64>,
    /// What follows.
    pub verdict: Verdict,
    /// About how many seeds would decide it.
    pub seeds_to_decide: Option<f64>,
    /// Every filter's change.
    #[serde(skip)]
    pub filters: Vec<FilterChange>,
}

/// The leaner scene.
#[derive(Clone, Debug, Serialize)]
pub struct Leaner {
    /// `sensor.term` of what stays.
    pub kept: Vec<String>,
    /// Of what is left out.
    pub left_out: Vec<String>,
    /// Of what could go alone, but not with the others, and why.
    pub put_back: Vec<String>,
    /// Nanoseconds a nine-axis sample of the whole scene.
    pub ns_before: f64,
    /// Of the leaner one.
    pub ns_after: f64,
    /// Each filter's change from the whole scene: the same within its margin.
    pub filters: Vec<FilterChange>,
    /// It as a scene.
    #[serde(skip)]
    pub text: String,
}

/// What was found.
#[derive(Clone, Debug, Serialize)]
pub struct Parsimony {
    /// The scene's name.
    pub scene: String,
    /// How much of it was played, s.
    pub seconds: f64,
    /// How long it is, s.
    pub whole_seconds: f64,
    /// Over how many seeds.
    pub seeds: u64,
    /// Of the intervals.
    pub confidence: f64,
    /// The largest difference that was measured between the costs of a scene and itself, ns a sample.
    pub ns_of_nothing: f64,
    /// A row a part.
    pub rows: Vec<Row>,
    /// Every filter's change, part by part, in the order of `rows`.
    pub filters: Vec<Vec<FilterChange>>,
    /// The leaner scene.
    pub lean: Leaner,
}

/// Studies `plan` on `threads` threads; `now` is a clock that never goes back. `progress` counts the runs of one stage
/// after the other.
///
/// # Errors
/// A scene that cannot be read again as it was resolved, as when a file that it names has changed.
pub fn run(
    plan: &Plan,
    effort: Effort,
    threads: usize,
    now: &dyn Fn() -> Duration,
    progress: Progress,
) -> Result<Parsimony, SceneError> {
    let base = Base::of(plan)?;
    let whole = base.whole();
    let of = |part: Part| (part, base.without(part));
    let without: Vec<(Part, Variant)> = parts::parts(plan).into_iter().map(of).collect();
    let end = plan.duration.min(SimTime(effort.seconds * NANOS));
    let seeds = effort.seeds.max(2);
    let runs = scores::runs(plan);
    let trials = |seeds| Trials { runs: &runs, seeds, end, threads };

    let changes = parallel::map(threads, without.len(), &|_, _| (), |i| {
        readings::change(without[i].0, [&whole, &without[i].1], end)
    });
    let changes = changes.into_iter().collect::<Result<Vec<_>, _>>()?;
    let filters = filters(&whole, &without, &trials(0..seeds), progress)?;
    let rounds = Rounds { rounds: effort.rounds.max(1), ticks: effort.ticks, now };
    let costs = rounds.costs(&whole, &without)?;
    let parts = without.iter().zip(changes).zip(&filters).zip(&costs.ns);
    let rows: Vec<Row> =
        parts.map(|((((part, _), change), filters), ns)| Row::of(*part, *ns, change, filters)).collect();

    let lean = lean::search(&base, &candidates(&without, &rows), &trials(seeds..2 * seeds), progress)?;
    let ns = rounds.nine_axis(&[whole, lean.variant.clone()])?;
    Ok(Parsimony {
        scene: plan.name.clone(),
        seconds: end.seconds(),
        whole_seconds: plan.duration.seconds(),
        seeds,
        confidence: CONFIDENCE,
        ns_of_nothing: costs.ns_of_nothing,
        rows,
        filters,
        lean: Leaner::of(plan, lean, [ns[0], ns[1]], seeds),
    })
}

/// Every filter's change without each part; none for a part of a sensor that no filter reads.
fn filters(
    whole: &Variant,
    without: &[(Part, Variant)],
    trials: &Trials<'_>,
    progress: Progress,
) -> Result<Vec<Vec<FilterChange>>, SceneError> {
    let read = |part: Part| trials.runs.iter().any(|run| scores::reads(run, part.sensor));
    let variants = without.iter().filter(|(part, _)| read(*part)).map(|(_, variant)| variant);
    let played: Vec<&Variant> = [whole].into_iter().chain(variants).collect();
    if played.len() == 1 {
        return Ok(vec![Vec::new(); without.len()]);
    }
    let mut scores = trials.of(&played, progress)?.into_iter();
    let with = scores.next().unwrap_or_default();
    let of = |(part, _): &(Part, Variant)| {
        let one = if read(*part) { scores.next() } else { None };
        one.map_or_else(Vec::new, |one| verdicts::filter_changes(trials.runs, part.sensor, &with, &one))
    };
    Ok(without.iter().map(of).collect())
}

/// What may go.
fn candidates(without: &[(Part, Variant)], rows: &[Row]) -> Vec<Candidate> {
    let may_go = without.iter().zip(rows).filter(|(_, row)| row.verdict.may_go());
    let of = |((part, _), row): (&(Part, Variant), &Row)| {
        let margins = if row.filters.is_empty() { 0.0 } else { row.times_noticed.unwrap_or(0.0) };
        Candidate { part: *part, margins, why: row.verdict.to_string() }
    };
    may_go.map(of).collect()
}

impl Row {
    fn of(part: Part, ns_per_sample: f64, change: Option<Change>, filters: &[FilterChange]) -> Row {
        let (worst, verdict) = (verdicts::worst(filters), Verdict::of(part, change.as_ref(), filters));
        let seeds = filters.iter().filter_map(|filter| filter.seeds_to_decide).reduce(f64::max);
        let counts = change.and_then(|change| change.counts);
        let noise = change.and_then(|change| change.noise);
        let shown = change.map(|change| change.times_shown(part)).filter(|times| times.is_finite());
        Row {
            sensor: part.owner(),
            term: part.name(),
            ns_per_sample,
            rms_counts: counts.map(|[rms, _]| rms),
            largest_counts: counts.map(|[_, most]| most),
            rms_of_noise: noise.map(|[rms, _]| rms),
            largest_of_noise: noise.map(|[_, most]| most),
            filter: worst.map(|filter| filter.filter.clone()),
            change_deg: worst.map(|filter| filter.change.mean),
            standard_error_deg: worst.map(|filter| filter.change.standard_error),
            interval_deg: worst.map(|filter| filter.change.half),
            margin_deg: worst.map(|filter| filter.margin_deg),
            times_noticed: worst.map(FilterChange::margins).or(shown),
            verdict,
            seeds_to_decide: seeds.filter(|_| verdict == Verdict::Undecided),
            filters: filters.to_vec(),
        }
    }
}

impl Leaner {
    fn of(plan: &Plan, lean: Lean, [ns_before, ns_after]: [f64; 2], seeds: u64) -> Leaner {
        let name = |part: &Part| format!("{}.{}", part.owner(), part.name());
        let headline = headline(plan, &lean, seeds);
        Leaner {
            text: lean::text(plan, &lean, &headline),
            kept: lean.kept.iter().map(name).collect(),
            left_out: lean.left_out.iter().map(|(part, _)| name(part)).collect(),
            put_back: lean.put_back.iter().map(|(part, why)| format!("{} ({why})", name(part))).collect(),
            ns_before,
            ns_after,
            filters: lean.filters,
        }
    }
}

/// What the lean scene says of itself.
fn headline(plan: &Plan, lean: &Lean, seeds: u64) -> String {
    let (out, kept) = (lean.left_out.len(), lean.kept.len());
    if out == 0 {
        return format!("The scene {} as it is: nothing of its {kept} terms can be left out", plan.name);
    }
    let first =
        format!("The scene {} without {out} of its {} terms, which it does not need", plan.name, out + kept);
    if lean.filters.is_empty() {
        return format!("{first}\nNo filter reads its sensors: only their readings were looked at");
    }
    let bounds = lean.filters.iter().map(|filter| {
        let (bound, margin) = (filter.change.bound(), filter.margin_deg);
        format!(
            "\n  {}: {:.4} deg, within ±{bound:.4} of it (margin {margin:.4})",
            filter.filter, filter.rms_deg
        )
    });
    format!(
        "{first}\nIts filters' RMS attitude errors are those of the whole scene, over {seeds} seeds of their own ({} % intervals):{}",
        CONFIDENCE * 100.0,
        bounds.collect::<String>()
    )
}

#[cfg(test)]
mod tests;
