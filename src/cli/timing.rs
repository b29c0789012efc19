//! `ratetable timing`: how late and how even a stream is, measured at both ends and against a bare timer.

mod charts;
mod collector;
mod ledger;
mod reader;
mod results;

use super::clash::{self, Besides};
use super::progress::Bar;
use super::run::written_to_the_end;
use super::show::{LiveArguments, PAGE, Show};
use super::terminal::Stream;
use super::{Refusal, Verdict, options, say, tell};
use crate::clock::WallClock;
use crate::dataset::{self, DatasetError, Folder, Holds};
use crate::link::Address;
use crate::live::{About, Scene};
use crate::report::{Limit, TimingReport};
use crate::scene::{Destination, Output, Plan};
use crate::session::{self, BareTimer, Event, Job, Outcome, Record, SessionError, Tap, Watch};
use crate::time::{NANOS, Rate, SimTime};
use crate::wire::{self, Protocol};
use collector::{Collector, Onward};
use ledger::Ledger;
use reader::{Arrivals, Came, Reader};
use rtrb::Producer;
use std::cell::RefCell;
use std::io;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::Arc;
use std::time::Duration;

/// The scene unless another is named: gyro and accelerometer at 1 kHz, magnetometer at 100 Hz.
const SCENE: &str = "still";
/// How long the stream and the bare timer take turns of.
const SLICE: SimTime = SimTime(NANOS);
/// How long to wait for somebody on a link that is no pty.
const WAIT: Duration = Duration::from_secs(30);
/// The files of the output folder.
const FILES: [&str; 4] = ["timing.csv", "timing.svg", PAGE, "report.json"];

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// A TOML file or the name of a built-in scene
    #[arg(default_value = SCENE)]
    scene: String,
    /// Over what: a pty, read at its other end, or a serial port with a loopback plug (TX to RX); any other link is
    /// measured at the sending end alone [default: the scene's only output, or mpu@pty]
    #[arg(long, value_name = "PROTOCOL@LINK", value_parser = options::output)]
    to: Option<Output>,
    /// How long to stream (10 s have a 99.9th percentile at 1 kHz), not counting the bare timer's slices, which take as long again
    #[arg(long = "for", value_name = "TIME|forever", default_value = "10s", value_parser = options::span)]
    span: SimTime,
    /// Keep the pacing thread to this processor
    #[arg(long, value_name = "N", value_parser = options::processor)]
    cpu: Option<usize>,
    /// Override one key of the scene, such as gyro.rate='8 kHz'
    #[arg(long = "set", value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Fail (exit 1) unless a field of the report keeps to this, such as 'ratio_p99<1.5'
    #[arg(long = "limit", value_name = "FIELD<VALUE", value_parser = options::limit)]
    limit: Vec<Limit>,
    /// Write every sample's times as timing.csv, a picture and the report into this folder
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    live: LiveArguments,
    /// Replace the output folder if there is one
    #[arg(long)]
    force: bool,
    /// Print the report as JSON on standard output
    #[arg(long)]
    json: bool,
}

