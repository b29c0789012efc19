//! The outcome of a run.

use super::host::host;
use super::pace::Speed;
use super::watch::Watched;
use crate::bus::Change;
use crate::geometry::Attitude;
use crate::report::{AttitudeReport, Host, Limit, LinkReport, PacingReport, Report, SensorReport, number};
use crate::scene::{Destination, Plan};
use crate::score::Figures;
use crate::time::SimTime;
use std::io::ErrorKind;

/// The outcome of a run.
#[derive(Debug, Default)]
pub struct Outcome {
    /// Scene time reached: the end, or where the run stopped.
    pub played: SimTime,
    /// The requested speed.
    pub speed: Speed,
    /// Whether the user stopped it.
    pub interrupted: bool,
    /// How long the vehicle was held still before the scene, s.
    pub rest_s: f64,
    /// How long scene time stood still for a full link or a controller in lockstep, s.
    pub stretched_s: f64,
    /// Whether the pacing thread had real-time priority.
    pub realtime: bool,
    /// Whether the process was locked in memory.
    pub memory_locked: bool,
    /// How the pacing thread waited; `None` if nothing was paced.
    pub pacing: Option<PacingReport>,
    /// The comparison with a bare timer, if requested.
    pub watched: Option<Watched>,
    /// Each sensor's counts, rates and lateness.
    pub sensors: Vec<SensorReport>,
    /// Each link's counts.
    pub links: Vec<LinkReport>,
    /// The faults of outputs that acted: `mpu@pty drop from 2 s to 3 s`.
    pub faults: Vec<String>,
    /// What a driver set sensors to, on a bus.
    pub settings: Vec<Change>,
    /// The verdict on the other side's estimates.
    pub attitude: Option<Figures>,
    /// Every estimate that came back, with the scene time at which it held, as far as known.
    pub estimates: Vec<(SimTime, Attitude)>,
    /// The command's exit code; `None` without a command, or if we killed it.
    pub command: Option<i32>,
}

impl Outcome {
    /// The report of a run of this plan, not judged yet; `estimator` names the estimator on the other side.
    pub fn report(&self, plan: &Plan, estimator: &str) -> Report {
        let Outcome { realtime, memory_locked, pacing, .. } = *self;
        let known = |figures| AttitudeReport { estimator: estimator.into(), figures };
        Report {
            duration_s: self.played.seconds(),
            rest_s: self.rest_s,
            stretched_s: self.stretched_s,
            speed: self.speed.report(),
            faults: [plan.faults_until(self.played), self.faults.clone()].concat(),
            settings: self.settings.iter().map(|it| format!("{} {it}", it.setting.start)).collect(),
            host: Host { realtime, memory_locked, pacing, ..host() },
            sensors: self.sensors.clone(),
            links: self.links.clone(),
            attitude: self.attitude.clone().map(known),
            ..Report::new(&plan.name, plan.seed)
        }
    }

    /// Judges its report: losses, broken links, a failed command, a run that never started, broken limits. `fed`
    /// says whether a controller chose how many packets it gets.
    pub fn judge(&self, report: &mut Report, limits: &[Limit], fed: bool) -> serde_json::Result<()> {
        let mut failed = lost(report, fed);
        let broken = report.links.iter().filter(|link| !is_enough(link));
        failed
            .extend(broken.filter_map(|link| Some(format!("{} broke: {}", link.to, link.broken.as_ref()?))));
        let code = self.command.filter(|code| *code != 0);
        failed.extend(code.map(|code| format!("the command ended with exit code {code}")));
        failed.extend(report.links.iter().filter_map(silent));
        let nothing = report.links.iter().all(|link| link.packets == 0);
        if self.command == Some(0) && nothing {
            failed.push("the command ended before anything was sent: it must open the link, {} in its arguments or $RATETABLE_LINK".into());
        } else if self.interrupted && nothing {
            failed.push("it was ended before anything was sent".into());
        }
        let value = serde_json::to_value(&*report)?;
        failed.extend(limits.iter().filter_map(|limit| limit.broken(&value)));
        report.ok = failed.is_empty();
        report.failed = failed;
        Ok(())
    }

    /// Why standard output did not take its packets although somebody reads them, for example a full disk.
    pub fn unwritten(&self) -> Option<&str> {
        let refused = |link: &&LinkReport| is_stdout(link) && !is_enough(link);
        self.links.iter().filter(refused).find_map(|link| link.broken.as_deref())
    }
}

/// What went wrong with the answers on a link: none came, or no more came.
fn silent(link: &LinkReport) -> Option<String> {
    let answers = link.answers.as_ref().filter(|_| link.packets > 0)?;
    let count = answers.count();
    match answers.stopped_at_s {
        Some(t) => Some(format!("{} stopped answering at {} s of the scene: {count}", link.to, number(t))),
        None if answers.received == 0 => {
            Some(format!("{} never answered during the scene: {count}", link.to))
        }
        None => None,
    }
}

/// The sensors that lost samples.
fn lost(report: &Report, fed: bool) -> Vec<String> {
    let excused = report.links.iter().any(is_enough)
        && report.links.iter().all(|link| is_enough(link) || (link.dropped == 0 && link.queued == 0));
    // A controller that asks for fewer packets than there are samples loses none, nor does a driver that reads fewer.
    let given_up = |sensor: &SensorReport| match sensor.read {
        Some(_) => sensor.dropped,
        None if fed => sensor.replaced,
        None => 0,
    };
    let lost = report.sensors.iter().filter(|sensor| !excused && sensor.dropped > given_up(sensor));
    lost.map(|sensor| format!("sensors.{}.dropped = {} > 0", sensor.name, sensor.dropped)).collect()
}

/// Whether a link ended because the reader of standard output had enough, as `head` does: nobody misses anything.
fn is_enough(link: &LinkReport) -> bool {
    let enough = ErrorKind::BrokenPipe.to_string();
    is_stdout(link) && link.broken.as_ref().is_some_and(|broken| *broken == enough)
}

fn is_stdout(link: &LinkReport) -> bool {
    link.to.parse::<Destination>().is_ok_and(|to| to.address.is_stdout())
}
