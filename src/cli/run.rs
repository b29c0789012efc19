//! `ratetable run`: a scene in real time.

use super::clash::{self, Besides};
use super::demo::{Firmware, Received};
use super::generate::REPORT;
use super::progress::Bar;
use super::show::{self, LiveArguments, PAGE, Show, ends};
use super::terminal::Stream;
use super::{Refusal, Verdict, options, say, summary, tell};
use crate::bus;
use crate::clock::WallClock;
use crate::link::Address;
use crate::live::{About, Scene};
use crate::report::Limit;
use crate::scene::{Destination, Output, OutputFault, Plan, Target, Tells};
use crate::session::{self, Event, Job, Judging, Outcome, Speed};
use crate::time::SimTime;
use crate::wire::{self, Protocol};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

/// The scene of the demonstration.
const DEMO_SCENE: &str = "table-1";

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// A TOML file or the name of a built-in scene [default: table-1, in a demonstration]
    scene: Option<String>,
    /// Where to: PROTOCOL@LINK or TARGET@LINK, such as mpu@pty or px4@/dev/ttyACM0; may be repeated
    #[arg(long = "to", value_name = "PROTOCOL@LINK", value_parser = options::output)]
    to: Vec<Output>,
    /// Where else the other side tells its attitude, such as mavlink@tcpin:127.0.0.1:5762: it is sent no readings there
    #[arg(long, value_name = "PROTOCOL@LINK", value_parser = options::mute)]
    attitude: Option<Output>,
    /// How much of the scene, such as 90s; longer than it lasts holds at the end [default: all of it]
    #[arg(long = "for", value_name = "TIME|forever", value_parser = options::span)]
    span: Option<SimTime>,
    /// Scene seconds a second, or max: as fast as the other side reads, nothing dropped
    #[arg(long, value_name = "1|N|max", default_value = "1", value_parser = options::speed)]
    speed: Speed,
    /// How long to wait for somebody on the other side; 0 starts at once
    #[arg(long, value_name = "TIME", default_value = "30s", value_parser = options::wait)]
    wait: Duration,
    /// How long the vehicle is held still before the scene at the least, and then until the other side is ready [default: what a target needs]
    #[arg(long, value_name = "TIME", value_parser = options::from_zero)]
    rest: Option<SimTime>,
    /// Pass the controller's other messages to and from a ground station over UDP
    #[arg(long, value_name = "ADDR:PORT", num_args = 0..=1, require_equals = true, default_missing_value = "127.0.0.1:14550", value_parser = options::ground)]
    qgc: Option<Address>,
    /// Scene time from which on the other side's estimates are judged
    #[arg(long, value_name = "TIME", default_value = "0", value_parser = options::from_zero)]
    settle: SimTime,
    /// What to take out of its estimates before they are judged [default: none; heading for a target without a source of heading]
    #[arg(long, value_enum)]
    align: Option<options::Alignment>,
    /// Keep the pacing thread to this processor
    #[arg(long, value_name = "N", value_parser = options::processor)]
    cpu: Option<usize>,
    /// Override one key of the scene, such as gyro.rate='8 kHz'
    #[arg(long = "set", value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Fail (exit 1) unless a field of the report keeps to this, such as 'sensors.gyro.late_us.p99<200'
    #[arg(long = "limit", value_name = "FIELD<VALUE", value_parser = options::limit)]
    limit: Vec<Limit>,
    /// Write the dataset played, the estimates that came back and the report into this folder
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    live: LiveArguments,
    /// Start although a baud rate does not carry the packets, and replace the output folder if there is one
    #[arg(long)]
    force: bool,
    /// Print the report as JSON on standard output
    #[arg(long)]
    json: bool,
    /// A program to test: started when the links are ready, {} standing for the first one
    #[arg(last = true, value_name = "COMMAND")]
    command: Vec<String>,
}

