//! From what was measured to the report, as JSON and as a person reads it.

use super::Measured;
use super::ledger::Sensor;
use crate::cli::sheet::Sheet;
use crate::cli::show::ends;
use crate::cli::terminal::Stream;
use crate::live::{End, Figure};
use crate::report::{Baseline, Late, Report, SensorReport, SensorTiming, TimingReport, number};
use crate::scene::Plan;

/// What was measured, not judged yet: a report of this shape.
pub fn report(shape: TimingReport, plan: &Plan, measured: &Measured) -> TimingReport {
    let Measured { outcome, ledger, far, rate } = measured;
    let mut run = Report { faults: shape.run.faults, attitude: None, ..outcome.report(plan, "") };
    for (sensor, seen) in run.sensors.iter_mut().zip(&ledger.sensors) {
        add(sensor, seen, far.is_some());
    }
    if let (Some((_, came)), Some(link)) = (far, run.links.first_mut()) {
        link.lost_seq = came.lost_seq;
        link.crc_errors += came.damaged;
    }
    let baseline = Baseline::new(&measured.bare(), *rate);
    let first = run.sensors.first().and_then(|sensor| sensor.late_us);
    let unrecorded = outcome.watched.as_ref().map_or(0, |watched| watched.unrecorded);
    TimingReport {
        run,
        received_by: far.as_ref().map(|(who, _)| *who),
        baseline,
        ratio_p99: first.zip(baseline.late_us).map(|(ours, bare)| ours.p99 / bare.p99),
        unrecorded: unrecorded + far.as_ref().map_or(0, |(_, came)| came.unrecorded),
    }
}

/// Adds what was seen of a sensor, at the other end too where somebody received.
fn add(sensor: &mut SensorReport, seen: &Sensor, received: bool) {
    let ppm = |hz: f64| (hz / sensor.rate_hz - 1.0) * 1e6;
    sensor.received_hz = seen.received_hz();
    sensor.timing = Some(SensorTiming {
        sent_ppm: sensor.sent_hz.map(ppm),
        received_ppm: sensor.received_hz.map(ppm),
        overdue: seen.overdue,
        received: received.then_some(seen.received),
        missed: received.then_some(seen.missed),
        transit_us: seen.transit.spread(),
    });
}

/// Everything on a screenful.
pub fn text(report: &TimingReport, interrupted: bool) -> String {
    let run = &report.run;
    let ended = if interrupted { ", stopped by the user" } else { "" };
    let to = run.links.first().map_or("", |link| link.to.as_str());
    let mut text = format!("\n{} over {to}: {} s streamed{ended}\n\n", run.scene, number(run.duration_s));
    text += &(sensors(report).text(Stream::Err) + "\n");
    text += &lateness(report).text(Stream::Err);
    text += &format!("\n{}\n", ratio(report));
    if let Some(pacing) = run.host.pacing {
        let share = number(100.0 * pacing.pacing_cpu);
        text += &format!(
            "pacing thread: {share} % of a core, writes included; sleeps until {} µs before and spins the rest\n",
            number(pacing.spin_us)
        );
    }
    text += &match report.received_by {
        Some(who) => format!("received by {who}\n"),
        None => "received by nobody we can ask: the sending end alone is measured\n".to_string(),
    };
    if report.unrecorded > 0 {
        text += &format!("notice: {} records came too fast to be kept one by one\n", report.unrecorded);
    }
    run.failed.iter().for_each(|failure| text += &format!("FAILED: {failure}\n"));
    text
}

/// What was made of each sensor, and at what rate.
pub fn sensors(report: &TimingReport) -> Sheet {
    let rate = |hz: Option<f64>, ppm: Option<f64>| {
        [hz.map_or("-".into(), |hz| format!("{hz:.3}")), ppm.map_or("-".into(), |ppm| format!("{ppm:.1}"))]
    };
    let count = |n: Option<u64>| n.map_or("-".into(), |n| n.to_string());
    let row = |sensor: &SensorReport| {
        let timing = sensor.timing.unwrap_or_default();
        let mut row = vec![sensor.name.clone(), number(sensor.rate_hz)];
        row.extend(rate(sensor.sent_hz, timing.sent_ppm));
        row.extend(rate(sensor.received_hz, timing.received_ppm));
        row.extend([sensor.made, sensor.sent, sensor.dropped, sensor.queued].map(|n| n.to_string()));
        row.extend([count(timing.missed), timing.overdue.to_string()]);
        row
    };
    let heading = [
        "sensor",
        "asked Hz",
        "sent Hz",
        "ppm",
        "received Hz",
        "ppm",
        "made",
        "sent",
        "dropped",
        "queued",
        "missed",
        "overdue",
    ];
    Sheet { heading: heading.to_vec(), rows: report.run.sensors.iter().map(row).collect() }
}

/// How late each sensor was, beside the bare timer.
pub fn lateness(report: &TimingReport) -> Sheet {
    let cells =
        |values: Option<[f64; 4]>| values.map_or(["-"; 4].map(String::from), |values| values.map(number));
    let late = |late: Late| [late.p50, late.p99, late.p99_9, late.max];
    let mut rows = Vec::new();
    for sensor in &report.run.sensors {
        let transit = sensor.timing.and_then(|timing| timing.transit_us);
        let transit =
            transit.map_or(["-"; 2].map(String::from), |spread| [spread.p50, spread.p99].map(number));
        let interval = sensor.interval_us.map_or("-".into(), |interval| number(interval.std));
        rows.push(
            [
                vec![sensor.name.clone()],
                cells(sensor.late_us.map(late)).into(),
                vec![interval],
                transit.into(),
            ]
            .concat(),
        );
    }
    let bare = cells(report.baseline.late_us.map(late));
    rows.push([vec!["bare timer".to_string()], bare.into(), ["-"; 3].map(String::from).into()].concat());
    let heading = ["late µs", "p50", "p99", "p99.9", "max", "interval std", "transit p50", "p99"];
    Sheet { heading: heading.to_vec(), rows }
}

/// What came of it, for its page.
pub fn end(report: &TimingReport) -> End {
    let of_run = ends::run(&report.run);
    let tables = [sensors(report).table("Sensors"), lateness(report).table("Lateness beside a bare timer")];
    let ratio = report.ratio_p99.map(|ratio| Figure {
        label: "p99 over a bare timer's".into(),
        value: number(ratio),
        unit: "times".into(),
    });
    let of_links = of_run.tables.into_iter().filter(|table| table.title == "Links");
    End {
        figures: ratio.into_iter().chain(of_run.figures).collect(),
        tables: tables.into_iter().flatten().chain(of_links).collect(),
        ..of_run
    }
}

fn ratio(report: &TimingReport) -> String {
    let Baseline { rate_hz, wakes, overdue, .. } = report.baseline;
    let ratio = report.ratio_p99.map_or("unknown".into(), number);
    let first = report.run.sensors.first().map_or("stream", |sensor| sensor.name.as_str());
    format!(
        "p99 of the {first} over that of a bare timer: {ratio} ({wakes} wake-ups at {} Hz between slices of the stream, {overdue} of them a whole period late)",
        number(rate_hz)
    )
}