pub fn timing(arguments: &Arguments) -> Result<Verdict, Refusal> {
    let plan = Plan::load(&arguments.scene, &arguments.set)?;
    let output = output(arguments, &plan)?;
    let limits = options::limits(&arguments.limit, &plan)?;
    let job = job(arguments, Arc::new(plan), output);
    let (plan, output) = (job.plan.clone(), &job.outputs[0]);
    if !output.sends() {
        return Err(Refusal(format!(
            "{} sends no packets whose time could be measured: `ratetable run` reports how fast a bus is answered",
            output.to
        )));
    }
    let shape = TimingReport::shape(job.shape());
    let as_json = serde_json::to_value(&shape)?;
    limits.iter().try_for_each(|limit| limit.check(&as_json))?;
    wire::check(output.to.protocol, &output.wire, &plan.sensors).map_err(Refusal)?;
    let besides = Besides { out: arguments.out.as_deref(), ground: None, report: arguments.json };
    clash::outputs(&plan, &job.outputs, &besides)?;
    let folder = arguments.out.as_ref().map(|dir| folder(dir, arguments.force)).transpose()?;
    let (show, shown) = show(arguments, &job)?;
    let csv = folder.as_ref().map(|folder| folder.file("timing.csv")).transpose()?;
    let measured = match measure(job, Onward { csv, shown }, &show) {
        Ok(measured) => measured,
        Err(refusal) => return Err(show.fail(refusal)),
    };
    let mut report = results::report(shape, &plan, &measured);
    measured.outcome.judge(&mut report.run, &[], false)?;
    report.judge(&limits)?;
    let page = show.end(|| results::end(&report), Some(measured.outcome.played));
    tell(&Stream::Err.fold(&results::text(&report, measured.outcome.interrupted)));
    if let (Some(folder), Some(dir)) = (folder, &arguments.out) {
        let picture = charts::timing(&report, &measured.ledger, &measured.bare());
        folder.put("timing.svg", picture.as_bytes())?;
        folder.put(PAGE, page.unwrap_or_default().as_bytes())?;
        folder.put("report.json", (serde_json::to_string_pretty(&report)? + "\n").as_bytes())?;
        folder.commit_with_manifest()?;
        tell(&format!("{}: {}", dir.display(), FILES.join(", ")));
    }
    if arguments.json {
        say(&(serde_json::to_string_pretty(&report)? + "\n"))?;
    }
    written_to_the_end(&measured.outcome)?;
    Ok(if report.run.ok { Verdict::Fine } else { Verdict::Failed })
}

/// What is to be run, but for who watches.
fn job(arguments: &Arguments, plan: Arc<Plan>, output: Output) -> Job {
    Job {
        end: arguments.span,
        rest: None,
        wait: WAIT,
        keep_stdout: arguments.json,
        cpu: arguments.cpu,
        ..Job::new(plan, vec![output])
    }
}

/// Shows a run to whoever looks on, and keeps it for its page, where either is wanted; what its records go to.
fn show(arguments: &Arguments, job: &Job) -> Result<(Show, Option<Producer<Record>>), Refusal> {
    let (at, keeps) = (arguments.live.live, arguments.out.is_some());
    let links = job.outputs.iter().map(|output| output.to.to_string()).collect();
    let mut about = About::scene("timing", &job.plan, job.end, links);
    about.speed = job.speed.report();
    let (records, recorded) = rtrb::RingBuffer::new(collector::RING);
    let scene = Scene { plan: job.plan.clone(), end: job.end, records: Some(recorded) };
    let show = Show::start(about, Some(scene), at, keeps)?;
    let wanted = show.board().is_some();
    Ok((show, wanted.then_some(records)))
}

/// The output folder, begun.
fn folder(dir: &Path, force: bool) -> Result<Folder, DatasetError> {
    dataset::may_write(dir, force, Holds::Timing, &FILES.map(String::from))?;
    Folder::open(dir, force, Holds::Timing)
}

/// The one link that is measured.
fn output(arguments: &Arguments, plan: &Plan) -> Result<Output, Refusal> {
    let on_a_pty = || Output::to(Destination::new(Protocol::Mpu, Address::Pty { path: None, baud: None }));
    let output = match (&arguments.to, plan.outputs.as_slice()) {
        (Some(to), _) => to.clone(),
        (None, []) => on_a_pty(),
        // Timing is of the stream itself: samples are matched by their place in it.
        (None, [only]) => Output { faults: Vec::new(), ..only.clone() },
        (None, several) => {
            let names: Vec<_> = several.iter().map(|output| output.to.to_string()).collect();
            return Err(Refusal(format!(
                "timing measures one link, and the scene has {} ({}): name one with --to",
                names.len(),
                names.join(", ")
            )));
        }
    };
    match output.to.address.is_stdout() && arguments.json {
        true => Err(Refusal(
            "--json prints the report on standard output, where `-` already sends packets: leave out one of the two"
                .into(),
        )),
        false => Ok(output),
    }
}

