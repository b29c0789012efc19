//! `ratetable study accuracy`: every method against every motion.

mod glance;

use super::{Outcome, Request, Study};
use crate::cli::Refusal;
use crate::cli::progress::Bar;
use crate::cli::terminal::Stream;
use crate::motion::Trajectory;
use crate::motion::method::{Input, find};
use crate::report::chart::{self, LogLog};
use crate::report::number;
use crate::study::accuracy::{self, Row};
use crate::study::all_cores;
use crate::study::motions::{self, Case, OfTrajectory};
use std::time::Instant;

pub(super) static STUDY: Study =
    Study { name: "accuracy", files: &["accuracy.csv", "accuracy.svg", "accuracy-glance.svg"], run };

/// Final errors at these rates are shown.
const SHOWN_RATES: [u32; 2] = [100, 1000];
/// Tolerances (degrees) for which the cheapest is named.
const TOLERANCES: [f64; 4] = [1.0, 1e-2, 1e-4, 1e-6];
/// Below this the truth itself is not known better, degrees.
const FLOOR: f64 = 1e-12;

fn run(request: &Request) -> Result<Outcome, Refusal> {
    let cases = cases(request)?;
    let bar = Bar::of_jobs("accuracy");
    let start = Instant::now();
    let rows = accuracy::run(&cases, all_cores(), &|| start.elapsed(), &|done, all| bar.jobs(done, all));
    bar.clear();
    let outcome = Outcome::of("accuracy", &rows, table(&rows, &cases))?;
    let outcome = outcome.csv(&rows)?.picture("accuracy.svg", &chart(&rows, &cases))?;
    outcome.picture("accuracy-glance.svg", &glance::chart(&rows, &cases))
}

/// The built-in motions, and the scene's own.
fn cases<'a>(request: &Request<'a>) -> Result<Vec<Case<'a>>, Refusal> {
    let mut cases = if request.quick { motions::quick() } else { motions::built_in() };
    if let Some(plan) = request.scene {
        let name = plan.name.clone();
        if cases.iter().any(|case| case.name == name) {
            return Err(Refusal(format!(
                "the scene's name `{name}` is also a built-in motion's: give it another `name`"
            )));
        }
        let rates = if request.quick { motions::QUICK_RATES.to_vec() } else { motions::RATES.to_vec() };
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

/// Cost against error, a plot a motion, a point a rate.
fn chart(rows: &[Row], cases: &[Case]) -> LogLog {
    let motion = |case: &Case| {
        let of: Vec<_> = rows.iter().filter(|row| row.motion == case.name).collect();
        let method = |name: String| {
            let points = of.iter().filter(|row| label(row) == name);
            let points = points.filter_map(|row| Some((row.ns_per_simulated_s, row.error_deg?))).collect();
            chart::Method { name, points }
        };
        chart::Motion {
            title: format!("{}: {}, {} s", case.name, case.about, number(case.duration)),
            methods: series(of.iter().copied()).into_iter().map(method).collect(),
        }
    };
    LogLog {
        title: "What each attitude method costs and how far it ends from the truth".into(),
        subtitle: format!("{}; one thread", rates(cases)),
        x_label: "cost (ns per simulated second)".into(),
        y_label: "error at the end (deg)".into(),
        y_floor: Some(FLOOR),
        motions: cases.iter().map(motion).collect(),
    }
}

/// The rates of most cases, and of each that has others.
fn rates(cases: &[Case]) -> String {
    let span = |case: &Case| match (case.rates.iter().min(), case.rates.iter().max()) {
        (Some(least), Some(most)) => format!("{least} to {most} Hz"),
        _ => "no rate".to_string(),
    };
    let spans: Vec<String> = cases.iter().map(span).collect();
    let common = |span: &&String| spans.iter().filter(|other| other == span).count();
    let Some(usual) = spans.iter().max_by_key(common) else { return String::new() };
    let others = cases.iter().zip(&spans).filter(|(_, span)| *span != usual);
    let others: String = others.map(|(case, span)| format!(" (on {} {span})", case.name)).collect();
    format!("a point a sample rate, the lowest leftmost: {usual}{others}")
}

/// Errors at [`SHOWN_RATES`], then the cheapest within each tolerance.
fn table(rows: &[Row], cases: &[Case]) -> String {
    let mut text = String::new();
    for case in cases {
        text += &format!("{}: {}, {} s\n", case.name, case.about, number(case.duration));
    }
    for rate in SHOWN_RATES {
        let kept: Vec<_> = rows.iter().filter(|row| row.rate_hz == rate).collect();
        if !kept.is_empty() {
            text += &format!("\nfinal attitude error at {rate} Hz, degrees; nanoseconds a step\n");
            text += &errors(&kept, cases);
        }
    }
    text +=
        "\ncheapest method and rate that end within a tolerance, with its nanoseconds per simulated second\n";
    text + &cheapest(rows, cases)
}

/// A line a method: its error on each motion.
fn errors(rows: &[&Row], cases: &[Case]) -> String {
    let names: Vec<_> = cases.iter().map(|case| case.name.as_str()).collect();
    let heading = [&["method"], names.as_slice(), &["ns/step"]].concat();
    let mut lines: Vec<Vec<String>> = Vec::new();
    for method in series(rows.iter().copied()) {
        let of: Vec<_> = rows.iter().filter(|row| label(row) == method).collect();
        let cell = |name: &&str| {
            let row = of.iter().find(|row| row.motion == *name);
            row.map_or("-".into(), |row| row.error_deg.map_or("lost".into(), |error| format!("{error:.1e}")))
        };
        let cost = of.iter().map(|row| row.ns_per_step).fold(f64::INFINITY, f64::min);
        let cells = names.iter().map(cell);
        lines.push([method].into_iter().chain(cells).chain([format!("{cost:.0}")]).collect());
    }
    Stream::Out.table(&heading, &lines)
}

/// Two lines a motion: from samples of rate, and from increments, which not every part gives.
fn cheapest(rows: &[Row], cases: &[Case]) -> String {
    let titles: Vec<_> = TOLERANCES.iter().map(|tolerance| format!("{tolerance} deg")).collect();
    let heading: Vec<_> = ["motion", "from"].into_iter().chain(titles.iter().map(String::as_str)).collect();
    let mut lines = Vec::new();
    for case in cases {
        for from in ["rates", "increments"] {
            let tried: Vec<_> =
                rows.iter().filter(|row| row.motion == case.name && input(row) == Some(from)).collect();
            let cells = TOLERANCES.iter().map(|&tolerance| best(&tried, tolerance));
            lines.push([case.name.clone(), from.to_string()].into_iter().chain(cells).collect());
        }
    }
    Stream::Out.table(&heading, &lines)
}

fn best(tried: &[&Row], tolerance: f64) -> String {
    let within = tried.iter().filter(|row| row.error_deg.is_some_and(|error| error <= tolerance));
    let best = within.min_by(|a, b| a.ns_per_simulated_s.total_cmp(&b.ns_per_simulated_s));
    best.map_or("none".into(), |row| {
        format!("{} {} Hz ({:.0e})", label(row), row.rate_hz, row.ns_per_simulated_s)
    })
}

fn input(row: &Row) -> Option<&'static str> {
    Some(match find(row.method)?.input {
        Input::Rate(_) => "rates",
        Input::Increments(_) => "increments",
    })
}

