//! `ratetable generate`: a dataset.

use super::progress::Bar;
use super::{Refusal, Verdict, list, options};
use crate::dataset::{self, FEATURES, FORMATS, Figure, Format, Made, Options, RunOptions, Shard, Summary};
use crate::parallel;
use crate::report::chart::{Line, LineKind, Panel, Panels, panels};
use crate::report::{Report, count};
use crate::scene::{Plan, Runs, nearest};
use crate::session::{Outcome, on_interrupt};
use std::path::{Path, PathBuf};
use std::time::Instant;

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// A TOML file or the name of a built-in scene
    scene: String,
    /// The folder to make
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    #[arg(long, value_name = "FORMAT", help = formats_help(), value_delimiter = ',', default_value = "csv", value_parser = format)]
    format: Vec<&'static Format>,
    /// Override one key of the scene, such as gyro.rate='8 kHz'
    #[arg(long = "set", value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Make this many runs of the scene, each in a folder of its own, seeded by its index and with its part of [sweep]
    /// (default where [sweep] has lists: every combination once)
    #[arg(long, value_name = "N", value_parser = options::runs)]
    runs: Option<u64>,
    /// Make only the runs whose index leaves the remainder I when divided by N
    #[arg(long, value_name = "I/N")]
    shard: Option<Shard>,
    /// Draw the sensors and the reference angles as SVG too
    #[arg(long)]
    figures: bool,
    /// Replace the folder if there is one
    #[arg(long)]
    force: bool,
}

fn formats_help() -> String {
    format!("In which formats, separated by commas: {}", list::formats::named())
}

fn format(name: &str) -> Result<&'static Format, String> {
    Format::from_name(name).ok_or_else(|| {
        if FEATURES.contains(&name) {
            return format!(
                "`{name}` is not in this build: it brings heavy crates, so build with `--features {name}`"
            );
        }
        let names: Vec<_> = FORMATS.iter().map(|format| format.name).collect();
        let near =
            nearest(name, names.iter().copied()).map_or(String::new(), |near| format!(", perhaps `{near}`"));
        format!("`{name}` is no format of this version ({}){near}", names.join(", "))
    })
}

pub fn generate(arguments: &Arguments) -> Result<Verdict, Refusal> {
    if let Some(runs) = several(arguments)? {
        return generate_runs(arguments, &runs);
    }
    let plan = Plan::load(&arguments.scene, &arguments.set)?;
    dataset::may_write(&arguments.out, arguments.force)?;
    plan.warnings.iter().for_each(|warning| eprintln!("warning: {warning}"));
    let started = Instant::now();
    let bar = Bar::new(plan.duration);
    let stop = on_interrupt();
    let figures = if arguments.figures { figures(&plan) } else { Vec::new() };
    let mut progress = |t| bar.offline(t);
    let options = Options {
        force: arguments.force,
        formats: arguments.format.clone(),
        extra: &figures,
        stop: Some(&stop),
        ..Options::new(&mut progress)
    };
    let written = dataset::write(&plan, plan.duration, &arguments.out, options);
    bar.clear();
    let summary = written?;
    let seconds = started.elapsed().as_secs_f64();
    eprintln!(
        "{}: {} of scene, {} in {seconds:.2} s",
        summary.folder.display(),
        plan.duration,
        count(summary.rows, "row")
    );
    say_clipped(&plan, &summary);
    Ok(Verdict::Fine)
}

/// The scene as one of many runs, if there are to be several.
fn several(arguments: &Arguments) -> Result<Option<Runs>, Refusal> {
    let runs = Runs::load(&arguments.scene, &arguments.set)?;
    let asked = arguments.runs.is_some() || arguments.shard.is_some() || runs.keys().next().is_some();
    if asked && arguments.runs.is_none() && runs.combinations() == 1 {
        return Err(Refusal("how many runs? say so, such as --runs 100".into()));
    }
    Ok(asked.then_some(runs))
}

