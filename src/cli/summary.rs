//! The report of a run as a person reads it.

use crate::cli::sheet::Sheet;
use crate::cli::terminal::Stream;
use crate::report::{AnswersReport, AttitudeReport, BusReport, HeardReport, LinkReport, Report, number};
use crate::score::DelayKnown;
use crate::session::Outcome;
use crate::time::SimTime;

/// The share of a scene that counts as all of it.
const WHOLE: f64 = 0.995;

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
    match report.links.first().and_then(|link| Some((link, link.bus.as_ref()?))) {
        Some((link, bus)) => text += &read_from(report, link, bus),
        None => {
            text += &sensors(report).text(Stream::Err);
            text.push('\n');
            text += &links(report).text(Stream::Err);
        }
    }
    if report.rest_s > 0.0 {
        let is_asked = report.links.iter().any(|link| link.bus.is_some());
        let counted = if is_asked { "not in the counts" } else { "in the counts" };
        text += &format!(
            "held still for {} s before the scene: those samples are {counted}\n",
            number(report.rest_s)
        );
    }
    if report.stretched_s > 0.0 {
        text += &format!(
            "scene time stood still for {} s while a link was full or a controller took its time\n",
            number(report.stretched_s)
        );
    }
    report.links.iter().for_each(|link| text += &happened(link));
    if let Some(attitude) = &report.attitude {
        text += &known(attitude, report.duration_s);
    }
    report.links.iter().for_each(|link| text += &harmed(link));
    for fault in &report.faults {
        text += &format!("fault: {fault}\n");
    }
    for failure in &report.failed {
        text += &format!("FAILED: {failure}\n");
    }
    text
}

/// How a driver read each sensor of the chips on a bus.
pub fn read_sensors(report: &Report) -> Sheet {
    let rows = report.sensors.iter().filter_map(|sensor| {
        let read = sensor.read?;
        let counts = [sensor.made, read.samples, read.again, read.missed, read.overflowed, sensor.queued];
        let hz = read.hz.map_or("-".into(), |hz| format!("{hz:.3}"));
        Some([vec![sensor.name.clone(), hz], counts.map(|count| count.to_string()).to_vec()].concat())
    });
    let heading = ["sensor", "read Hz", "made", "read", "read again", "missed", "FIFO lost", "waiting"];
    Sheet { heading: heading.to_vec(), rows: rows.collect() }
}

/// How a driver read the chips on a bus.
fn read_from(report: &Report, link: &LinkReport, bus: &BusReport) -> String {
    let mut text = read_sensors(report).text(Stream::Err);
    text += &format!("\n{}: {} transfers", link.name, bus.transfers);
    if let Some(rate) = bus.transfers_per_s {
        text += &format!(", {} a second", number(rate));
    }
    if let Some(us) = bus.answer_us {
        text += &format!(
            "; answered in {} µs (p99 {}, longest {})",
            number(us.p50),
            number(us.p99),
            number(us.max)
        );
    }
    if bus.refused > 0 {
        text += &format!("; {} not acknowledged", bus.refused);
    }
    if bus.strange > 0 {
        text += &format!("; {} strange bytes", bus.strange);
    }
    text + "\n"
}

/// What happened on a link besides the packets.
fn happened(link: &LinkReport) -> String {
    let mut text = String::new();
    if let Some(gaps) = link.gaps {
        text += &format!(
            "{} was unplugged {}, {} s in all: {} packets with {} samples dropped\n",
            link.name,
            times(gaps.count),
            number(gaps.total_s),
            gaps.dropped,
            gaps.samples
        );
    }
    if let Some(answers) = &link.answers {
        text += &answered(&link.name, answers);
    }
    for asked in &link.asked {
        text += &format!(
            "the controller on {} asked for {} Hz: sent so from {} s of the stream on\n",
            link.name,
            number(asked.hz),
            number(asked.at_s)
        );
    }
    text
}

/// The packets of a link that faults acted on.
fn harmed(link: &LinkReport) -> String {
    if link.faults.is_empty() {
        return String::new();
    }
    let counts: Vec<_> = link.faults.iter().map(|(kind, packets)| format!("{kind} {packets}")).collect();
    format!("packets that faults acted on, {}: {}\n", link.name, counts.join(", "))
}

/// What came back on a link.
fn answered(name: &str, answers: &AnswersReport) -> String {
    let gap = answers.gap_us.map_or(String::new(), |us| {
        let [p50, p99, max] = [us.p50, us.p99, us.max].map(|us| number(us / 1000.0));
        format!(", one every {p50} ms (p99 {p99}, longest {max})")
    });
    let mut text = format!("{name}: {}{gap}", answers.count());
    if answers.silences > 0 {
        text += &format!(", silent {}, {} s in all", times(answers.silences), number(answers.silent_s));
    }
    if answers.restarts > 0 {
        text += &format!(", restarted {}", times(answers.restarts));
    }
    text + "\n"
}

