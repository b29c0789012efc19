//! `ratetable generate`: a dataset.

use super::progress::Bar;
use super::show::PAGE;
use super::{Refusal, Verdict, clash, list, options, tell};
use crate::dataset::{
    self, Bounds, FEATURES, FORMATS, Figure, Format, Holds, Made, Options, RunOptions, Shard, Summary,
};
use crate::interrupt::on_interrupt;
use crate::parallel;
use crate::report::chart::{Line, LineKind, Panel, Panels, panels};
use crate::report::count;
use crate::scene::{Plan, Runs, nearest};
use crate::session::Outcome;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Folders that one command makes at most.
const MOST_RUNS: u64 = 1_000_000;

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// A TOML file or the name of a built-in scene
    scene: String,
    /// The folder to create
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    #[arg(long, value_name = "FORMAT", help = formats_help(), value_delimiter = ',', default_value = "csv", value_parser = format)]
    format: Vec<&'static Format>,
    /// Override one key of the scene, such as gyro.rate='8 kHz'
    #[arg(long = "set", value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Make this many runs of the scene, each in its own folder, seeded by its index and with its values from [sweep]
    /// (default if [sweep] has lists: every combination once)
    #[arg(long, value_name = "N", value_parser = options::runs)]
    runs: Option<u64>,
    /// Make only the runs whose index divided by N leaves the remainder I
    #[arg(long, value_name = "I/N")]
    shard: Option<Shard>,
    /// Also draw the sensors and the reference angles as SVG
    #[arg(long)]
    figures: bool,
    /// Replace the folder if it exists
    #[arg(long)]
    force: bool,
}

fn formats_help() -> String {
    format!("Formats, separated by commas: {}", list::formats::named())
}

fn format(name: &str) -> Result<&'static Format, String> {
    Format::from_name(name).ok_or_else(|| {
        if FEATURES.contains(&name) {
            return format!(
                "`{name}` is not in this build: it needs large dependencies; build with `--features {name}`"
            );
        }
        let names: Vec<_> = FORMATS.iter().map(|format| format.name).collect();
        let near =
            nearest(name, names.iter().copied()).map_or(String::new(), |near| format!(", perhaps `{near}`"));
        format!("`{name}` is not a format of this version ({}){near}", names.join(", "))
    })
}

pub fn generate(arguments: &Arguments) -> Result<Verdict, Refusal> {
    if let Some(runs) = several(arguments)? {
        return generate_runs(arguments, &runs);
    }
    let plan = Plan::load(&arguments.scene, &arguments.set)?;
    let names = dataset::names(&plan, &arguments.format, arguments.figures, &[]);
    dataset::may_write(&arguments.out, arguments.force, Holds::Dataset, &names)?;
    clash::folder(&plan, &dataset::replaced(&arguments.out, &names))?;
    affordable(&plan, 1)?;
    plan.warnings.iter().for_each(|warning| tell(&format!("warning: {warning}")));
    let started = Instant::now();
    let bar = Bar::new(plan.duration);
    let stop = on_interrupt();
    let mut progress = |t| bar.offline(t);
    let options = Options {
        force: arguments.force,
        formats: arguments.format.clone(),
        draw: arguments.figures.then_some(&figures),
        stop: Some(&stop),
        ..Options::new(&mut progress)
    };
    let written = dataset::write(&plan, plan.duration, &arguments.out, options);
    bar.clear();
    let summary = written?;
    let seconds = started.elapsed().as_secs_f64();
    tell(&format!(
        "{}: {} of scene, {} in {seconds:.2} s",
        summary.folder.display(),
        plan.duration,
        count(summary.rows, "row")
    ));
    say_clipped(&plan, &summary);
    Ok(Verdict::Fine)
}

/// The scene as one of many runs, if there are several.
fn several(arguments: &Arguments) -> Result<Option<Runs>, Refusal> {
    let runs = Runs::load(&arguments.scene, &arguments.set)?;
    let asked = arguments.runs.is_some() || arguments.shard.is_some() || runs.keys().next().is_some();
    if asked && arguments.runs.is_none() && runs.combinations() == 1 {
        return Err(Refusal("say how many runs, such as --runs 100".into()));
    }
    Ok(asked.then_some(runs))
}

