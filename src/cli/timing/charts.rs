//! `timing.svg`: how often packets and the bare timer's wake-ups were how late, and when.

use super::ledger::{Ledger, Peaks};
use crate::report::chart::{
    Distribution, Histogram, Line, LineKind, Marker, Panel, Panels, Shape, histogram, panels, stacked,
};
use crate::report::{Times, TimingReport, number};

/// The picture.
pub fn timing(report: &TimingReport, ledger: &Ledger, bare: &Times) -> String {
    let first = report.run.sensors.first().map_or("stream", |sensor| sensor.name.as_str());
    stacked(&[shares(report, ledger, bare, first), over_time(ledger, first)])
}

fn shares(report: &TimingReport, ledger: &Ledger, bare: &Times, first: &str) -> String {
    let names = [format!("{first}, just before its write"), "bare timer, just after its wake-up".to_string()];
    let times = [&ledger.late, bare];
    let marker = |i: usize| {
        let p99 = times[i].late()?.p99;
        let who = if i == 0 { first } else { "bare timer" };
        Some(Marker { x: p99, label: format!("{who} p99 {} µs", number(p99)), of: Some(i) })
    };
    let distribution = |i: usize| Distribution { name: names[i].clone(), values: times[i].values() };
    histogram(&Histogram {
        title: format!("Lateness of the {first} and of a bare timer"),
        subtitle: subtitle(report),
        x_label: "lateness (µs)".into(),
        shape: Shape::Above,
        log_x: true,
        log_y: true,
        distributions: vec![distribution(0), distribution(1)],
        markers: (0..2).filter_map(marker).collect(),
    })
}

fn subtitle(report: &TimingReport) -> String {
    let run = &report.run;
    let to = run.links.first().map_or("", |link| link.to.as_str());
    let priority = if run.host.realtime { "real-time priority" } else { "ordinary priority" };
    format!(
        "{} over {to}, {} Hz, {priority}, {}",
        run.scene,
        number(report.baseline.rate_hz),
        run.host.kernel
    )
}

fn over_time(ledger: &Ledger, first: &str) -> String {
    let points = [&ledger.stream, &ledger.bare].map(Peaks::points);
    let line = |i: usize, name| Line { name, x: &points[i].0, y: &points[i].1, kind: LineKind::Value };
    let width = number(ledger.stream.width_ms().max(ledger.bare.width_ms()));
    panels(&Panels {
        title: "Lateness over time".into(),
        subtitle: format!("the greatest of every {width} ms; the two take turns"),
        x_label: "time since the start (s)".into(),
        panels: vec![Panel {
            y_label: "lateness (µs)".into(),
            lines: vec![line(0, first), line(1, "bare timer")],
            log_y: true,
            ..Panel::default()
        }],
    })
}
