//! `ratetable study`: every method against every motion, and where methods fail.

mod charts;
mod tables;

use super::progress::Bar;
use super::{Refusal, Verdict, say, tell};
use crate::dataset::{self, Holds};
use crate::motion::Trajectory;
use crate::scene::{Plan, builtin, nearest};
use crate::study::motions::{self, Case, OfTrajectory};
use crate::study::stability::Effort;
use crate::study::{accuracy, all_cores, allan, cost, stability};
use clap::ValueEnum;
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::time::Instant;

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// accuracy, stability, cost, allan or all (default); or the scene directly
    study: Option<String>,
    /// A TOML file or the name of a built-in scene: adds its motion to the built-in ones, and measures its samples' cost
    scene: Option<String>,
    /// Write the numbers as CSV and the charts as SVG into this folder
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Only motions A to D at 100 Hz and 1 kHz, a tenth of the drift steps, and few cost rounds
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
    /// What makes methods fail, and which ones
    Stability,
    /// The cost of a scene's samples as error terms are added
    Cost,
    /// The Allan deviation of a scene's sensors against theory
    Allan,
    /// All of them
    All,
}

impl What {
    /// The files that it writes.
    fn files(self) -> Vec<String> {
        let all = [What::Accuracy, What::Stability, What::Cost, What::Allan];
        let mine = all.into_iter().filter(|what| self == What::All || self == *what);
        let name =
            |what: What| what.to_possible_value().map_or(String::new(), |value| value.get_name().into());
        mine.map(name).flat_map(|name| [format!("{name}.csv"), format!("{name}.svg")]).collect()
    }
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
    #[serde(skip_serializing_if = "Option::is_none", flatten)]
    cost: Option<cost::Cost>,
    #[serde(skip_serializing_if = "Option::is_none")]
    allan: Option<Vec<allan::Point>>,
}

/// The scene whose noise is studied where none is given: at rest, nothing but noise is in the readings.
const NOISE_SCENE: &str = "still";
/// The scene whose cost is studied where none is given.
const COST_SCENE: &str = "full-mpu9250";

