//! The comparison as files: errors as a table, attitudes and errors as charts.

use super::sources::Truth;
use crate::geometry::Euler;
use crate::report::ScoreReport;
use crate::report::chart::{Line, LineKind, Panel, Panels, panels};
use crate::report::number;
use crate::score::Judged;
use std::fmt::Write;

/// As many points of a line are drawn.
const POINTS: usize = 4000;

/// Every error of every estimate, in the estimates' order.
pub(super) fn errors_csv(report: &ScoreReport, judged: &[Judged]) -> String {
    let mut text = String::from("estimate,t_ns,error_deg,inclination_deg,heading_deg\n");
    for (scored, judged) in report.estimates.iter().zip(judged) {
        for row in &judged.rows {
            let [error, inclination, heading] =
                [row.error.total, row.error.inclination, row.error.heading].map(f64::to_degrees);
            let _ = writeln!(text, "{},{},{error},{inclination},{heading}", scored.name, row.t.0);
        }
    }
    text
}

/// One estimate's columns, thinned out for a picture.
struct Drawn<'a> {
    name: &'a str,
    t: Vec<f64>,
    /// What is drawn in each panel, deg.
    columns: Vec<Vec<f64>>,
}

fn every(count: usize) -> usize {
    count.div_ceil(POINTS).max(1)
}

fn drawn<'a>(
    report: &'a ScoreReport,
    judged: &[Judged],
    of: impl Fn(&crate::score::Row) -> Vec<f64>,
) -> Vec<Drawn<'a>> {
    let one = |(scored, judged): (&'a crate::report::Scored, &Judged)| {
        let rows = || judged.rows.iter().step_by(every(judged.rows.len()));
        let values: Vec<Vec<f64>> = rows().map(&of).collect();
        let width = values.first().map_or(0, Vec::len);
        Drawn {
            name: &scored.name,
            t: rows().map(|row| row.t.seconds()).collect(),
            columns: (0..width).map(|i| values.iter().map(|row| row[i].to_degrees()).collect()).collect(),
        }
    };
    report.estimates.iter().zip(judged).map(one).collect()
}

fn angles(euler: Euler) -> Vec<f64> {
    vec![euler.roll, euler.pitch, euler.yaw]
}

/// Roll, pitch and yaw over time, with the truth.
pub(super) fn attitude(report: &ScoreReport, judged: &[Judged], truth: &Truth) -> String {
    let drawn = drawn(report, judged, |row| angles(Euler::from_quat(row.attitude.q)));
    let rows = truth.track.rows();
    let thin = || rows.iter().step_by(every(rows.len()));
    let t: Vec<f64> = thin().map(|(t, _)| t.seconds()).collect();
    let angles: Vec<_> = thin().map(|(_, attitude)| angles(Euler::from_quat(attitude.q))).collect();
    let columns: Vec<Vec<f64>> =
        (0..3).map(|i| angles.iter().map(|row| row[i].to_degrees()).collect()).collect();
    let panel = |(i, name): (usize, &str)| {
        let mut lines = lines(&drawn, i);
        lines.push(Line { name: "truth", x: &t, y: &columns[i], kind: LineKind::Truth });
        Panel {
            title: name.to_string(),
            y_label: format!("{} (deg)", name.to_lowercase()),
            lines,
            wrap: (i != 1).then_some(360.0),
            log_y: false,
        }
    };
    panels(&Panels {
        title: "Estimated attitude and truth".into(),
        subtitle: subtitle(report),
        x_label: "time (s)".into(),
        panels: ["Roll", "Pitch", "Yaw"].into_iter().enumerate().map(panel).collect(),
    })
}

/// Errors over time.
pub(super) fn error(report: &ScoreReport, judged: &[Judged]) -> String {
    let drawn = drawn(report, judged, |row| vec![row.error.total, row.error.inclination, row.error.heading]);
    let panel = |(i, name): (usize, &str)| Panel {
        title: name.to_string(),
        y_label: "error (deg)".into(),
        lines: lines(&drawn, i),
        ..Panel::default()
    };
    let titles =
        ["The whole error", "Inclination: the part that tilts", "Heading: the turn about the vertical"];
    panels(&Panels {
        title: "Error of the estimated attitude".into(),
        subtitle: subtitle(report),
        x_label: "time (s)".into(),
        panels: titles.into_iter().enumerate().map(panel).collect(),
    })
}

fn lines<'a>(drawn: &'a [Drawn<'_>], i: usize) -> Vec<Line<'a>> {
    let line = |drawn: &'a Drawn<'_>| {
        Some(Line { name: drawn.name, x: &drawn.t, y: drawn.columns.get(i)?, kind: LineKind::Value })
    };
    drawn.iter().filter_map(line).collect()
}

/// Who is how good.
fn subtitle(report: &ScoreReport) -> String {
    let one = |scored: &crate::report::Scored| {
        format!("{} {} deg RMS", scored.name, number(scored.figures.rms_deg))
    };
    let each: Vec<_> = report.estimates.iter().map(one).collect();
    format!("{}: {}", report.truth, each.join(", "))
}
