//! The report of a run as a person reads it.

use crate::report::{Report, number, table};
use crate::session::Outcome;
use crate::time::SimTime;

/// Everything of a run on a screenful.
pub fn run(report: &Report, outcome: &Outcome) -> String {
    let ended = if outcome.interrupted { ", stopped by the user" } else { "" };
    let speed = match report.speed.as_f64() {
        Some(1.0) => "in real time".to_string(),
        Some(times) => format!("at {} times real time", number(times)),
        None => "as fast as possible".to_string(),
    };
    let mut text =
        format!("\n{}: {} {speed}, seed {}{ended}\n\n", report.scene, played(outcome.played), report.seed);
    text += &sensors(report);
    text.push('\n');
    text += &links(report);
    if let Some(score) = &report.attitude {
        let delay = score
            .delay_ms
            .map_or(String::new(), |delay| format!(", answers {} ms after their sample", number(delay)));
        text += &format!(
            "\nattitude by {}: {} deg RMS against the truth (inclination {}, heading {}), {} deg at most; {} answers{delay}\n",
            score.estimator,
            number(score.rms_deg),
            number(score.inclination_rms_deg),
            number(score.heading_rms_deg),
            number(score.max_deg),
            score.samples,
        );
    }
    for fault in &report.faults {
        text += &format!("fault: {fault}\n");
    }
    for failure in &report.failed {
        text += &format!("FAILED: {failure}\n");
    }
    text
}

fn played(t: SimTime) -> String {
    format!("{} s", number(t.seconds()))
}

fn sensors(report: &Report) -> String {
    let received = report.sensors.iter().any(|sensor| sensor.received_hz.is_some());
    let paced = report.sensors.iter().any(|sensor| sensor.late_us.is_some());
    let mut heading = vec!["sensor", "asked Hz", "sent Hz"];
    heading.extend(received.then_some("received Hz"));
    heading.extend(["made", "sent", "dropped"]);
    if paced {
        heading.extend(["late µs p50", "p99", "p99.9", "max"]);
    }
    let hz = |rate: Option<f64>| rate.map_or("-".into(), |rate| format!("{rate:.3}"));
    let rows = report.sensors.iter().map(|sensor| {
        let mut row = vec![sensor.name.clone(), number(sensor.rate_hz), hz(sensor.sent_hz)];
        row.extend(received.then(|| hz(sensor.received_hz)));
        row.extend([sensor.made, sensor.sent, sensor.dropped].map(|count| count.to_string()));
        if paced {
            let late = sensor.late_us.map(|late| [late.p50, late.p99, late.p99_9, late.max].map(number));
            row.extend(late.unwrap_or_else(|| ["-"; 4].map(String::from)));
        }
        row
    });
    table(&heading, &rows.collect::<Vec<_>>())
}

fn links(report: &Report) -> String {
    let rows = report.links.iter().map(|link| {
        let missed = link.lost_seq.map_or("-".into(), |lost| lost.to_string());
        let load = link.utilisation.map_or("-".into(), |share| format!("{:.0} %", 100.0 * share));
        vec![
            link.name.clone(),
            link.packets.to_string(),
            link.bytes.to_string(),
            link.dropped.to_string(),
            missed,
            load,
        ]
    });
    table(
        &["link", "packets", "bytes", "dropped", "missed by receiver", "of baud rate"],
        &rows.collect::<Vec<_>>(),
    )
}
