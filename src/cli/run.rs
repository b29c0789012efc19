//! `ratetable run`: a scene in real time.

use super::budget::Budget;
use super::clash::{self, Besides};
use super::demo::{Firmware, Received};
use super::progress::Bar;
use super::{Refusal, Verdict, options, say, summary, tell};
use crate::link::Address;
use crate::report::{
    AttitudeReport, Gaps, Host, Interval, Late, Limit, LinkReport, PacingReport, Report, SensorReport, Spread,
};
use crate::scene::{Destination, Output, OutputFault, Overload, Plan};
use crate::score::Figures;
use crate::session::{self, Event, Job, Judging, Outcome, Speed};
use crate::time::SimTime;
use crate::wire::{self, Protocol};
use serde_json::Value;
use std::io::ErrorKind;
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
    /// What to take out of its estimates before they are judged
    #[arg(long, value_enum, default_value_t = options::Alignment::None)]
    align: options::Alignment,
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
    let plan = plan(arguments)?;
    let outputs = if arguments.to.is_empty() { plan.outputs.clone() } else { arguments.to.clone() };
    let demonstration = outputs.is_empty();
    let mut outputs = if demonstration { vec![demo_output()] } else { outputs };
    for idle in OutputFault::equip(&plan.output_faults, &mut outputs) {
        tell(&format!("warning: the fault {idle} concerns no output of this run"));
    }
    let limits = options::limits(&arguments.limit, &plan)?;
    let mut report = shape(&plan, &outputs);
    let as_json = serde_json::to_value(&report)?;
    limits.iter().try_for_each(|limit| limit.check(&as_json))?;
    refuse(arguments, &plan, &outputs)?;
    let plan = Arc::new(plan);
    let estimator = estimator(demonstration, &outputs);
    let fed = outputs.iter().any(|output| output.to.target.is_some());
    let job = Job {
        plan: plan.clone(),
        end: arguments.span.unwrap_or(plan.duration),
        rest: rest(arguments.rest, &outputs),
        ground: ground(arguments.qgc.clone(), &outputs)?,
        judging: Judging { align: arguments.align.into(), settle: arguments.settle },
        outputs,
        speed: arguments.speed,
        wait: arguments.wait,
        command: arguments.command.clone(),
        keep_stdout: arguments.json,
        cpu: arguments.cpu,
        watch: None,
        tap: None,
    };
    let (outcome, received) = play(job, &plan, demonstration)?;
    fill(&mut report, &outcome, arguments.speed);
    report.attitude =
        outcome.attitude.clone().map(|figures| AttitudeReport { estimator: estimator.clone(), figures });
    report.faults = [plan.faults_until(outcome.played), outcome.faults.clone()].concat();
    if let Some(received) = received {
        received.add_to(&mut report.sensors, &mut report.links);
    }
    let ended = Ended { command: outcome.command, interrupted: outcome.interrupted, fed };
    judge(&mut report, &limits, &ended)?;
    tell(&summary::run(&report, &outcome));
    if let Some(dir) = &arguments.out {
        super::generate::after_run(&plan, &outcome, &report, dir, arguments.force)?;
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

/// The scene that is asked for, or the first target's, or the demonstration's.
fn plan(arguments: &Arguments) -> Result<Plan, Refusal> {
    let target = arguments.to.iter().find_map(|output| output.to.target);
    let (scene, settings) = match (&arguments.scene, target, arguments.to.first()) {
        (Some(scene), ..) => (scene.as_str(), &[][..]),
        (None, Some(target), _) => (target.scene, target.settings),
        (None, None, Some(output)) => {
            return Err(Refusal(format!(
                "--to {} needs a scene: ratetable run SCENE --to …; `ratetable list scenes` shows the built-in ones",
                output.to
            )));
        }
        (None, None, None) => (DEMO_SCENE, &[][..]),
    };
    let settings = settings.iter().map(|setting| setting.to_string());
    Ok(Plan::load(scene, &settings.chain(arguments.set.iter().cloned()).collect::<Vec<_>>())?)
}

/// How long the vehicle is held still first: as told, or what the most demanding target needs.
fn rest(told: Option<SimTime>, outputs: &[Output]) -> Option<SimTime> {
    let needed = outputs.iter().filter_map(|output| Some(output.to.target?.rest)).max();
    told.or(needed)
}

/// A ground station's address, and the output that it listens in on.
fn ground(address: Option<Address>, outputs: &[Output]) -> Result<Option<(Address, usize)>, Refusal> {
    let Some(address) = address else { return Ok(None) };
    let with = outputs.iter().position(|output| output.to.protocol == Protocol::Mavlink);
    with.map(|with| Some((address, with))).ok_or_else(|| {
        Refusal(
            "--qgc passes on MAVLink, and no output speaks it: add, for example, --to px4@/dev/ttyACM0"
                .into(),
        )
    })
}

/// What the estimator on the other side is called.
fn estimator(demonstration: bool, outputs: &[Output]) -> String {
    let target = outputs.iter().find_map(|output| output.to.target);
    target.map_or(if demonstration { "vqf" } else { "firmware" }, |target| target.name).into()
}

fn demo_output() -> Output {
    Output::to(Destination::new(Protocol::Mpu, Address::Pty { path: None, baud: None }))
}

/// What cannot go together, before anything is opened.
fn refuse(arguments: &Arguments, plan: &Plan, outputs: &[Output]) -> Result<(), Refusal> {
    if arguments.json && outputs.iter().any(|output| output.to.address.is_stdout()) {
        return Err(Refusal("--json prints the report on standard output, where `-` already sends packets: leave out one of the two".into()));
    }
    if arguments.span == Some(SimTime::FOREVER) && arguments.speed == Speed::Max {
        return Err(Refusal("--for forever at --speed max never ends and never waits: give a time".into()));
    }
    if arguments.cpu.is_some() && arguments.speed == Speed::Max {
        return Err(Refusal("--cpu keeps the pacing thread to a processor, and --speed max paces nothing: leave out one of the two".into()));
    }
    plan.warnings.iter().for_each(|warning| tell(&format!("warning: {warning}")));
    for output in outputs {
        wire::check(output.to.protocol, &output.wire, &plan.sensors).map_err(Refusal)?;
        wire::warnings(output.to.protocol, &plan.sensors)
            .iter()
            .for_each(|warning| tell(&format!("warning: {warning}")));
    }
    if let Some(dir) = &arguments.out {
        super::generate::may_write(plan, dir, arguments.force)?;
    }
    let besides =
        Besides { out: arguments.out.as_deref(), ground: arguments.qgc.as_ref(), report: arguments.json };
    clash::outputs(plan, outputs, &besides)?;
    match arguments.speed {
        Speed::Times(times) => afford(plan, outputs, times, arguments.force),
        Speed::Max => Ok(()),
    }
}

/// Every output that its link does not carry is refused, unless its user wants it so.
fn afford(plan: &Plan, outputs: &[Output], speed: f64, force: bool) -> Result<(), Refusal> {
    let mut refused = Vec::new();
    for output in outputs.iter().filter(|output| output.to.address.baud().is_some()) {
        let budget = Budget::of(plan, output, speed);
        match (budget.fits(), force || !refuses(output)) {
            (true, _) => {}
            (false, false) => refused.push(budget.to_string()),
            (false, true) => {
                let stretched = output.overload == Overload::Stretch;
                let but = if stretched { "scene time is stretched" } else { "the rest is lost" };
                tell(&format!("warning: {}; {but}", budget.arithmetic()));
            }
        }
    }
    if refused.is_empty() { Ok(()) } else { Err(Refusal(refused.join("\n"))) }
}

/// Whether an output that its link does not carry would lose packets that nobody has given up.
fn refuses(output: &Output) -> bool {
    !output.force && output.overload != Overload::Stretch
}

fn play(job: Job, plan: &Arc<Plan>, demonstration: bool) -> Result<(Outcome, Option<Received>), Refusal> {
    let bar = Bar::new(job.end);
    let (mut firmware, mut held) = (None, false);
    let outcome = session::run(job, &mut |event| match event {
        Event::Notice(notice) => bar.line(&format!("notice: {notice}")),
        Event::Ready(name) => {
            bar.line(&format!("ready: {name}"));
            if demonstration {
                let path = name.split_once('@').map_or(name, |(_, path)| path);
                bar.line("demonstration: a driver and an AHRS (VQF) open that pty as firmware would");
                firmware = Some(Firmware::start(path, plan));
            }
        }
        Event::Ground(place) => bar.line(&format!("ground station: udp {place}")),
        Event::Waiting { whom, left } => {
            bar.line(&format!("waiting for {whom} ({:.0} s)", left.as_secs_f64().ceil()))
        }
        Event::Silent(name) => bar.line(&format!("waiting for the controller on {name} to speak")),
        Event::Still => {
            held = true;
            bar.line("holding still until the other side is ready");
        }
        Event::Started if held => bar.line("the scene starts"),
        Event::Started => {}
        Event::Progress(progress) => bar.live(&progress),
    });
    bar.clear();
    let received = firmware.map(Firmware::end).transpose();
    let outcome = outcome?;
    let received =
        received.map_err(|error| Refusal(format!("the demonstration's receiving side failed: {error}")))?;
    Ok((outcome, received))
}

/// A report with every field that a run can have: limits are checked against it before anything is opened.
pub(super) fn shape(plan: &Plan, outputs: &[Output]) -> Report {
    let sensor = |sensor: &crate::sensor::SensorPlan| SensorReport {
        name: sensor.kind.name().into(),
        rate_hz: sensor.rate.as_hz(),
        sent_hz: None,
        received_hz: Some(0.0),
        made: 0,
        sent: 0,
        dropped: 0,
        replaced: 0,
        queued: 0,
        late_us: Some(Late::default()),
        interval_us: Some(Interval::default()),
        write_us: Some(Spread::default()),
        timing: None,
    };
    let link = |output: &Output| LinkReport {
        to: output.to.to_string(),
        name: output.to.to_string(),
        made: 0,
        sent: 0,
        packets: 0,
        bytes: 0,
        dropped: 0,
        queued: 0,
        overload: output.overload.name().into(),
        queue_bytes: Some(0),
        utilisation: None,
        paced_baud: None,
        gaps: Some(Gaps::default()),
        replies: 0,
        faults: output.faults.iter().map(|fault| (fault.kind.name(), 0)).collect(),
        crc_errors: 0,
        lost_seq: None,
        broken: None,
    };
    Report {
        version: env!("CARGO_PKG_VERSION").into(),
        ok: true,
        failed: Vec::new(),
        scene: plan.name.clone(),
        seed: plan.seed,
        duration_s: 0.0,
        rest_s: 0.0,
        stretched_s: 0.0,
        speed: Value::Null,
        faults: plan.faults_until(SimTime::FOREVER),
        host: host(false, false, Some(PacingReport::default())),
        sensors: plan.sensors.iter().map(sensor).collect(),
        links: outputs.iter().map(link).collect(),
        attitude: Some(AttitudeReport { estimator: String::new(), figures: Figures::shape() }),
    }
}

/// What this runs on, what the pacing thread was granted, and how it waited.
pub fn host(realtime: bool, memory_locked: bool, pacing: Option<PacingReport>) -> Host {
    let name = rustix::system::uname();
    let cpus = std::thread::available_parallelism().map_or(1, |cpus| cpus.get());
    let kernel = format!("{} {}", name.sysname().to_string_lossy(), name.release().to_string_lossy());
    Host { kernel, cpus, realtime, memory_locked, clock: "CLOCK_MONOTONIC", pacing }
}

pub(super) fn fill(report: &mut Report, outcome: &Outcome, speed: Speed) {
    report.duration_s = outcome.played.seconds();
    report.rest_s = outcome.rest_s;
    report.stretched_s = outcome.stretched_s;
    report.speed = match speed {
        Speed::Times(times) => times.into(),
        Speed::Max => "max".into(),
    };
    report.host = host(outcome.realtime, outcome.memory_locked, outcome.pacing);
    report.sensors = outcome.sensors.clone();
    report.links = outcome.links.clone();
}

/// How a run came to its end.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Ended {
    /// The exit code of the command that was run.
    pub command: Option<i32>,
    /// Whether the user ended it.
    pub interrupted: bool,
    /// Whether a controller chose how many packets it gets.
    pub fed: bool,
}

