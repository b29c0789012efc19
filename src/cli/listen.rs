//! `ratetable listen`: the meter on anybody's stream.

use super::progress::Bar;
use super::show::heard::Clocks;
use super::show::{LiveArguments, PAGE, Show, ends};
use super::terminal::Stream;
use super::{Refusal, Verdict, options, say, summary, tell};
use crate::dataset::{self, Holds};
use crate::link::{self, Address};
use crate::listen::{self, Event, Heard, Job, Meter};
use crate::live::About;
use crate::parallel;
use crate::report::chart::{Distribution, Histogram, Marker, histogram};
use crate::report::{HeardLink, HeardReport, HeardSensor, Host, Limit, number};
use crate::scene::Destination;
use crate::sensor::SensorKind;
use crate::time::SimTime;
use crate::wire::Protocol;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// The files of a recording: the attitude body to north-east-down by the controller's own clock, and the report.
const RECORDED: [&str; 2] = ["estimate.csv", "report.json"];
/// The files of the output folder.
const FILES: [&str; 3] = ["report.json", "intervals.svg", PAGE];

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// What to listen to, such as mpu@/dev/ttyUSB0,921600, mavlink@udpin:14550 or csv@file:readings.csv
    #[arg(value_name = "PROTOCOL@LINK", value_parser = options::destination)]
    from: Destination,
    /// For how long from the first bytes on [default: until the sender leaves, or Ctrl-C]
    #[arg(long = "for", value_name = "TIME|forever", value_parser = options::span)]
    span: Option<SimTime>,
    /// How long to wait for the first packet; 0 waits without end
    #[arg(long, value_name = "TIME", default_value = "30s", value_parser = options::wait)]
    wait: Duration,
    /// Fail (exit 1) unless a field of the report keeps to this, such as 'sensors.gyro.jitter_us.p99<500'
    #[arg(long = "limit", value_name = "FIELD<VALUE", value_parser = options::limit)]
    limit: Vec<Limit>,
    /// Write the report and a chart of the intervals into this folder
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Ask the controller for its attitude, as a ground station does (mavlink)
    #[arg(long, requires = "record")]
    attitude: bool,
    /// Write the attitude that it tells into this folder, for `ratetable score`
    #[arg(long, value_name = "DIR", requires = "attitude", conflicts_with = "out")]
    record: Option<PathBuf>,
    #[command(flatten)]
    live: LiveArguments,
    /// Replace the output folder if there is one
    #[arg(long)]
    force: bool,
    /// Print the report as JSON on standard output
    #[arg(long)]
    json: bool,
}

pub fn listen(arguments: &Arguments) -> Result<Verdict, Refusal> {
    let shape = serde_json::to_value(shape(&arguments.from))?;
    arguments.limit.iter().try_for_each(|limit| limit.check(&shape))?;
    if arguments.from.protocol == Protocol::Bus {
        return Err(Refusal("the chips on a bus answer a driver and send nothing by themselves: serve them with `ratetable run SCENE --to bus@…`".into()));
    }
    if arguments.attitude && arguments.from.protocol != Protocol::Mavlink {
        return Err(Refusal(format!(
            "--attitude asks over MAVLink, not over `{}`: listen to the controller's telemetry, such as mavlink@tcpout:127.0.0.1:5760",
            arguments.from.protocol.name()
        )));
    }
    if let Some(dir) = &arguments.out {
        dataset::may_write(dir, arguments.force, Holds::Listen, &FILES.map(String::from))?;
    }
    if let Some(dir) = &arguments.record {
        dataset::may_write(dir, arguments.force, Holds::Listen, &RECORDED.map(String::from))?;
    }
    let span = arguments.span.filter(|span| *span != SimTime::FOREVER);
    let job = Job {
        protocol: arguments.from.protocol,
        address: arguments.from.address.clone(),
        span: span.map(|span| Duration::from_nanos(span.0.unsigned_abs())),
        wait: arguments.wait,
        attitude: arguments.attitude,
        values: arguments.live.live.is_some() || arguments.out.is_some(),
    };
    // Asked before: a pty is gone when its sender is.
    let baud = match &arguments.from.address {
        Address::Serial { path, .. } if link::is_pty(path) => None,
        address => address.baud(),
    };
    let show = show(arguments, span)?;
    let heard = match hear(&job, span.unwrap_or(SimTime::FOREVER), &show) {
        Ok(heard) => heard,
        Err(refusal) => return Err(show.fail(refusal)),
    };
    let mut report = report(&arguments.from, &heard, baud);
    report.links[0].attitudes = arguments.attitude.then_some(heard.told.len() as u64);
    report.judge(&arguments.limit)?;
    let page = show.end(|| ends::heard(&report), None);
    tell(&Stream::Err.fold(&summary::heard(&report, heard.interrupted)));
    if let Some(dir) = &arguments.out {
        let json = serde_json::to_string_pretty(&report)? + "\n";
        let chart = intervals(&arguments.from, &heard.meter, &report.sensors);
        let page = page.unwrap_or_default();
        let files: Vec<_> = FILES.into_iter().zip([json, chart, page].map(String::into_bytes)).collect();
        dataset::put_all(dir, arguments.force, Holds::Listen, &files)?;
        tell(&format!("{}: written", dir.display()));
    }
    if let Some(dir) = &arguments.record {
        record(dir, arguments.force, &heard, &report)?;
    }
    if arguments.json {
        say(&(serde_json::to_string_pretty(&report)? + "\n"))?;
    }
    Ok(if report.ok { Verdict::Fine } else { Verdict::Failed })
}

