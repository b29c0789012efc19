//! `ratetable study normals`: ways to make normal numbers, cost against error.

use super::{Outcome, Request, Study};
use crate::cli::Refusal;
use crate::cli::progress::Bar;
use crate::cli::terminal::Stream;
use crate::report::chart::{Level, Point, Points};
use crate::report::number;
use crate::study::all_cores;
use crate::study::normals::{self, Effort, Row};
use std::time::Instant;

pub(super) static STUDY: Study = Study { name: "normals", files: &["normals.csv", "normals.svg"], run };

/// Numbers that are exact to their rounding are drawn here, σ.
const FLOOR: f64 = 1e-16;

fn run(request: &Request) -> Result<Outcome, Refusal> {
    let bar = Bar::of_jobs("normals");
    let effort = if request.quick { Effort::QUICK } else { Effort::FULL };
    let start = Instant::now();
    let rows = normals::run(effort, all_cores(), &|| start.elapsed(), &|done, all| bar.jobs(done, all));
    bar.clear();
    Outcome::of("normals", &rows, table(&rows))?.csv(&rows)?.picture("normals.svg", &chart(&rows))
}

/// A line a way.
fn table(rows: &[Row]) -> String {
    let line = |row: &Row| {
        let name = format!("{}{}", row.method, if row.is_default { " (default)" } else { "" });
        let error = row.error_sigma.map_or("rounding".into(), |error| format!("{error:.1e}"));
        vec![
            name,
            format!("{:.2}", row.ns_per_number),
            error,
            format!("{:.1e}", row.ks),
            number(row.tail_z),
            number(row.variance_z),
        ]
    };
    let heading = ["method", "ns a number", "error (σ)", "KS distance", "tails (z)", "variance (z)"];
    let lines: Vec<_> = rows.iter().map(line).collect();
    let about = rows.first().map_or(String::new(), |row| {
        format!(
            "{} million numbers each; by chance alone a KS distance is below {:.1e} in 95 of 100 runs, a z below 2 in 95 of 100 counts\n",
            number(row.draws as f64 / 1e6),
            row.ks_by_chance
        )
    });
    format!("normal numbers: cost and error\n{}{about}", Stream::Out.table(&heading, &lines))
}

/// Cost across, error up.
fn chart(rows: &[Row]) -> Points {
    const GROUPS: [&str; 3] =
        ["inverse distribution, a table of polynomials", "Box-Muller, arithmetic alone", "ziggurat"];
    let group = |row: &Row| match row.method.split('-').next() {
        Some("inverse") => 0,
        Some("box") => 1,
        _ => 2,
    };
    let point = |row: &Row| Point {
        name: format!("{}{}", row.method, if row.is_default { ", the default" } else { "" }),
        group: group(row),
        x: row.ns_per_number,
        y: row.error_sigma.unwrap_or(FLOOR),
        spread: None,
    };
    let shown = rows.first().map_or(f64::NAN, |row| 1.0 / libm::sqrt(row.draws as f64));
    let draws = rows.first().map_or(String::new(), |row| number(row.draws as f64 / 1e6));
    Points {
        title: "What a normal number costs and how exact it is".into(),
        subtitle: "one thread, random bits included; lower is more exact, further left is cheaper".into(),
        x_label: "cost (ns a number)".into(),
        y_label: "largest error of a number (σ)".into(),
        x_linear: true,
        y_floor: Some(FLOOR),
        groups: GROUPS.map(String::from).into(),
        points: rows.iter().map(point).collect(),
        levels: vec![Level { name: format!("{draws} million samples could show"), y: shown }],
        front: true,
        ..Points::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::study::picture::Picture;

    #[test]
    fn the_table_and_the_chart_name_every_way_and_the_default() {
        let row = |method, is_default, error_sigma| Row {
            method,
            is_default,
            ns_per_number: 0.857,
            error_sigma,
            draws: 1_000_000,
            ks: 5.0e-4,
            ks_by_chance: 1.358e-3,
            tail_z: 1.2,
            variance_z: 0.3,
        };
        let rows = [row("ziggurat", false, None), row("box-muller", true, Some(2e-10))];
        let (text, drawn) = (table(&rows), chart(&rows).svg());
        for word in ["ziggurat", "rounding", "box-muller (default)", "0.86", "2.0e-10", "1.4e-3"] {
            assert!(text.contains(word), "{word} in\n{text}");
        }
        assert!(drawn.contains("box-muller, the default") && drawn.contains("could show"));
    }
}
