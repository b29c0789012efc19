//! `ratetable score`: recorded estimates and filters against the truth, side by side.

mod book;
mod charts;
mod columns;
mod hints;
mod page;
mod sources;
mod text;
mod units;

use super::options::{self, Alignment};
use super::progress::Bar;
use super::{Refusal, Verdict, say, tell};
use crate::dataset::{self, Holds};
use crate::geometry::Axes;
use crate::report::{Limit, LimitError, ScoreReport, Scored};
use crate::score::{self, Clock, Delay, Figures, Options, Series, Unjudged};
use crate::table::{Rows, TimeUnit};
use crate::time::SimTime;
use book::Book;
use serde_json::Value;
use sources::Truth;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// A dataset folder, or a file of time and attitude like an estimate's
    truth: PathBuf,
    /// Files of time and attitude (a table with a header, a TUM trajectory, a PX4 ULog), or filters to run on the
    /// dataset: vqf, fusion, madgwick, mahony, eskf, each also with -6d (no magnetometer)
    #[arg(required = true)]
    estimate: Vec<String>,
    /// What to remove from each estimate before scoring
    #[arg(long, value_enum, default_value_t = Alignment::None)]
    align: Alignment,
    /// The delay on the dataset's own clock: 0 keeps it, fit estimates it, or a time such as 12ms; rows and charts are
    /// without it, and figures with and without it are always given. It also says that the times are the dataset's
    #[arg(long, value_name = "0|fit|TIME", allow_hyphen_values = true, value_parser = options::delay)]
    delay: Option<Delay>,
    /// Which clock the estimates' times use: the truth's, or another, whose offset is found from the motion
    /// [default: found from the motion or from the times themselves]
    #[arg(long, value_enum, conflicts_with = "delay")]
    clock: Option<ClockOf>,
    /// The unit of times whose column has none
    #[arg(long, value_name = "s|ms|us|ns", value_parser = |text: &str| text.parse::<TimeUnit>())]
    time_unit: Option<TimeUnit>,
    /// Leave out this much time from the truth's start
    #[arg(long, value_name = "TIME", default_value = "0", value_parser = options::from_zero)]
    settle: SimTime,
    /// The axes of tables and TUM trajectories: ned-frd or enu-flu [default: the dataset's, else ned-frd]
    #[arg(long, value_name = "AXES", value_parser = axes)]
    axes: Option<Axes>,
    #[command(flatten)]
    columns: columns::Columns,
    /// Fail (exit 1) unless a report field meets this limit, such as 'estimates.vqf.rms_deg<1'; a field of an
    /// estimate alone, such as 'rms_deg<1', applies to every estimate
    #[arg(long = "limit", value_name = "FIELD<VALUE", value_parser = options::limit)]
    limit: Vec<Limit>,
    /// Write report, errors and charts into this folder
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Replace the output folder if there is one
    #[arg(long)]
    force: bool,
    /// Print the report as JSON on standard output
    #[arg(long)]
    json: bool,
}

fn axes(text: &str) -> Result<Axes, String> {
    Axes::from_name(text).ok_or_else(|| format!("write {}", Axes::NAMES.join(" or ")))
}

/// An estimate with its name and where it came from.
struct Source {
    name: String,
    source: String,
    /// What is known of its clock.
    clock: Clock,
    /// The unit of its times.
    time_unit: TimeUnit,
    /// What of a file was read and left out.
    rows: Option<Rows>,
    recorded: Estimates,
    hints: hints::Known,
}

/// What is judged.
struct Estimates {
    series: Series,
    /// Other ways to read it.
    others: Vec<(&'static str, Series)>,
    /// In which it is written.
    axes: Axes,
    /// What the user should know of how it was read.
    remarks: Vec<String>,
}

/// `--clock`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum ClockOf {
    /// The truth's
    Truth,
    /// Another
    Other,
}

pub fn score(arguments: &Arguments) -> Result<Verdict, Refusal> {
    if let Some(dir) = &arguments.out {
        dataset::may_write(dir, arguments.force, Holds::Score, &book::FILES.map(String::from))?;
    }
    let bar = Bar::of_steps();
    let (truth, sources) = sources::load(arguments, &bar)?;
    check_limits(&arguments.limit, &sources)?;
    let mut book = arguments.out.as_ref().map(|dir| Book::open(dir, arguments.force)).transpose()?;
    let mut scored = Vec::new();
    for source in sources {
        bar.step(format!("judges {}", source.name));
        scored.push(one(&truth, source, arguments, book.as_mut())?);
    }
    bar.clear();
    let report = report(arguments, &truth, scored)?;
    tell(&text::report(&report));
    let json = serde_json::to_string_pretty(&report)? + "\n";
    if let (Some(book), Some(dir)) = (book, &arguments.out) {
        book.close(&report, &truth, &json)?;
        tell(&format!("{}: written", dir.display()));
    }
    if arguments.json {
        say(&json)?;
    }
    Ok(if report.ok { Verdict::Fine } else { Verdict::Failed })
}