/// Shows a stream to whoever looks on, and keeps it for its page, where either is wanted.
fn show(arguments: &Arguments, span: Option<SimTime>) -> Result<Show, Refusal> {
    let link = arguments.from.to_string();
    let about = About {
        duration: span,
        estimators: if arguments.attitude { vec!["controller".into()] } else { Vec::new() },
        links: vec![link.clone()],
        ..About::of_data("listen", link)
    };
    Show::start(about, None, arguments.live.live, arguments.out.is_some())
}

fn hear(job: &Job, end: SimTime, show: &Show) -> Result<Heard, Refusal> {
    let bar = Bar::new(end);
    let mut clocks = Clocks::default();
    let heard = listen::listen(job, &mut |event| {
        if let Some(board) = show.board() {
            clocks.put(&event, board);
        }
        match event {
            Event::Notice(notice) => bar.line(&format!("notice: {notice}")),
            Event::Ready(name) => bar.line(&format!("listening: {name}")),
            Event::Progress(progress) => bar.heard(&progress),
            _ => {}
        }
    });
    bar.clear();
    Ok(heard?)
}

/// Writes the attitudes that a controller sent, with the times of its own clock.
///
/// # Errors
/// It told none, or the folder cannot be written.
fn record(dir: &Path, force: bool, heard: &Heard, report: &HeardReport) -> Result<(), Refusal> {
    if heard.told.is_empty() {
        return Err(Refusal(format!(
            "{} told no attitude: ATTITUDE and ATTITUDE_QUATERNION were asked for and neither came; does an autopilot beat on this link?",
            heard.name
        )));
    }
    let mut csv = String::from("t_ns,qw,qx,qy,qz\n");
    for (t, attitude) in &heard.told {
        let q = attitude.q;
        csv += &format!("{t},{},{},{},{}\n", q.w, q.x, q.y, q.z);
    }
    let [estimate, json] = RECORDED;
    let files =
        [(estimate, csv.into_bytes()), (json, (serde_json::to_string_pretty(report)? + "\n").into_bytes())];
    dataset::put_all(dir, force, Holds::Listen, &files)?;
    tell(&format!(
        "{}: {} attitudes; `ratetable score TRUTH {0}` judges them",
        dir.display(),
        heard.told.len()
    ));
    Ok(())
}

/// A report with every field that a stream can have: limits are checked against it before anything is opened.
pub(super) fn shape(from: &Destination) -> HeardReport {
    let more = |kind: SensorKind| (2..=4).map(move |n| format!("{kind}-{n}"));
    let names = SensorKind::ALL.into_iter().flat_map(|kind| [kind.to_string()].into_iter().chain(more(kind)));
    let link =
        HeardLink { to: from.to_string(), stamp_steps: Some(0), attitudes: Some(0), ..HeardLink::default() };
    HeardReport::new(Host::new(parallel::all_cores()), names.map(HeardSensor::shape).collect(), link)
}

/// What was heard; `baud` is what the link carries, where it has a speed.
fn report(from: &Destination, heard: &Heard, baud: Option<u32>) -> HeardReport {
    let meter = &heard.meter;
    let link = meter.link(from.to_string(), heard.name.clone(), baud);
    let report = HeardReport::new(Host::new(parallel::all_cores()), meter.sensors(), link);
    HeardReport { duration_s: meter.duration_s(), ..report }
}

/// How the intervals between arrivals are spread, by sensor.
fn intervals(from: &Destination, meter: &Meter, sensors: &[HeardSensor]) -> String {
    let distribution = |stream: &listen::Stream| Distribution {
        name: stream.name().to_string(),
        values: stream.intervals_us(),
    };
    let named = |name: &str| sensors.iter().find(|sensor| sensor.name == name);
    let median = |(of, stream): (usize, &listen::Stream)| {
        let x = named(stream.name())?.interval_us?.p50;
        Some(Marker { x, label: format!("{} {} µs", stream.name(), number(x)), of: Some(of) })
    };
    histogram(&Histogram {
        title: "Intervals between arrivals".into(),
        subtitle: from.to_string(),
        x_label: "interval (µs)".into(),
        log_x: true,
        log_y: true,
        distributions: meter.streams().iter().map(distribution).collect(),
        markers: meter.streams().iter().enumerate().filter_map(median).collect(),
        ..Histogram::default()
    })
}
