//! What came of a run, a measurement or a stream, as its page shows it: the figures of its report.

use crate::cli::summary;
use crate::live::{End, Figure, Table};
use crate::report::{AttitudeReport, HeardReport, Late, Report, number};

fn figure(label: impl Into<String>, value: f64, unit: &str) -> Figure {
    Figure { label: label.into(), value: number(value), unit: unit.into() }
}

/// Of a run.
pub fn run(report: &Report) -> End {
    let on_a_bus = report.links.iter().any(|link| link.bus.is_some());
    let sensors = if on_a_bus { summary::read_sensors(report) } else { summary::sensors(report) };
    let tables = [sensors.table("Sensors"), summary::links(report).table("Links")];
    let happened = [("Faults", "fault", &report.faults), ("Settings", "setting", &report.settings)];
    let happened =
        happened.into_iter().filter(|(_, _, what)| !what.is_empty()).map(|(title, heading, what)| Table {
            title: title.into(),
            heading: vec![heading.into()],
            rows: what.iter().map(|text| vec![text.clone()]).collect(),
        });
    End {
        ok: report.ok,
        failed: report.failed.clone(),
        figures: figures(report),
        tables: tables.into_iter().flatten().chain(happened).collect(),
        ..End::default()
    }
}

fn figures(report: &Report) -> Vec<Figure> {
    let mut figures = vec![figure("played", report.duration_s, "s")];
    if let Some(AttitudeReport { estimator, figures: of }) = &report.attitude {
        let errors = &of.errors;
        figures.push(figure(format!("attitude by {estimator}"), errors.rms_deg, "deg RMS"));
        figures.push(figure("inclination", errors.inclination_rms_deg, "deg RMS"));
        figures.push(figure("heading", errors.heading_rms_deg, "deg RMS"));
        figures.push(figure("at most", errors.max_deg, "deg"));
        figures.push(Figure { label: "answers".into(), value: of.samples.to_string(), unit: String::new() });
        figures.extend(of.delay_ms.map(|ms| figure("answers late", ms, "ms")));
    }
    // The others are in the table.
    if let Some(sensor) = report.sensors.first()
        && let Some(Late { p99, max, .. }) = sensor.late_us
    {
        figures.push(figure(format!("{} late, p99", sensor.name), p99, "µs"));
        figures.push(figure(format!("{} late, at most", sensor.name), max, "µs"));
    }
    let dropped: u64 = report.sensors.iter().map(|sensor| sensor.dropped).sum();
    figures.push(Figure { label: "dropped".into(), value: dropped.to_string(), unit: "samples".into() });
    figures
}

/// Of a stream that was listened to.
pub fn heard(report: &HeardReport) -> End {
    let mut figures = Vec::new();
    figures.extend(report.duration_s.map(|s| figure("heard", s, "s")));
    for sensor in &report.sensors {
        figures.extend(sensor.received_hz.or(sensor.rate_hz).map(|hz| figure(&sensor.name, hz, "Hz")));
    }
    let mut rows = Vec::new();
    for link in &report.links {
        let lost = link.lost_seq.map_or("-".into(), |lost| lost.to_string());
        let counts = [link.packets.to_string(), link.bytes.to_string(), lost, link.crc_errors.to_string()];
        rows.push([vec![link.name.clone()], counts.to_vec()].concat());
    }
    let heading = ["link", "packets", "bytes", "lost", "damaged"].map(String::from).to_vec();
    let links = Table { title: "Links".into(), heading, rows };
    End {
        ok: report.ok,
        failed: report.failed.clone(),
        figures,
        tables: summary::heard_sensors(report).table("Sensors").into_iter().chain([links]).collect(),
        ..End::default()
    }
}