/// Judges one estimate and adds its errors to the book.
fn one(
    truth: &Truth,
    source: Source,
    arguments: &Arguments,
    book: Option<&mut Book>,
) -> Result<Scored, Refusal> {
    let Source { name, source, clock, time_unit, rows, recorded, hints: given } = source;
    let at = |t| truth.track.at(t);
    let Estimates { series, others, axes, remarks } = recorded;
    let (count, options) = (series.len(), options(truth, clock, axes, arguments));
    let time_unit = time_unit.name();
    let mut scored =
        Scored { name, source, figures: None, unknown: None, time_unit, rows, remarks, hints: Vec::new() };
    match score::judge_series(&at, series, &others, &options) {
        Ok(judged) => {
            if let Some(book) = book {
                book.add(&scored.name, &judged, &at)?;
            }
            scored.remarks.extend(judged.note.clone());
            scored.hints = hints::of(&judged, given);
            scored.figures = Some(judged.figures);
        }
        Err(Unjudged::NoTruth) => {
            return Err(Refusal(format!(
                "{}: none of its {count} attitudes is at a time that the truth covers ({} to {}{})",
                scored.source,
                truth.track.first(),
                truth.track.last(),
                if arguments.settle > SimTime::ZERO { ", less --settle" } else { "" }
            )));
        }
        Err(Unjudged::When(why)) => {
            scored.unknown = Some(format!("{why}; if its times are the truth's, say --clock truth"));
        }
    }
    Ok(scored)
}

/// How an estimate is judged.
fn options(truth: &Truth, clock: Clock, axes: Axes, arguments: &Arguments) -> Options {
    Options {
        align: arguments.align.into(),
        clock: match (arguments.clock, arguments.delay) {
            _ if clock != Clock::Auto => clock,
            (Some(ClockOf::Other), _) => Clock::Other,
            (Some(ClockOf::Truth), _) | (_, Some(_)) => Clock::Truth,
            (None, None) => Clock::Auto,
        },
        delay: arguments.delay.unwrap_or(Delay::Keep),
        from: truth.track.first(),
        until: truth.track.last(),
        rest: truth.rest,
        settle: arguments.settle,
        axes,
    }
}

fn report(arguments: &Arguments, truth: &Truth, estimates: Vec<Scored>) -> Result<ScoreReport, Refusal> {
    let mut report = ScoreReport {
        version: env!("CARGO_PKG_VERSION").into(),
        ok: true,
        failed: Vec::new(),
        truth: arguments.truth.display().to_string(),
        truth_time_unit: truth.unit.name(),
        truth_remarks: truth.remarks.clone(),
        align: arguments.align.name().into(),
        settle_s: arguments.settle.seconds(),
        estimates,
    };
    let unknown = report.estimates.iter().filter_map(|scored| Some((&scored.name, scored.unknown.as_ref()?)));
    report.failed.extend(unknown.map(|(name, why)| format!("estimates.{name} cannot be judged: {why}")));
    let value = serde_json::to_value(&report)?;
    for limit in &arguments.limit {
        if limit.check(&value).is_ok() {
            report.failed.extend(limit.broken(&value));
            continue;
        }
        for (scored, value) in
            report.estimates.iter().zip(value["estimates"].as_array().into_iter().flatten())
        {
            let broken = limit.broken(value);
            report.failed.extend(broken.map(|broken| format!("estimates.{}.{broken}", scored.name)));
        }
    }
    report.ok = report.failed.is_empty();
    Ok(report)
}

/// An estimate with every field that there can be: limits are checked against it before anything is judged.
pub(super) fn shape(name: &str) -> Scored {
    Scored {
        name: name.into(),
        source: name.into(),
        figures: Some(Figures::shape()),
        unknown: None,
        time_unit: "ns",
        rows: Some(Rows::default()),
        remarks: Vec::new(),
        hints: Vec::new(),
    }
}

/// Whether every limit is of a field that there will be.
fn check_limits(limits: &[Limit], sources: &[Source]) -> Result<(), LimitError> {
    let estimates: Vec<Value> =
        sources.iter().map(|source| serde_json::to_value(shape(&source.name)).unwrap_or_default()).collect();
    let one = estimates.first().cloned().unwrap_or_default();
    let shape = serde_json::json!({ "estimates": estimates });
    limits.iter().try_for_each(|limit| match limit.check(&one) {
        Ok(()) => Ok(()),
        Err(of_one) => {
            limit.check(&shape).map_err(|of_all| if limit.is_of("estimates") { of_all } else { of_one })
        }
    })
}