/// What a method is called in a table or chart: the precision is named where it is not the usual.
fn label(row: &Row) -> String {
    match row.precision {
        "f64" => row.method.to_string(),
        other => format!("{} {other}", row.method),
    }
}

/// The labels that occur, in order of appearance.
fn series<'a>(rows: impl IntoIterator<Item = &'a Row>) -> Vec<String> {
    let mut labels = Vec::new();
    for label in rows.into_iter().map(label) {
        if !labels.contains(&label) {
            labels.push(label);
        }
    }
    labels
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::study::picture::Picture;
    use crate::scene::Plan;

    fn rows() -> Vec<Row> {
        let row = |method, rate_hz, error_deg| Row {
            method,
            motion: "A".into(),
            rate_hz,
            precision: "f64",
            error_deg,
            norm_error: error_deg,
            ns_per_step: 2.5,
            ns_per_simulated_s: 250.0,
        };
        vec![row("paper", 100, Some(1e-3)), row("coning-2", 100, None)]
    }

    const NONE: Request = Request { quick: true, scene: None, source: None, is_alone: true };

    #[test]
    fn the_table_for_machines_has_the_columns_it_is_known_by() {
        let outcome = Outcome::of("accuracy", &rows(), String::new()).unwrap().csv(&rows()).unwrap();
        let (name, bytes) = &outcome.files[0];
        assert_eq!(name, "accuracy.csv");
        assert_eq!(
            String::from_utf8_lossy(bytes),
            "method,motion,rate_hz,precision,error_deg,norm_error,ns_per_step,ns_per_simulated_s\n\
             paper,A,100,f64,0.001,0.001,2.5,250.0\n\
             coning-2,A,100,f64,,,2.5,250.0\n"
        );
        let chart = chart(&rows(), &cases(&NONE).unwrap());
        assert!(chart.svg().starts_with("<svg"));
        let asked = chart.charts();
        let paper = &asked[0].series[0];
        assert_eq!((asked.len(), paper.name.as_str(), paper.points.len()), (4, "paper", 1));
        assert_eq!(paper.points[0], (250.0, 1e-3, None));
    }

    #[test]
    fn a_person_reads_the_errors_and_what_is_cheapest() {
        let text = table(&rows(), &cases(&NONE).unwrap());
        for line in ["paper     1.0e-3  -", "coning-2  lost    -", "A       rates       paper 100 Hz (2e2)"] {
            assert!(text.contains(line), "{line} in\n{text}");
        }
    }

    #[test]
    fn the_chart_says_which_rates_each_motion_has() {
        let said = rates(&motions::built_in());
        assert_eq!(said, "a point a sample rate, the lowest leftmost: 25 to 8000 Hz (on G 25 to 100 Hz)");
        assert_eq!(rates(&motions::quick()), "a point a sample rate, the lowest leftmost: 100 to 1000 Hz");
        assert_eq!(rates(&[]), "");
    }

    #[test]
    fn a_scene_joins_unless_it_has_the_name_of_a_motion() {
        let mut plan = Plan::load("coning", &[]).unwrap();
        fn joined(plan: &Plan) -> Result<usize, Refusal> {
            cases(&Request { quick: true, scene: Some(plan), source: None, is_alone: true })
                .map(|cases| cases.len())
        }
        assert_eq!(joined(&plan).unwrap(), 5);
        plan.name = "B".into();
        assert!(joined(&plan).unwrap_err().0.contains("give it another `name`"));
    }
}
