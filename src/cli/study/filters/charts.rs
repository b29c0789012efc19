//! The pictures.

use super::{median, names, tried};
use crate::filters::SIX;
use crate::report::chart::{self, Cell, Grid, LogLog};
use crate::report::number;
use crate::study::filters::scenes::Scene;
use crate::study::filters::stability::{self, CASES, COME_BACK, FAILS, STABLE, Verdict};
use crate::study::filters::{Row, START_UP};

/// Below this an error is that of the sensors, degrees.
const FLOOR: f64 = 1e-3;

/// Cost against error, a plot a scene, a line a filter, a point a rate.
pub(super) fn rates(rows: &[Row], scenes: &[Scene], seeds: u64) -> LogLog {
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
    LogLog {
        title: "What each attitude filter costs and how far it is from the truth".into(),
        subtitle: format!(
            "a point a gyro rate, {}; mean of {seeds} seeds; -6d without magnetometer, its heading as drift",
            span(rows)
        ),
        x_label: "cost (ns per simulated second)".into(),
        y_label: format!("RMS error after {} s (deg)", number(START_UP.seconds())),
        y_floor: Some(FLOOR),
        motions: scenes.iter().map(plot).collect(),
    }
}

fn span(rows: &[Row]) -> String {
    let all = || rows.iter().map(|row| row.rate_hz);
    match (all().min(), all().max()) {
        (Some(least), Some(most)) => format!("from {least} to {most} Hz"),
        _ => String::new(),
    }
}

/// Verdicts, a row a case, a column a filter.
pub(super) fn verdicts(rows: &[stability::Row]) -> Grid {
    let columns = tried(rows);
    let cell = |case: &str, filter: &str| {
        let found = rows.iter().find(|row| row.case == case && row.filter == filter);
        found.map_or_else(Cell::default, |row| Cell { verdict: verdict(row.verdict), figure: figure(row) })
    };
    let row = |case: &stability::Case| chart::Row {
        name: format!("{}: {}", case.name, case.about),
        cells: columns.iter().map(|filter| cell(case.name, filter)).collect(),
    };
    Grid {
        title: "Where attitude filters fail".into(),
        subtitle: format!(
            "stable within {STABLE} deg; a figure is the largest error; ! is the error {COME_BACK} s after; # is the first reading past {FAILS} deg or without a number"
        ),
        rows: CASES.iter().map(row).collect(),
        columns: columns.iter().map(ToString::to_string).collect(),
    }
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
pub(super) fn glance(rows: &[Row]) -> chart::Points {
    let point = |name: &&str| {
        let best = at_best(rows, name)?;
        Some(chart::Point {
            name: format!("{name}, {} Hz", best.rate_hz),
            group: usize::from(name.ends_with(SIX)),
            x: best.ns_per_update,
            y: best.error_deg,
            spread: Some(best.range_deg),
        })
    };
    chart::Points {
        title: "Attitude filters at a glance".into(),
        subtitle: "medians over the scenes, each filter at the rate with its least error".into(),
        x_label: "cost (ns per update)".into(),
        y_label: "RMS error (deg)".into(),
        y_floor: Some(FLOOR),
        groups: vec!["with magnetometer".into(), "without, heading as drift".into()],
        points: names(rows).iter().filter_map(point).collect(),
        notes: vec![
            "bars: from the scene with the least error to the one with the largest".into(),
            "drift and heading are not alike: compare within a colour".into(),
        ],
        ..chart::Points::default()
    }
}

/// A filter at the rate with the least error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Best {
    pub rate_hz: u32,
    /// The median over the scenes.
    pub ns_per_update: f64,
    /// The median over the scenes.
    pub error_deg: f64,
    /// Of the best scene and of the worst.
    pub range_deg: (f64, f64),
}

/// The rate at which a filter's median error over the scenes is least. One at which it loses itself in a scene does
/// not count.
pub(super) fn at_best(rows: &[Row], filter: &str) -> Option<Best> {
    let mut rates: Vec<u32> = rows.iter().map(|row| row.rate_hz).collect();
    rates.sort_unstable();
    rates.dedup();
    let at = |rate_hz: u32| {
        let of = || rows.iter().filter(move |row| row.filter == filter && row.rate_hz == rate_hz);
        let errors: Vec<f64> = of().map(|row| row.error_deg).collect::<Option<_>>()?;
        let range_deg = errors
            .iter()
            .fold((f64::INFINITY, 0.0_f64), |(least, most), &error| (least.min(error), most.max(error)));
        let ns_per_update = median(of().map(|row| row.ns_per_update).collect())?;
        Some(Best { rate_hz, ns_per_update, error_deg: median(errors)?, range_deg })
    };
    rates.into_iter().filter_map(at).min_by(|a, b| a.error_deg.total_cmp(&b.error_deg))
}