pub fn study(arguments: &Arguments) -> Result<Verdict, Refusal> {
    let (what, scene) = asked(arguments)?;
    let plan = scene.map(|scene| Plan::load(scene, &[])).transpose()?;
    if let Some(dir) = &arguments.out {
        dataset::may_write(dir, arguments.force, Holds::Study, &what.files())?;
    }
    let cases = cases(plan.as_ref(), arguments.quick)?;
    let (costly, noisy) = match &plan {
        Some(plan) => (plan, plan),
        None => (&Plan::load(COST_SCENE, &[])?, &Plan::load(NOISE_SCENE, &[])?),
    };
    let results = run(what, arguments.quick, &cases, costly, noisy);
    if let Some(dir) = &arguments.out {
        dataset::put_all(dir, arguments.force, Holds::Study, &files(&results, &cases)?)?;
        tell(&format!("{}: written", dir.display()));
    }
    if arguments.json {
        say(&(serde_json::to_string_pretty(&results)? + "\n"))?;
    } else {
        say(&text(&results, &cases))?;
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
                "the scene's name `{name}` is also a built-in motion's: give it another `name`"
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

/// Which study, and of which scene: the first word is a study's name, or else the scene of all studies.
fn asked(arguments: &Arguments) -> Result<(What, Option<&str>), Refusal> {
    let (first, second) = (arguments.study.as_deref(), arguments.scene.as_deref());
    let Some(word) = first else { return Ok((What::All, None)) };
    if let Ok(what) = What::from_str(word, false) {
        return Ok((what, second));
    }
    let studies: Vec<_> = What::value_variants().iter().filter_map(What::to_possible_value).collect();
    let studies = || studies.iter().map(|study| study.get_name());
    let is_scene = builtin::text(word).is_some() || Path::new(word).exists();
    if is_scene && second.is_none() {
        return Ok((What::All, Some(word)));
    }
    let names = studies().collect::<Vec<_>>().join(", ");
    let near = nearest(word, studies().chain(builtin::SCENES.map(|(name, _)| name)));
    let near = near.map_or(String::new(), |near| format!("; did you mean `{near}`?"));
    Err(Refusal(match second {
        None => format!("`{word}` is neither a study ({names}) nor a scene, built in or a file{near}"),
        Some(scene) if is_scene => {
            format!(
                "`{word}` is a scene, so `{scene}` is a second one: write a study ({names}), then one scene"
            )
        }
        Some(_) => format!("`{word}` is not a study ({names}){near}"),
    }))
}

fn run(what: What, quick: bool, cases: &[Case], costly: &Plan, noisy: &Plan) -> Results {
    let wanted = |study| what == What::All || what == study;
    let threads = all_cores();
    Results {
        version: env!("CARGO_PKG_VERSION"),
        quick,
        accuracy: wanted(What::Accuracy).then(|| {
            let bar = Bar::of_jobs("accuracy");
            let start = Instant::now();
            let rows = accuracy::run(cases, threads, &|| start.elapsed(), &|done, all| bar.jobs(done, all));
            bar.clear();
            rows
        }),
        stability: wanted(What::Stability).then(|| {
            let bar = Bar::of_jobs("stability");
            let effort = if quick { Effort::QUICK } else { Effort::FULL };
            let rows = stability::run(effort, threads, &|done, all| bar.jobs(done, all));
            bar.clear();
            rows
        }),
        cost: wanted(What::Cost).then(|| {
            let effort = if quick { cost::Effort::QUICK } else { cost::Effort::FULL };
            let start = Instant::now();
            cost::run(costly, effort, &|| start.elapsed())
        }),
        allan: wanted(What::Allan)
            .then(|| allan::run(noisy, if quick { allan::Effort::QUICK } else { allan::Effort::FULL })),
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
    if let Some(cost) = &results.cost {
        files.push(("cost.csv", csv(&cost.terms)?));
        files.push(("cost.svg", charts::cost(cost).into_bytes()));
    }
    if let Some(points) = &results.allan {
        files.push(("allan.csv", csv(points)?));
        files.push(("allan.svg", charts::allan(points).into_bytes()));
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
    let cost = results.cost.as_ref().map(tables::cost);
    let allan = results.allan.as_ref().map(|points| tables::allan(points));
    accuracy.into_iter().chain(stability).chain(cost).chain(allan).collect::<Vec<_>>().join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::stability::Verdict;

    fn results() -> Results {
        let row = |method, rate_hz, error_deg| accuracy::Row {
            method,
            motion: "A".into(),
            rate_hz,
            precision: "f64",
            error_deg,
            norm_error: error_deg,
            ns_per_step: 2.5,
            ns_per_simulated_s: 250.0,
        };
        let failed = stability::Row {
            method: "paper",
            case: "rate-1e6",
            verdict: Verdict::Fails,
            figure: f64::INFINITY,
            first_failing_step: Some(1),
        };
        Results {
            version: "0",
            quick: true,
            accuracy: Some(vec![row("paper", 100, Some(1e-3)), row("coning-2", 100, None)]),
            stability: Some(vec![failed]),
            cost: None,
            allan: None,
        }
    }

    #[test]
    fn the_tables_for_machines_have_the_columns_they_are_known_by() {
        let files = files(&results(), &cases(None, true).unwrap()).unwrap();
        let text = |name| {
            let (_, bytes) = files.iter().find(|(found, _)| *found == name).unwrap();
            String::from_utf8(bytes.clone()).unwrap()
        };
        assert_eq!(
            text("accuracy.csv"),
            "method,motion,rate_hz,precision,error_deg,norm_error,ns_per_step,ns_per_simulated_s\n\
             paper,A,100,f64,0.001,0.001,2.5,250.0\n\
             coning-2,A,100,f64,,,2.5,250.0\n"
        );
        assert_eq!(
            text("stability.csv"),
            "method,case,verdict,figure,first_failing_step\npaper,rate-1e6,fails,inf,1\n"
        );
        assert!(text("accuracy.svg").starts_with("<svg") && text("stability.svg").contains("rate-1e6"));
    }

    #[test]
    fn a_person_reads_the_errors_what_is_cheapest_and_the_verdicts() {
        let text = text(&results(), &cases(None, true).unwrap());
        for line in [
            "paper     1.0e-3  -",
            "coning-2  lost    -",
            "A       rates       paper 100 Hz (2e2)",
            "~ degraded",
        ] {
            assert!(text.contains(line), "{line} in\n{text}");
        }
    }

    #[test]
    fn a_scene_joins_unless_it_has_the_name_of_a_motion() {
        let mut plan = Plan::load("coning", &[]).unwrap();
        let joined = cases(Some(&plan), true).unwrap();
        assert_eq!(joined.last().map(|case| (case.name.as_str(), joined.len())), Some(("coning", 5)));
        drop(joined);
        plan.name = "B".into();
        assert!(cases(Some(&plan), true).unwrap_err().0.contains("give it another `name`"));
    }
}