pub fn run(arguments: &Arguments) -> Result<Verdict, Refusal> {
    let (mut job, demonstration) = job(arguments, plan(arguments)?);
    let limits = options::limits(&arguments.limit, &job.plan)?;
    let shape = serde_json::to_value(job.shape())?;
    limits.iter().try_for_each(|limit| limit.check(&shape))?;
    refuse(arguments, &job)?;
    job.ground = ground(arguments.qgc.clone(), &job)?;
    let (mut plan, target, hears) = (job.plan.clone(), job.target(), job.hears());
    let estimator = target.map_or(if demonstration { "vqf" } else { "firmware" }, |target| target.name);
    let show = show(arguments, &mut job, estimator)?;
    let (outcome, received) = match play(job, demonstration, &show) {
        Ok(played) => played,
        Err(refusal) => return Err(show.fail(refusal)),
    };
    let mut report = outcome.report(&plan, estimator);
    if let Some(received) = received {
        received.add_to(&mut report.sensors, &mut report.links);
    }
    outcome.judge(&mut report, &limits, target.is_some())?;
    if let Some(to) = hears.filter(|_| outcome.estimates.is_empty()) {
        report.ok = false;
        report.failed.push(format!("no attitude came on {to}"));
    }
    let page = show.end(|| ends::run(&report), Some(outcome.played));
    // Nobody else has the plan any more: who showed it has ended.
    if let Some(plan) = Arc::get_mut(&mut plan) {
        plan.set(outcome.settings.iter().map(|it| (it.kind, it.setting.clone(), it.written.clone())));
    }
    tell(&Stream::Err.fold(&summary::run(&report, &outcome)));
    let told = outcome.attitude.is_some();
    if let Some(target) = target.filter(|target| target.tells == Tells::Nothing && !told) {
        tell(&format!(
            "{} does not tell its attitude on this link: while a scene plays, record it from its telemetry with `ratetable listen mavlink@PORT --attitude --record DIR`, then `ratetable score TRUTH DIR`",
            target.name
        ));
    }
    if let Some(dir) = &arguments.out {
        let files =
            [(REPORT, serde_json::to_string_pretty(&report)? + "\n"), (PAGE, page.unwrap_or_default())];
        super::generate::after_run(&plan, &outcome, &files, dir, arguments.force)?;
    }
    if arguments.json {
        say(&(serde_json::to_string_pretty(&report)? + "\n"))?;
    }
    written_to_the_end(&outcome)?;
    Ok(match outcome.command {
        Some(code) if code != 0 => Verdict::Code(u8::try_from(code).unwrap_or(1)),
        _ if report.ok => Verdict::Fine,
        _ => Verdict::Failed,
    })
}

/// What is to be run, but for a ground station, and whether it is the demonstration.
fn job(arguments: &Arguments, plan: Plan) -> (Job, bool) {
    let outputs = if arguments.to.is_empty() { plan.outputs.clone() } else { arguments.to.clone() };
    let demonstration = outputs.is_empty();
    let mut outputs = if demonstration { vec![demo_output()] } else { outputs };
    outputs.extend(arguments.attitude.clone());
    for output in &mut outputs {
        output.force |= arguments.force;
    }
    for idle in OutputFault::equip(&plan.output_faults, &mut outputs) {
        tell(&format!("warning: the fault {idle} concerns no output of this run"));
    }
    let whole = Job::new(Arc::new(plan), outputs);
    let job = Job {
        end: arguments.span.unwrap_or(whole.end),
        rest: arguments.rest.or(whole.rest),
        judging: Judging { align: align(arguments, whole.target()).into(), settle: arguments.settle },
        speed: arguments.speed,
        wait: arguments.wait,
        command: arguments.command.clone(),
        keep_stdout: arguments.json,
        cpu: arguments.cpu,
        ..whole
    };
    (job, demonstration)
}

/// What is taken out of the estimates: as asked, or what a target cannot know.
fn align(arguments: &Arguments, target: Option<&Target>) -> options::Alignment {
    let blind = target.is_some_and(|target| !target.has_heading);
    arguments.align.unwrap_or(if blind { options::Alignment::Heading } else { options::Alignment::None })
}