fn generate_runs(arguments: &Arguments, scene: &Runs) -> Result<Verdict, Refusal> {
    let runs = arguments.runs.unwrap_or(scene.combinations());
    let first = scene.plan(0)?;
    first.warnings.iter().for_each(|warning| eprintln!("warning: {warning}"));
    let (started, bar, stop) = (Instant::now(), Bar::of_jobs("runs"), on_interrupt());
    let options = RunOptions {
        runs,
        shard: arguments.shard.unwrap_or(Shard::WHOLE),
        force: arguments.force,
        formats: arguments.format.clone(),
        extra: &|plan| if arguments.figures { figures(plan) } else { Vec::new() },
        threads: parallel::all_cores(),
        progress: &|done, all| bar.runs(done, all),
        stop: &stop,
    };
    let made = dataset::write_runs(scene, &arguments.out, &options);
    bar.clear();
    let Made { written, kept } = made?;
    let there = match kept {
        0 => String::new(),
        1 => ", 1 was there already".to_string(),
        kept => format!(", {kept} were there already"),
    };
    let seconds = started.elapsed().as_secs_f64();
    eprintln!(
        "{}: {} of {} in {seconds:.2} s{there}",
        arguments.out.display(),
        count(written, "run"),
        first.duration
    );
    Ok(Verdict::Fine)
}

fn say_clipped(plan: &Plan, summary: &Summary) {
    for (sensor, clipped) in plan.sensors.iter().zip(&summary.clipped).filter(|(_, clipped)| **clipped > 0) {
        let (samples, are) =
            (count(*clipped, &format!("{} sample", sensor.kind)), if *clipped == 1 { "is" } else { "are" });
        eprintln!("notice: {samples} beyond the range {are} clipped");
    }
}

/// Every figure as a file.
fn figures(plan: &Plan) -> Vec<(String, Vec<u8>)> {
    let figures = dataset::figures(plan, plan.duration);
    figures
        .iter()
        .map(|figure| (format!("{}.svg", figure.file_stem), draw(plan, figure).into_bytes()))
        .collect()
}

/// Readings one under another with the truth over each; reference angles together in one panel.
fn draw(plan: &Plan, figure: &Figure) -> String {
    let columns: Vec<(Vec<f64>, Vec<f64>)> =
        figure.series.iter().map(|series| series.points.iter().copied().unzip()).collect();
    let readings: Vec<_> = (0..figure.series.len()).filter(|&i| !figure.series[i].is_truth).collect();
    let line = |i: usize| Line {
        name: figure.series[i].label,
        x: &columns[i].0,
        y: &columns[i].1,
        kind: if figure.series[i].is_truth && !readings.is_empty() {
            LineKind::Truth
        } else {
            LineKind::Value
        },
    };
    let stacked = if !readings.is_empty() {
        let pair = |(k, &i): (usize, &usize)| {
            panel(figure, figure.series[i].label, vec![line(i), line(readings.len() + k)])
        };
        readings.iter().enumerate().map(pair).collect()
    } else {
        vec![panel(figure, "", (0..figure.series.len()).map(line).collect())]
    };
    panels(&Panels {
        title: figure.title.to_string(),
        subtitle: format!("{}, {} axes, seed {}", plan.name, plan.axes, plan.seed),
        x_label: "time (s)".into(),
        panels: stacked,
    })
}

fn panel<'a>(figure: &Figure, title: &str, lines: Vec<Line<'a>>) -> Panel<'a> {
    Panel {
        title: title.to_string(),
        y_label: figure.y_label.to_string(),
        lines,
        wrap: figure.wraps.then_some(360.0),
        log_y: false,
    }
}

/// Asks before a run whether its folder may be written.
pub fn may_write(dir: &Path, force: bool) -> Result<(), Refusal> {
    Ok(dataset::may_write(dir, force)?)
}

/// The dataset of what a run played, with the estimates that came back and the run's report.
pub fn after_run(
    plan: &Plan,
    outcome: &Outcome,
    report: &Report,
    dir: &Path,
    force: bool,
) -> Result<(), Refusal> {
    let report = serde_json::to_string_pretty(report)? + "\n";
    let mut progress = |_| {};
    let options = Options {
        force,
        estimates: &outcome.estimates,
        link_faults: &outcome.faults,
        extra: &[("report.json".to_string(), report.into_bytes())],
        ..Options::new(&mut progress)
    };
    let summary = dataset::write(plan, outcome.played, dir, options)?;
    eprintln!("{}: {}", summary.folder.display(), count(summary.rows, "row"));
    Ok(())
}
