//! The studies as text.

use crate::cli::terminal::Stream;
use crate::motion::method::{Input, METHODS, find};
use crate::report::number;
use crate::study::accuracy;
use crate::study::allan;
use crate::study::cost::Cost;
use crate::study::motions::Case;
use crate::study::stability::{self, CASES, Verdict};

/// Final errors at these rates are shown.
const SHOWN_RATES: [u32; 2] = [100, 1000];
/// Tolerances (degrees) for which the cheapest is named.
const TOLERANCES: [f64; 4] = [1.0, 1e-2, 1e-4, 1e-6];

/// Errors at [`SHOWN_RATES`], then the cheapest within each tolerance.
pub fn accuracy(rows: &[accuracy::Row], cases: &[Case]) -> String {
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
fn errors(rows: &[&accuracy::Row], cases: &[Case]) -> String {
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
fn cheapest(rows: &[accuracy::Row], cases: &[Case]) -> String {
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

fn best(tried: &[&accuracy::Row], tolerance: f64) -> String {
    let within = tried.iter().filter(|row| row.error_deg.is_some_and(|error| error <= tolerance));
    let best = within.min_by(|a, b| a.ns_per_simulated_s.total_cmp(&b.ns_per_simulated_s));
    best.map_or("none".into(), |row| {
        format!("{} {} Hz ({:.0e})", label(row), row.rate_hz, row.ns_per_simulated_s)
    })
}

fn input(row: &accuracy::Row) -> Option<&'static str> {
    Some(match find(row.method)?.input {
        Input::Rate(_) => "rates",
        Input::Increments(_) => "increments",
    })
}

/// What a method is called in a table or chart: the precision is named where it is not the usual.
pub fn label(row: &accuracy::Row) -> String {
    match row.precision {
        "f64" => row.method.to_string(),
        other => format!("{} {other}", row.method),
    }
}

/// The labels that occur, in order of appearance.
pub fn series<'a>(rows: impl IntoIterator<Item = &'a accuracy::Row>) -> Vec<String> {
    let mut labels = Vec::new();
    for label in rows.into_iter().map(label) {
        if !labels.contains(&label) {
            labels.push(label);
        }
    }
    labels
}

/// A line a method, a sign a case, and what the cases are.
pub fn stability(rows: &[stability::Row]) -> String {
    let numbers: Vec<_> = (1..=CASES.len()).map(|n| n.to_string()).collect();
    let heading: Vec<_> = ["method"].into_iter().chain(numbers.iter().map(String::as_str)).collect();
    let line = |name: &'static str| {
        let sign = |case: &stability::Case| {
            let row = rows.iter().find(|row| row.method == name && row.case == case.name);
            row.map_or("-", |row| sign(row.verdict)).to_string()
        };
        [name.to_string()].into_iter().chain(CASES.iter().map(sign)).collect()
    };
    let lines: Vec<_> = METHODS.iter().map(|method| line(method.name)).collect();
    let about: String = CASES
        .iter()
        .zip(&numbers)
        .map(|(case, n)| format!("{n:>2} {}: {}\n", case.name, case.about))
        .collect();
    format!(
        "where methods fail: . stable, ~ degraded, X fails\n{}\n{about}",
        Stream::Out.table(&heading, &lines)
    )
}

fn sign(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Stable => ".",
        Verdict::Degraded => "~",
        Verdict::Fails => "X",
    }
}
/// What a sample costs with the terms up to each.
pub fn cost(cost: &Cost) -> String {
    let mut before = 0.0;
    let rows = cost.terms.iter().map(|term| {
        let added = term.ns_per_sample - std::mem::replace(&mut before, term.ns_per_sample);
        vec![term.term.to_string(), number(added), number(term.ns_per_sample)]
    });
    let millions = |rate: f64| number(rate / 1e6);
    let floor = cost.floor_samples_per_s.zip(cost.ratio).map_or(String::new(), |(floor, ratio)| {
        let normals = number(cost.normals_per_sample);
        format!("; its {normals} normal numbers alone: {} million; ratio {}", millions(floor), number(ratio))
    });
    let cores = cost.cores.as_ref().map_or(String::new(), |cores| {
        let (rate, times) = (millions(cores.nine_axis_samples_per_s), number(cores.times_one));
        format!("{} threads, a run each: {rate} million; {times} times one\n", cores.threads)
    });
    format!(
        "{}\n{} million nine-axis samples/s of {}, one thread{floor}\n{cores}",
        Stream::Out.table(&["with", "ns more", "ns a sample"], &rows.collect::<Vec<_>>()),
        millions(cost.nine_axis_samples_per_s),
        cost.scene,
    )
}

/// Measured and expected deviations nearest to round averaging times, the mean of the three axes.
pub fn allan(points: &[allan::Point]) -> String {
    const TAUS: [f64; 4] = [0.1, 1.0, 10.0, 100.0];
    let mut sensors: Vec<_> = points.iter().map(|point| point.sensor).collect();
    sensors.dedup();
    let cell = |sensor: &str, tau: f64| {
        let far = |point: &allan::Point| libm::log2(point.tau_s / tau).abs();
        let of = || points.iter().filter(|point| point.sensor == sensor && far(point) <= 0.5);
        let mean = |pick: fn(&allan::Point) -> f64| of().map(pick).sum::<f64>() / of().count() as f64;
        match of().count() {
            0 => "-".to_string(),
            _ => {
                format!("{} ({})", number(mean(|point| point.deviation)), number(mean(|point| point.theory)))
            }
        }
    };
    let rows = sensors.iter().map(|sensor| {
        let cells = TAUS.iter().map(|&tau| cell(sensor, tau));
        [sensor.to_string(), allan::unit(sensor).to_string()].into_iter().chain(cells).collect()
    });
    let text = Stream::Out
        .table(&["sensor", "unit", "about 0.1 s", "1 s", "10 s", "100 s"], &rows.collect::<Vec<_>>());
    format!("Allan deviation, and by theory\n{text}")
}
