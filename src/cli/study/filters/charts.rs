//! The pictures.

use super::{median, names};
use crate::report::chart::{self, Cell, Grid, LogLog};
use crate::report::number;
use crate::study::filters::scenes::Scene;
use crate::study::filters::stability::{self, CASES, COME_BACK, FAILS, STABLE, Verdict};
use crate::study::filters::{Row, START_UP, subjects};

/// Below this an error is that of the sensors, degrees.
const FLOOR: f64 = 1e-3;

/// Cost against error, a plot a scene, a line a filter, a point a rate.
pub(super) fn rates(rows: &[Row], scenes: &[Scene], seeds: u64) -> String {
    let names = names(rows);
    let plot = |scene: &Scene| {
        let filter = |name: &&str| {
            let of = rows.iter().filter(|row| row.scene == scene.name && row.filter == **name);
            let points = of.filter_map(|row| Some((row.ns_per_simulated_s, row.error_deg?)));
            chart::Method { name: name.to_string(), points: points.collect() }
        };
        chart::Motion {
            title: format!("{}: {}, {} s", scene.name, scene.about, number(scene.seconds())),
            methods: names.iter().map(filter).collect(),
        }
    };
    chart::loglog(&LogLog {
        title: "What each attitude filter costs and how far it is from the truth".into(),
        subtitle: format!(
            "a point a gyro rate, {}; mean of {seeds} seeds; -6d without magnetometer, its heading as drift",
            span(rows)
        ),
        x_label: "cost (ns per simulated second)".into(),
        y_label: format!("RMS error after {} s (deg)", number(START_UP.seconds())),
        y_floor: Some(FLOOR),
        motions: scenes.iter().map(plot).collect(),
    })
}

fn span(rows: &[Row]) -> String {
    let all = || rows.iter().map(|row| row.rate_hz);
    match (all().min(), all().max()) {
        (Some(least), Some(most)) => format!("from {least} to {most} Hz"),
        _ => String::new(),
    }
}

/// Verdicts, a row a case, a column a filter.
pub(super) fn verdicts(rows: &[stability::Row]) -> String {
    let columns: Vec<String> = subjects().iter().map(|subject| subject.name()).collect();
    let cell = |case: &str, filter: &str| {
        let found = rows.iter().find(|row| row.case == case && row.filter == filter);
        found.map_or_else(Cell::default, |row| Cell { verdict: verdict(row.verdict), figure: figure(row) })
    };
    let row = |case: &stability::Case| chart::Row {
        name: format!("{}: {}", case.name, case.about),
        cells: columns.iter().map(|filter| cell(case.name, filter)).collect(),
    };
    chart::grid(&Grid {
        title: "Where attitude filters fail".into(),
        subtitle: format!(
            "stable within {STABLE} deg; a figure is the largest error; ! is the error {COME_BACK} s after; # is the first reading past {FAILS} deg or without a number"
        ),
        rows: CASES.iter().map(row).collect(),
        columns,
    })
}

/// How much where it is worse, when where it fails.
fn figure(row: &stability::Row) -> String {
    match (row.verdict, row.first_failing_step) {
        (Verdict::Stable, _) => String::new(),
        (Verdict::NeverComesBack, _) => format!("!{:.0}°", row.figure_deg),
        (_, Some(step)) => format!("#{}", number(step as f64)),
        _ if row.figure_deg < 10.0 => format!("{:.1}°", row.figure_deg),
        _ => format!("{:.0}°", row.figure_deg),
    }
}

fn verdict(verdict: Verdict) -> chart::Verdict {
    match verdict {
        Verdict::Stable => chart::Verdict::Stable,
        Verdict::Degraded => chart::Verdict::Degraded,
        Verdict::NeverComesBack | Verdict::Fails => chart::Verdict::Fails,
    }
}

/// Cost of an update against error, the medians over the scenes at the rate with the least error; a point a filter.
pub(super) fn glance(rows: &[Row]) -> String {
    let point = |name: &&str| {
        let (rate, cost, error) = at_best(rows, name)?;
        Some(chart::Method { name: format!("{name} {rate} Hz"), points: vec![(cost, error)] })
    };
    chart::loglog(&LogLog {
        title: "Attitude filters at a glance".into(),
        subtitle: "medians over the scenes, each filter at its best rate".into(),
        x_label: "cost (ns per update)".into(),
        y_label: "RMS error (deg)".into(),
        y_floor: Some(FLOOR),
        motions: vec![chart::Motion {
            title: String::new(),
            methods: names(rows).iter().filter_map(point).collect(),
        }],
    })
}

/// The rate at which a filter's median error over the scenes is least, with the median cost and that error. A rate at
/// which it loses itself in a scene does not count.
pub(super) fn at_best(rows: &[Row], filter: &str) -> Option<(u32, f64, f64)> {
    let mut rates: Vec<u32> = rows.iter().map(|row| row.rate_hz).collect();
    rates.sort_unstable();
    rates.dedup();
    let at = |rate: u32| {
        let of = || rows.iter().filter(move |row| row.filter == filter && row.rate_hz == rate);
        let errors: Option<Vec<f64>> = of().map(|row| row.error_deg).collect();
        Some((rate, median(of().map(|row| row.ns_per_update).collect())?, median(errors?)?))
    };
    rates.into_iter().filter_map(at).min_by(|a, b| a.2.total_cmp(&b.2))
}
