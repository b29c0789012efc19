//! What comes of a run.

use super::watch::Watched;
use crate::geometry::Attitude;
use crate::report::{LinkReport, PacingReport, SensorReport};
use crate::score::Figures;
use crate::time::SimTime;

/// What came of it.
#[derive(Debug, Default)]
pub struct Outcome {
    /// Scene time reached: the end, or where it was stopped.
    pub played: SimTime,
    /// Whether it was stopped by the user.
    pub interrupted: bool,
    /// For how long the vehicle was held still before the scene, s.
    pub rest_s: f64,
    /// For how long scene time stood still for a link that was full or a controller in lockstep, s.
    pub stretched_s: f64,
    /// Whether the pacing thread had real-time priority.
    pub realtime: bool,
    /// Whether the process was locked in memory.
    pub memory_locked: bool,
    /// How the pacing thread waited; `None` where nothing was paced.
    pub pacing: Option<PacingReport>,
    /// The comparison, where one was asked for.
    pub watched: Option<Watched>,
    /// Each sensor's counts, rates and lateness.
    pub sensors: Vec<SensorReport>,
    /// Each link's counts.
    pub links: Vec<LinkReport>,
    /// The faults of outputs that acted: `mpu@pty drop from 2 s to 3 s`.
    pub faults: Vec<String>,
    /// What the other side estimated, judged.
    pub attitude: Option<Figures>,
    /// Every estimate that came back, with the scene time at which it held as far as that is known.
    pub estimates: Vec<(SimTime, Attitude)>,
    /// The command's exit code; `None` without a command, or when it was ended by us.
    pub command: Option<i32>,
}
