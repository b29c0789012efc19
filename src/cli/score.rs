//! `ratetable score`: recorded estimates and filters against the truth, side by side.

mod charts;
mod columns;
mod sources;
mod text;

use super::options::{self, Alignment};
use super::{Refusal, Verdict, say};
use crate::dataset;
use crate::geometry::Axes;
use crate::report::{Limit, LimitError, ScoreReport, Scored};
use crate::score::{self, Clock, DelayKnown, Figures, Judged, Recorded, Timed, Track};
use crate::time::SimTime;
use serde_json::Value;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// A dataset's folder, or a file of time and attitude as an estimate's
    truth: PathBuf,
    /// Files of time and attitude (a table with a header, a TUM trajectory, a PX4 ULog), or filters to run on the
    /// dataset: vqf, fusion, madgwick, mahony, and with -6d without the magnetometer
    #[arg(required = true)]
    estimate: Vec<String>,
    /// What to take out of each estimate before it is judged
    #[arg(long, value_enum, default_value_t = Alignment::None)]
    align: Alignment,
    /// Leave out so much from the truth's start on
    #[arg(long, value_name = "TIME", default_value = "0", value_parser = options::from_zero)]
    settle: SimTime,
    /// The axes of tables and TUM trajectories: ned-frd or enu-flu [default: the dataset's, else ned-frd]
    #[arg(long, value_name = "AXES", value_parser = axes)]
    axes: Option<Axes>,
    #[command(flatten)]
    columns: columns::Columns,
    /// Fail (exit 1) unless a field of the report keeps to this, such as 'estimates.vqf.rms_deg<1'; a field of an
    /// estimate alone, such as 'rms_deg<1', means each of them
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
    recorded: Recorded,
    /// What was recorded, with its times in ns.
    estimates: Vec<Timed>,
}

pub fn score(arguments: &Arguments) -> Result<Verdict, Refusal> {
    if let Some(dir) = &arguments.out {
        dataset::may_write(dir, arguments.force)?;
    }
    let given = sources::Given { axes: arguments.axes, columns: arguments.columns.choice() };
    let truth = sources::truth(&arguments.truth, &given)?;
    let sources = sources::estimates(&truth, &arguments.estimate, &given)?;
    check_limits(&arguments.limit, &sources)?;
    let mut judged = Vec::new();
    let mut scored = Vec::new();
    for Source { name, source, recorded, estimates } in &sources {
        let one = judge(&truth.track, recorded, estimates, arguments).ok_or_else(|| {
            Refusal(format!(
                "{source}: none of its {} attitudes is at a time at which the truth is known ({} to {}{})",
                estimates.len(),
                truth.track.first(),
                truth.track.last(),
                if arguments.settle > SimTime::ZERO { ", less --settle" } else { "" }
            ))
        })?;
        let mut remarks = recorded.remarks.clone();
        remarks.extend(advice(&one.figures, arguments.align));
        let (name, source) = (name.clone(), source.clone());
        scored.push(Scored { name, source, figures: one.figures.clone(), remarks });
        judged.push(one);
    }
    let report = report(arguments, scored)?;
    eprint!("{}", text::report(&report));
    if let Some(dir) = &arguments.out {
        let json = serde_json::to_string_pretty(&report)? + "\n";
        let files = [
            ("report.json", json.into_bytes()),
            ("errors.csv", charts::errors_csv(&report, &judged).into_bytes()),
            ("attitude.svg", charts::attitude(&report, &judged, &truth).into_bytes()),
            ("error.svg", charts::error(&report, &judged).into_bytes()),
        ];
        dataset::put_all(dir, arguments.force, &files)?;
        eprintln!("{}: written", dir.display());
    }
    if arguments.json {
        say(&(serde_json::to_string_pretty(&report)? + "\n"));
    }
    Ok(if report.ok { Verdict::Fine } else { Verdict::Failed })
}

/// On the truth's clock, unless the times do not fit or the estimate is far off there and near on a clock of its own.
fn judge(track: &Track, recorded: &Recorded, estimates: &[Timed], arguments: &Arguments) -> Option<Judged> {
    let options = score::Options {
        align: arguments.align.into(),
        clock: Clock::Scene,
        from: track.first() + arguments.settle,
        until: track.last(),
        axes: recorded.axes,
    };
    let on = |clock| {
        let options = score::Options { clock, ..options };
        score::judge_readings(&|t| track.at(t), estimates, &recorded.others, &options)
    };
    let within = |i: usize| {
        let t = estimates[i].arrival;
        track.first() <= t && t <= track.last()
    };
    let inside = (0..estimates.len()).filter(|&i| within(i)).count();
    let is_ours = 2 * inside >= estimates.len();
    let ours = if is_ours { Some(on(Clock::Scene)?) } else { None };
    let is_good = |judged: &Judged| judged.figures.rms_deg < 10.0 || judged.figures.looks.is_some();
    if ours.as_ref().is_some_and(is_good) {
        return ours;
    }
    let theirs = on(Clock::Foreign);
    let is_sure = |judged: &Judged| is_good(judged) && judged.figures.delay_doubt.is_none();
    if ours.is_none() || theirs.as_ref().is_some_and(is_sure) { theirs } else { ours }
}

/// What would help.
fn advice(figures: &Figures, align: Alignment) -> Option<String> {
    let heading_alone = figures.heading_rms_deg > 10.0 && figures.inclination_rms_deg < 5.0;
    (align == Alignment::None && heading_alone && figures.looks.is_none()).then(|| {
        "only its heading is far off: without a magnetometer it is free, and --align heading takes a constant one out"
            .to_string()
    })
}

fn report(arguments: &Arguments, estimates: Vec<Scored>) -> Result<ScoreReport, Refusal> {
    let mut report = ScoreReport {
        version: env!("CARGO_PKG_VERSION").into(),
        ok: true,
        failed: Vec::new(),
        truth: arguments.truth.display().to_string(),
        align: arguments.align.name().into(),
        settle_s: arguments.settle.seconds(),
        estimates,
    };
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

/// Whether every limit is of a field that there will be: before anything is judged.
fn check_limits(limits: &[Limit], sources: &[Source]) -> Result<(), LimitError> {
    let figures = Figures {
        samples: 0,
        rms_deg: 0.0,
        max_deg: 0.0,
        inclination_rms_deg: 0.0,
        inclination_max_deg: 0.0,
        heading_rms_deg: 0.0,
        heading_max_deg: 0.0,
        delay_ms: Some(0.0),
        delay_known: DelayKnown::Unknown,
        delay_doubt: None,
        clock_offset_s: Some(0.0),
        heading_offset_deg: Some(0.0),
        looks: None,
        looks_rms_deg: Some(0.0),
    };
    let scored = |source: &Source| {
        let (name, source) = (source.name.clone(), source.source.clone());
        let scored = Scored { name, source, figures: figures.clone(), remarks: Vec::new() };
        serde_json::to_value(scored).unwrap_or_default()
    };
    let estimates: Vec<Value> = sources.iter().map(scored).collect();
    let one = estimates.first().cloned().unwrap_or_default();
    let shape = serde_json::json!({ "estimates": estimates });
    limits.iter().try_for_each(|limit| match limit.check(&one) {
        Ok(()) => Ok(()),
        Err(of_one) => {
            limit.check(&shape).map_err(|of_all| if limit.is_of("estimates") { of_all } else { of_one })
        }
    })
}