/// How well somebody knew the attitude.
fn known(AttitudeReport { estimator, figures }: &AttitudeReport, duration_s: f64) -> String {
    let delay = match (figures.delay_ms, figures.delay_known, figures.delay_doubt) {
        (Some(ms), DelayKnown::Echoed, _) => format!(", answers {} ms after their sample", number(ms)),
        (Some(ms), ..) => {
            let given = figures.as_arrived.map_or(String::new(), |errors| {
                format!(" ({} deg RMS as they arrived)", number(errors.rms_deg))
            });
            format!(", answers about {} ms late{given}", number(ms))
        }
        (None, _, Some(doubt)) => format!(", their delay not known: {doubt}"),
        (None, ..) => String::new(),
    };
    let mut text = format!(
        "\nattitude by {estimator}: {} deg RMS against the truth (inclination {}, heading {}), {} deg at most; {} answers{delay}\n",
        number(figures.errors.rms_deg),
        number(figures.errors.inclination_rms_deg),
        number(figures.errors.heading_rms_deg),
        number(figures.errors.max_deg),
        figures.samples,
    );
    if figures.coverage < WHOLE {
        text += &format!(
            "judged from {} s to {} s: {} % of the scene's {} s\n",
            number(figures.from_s),
            number(figures.to_s),
            number(100.0 * figures.coverage),
            number(duration_s)
        );
    }
    if let Some(looks) = &figures.looks {
        let without = figures
            .looks_rms_deg
            .map_or(String::new(), |rms| format!(" (without that {} deg RMS)", number(rms)));
        text += &format!("the estimate looks {looks}{without}\n");
    }
    text
}

fn played(t: SimTime) -> String {
    format!("{} s", number(t.seconds()))
}

/// What was made of each sensor, and how late.
pub fn sensors(report: &Report) -> Sheet {
    let received = report.sensors.iter().any(|sensor| sensor.received_hz.is_some());
    let paced = report.sensors.iter().any(|sensor| sensor.late_us.is_some());
    let mut heading = vec!["sensor", "asked Hz", "sent Hz"];
    heading.extend(received.then_some("received Hz"));
    heading.extend(["made", "sent", "dropped", "queued"]);
    if paced {
        heading.extend(["late µs p50", "p99", "p99.9", "max"]);
    }
    let hz = |rate: Option<f64>| rate.map_or("-".into(), |rate| format!("{rate:.3}"));
    let rows = report.sensors.iter().map(|sensor| {
        let mut row = vec![sensor.name.clone(), number(sensor.rate_hz), hz(sensor.sent_hz)];
        row.extend(received.then(|| hz(sensor.received_hz)));
        row.extend([sensor.made, sensor.sent, sensor.dropped, sensor.queued].map(|count| count.to_string()));
        if paced {
            let late = sensor.late_us.map(|late| [late.p50, late.p99, late.p99_9, late.max].map(number));
            row.extend(late.unwrap_or_else(|| ["-"; 4].map(String::from)));
        }
        row
    });
    let rows = rows.collect();
    Sheet { heading, rows }
}

/// What went over each link.
pub fn links(report: &Report) -> Sheet {
    let rows = report.links.iter().map(|link| {
        let missed = link.lost_seq.map_or("-".into(), |lost| lost.to_string());
        let load = link.utilisation.map_or("-".into(), |share| format!("{:.0} %", 100.0 * share));
        let most = link.queue_bytes.map_or("-".into(), |bytes| bytes.to_string());
        vec![
            link.name.clone(),
            link.made.to_string(),
            link.sent.to_string(),
            link.dropped.to_string(),
            link.queued.to_string(),
            link.bytes.to_string(),
            missed,
            most,
            load,
        ]
    });
    let heading = [
        "link",
        "made",
        "sent",
        "dropped",
        "queued",
        "bytes",
        "missed by receiver",
        "most waiting",
        "of baud rate",
    ];
    Sheet { heading: heading.to_vec(), rows: rows.collect() }
}

