//! `ratetable study`: every method against every motion, and where methods fail.

mod charts;
mod tables;

use super::progress::Bar;
use super::{Refusal, Verdict, say};
use crate::dataset;
use crate::motion::Trajectory;
use crate::scene::Plan;
use crate::study::motions::{self, Case, OfTrajectory};
use crate::study::stability::Effort;
use crate::study::{accuracy, all_cores, stability};
use clap::ValueEnum;
use serde::Serialize;
use std::path::PathBuf;
use std::time::Instant;

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Which study
    #[arg(default_value = "all")]
    what: What,
    /// A TOML file or the name of a built-in scene: its motion joins the built-in ones
    scene: Option<String>,
    /// Write the numbers as CSV and the charts as SVG into this folder
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Motions A to D at 100 Hz and 1 kHz alone, and a tenth of the steps of drift
    #[arg(long)]
    quick: bool,
    /// Print every row as JSON on standard output
    #[arg(long)]
    json: bool,
    /// Replace the files of an earlier study in the folder
    #[arg(long)]
    force: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, ValueEnum)]
enum What {
    /// Error and cost of each method on each motion
    Accuracy,
    /// What breaks methods, and which it breaks
    Stability,
    /// Both
    All,
}

/// The rows of what was studied.
#[derive(Debug, Serialize)]
struct Results {
    version: &'static str,
    quick: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    accuracy: Option<Vec<accuracy::Row>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    stability: Option<Vec<stability::Row>>,
}

pub fn study(arguments: &Arguments) -> Result<Verdict, Refusal> {
    let plan = arguments.scene.as_ref().map(|scene| Plan::load(scene, &[])).transpose()?;
    if let Some(dir) = &arguments.out {
        dataset::may_write(dir, arguments.force)?;
    }
    let cases = cases(plan.as_ref(), arguments.quick)?;
    let results = run(arguments, &cases);
    if let Some(dir) = &arguments.out {
        dataset::put_all(dir, arguments.force, &files(&results, &cases)?)?;
        eprintln!("{}: written", dir.display());
    }
    if arguments.json {
        say(&(serde_json::to_string_pretty(&results)? + "\n"));
    } else {
        say(&text(&results, &cases));
    }
    Ok(Verdict::Fine)
}

/// The built-in motions, and the scene's own.
fn cases(plan: Option<&Plan>, quick: bool) -> Result<Vec<Case<'_>>, Refusal> {
    let mut cases = if quick { motions::quick() } else { motions::built_in() };
    if let Some(plan) = plan {
        let name = plan.name.clone();
        if cases.iter().any(|case| case.name == name) {
            return Err(Refusal(format!(
                "the scene is called `{name}`, as one of the built-in motions is: give it another `name`"
            )));
        }
        let rates = if quick { motions::QUICK_RATES.to_vec() } else { motions::RATES.to_vec() };
        let trajectory: &Trajectory = &plan.trajectory;
        cases.push(Case {
            name,
            about: "the scene's motion".to_string(),
            duration: plan.duration.seconds(),
            rates,
            path: Box::new(OfTrajectory(trajectory)),
        });
    }
    Ok(cases)
}

fn run(arguments: &Arguments, cases: &[Case]) -> Results {
    let wanted = |what| arguments.what == What::All || arguments.what == what;
    let threads = all_cores();
    Results {
        version: env!("CARGO_PKG_VERSION"),
        quick: arguments.quick,
        accuracy: wanted(What::Accuracy).then(|| {
            let bar = Bar::of_jobs("accuracy");
            let start = Instant::now();
            let rows = accuracy::run(cases, threads, &|| start.elapsed(), &|done, all| bar.jobs(done, all));
            bar.clear();
            rows
        }),
        stability: wanted(What::Stability).then(|| {
            let bar = Bar::of_jobs("stability");
            let effort = if arguments.quick { Effort::QUICK } else { Effort::FULL };
            let rows = stability::run(effort, threads, &|done, all| bar.jobs(done, all));
            bar.clear();
            rows
        }),
    }
}

/// The files of the folder, each by its name.
fn files(results: &Results, cases: &[Case]) -> Result<Vec<(&'static str, Vec<u8>)>, Refusal> {
    let mut files = Vec::new();
    if let Some(rows) = &results.accuracy {
        files.push(("accuracy.csv", csv(rows)?));
        files.push(("accuracy.svg", charts::accuracy(rows, cases).into_bytes()));
    }
    if let Some(rows) = &results.stability {
        files.push(("stability.csv", csv(rows)?));
        files.push(("stability.svg", charts::stability(rows).into_bytes()));
    }
    Ok(files)
}

/// A header and a line a row; what is missing is empty.
fn csv<T: Serialize>(rows: &[T]) -> Result<Vec<u8>, Refusal> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for row in rows {
        writer.serialize(row)?;
    }
    Ok(writer.into_inner()?)
}

fn text(results: &Results, cases: &[Case]) -> String {
    let accuracy = results.accuracy.as_ref().map(|rows| tables::accuracy(rows, cases));
    let stability = results.stability.as_ref().map(|rows| tables::stability(rows));
    accuracy.into_iter().chain(stability).collect::<Vec<_>>().join("\n")
}
