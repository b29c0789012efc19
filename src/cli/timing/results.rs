//! From what was measured to the report, as JSON and as a person reads it.

use super::run::{self, Ended};
use super::{Measured, Refusal};
use crate::cli::terminal::Stream;
use crate::report::{Baseline, Late, Limit, SensorReport, SensorTiming, Spread, TimingReport, number};
use crate::scene::{Output, Plan};
use crate::session::Speed;
use std::slice::from_ref;

/// A report with every field that there can be.
pub fn shape(plan: &Plan, output: &Output) -> TimingReport {
    let mut run = run::shape(plan, from_ref(output));
    for sensor in &mut run.sensors {
        sensor.timing = Some(SensorTiming {
            sent_ppm: Some(0.0),
            received_ppm: Some(0.0),
            overdue: 0,
            received: Some(0),
            missed: Some(0),
            transit_us: Some(Spread::default()),
        });
    }
    run.attitude = None;
    TimingReport {
        run,
        received_by: None,
        baseline: Baseline { rate_hz: 0.0, wakes: 0, overdue: 0, late_us: Some(Late::default()) },
        ratio_p99: Some(0.0),
        unrecorded: 0,
    }
}

/// Puts in what was measured.
pub fn fill(report: &mut TimingReport, measured: &Measured) {
    let Measured { outcome, ledger, far, rate } = measured;
    run::fill(&mut report.run, outcome, Speed::Times(1.0));
    let bare = measured.bare();
    for (sensor, seen) in report.run.sensors.iter_mut().zip(&ledger.sensors) {
        let ppm = |hz: f64| (hz / sensor.rate_hz - 1.0) * 1e6;
        let received = far.is_some();
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
    if let (Some((_, came)), Some(link)) = (far, report.run.links.first_mut()) {
        link.lost_seq = came.lost_seq;
        link.crc_errors += came.damaged;
    }
    report.received_by = far.as_ref().map(|(who, _)| *who);
    report.baseline = Baseline {
        rate_hz: rate.as_hz(),
        wakes: bare.count(),
        overdue: bare.above((rate.period() * 1e9) as i64),
        late_us: bare.late(),
    };
    let first = report.run.sensors.first().and_then(|sensor| sensor.late_us);
    report.ratio_p99 = first.zip(report.baseline.late_us).map(|(ours, bare)| ours.p99 / bare.p99);
    let unrecorded = outcome.watched.as_ref().map_or(0, |watched| watched.unrecorded);
    report.unrecorded = unrecorded + far.as_ref().map_or(0, |(_, came)| came.unrecorded);
}

/// Losses at either end, and broken limits.
pub fn judge(report: &mut TimingReport, limits: &[Limit], interrupted: bool) -> Result<(), Refusal> {
    run::judge(&mut report.run, &[], &Ended { interrupted, ..Ended::default() })?;
    let missed = report.run.sensors.iter().filter_map(|sensor| {
        let missed = sensor.timing?.missed?;
        // What was dropped is told already.
        (missed > sensor.dropped).then(|| format!("sensors.{}.missed = {missed} > 0", sensor.name))
    });
    let missed: Vec<_> = missed.collect();
    report.run.failed.extend(missed);
    let value = serde_json::to_value(&*report)?;
    report.run.failed.extend(limits.iter().filter_map(|limit| limit.broken(&value)));
    report.run.ok = report.run.failed.is_empty();
    Ok(())
}

/// Everything on a screenful.
pub fn text(report: &TimingReport, interrupted: bool) -> String {
    let run = &report.run;
    let ended = if interrupted { ", stopped by the user" } else { "" };
    let to = run.links.first().map_or("", |link| link.to.as_str());
    let mut text = format!("\n{} over {to}: {} s streamed{ended}\n\n", run.scene, number(run.duration_s));
    text += &sensors(report);
    text += &lateness(report);
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

fn sensors(report: &TimingReport) -> String {
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
    Stream::Err.table(&heading, &report.run.sensors.iter().map(row).collect::<Vec<_>>()) + "\n"
}

fn lateness(report: &TimingReport) -> String {
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
    Stream::Err.table(&heading, &rows)
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