/// A stream that was listened to, on a screenful.
pub fn heard(report: &HeardReport, interrupted: bool) -> String {
    let ended = if interrupted { ", stopped by the user" } else { "" };
    let span = report.duration_s.map_or("recorded".into(), |span| format!("{} s", number(span)));
    let mut text = format!("\n{span}{ended}\n\n");
    if !report.sensors.is_empty() {
        text += &heard_sensors(report).text(Stream::Err);
        text += &steps(report);
        text.push('\n');
    }
    for link in &report.links {
        let rate = |value: Option<f64>, unit| {
            value.map_or(String::new(), |value| format!(", {}{unit}", number(value)))
        };
        let some = |count: Option<u64>, what| {
            count.filter(|count| *count > 0).map_or(String::new(), |count| format!(", {count} {what}"))
        };
        let lost = link.lost_seq.map_or("no sequence numbers".into(), |lost| format!("{lost} lost"));
        text += &format!(
            "{}: {} packets, {} bytes{}{}; {lost}, {} damaged{}{}\n",
            link.name,
            link.packets,
            link.bytes,
            rate(link.bytes_per_s, " bytes/s"),
            rate(link.utilisation.map(|share| 100.0 * share), " % of the baud rate"),
            link.crc_errors,
            some(link.duplicates, "twice"),
            some(link.out_of_order, "out of order") + &some(Some(link.unchecked), "that cannot be checked"),
        );
        if let Some(steps) = link.stamp_steps.filter(|steps| *steps > 0) {
            text += &format!("its stamps went back or more than an hour ahead {}: left out\n", times(steps));
        }
        let others: Vec<_> = link.foreign.iter().map(|(name, count)| format!("{name} {count}")).collect();
        if !others.is_empty() {
            text += &format!("without samples: {}\n", others.join(", "));
        }
    }
    for failure in &report.failed {
        text += &format!("FAILED: {failure}\n");
    }
    text
}

/// Where the clocks of the sensors' samples were set, and what was made of it.
fn steps(report: &HeardReport) -> String {
    let mut text = String::new();
    for sensor in report.sensors.iter().filter(|sensor| sensor.steps_back + sensor.steps_forward > 0) {
        let told = [("did not go on", sensor.steps_back), ("jumped ahead", sensor.steps_forward)];
        let told = told.into_iter().filter(|(_, count)| *count > 0);
        let told: Vec<_> = told.map(|(what, count)| format!("{what} {}", times(count))).collect();
        let longest =
            sensor.longest_step_s.map_or(String::new(), |s| format!(", by {} s at most", number(s.abs())));
        text += &format!("{}: its time {}{longest}: left out\n", sensor.name, told.join(" and "));
    }
    let assumed = report.duration_s.is_none() && report.links.iter().all(|link| link.lost_seq.is_none());
    if assumed && report.sensors.iter().any(|sensor| sensor.steps_forward > 0) {
        text += "jumps of more than 1 s and 100 intervals are taken for the clock's, since nothing here tells them from samples that are missing\n";
    }
    text
}

fn times(count: u64) -> String {
    if count == 1 { "once".into() } else { format!("{count} times") }
}

/// How each sensor of a stream arrived.
pub fn heard_sensors(report: &HeardReport) -> Sheet {
    let live = report.sensors.iter().any(|sensor| sensor.received_hz.is_some());
    let gathered = report.sensors.iter().any(|sensor| sensor.burst_share.is_some());
    let stepped = report.sensors.iter().any(|sensor| sensor.steps_back + sensor.steps_forward > 0);
    let several = report.sensors.iter().any(|sensor| sensor.source != report.sensors[0].source);
    let mut heading = vec!["sensor"];
    heading.extend(several.then_some("source"));
    heading.extend(["received", "missing", "sampled Hz"]);
    heading.extend(stepped.then_some("time steps"));
    if live {
        heading.extend(["received Hz", "interval µs p50", "p99", "max", "jitter µs p99"]);
    }
    heading.extend(gathered.then_some("bursts"));
    let optional = |value: Option<f64>| value.map_or("-".into(), number);
    let hz = |rate: Option<f64>| rate.map_or("-".into(), |rate| format!("{rate:.3}"));
    let rows = report.sensors.iter().map(|sensor| {
        let missing = sensor.missing.map_or("-".into(), |missing| missing.to_string());
        let mut row = vec![sensor.name.clone()];
        row.extend(several.then(|| sensor.source.clone()));
        row.extend([sensor.received.to_string(), missing, hz(sensor.rate_hz)]);
        row.extend(stepped.then(|| (sensor.steps_back + sensor.steps_forward).to_string()));
        if live {
            let interval = sensor.interval_us;
            row.push(hz(sensor.received_hz));
            row.extend(
                [interval.map(|us| us.p50), interval.map(|us| us.p99), interval.map(|us| us.max)]
                    .map(optional),
            );
            row.push(optional(sensor.jitter_us.map(|us| us.p99)));
        }
        let share =
            |share: Option<f64>| share.map_or("-".into(), |share| format!("{} %", number(100.0 * share)));
        row.extend(gathered.then(|| share(sensor.burst_share)));
        row
    });
    let rows = rows.collect();
    Sheet { heading, rows }
}