/// Everything that a run brought.
struct Measured {
    outcome: Outcome,
    ledger: Ledger,
    /// Who received, and what came there.
    far: Option<(&'static str, Came)>,
    rate: Rate,
}

impl Measured {
    fn bare(&self) -> crate::report::Times {
        self.outcome.watched.as_ref().map(|watched| watched.late.clone()).unwrap_or_default()
    }
}

/// Streams, with somebody at the other end where there can be one.
fn measure(mut job: Job, onward: Onward, show: &Show) -> Result<Measured, Refusal> {
    let clock = WallClock::start();
    let (records, recorded) = rtrb::RingBuffer::new(collector::RING);
    let (ring, arrived) = rtrb::RingBuffer::new(collector::RING);
    let Destination { address, protocol, .. } = &job.outputs[0].to;
    let far = Far::of(address);
    let rate = job.plan.sensors.first().map_or(Rate::hz(1000), |sensor| sensor.rate);
    let ledger = Ledger::new(&job.plan, far != Far::Nobody, SLICE, 0);
    let collector = Collector::start(ledger, recorded, arrived, onward);
    let mut arrivals = Some(Arrivals::new(*protocol, clock, ring));
    let heard = Rc::new(RefCell::new(Came::default()));
    job.tap = arrivals.take_if(|_| far == Far::Loopback).map(|arrivals| tap(arrivals, heard.clone()));
    job.watch = Some(Watch { clock, bare: Some(BareTimer { slice: SLICE, rate }), records });
    let (outcome, came) = stream(job, arrivals.filter(|_| far == Far::Reader), show);
    let ledger = collector.end();
    let outcome = outcome?;
    let came = came.map_err(|error| Refusal(format!("the reader at the pty's other end failed: {error}")))?;
    let looped = (far == Far::Loopback).then(|| *heard.borrow());
    let ledger = ledger?;
    let far = came.map(|came| ("a reader on the pty", came));
    let far = far.or(looped.map(|came| ("the port itself, through a loopback plug", came)));
    // Silence is no measurement: without a plug nothing comes back.
    let far =
        far.filter(|(_, came)| came.samples > 0 || ledger.sensors.iter().any(|sensor| sensor.received > 0));
    Ok(Measured { outcome, ledger, far, rate })
}

/// Runs the job, while a reader of a pty's other end, if there is to be one, takes in what arrives; what came of both.
fn stream(
    job: Job,
    mut arrivals: Option<Arrivals>,
    show: &Show,
) -> (Result<Outcome, SessionError>, io::Result<Option<Came>>) {
    let bar = Bar::of_run(job.end, job.plan.axes);
    let mut reader = None;
    let outcome = session::run(job, &mut |event| {
        show.event(&event);
        bar.event(&event);
        if let Event::Ready(name) = event
            && let Some(arrivals) = arrivals.take()
        {
            let path = name.split_once('@').map_or(name, |(_, path)| path);
            reader = Some(Reader::start(path.into(), arrivals));
        }
    });
    bar.clear();
    (outcome, reader.map(Reader::end).transpose())
}

/// Reads back what a port sends to itself.
fn tap(mut arrivals: Arrivals, heard: Rc<RefCell<Came>>) -> Tap {
    Tap(Box::new(move |bytes| {
        arrivals.take(bytes);
        *heard.borrow_mut() = arrivals.came();
    }))
}

/// Who can be at the other end.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Far {
    /// A thread of ours.
    Reader,
    /// The port itself.
    Loopback,
    /// Nobody that we know of.
    Nobody,
}

impl Far {
    fn of(address: &Address) -> Far {
        match address {
            Address::Pty { .. } => Far::Reader,
            Address::Serial { .. } => Far::Loopback,
            _ => Far::Nobody,
        }
    }
}

#[cfg(test)]
mod tests;
