//! The description of a run.

use super::heard::Judging;
use super::host::host;
use super::pace::Speed;
use super::watch::Watch;
use crate::link::Address;
use crate::report::{AttitudeReport, Host, LinkReport, PacingReport, Report, SensorReport};
use crate::scene::{Output, Plan, Target};
use crate::score::Figures;
use crate::time::{NANOS, SimTime};
use crate::wire::Protocol;
use std::sync::Arc;
use std::time::Duration;

/// Everything a run needs.
#[derive(Debug)]
pub struct Job {
    /// The scene.
    pub plan: Arc<Plan>,
    /// Where to send: at least one.
    pub outputs: Vec<Output>,
    /// Scene time at which the run ends.
    pub end: SimTime,
    /// The shortest time to hold the vehicle still before the scene; the hold then lasts until every other side is
    /// ready. `None` begins with the scene.
    pub rest: Option<SimTime>,
    /// A ground station, and the index of the output whose controller it talks to.
    pub ground: Option<(Address, usize)>,
    /// How fast scene time goes.
    pub speed: Speed,
    /// How long to wait for the other side; zero starts at once.
    pub wait: Duration,
    /// A program to start when the links are ready, with its arguments.
    pub command: Vec<String>,
    /// Whether standard output is reserved for us: the command's output then goes to standard error.
    pub keep_stdout: bool,
    /// How to judge the estimates of the other side.
    pub judging: Judging,
    /// The processor to bind the pacing thread to.
    pub cpu: Option<usize>,
    /// Whoever wants a record of every sample; of a run that is paced.
    pub watch: Option<Watch>,
    /// Receives what comes back on the first link, in place of the score: a loopback plug returns the packets.
    pub tap: Option<Tap>,
}

impl Job {
    /// Plays the whole scene in real time to these outputs, with the rest that the most demanding target needs and
    /// without waiting for anybody.
    pub fn new(plan: Arc<Plan>, outputs: Vec<Output>) -> Job {
        Job {
            end: plan.duration,
            rest: rest(&plan, &outputs),
            plan,
            outputs,
            ground: None,
            speed: Speed::default(),
            wait: Duration::ZERO,
            command: Vec::new(),
            keep_stdout: false,
            judging: Judging::default(),
            cpu: None,
            watch: None,
            tap: None,
        }
    }

    /// The first target, whose controller chooses what it reads of the scene.
    pub fn target(&self) -> Option<&'static Target> {
        self.outputs.iter().find_map(|output| output.to.target)
    }

    /// Where nothing is sent and an attitude is heard.
    pub fn hears(&self) -> Option<String> {
        self.outputs.iter().find(|output| output.wire.is_mute).map(|output| output.to.to_string())
    }

    /// The first output with a controller that a ground station can talk to.
    pub fn mavlink(&self) -> Option<usize> {
        self.outputs.iter().position(|output| output.to.protocol == Protocol::Mavlink)
    }

    /// A report with every field that the run can have: limits are checked against it before anything opens.
    pub fn shape(&self) -> Report {
        let sensors = self.plan.sensors.iter();
        let link = |output: &Output| {
            let faults = output.faults.iter().map(|fault| fault.kind.name());
            LinkReport::shape(&output.to.to_string(), output.overload.name(), faults)
        };
        Report {
            faults: self.plan.faults_until(SimTime::FOREVER),
            host: Host { pacing: Some(PacingReport::default()), ..host() },
            sensors: sensors.map(|it| SensorReport::shape(it.kind.name(), it.rate.as_hz())).collect(),
            links: self.outputs.iter().map(link).collect(),
            attitude: Some(AttitudeReport { estimator: String::new(), figures: Figures::shape() }),
            ..Report::new(&self.plan.name, self.plan.seed)
        }
    }
}

/// How long the vehicle rests at least for the most demanding target. Where it moves as soon as the scene begins, its
/// estimator has no time to settle in the scene, and it rests longer.
fn rest(plan: &Plan, outputs: &[Output]) -> Option<SimTime> {
    const LONGER: SimTime = SimTime(5 * NANOS);
    let rest = outputs.iter().filter_map(|output| Some(output.to.target?.rest)).max()?;
    let start = plan.trajectory.at(SimTime::ZERO);
    let pushed = start.force.v.length() - plan.trajectory.gravity().v.length();
    let moves = start.rate.v.length() > 1e-3 || pushed.abs() > 0.05;
    Some(if moves && rest > SimTime::ZERO { rest + LONGER } else { rest })
}

/// Receives bytes as they arrive.
pub type OnBytes = dyn FnMut(&[u8]);

/// Receives what a link reads.
pub struct Tap(pub Box<OnBytes>);

impl std::fmt::Debug for Tap {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Tap")
    }
}