/// Losses, broken limits, a command that failed, and a run that never was.
pub(super) fn judge(report: &mut Report, limits: &[Limit], ended: &Ended) -> Result<(), Refusal> {
    // A reader of standard output that has enough, as `head` has, loses nothing that anybody wants.
    let quiet = |link: &LinkReport| is_stdout(link) && broken_by(link, ErrorKind::BrokenPipe);
    let excused = report.links.iter().any(quiet)
        && report.links.iter().all(|link| quiet(link) || (link.dropped == 0 && link.queued == 0));
    // A controller that asks for fewer packets than there are samples loses none.
    let given_up = |sensor: &SensorReport| if ended.fed { sensor.replaced } else { 0 };
    let lost = report.sensors.iter().filter(|sensor| !excused && sensor.dropped > given_up(sensor));
    let mut failed: Vec<_> =
        lost.map(|sensor| format!("sensors.{}.dropped = {} > 0", sensor.name, sensor.dropped)).collect();
    let broken = report.links.iter().filter(|link| !quiet(link));
    failed.extend(broken.filter_map(|link| Some(format!("{} broke: {}", link.to, link.broken.as_ref()?))));
    let code = ended.command.filter(|code| *code != 0);
    failed.extend(code.map(|code| format!("the command ended with exit code {code}")));
    let nothing = report.links.iter().all(|link| link.packets == 0);
    if ended.command == Some(0) && nothing {
        failed.push("the command ended before anything was sent: it must open the link, {} in its arguments or $RATETABLE_LINK".into());
    } else if ended.interrupted && nothing {
        failed.push("it was ended before anything was sent".into());
    }
    let value = serde_json::to_value(&*report)?;
    failed.extend(limits.iter().filter_map(|limit| limit.broken(&value)));
    report.ok = failed.is_empty();
    report.failed = failed;
    Ok(())
}

fn is_stdout(link: &LinkReport) -> bool {
    link.to.parse::<Destination>().is_ok_and(|to| to.address.is_stdout())
}

fn broken_by(link: &LinkReport, kind: ErrorKind) -> bool {
    link.broken.as_ref().is_some_and(|broken| *broken == kind.to_string())
}

/// Whether standard output took the packets that were for it, as long as somebody read them.
///
/// # Errors
/// It did not, as of a full disk: what was to be there is not.
pub(super) fn written_to_the_end(outcome: &Outcome) -> Result<(), Refusal> {
    let refused = |link: &&LinkReport| is_stdout(link) && !broken_by(link, ErrorKind::BrokenPipe);
    let broken = outcome.links.iter().filter(refused).find_map(|link| link.broken.clone());
    broken.map_or(Ok(()), |why| Err(Refusal(format!("cannot write to standard output: {why}"))))
}