fn generate_runs(arguments: &Arguments, scene: &Runs) -> Result<Verdict, Refusal> {
    let runs = arguments.runs.unwrap_or(scene.combinations());
    let shard = arguments.shard.unwrap_or(Shard::WHOLE);
    let mine = shard.count(runs);
    if mine > MOST_RUNS {
        return Err(Refusal(format!(
            "--runs {runs} makes {mine} folders here, above the limit of {MOST_RUNS}: make a share of them, such as --shard 1/{}, or fewer",
            runs.div_ceil(MOST_RUNS)
        )));
    }
    let first = scene.plan(0)?;
    affordable(&first, mine)?;
    first.warnings.iter().for_each(|warning| tell(&format!("warning: {warning}")));
    let (started, bar, stop) = (Instant::now(), Bar::of_jobs("runs"), on_interrupt());
    let options = RunOptions {
        runs,
        shard,
        force: arguments.force,
        formats: arguments.format.clone(),
        draw: arguments.figures.then_some(&figures),
        threads: parallel::all_cores(),
        progress: &|done, all| bar.runs(done, all),
        stop: &stop,
    };
    let made = dataset::write_runs(scene, &arguments.out, &options);
    bar.clear();
    let Made { written, kept } = made?;
    let there = match kept {
        0 => String::new(),
        1 => ", 1 already existed".to_string(),
        kept => format!(", {kept} already existed"),
    };
    let seconds = started.elapsed().as_secs_f64();
    tell(&format!(
        "{}: {} of {} in {seconds:.2} s{there}",
        arguments.out.display(),
        count(written, "run"),
        first.duration
    ));
    Ok(Verdict::Fine)
}

/// Refuses what would be too large or too slow.
pub fn affordable(plan: &Plan, runs: u64) -> Result<(), Refusal> {
    let absurd = Bounds::of(plan, plan.duration).times(runs).absurd();
    absurd.map_or(Ok(()), |why| Err(Refusal(format!("{}: {why}", plan.name))))
}

fn say_clipped(plan: &Plan, summary: &Summary) {
    for (sensor, clipped) in plan.sensors.iter().zip(&summary.clipped).filter(|(_, clipped)| **clipped > 0) {
        let (samples, are) =
            (count(*clipped, &format!("{} sample", sensor.kind)), if *clipped == 1 { "is" } else { "are" });
        tell(&format!("notice: {samples} beyond the range {are} clipped"));
    }
}

/// Every figure as a file.
fn figures(plan: &Plan, figures: &[Figure]) -> Vec<(String, Vec<u8>)> {
    let file = |figure: &Figure| (format!("{}.svg", figure.file_stem), draw(plan, figure).into_bytes());
    figures.iter().map(file).collect()
}

/// Readings one under another with the truth over each; reference angles together in one panel.
fn draw(plan: &Plan, figure: &Figure) -> String {
    let columns: Vec<(Vec<f64>, Vec<f64>)> =
        figure.series.iter().map(|series| series.points.iter().copied().unzip()).collect();
    let readings: Vec<_> = (0..figure.series.len()).filter(|&i| !figure.series[i].is_truth).collect();
    let line = |i: usize| Line {
        name: &figure.series[i].label,
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
            panel(figure, &figure.series[i].label, vec![line(i), line(readings.len() + k)])
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

/// The report of a run in its folder.
pub const REPORT: &str = "report.json";

/// Asks before a run whether its folder may be written.
pub fn may_write(plan: &Plan, dir: &Path, force: bool) -> Result<(), Refusal> {
    let names = dataset::names(plan, &FORMATS[..1], false, &[REPORT, PAGE]);
    dataset::may_write(dir, force, Holds::Dataset, &names)?;
    clash::folder(plan, &dataset::replaced(dir, &names))
}

/// The dataset of what a run played, with the estimates that came back and the run's own files.
pub fn after_run(
    plan: &Plan,
    outcome: &Outcome,
    files: &[(&str, String)],
    dir: &Path,
    force: bool,
) -> Result<(), Refusal> {
    let extra: Vec<_> =
        files.iter().map(|(name, text)| (name.to_string(), text.clone().into_bytes())).collect();
    let mut progress = |_| {};
    // Ctrl-C that ended the run is no wish to lose its dataset.
    let stop = if outcome.interrupted { Default::default() } else { on_interrupt() };
    let options = Options {
        force,
        stop: Some(&stop),
        estimates: &outcome.estimates,
        link_faults: &outcome.faults,
        extra: &extra,
        ..Options::new(&mut progress)
    };
    let summary = dataset::write(plan, outcome.played, dir, options)?;
    tell(&format!("{}: {}", summary.folder.display(), count(summary.rows, "row")));
    Ok(())
}