/// The requested scene, or the first target's, or the demonstration's.
fn plan(arguments: &Arguments) -> Result<Plan, Refusal> {
    let target = arguments.to.iter().find_map(|output| output.to.target);
    let scene = match (&arguments.scene, target, arguments.to.first()) {
        (scene, Some(target), _) => {
            let (plan, set) = target.load(scene.as_deref(), &arguments.set)?;
            if scene.is_some() && !set.is_empty() {
                tell(&format!("notice: {} gets {} (--set overrides it)", target.name, set.join(", ")));
            }
            return Ok(plan);
        }
        (Some(scene), ..) => scene,
        (None, None, Some(output)) => {
            return Err(Refusal(format!(
                "--to {} needs a scene: ratetable run SCENE --to …; `ratetable list scenes` shows the built-in ones",
                output.to
            )));
        }
        (None, None, None) => DEMO_SCENE,
    };
    Ok(Plan::load(scene, &arguments.set)?)
}

/// A ground station's address, and the output that it listens in on.
fn ground(address: Option<Address>, job: &Job) -> Result<Option<(Address, usize)>, Refusal> {
    let Some(address) = address else { return Ok(None) };
    job.mavlink().map(|with| Some((address, with))).ok_or_else(|| {
        Refusal(
            "--qgc passes on MAVLink, and no output speaks it: add, for example, --to px4@/dev/ttyACM0"
                .into(),
        )
    })
}

fn demo_output() -> Output {
    Output::to(Destination::new(Protocol::Mpu, Address::Pty { path: None, baud: None }))
}

/// What cannot go together, before anything is opened.
fn refuse(arguments: &Arguments, Job { plan, outputs, .. }: &Job) -> Result<(), Refusal> {
    if arguments.json && outputs.iter().any(|output| output.to.address.is_stdout()) {
        return Err(Refusal("--json prints the report on standard output, where `-` already sends packets: leave out one of the two".into()));
    }
    if arguments.span == Some(SimTime::FOREVER) && arguments.speed == Speed::Max {
        return Err(Refusal("--for forever at --speed max never ends and never waits: give a time".into()));
    }
    if arguments.cpu.is_some() && arguments.speed == Speed::Max {
        return Err(Refusal("--cpu keeps the pacing thread to a processor, and --speed max paces nothing: leave out one of the two".into()));
    }
    refuse_bus(arguments, plan, outputs)?;
    for output in outputs {
        let target = output.to.target.filter(|target| target.most_hz.is_some());
        let most = target.and_then(|target| Some((target.name, target.most_hz?)));
        if let Some((name, most)) = most
            && !matches!(arguments.speed, Speed::Times(times) if times <= 1.0)
        {
            return Err(Refusal(format!(
                "{name} takes at most {most} packets a second of real time: leave --speed out, or give 1 or less"
            )));
        }
    }
    plan.warnings.iter().for_each(|warning| tell(&format!("warning: {warning}")));
    for output in outputs {
        wire::check(output.to.protocol, &output.wire, &plan.sensors).map_err(Refusal)?;
        wire::warnings(output.to.protocol, &output.wire, &plan.sensors)
            .iter()
            .for_each(|warning| tell(&format!("warning: {warning}")));
    }
    if let Some(dir) = &arguments.out {
        super::generate::may_write(plan, dir, arguments.force)?;
    }
    let besides =
        Besides { out: arguments.out.as_deref(), ground: arguments.qgc.as_ref(), report: arguments.json };
    clash::outputs(plan, outputs, &besides)?;
    let warn = &mut |warning| tell(&format!("warning: {warning}"));
    match arguments.speed {
        Speed::Times(times) => session::afford(plan, outputs, times, arguments.force, warn).map_err(Refusal),
        Speed::Max => Ok(()),
    }
}

/// What a bus, whose driver asks, cannot go with.
fn refuse_bus(arguments: &Arguments, plan: &Plan, outputs: &[Output]) -> Result<(), Refusal> {
    let Some(bus) = outputs.iter().find(|output| output.to.protocol == Protocol::Bus) else { return Ok(()) };
    if let Some(other) = outputs
        .iter()
        .find(|other| other.sends() || (other.to != bus.to && other.to.protocol == Protocol::Bus))
    {
        return Err(Refusal(format!(
            "{} cannot go with {}: a driver asks the chips on a bus at times of its own. Play one of them alone; --attitude PROTOCOL@LINK hears an attitude beside it",
            other.to, bus.to
        )));
    }
    if arguments.qgc.is_some() {
        return Err(Refusal("--qgc passes on the other messages of a controller, and a driver on a bus has none: leave it out".into()));
    }
    if arguments.speed == Speed::Max {
        return Err(Refusal(
            "--speed max sends as fast as the other side reads, and a driver on a bus asks: leave it out"
                .into(),
        ));
    }
    if !bus.to.address.is_stream() {
        return Err(Refusal(format!(
            "{}: a driver asks the chips on a bus, and this link carries no questions and answers in order: use pty, a serial port or tcpin",
            bus.to
        )));
    }
    if plan.sensors.iter().any(|sensor| !sensor.settings.is_empty()) {
        return Err(Refusal(
            "the scene has [[setting]], and on a bus the driver sets the sensors: leave one of them out"
                .into(),
        ));
    }
    for fault in &bus.faults {
        tell(&format!("warning: the fault {fault} is one of packets, and a bus has none"));
    }
    bus::fit(&plan.sensors, bus.wire.chip).map(|_| ()).map_err(Refusal)
}

/// Shows a run to whoever looks on, and keeps it for its page, where either is wanted.
fn show(arguments: &Arguments, job: &mut Job, estimator: &str) -> Result<Show, Refusal> {
    let (at, keeps) = (arguments.live.live, arguments.out.is_some());
    if at.is_none() && !keeps {
        return Ok(Show::none());
    }
    let links: Vec<_> = job.outputs.iter().map(|output| output.to.to_string()).collect();
    let mut about = About::scene("run", &job.plan, job.end, links);
    let several = job.outputs.len() > 1;
    let told = |(output, name): (&Output, &mut String)| {
        let who = output.to.target.map_or(estimator, |target| target.name);
        *name = if several { format!("{who} on {}", output.to) } else { who.to_string() };
    };
    job.outputs.iter().zip(&mut about.estimators).for_each(told);
    about.speed = job.speed.report();
    let paces = job.speed.is_paced() && job.outputs.iter().any(Output::sends);
    let records = paces.then(|| {
        let (watch, records) = show::records(WallClock::start());
        job.watch = Some(watch);
        records
    });
    let scene = Scene { plan: job.plan.clone(), end: job.end, records };
    Show::start(about, Some(scene), at, keeps)
}

fn play(job: Job, demonstration: bool, show: &Show) -> Result<(Outcome, Option<Received>), Refusal> {
    let (bar, plan) = (Bar::of_run(job.end, job.plan.axes), job.plan.clone());
    let (mut firmware, mut held) = (None, false);
    let outcome = session::run(job, &mut |event| {
        show.event(&event);
        bar.event(&event);
        match event {
            Event::Ready(name) if demonstration => {
                let path = name.split_once('@').map_or(name, |(_, path)| path);
                bar.line("demonstration: a driver and an AHRS (VQF) open that pty as firmware would");
                firmware = Some(Firmware::start(path, &plan));
            }
            Event::Still => {
                held = true;
                bar.line("holding still until the other side is ready");
            }
            Event::Started if held => bar.line("the scene starts"),
            _ => {}
        }
    });
    bar.clear();
    let received = firmware.map(Firmware::end).transpose();
    let outcome = outcome?;
    let received =
        received.map_err(|error| Refusal(format!("the demonstration's receiving side failed: {error}")))?;
    Ok((outcome, received))
}

/// Whether standard output took the packets that were for it, as long as somebody read them.
///
/// # Errors
/// It did not, as of a full disk: what was to be there is not.
pub(super) fn written_to_the_end(outcome: &Outcome) -> Result<(), Refusal> {
    let why = outcome.unwritten().map(|why| format!("cannot write to standard output: {why}"));
    why.map_or(Ok(()), |why| Err(Refusal(why)))
}
