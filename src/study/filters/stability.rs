//! Where filters fail: each is put through what breaks filters.
//!
//! Readings are free of noise but for the gyro bias [`BIAS`], so that what a filter does comes from the case alone. The
//! error is the angle from the exact attitude; of a filter without the magnetometer it is the tilt alone, for nothing
//! tells it a heading.
//! The limits of the verdicts are the constants [`STABLE`], [`FAILS`] and [`COME_BACK`] and nowhere else.

mod cases;
mod harm;
mod trials;
mod watch;

pub use cases::CASES;
pub use trials::{BIAS, Trial};

use super::Subject;
use crate::filters::{self, Options};
use crate::geometry::Attitude;
use crate::parallel::{self, Progress};
use crate::time::SimTime;
use serde::Serialize;
use std::panic::{AssertUnwindSafe, catch_unwind};
use watch::Watch;

/// The largest stable error, degrees: what calibrated MEMS sensors leave at rest (8 mg of bias are half a degree, a
/// magnetometer's noise and iron a degree or more).
pub const STABLE: f64 = 2.0;
/// The largest degraded error, degrees: past it a third of gravity is taken for an acceleration (sin 20 deg = 0.34).
pub const FAILS: f64 = 20.0;
/// How long a filter has to come back after a disturbance, s: as long as VQF by its own default rejects a field at most,
/// and twenty times the slowest time constant by which these filters follow the accelerometer (3 s, VQF's).
pub const COME_BACK: f64 = 60.0;

/// A line of `filters-stability.csv`; the fields are its columns.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// Such as `vqf` or `vqf-6d`.
    pub filter: String,
    /// The case's name.
    pub case: &'static str,
    /// How it did.
    pub verdict: Verdict,
    /// The largest error that counts, degrees; 180 where an attitude is no number.
    pub figure_deg: f64,
    /// The gyro reading, counted from 1, after which the error is above [`FAILS`], the attitude is no number for good
    /// or the filter panics; none unless it fails.
    pub first_failing_step: Option<u64>,
}

/// How a filter did in a case.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// Never further off than [`STABLE`].
    Stable,
    /// Further off while it lasts, or until it is back within [`COME_BACK`].
    Degraded,
    /// The disturbance is over for [`COME_BACK`] and the error is still above [`STABLE`].
    NeverComesBack,
    /// Further off than [`FAILS`] in what lasts, no number for good, or a panic.
    Fails,
}

/// One thing that breaks filters.
#[derive(Debug)]
pub struct Case {
    /// As in the table.
    pub name: &'static str,
    /// What is done.
    pub about: &'static str,
    /// Whether it concerns the magnetometer alone: without it there is nothing to try.
    pub needs_mag: bool,
    trial: fn(Effort) -> Trial,
}

/// How much of it is done.
#[derive(Clone, Copy, Debug)]
pub struct Effort {
    /// How often the hundred seconds of the long case are repeated.
    pub rounds: u64,
}

impl Effort {
    /// A day.
    pub const FULL: Effort = Effort { rounds: 864 };
    /// Ten minutes.
    pub const QUICK: Effort = Effort { rounds: 6 };
}

/// Takes a trial's readings and says each attitude, as [`filters::run`] does.
pub type Estimator<'a> = &'a dyn Fn(&Trial, &mut dyn FnMut(SimTime, Attitude));

/// Every one of `subjects` through every case that concerns it, with `threads` threads.
pub fn run(subjects: &[Subject], effort: Effort, threads: usize, progress: Progress) -> Vec<Row> {
    let jobs: Vec<(&Case, &Subject)> = CASES
        .iter()
        .flat_map(|case| subjects.iter().map(move |subject| (case, subject)))
        .filter(|(case, subject)| subject.with_mag || !case.needs_mag)
        .collect();
    parallel::map(threads, jobs.len(), progress, |index| {
        let (case, subject) = jobs[index];
        let estimate = |trial: &Trial, each: &mut dyn FnMut(SimTime, Attitude)| subject.estimate(trial, each);
        case.row(&subject.name(), subject.with_mag, &estimate, effort)
    })
}

impl Subject {
    /// Runs it over a trial. A filter that finds its start by itself is shown the wrong one first: a second at rest.
    fn estimate(&self, trial: &Trial, each: &mut dyn FnMut(SimTime, Attitude)) {
        let options = Options { with_mag: self.with_mag, declination: 0.0, start: trial.start };
        let before = trial.start.filter(|_| !self.kind.takes_start);
        filters::run_as_read(self.kind, trial.streams(before), &options, each);
    }
}

impl Case {
    /// An estimator through this case; without `with_mag` its tilt alone counts. A panic is a failure.
    pub fn row(&self, name: &str, with_mag: bool, estimator: Estimator, effort: Effort) -> Row {
        let trial = (self.trial)(effort);
        let mut watch = Watch::new(&trial, with_mag);
        let ran = catch_unwind(AssertUnwindSafe(|| {
            estimator(&trial, &mut |t, attitude| watch.see(t, attitude));
        }));
        let (verdict, figure_deg, step) = watch.verdict(ran.is_err());
        Row { filter: name.to_string(), case: self.name, verdict, figure_deg, first_failing_step: step }
    }
}

#[cfg(test)]
mod tests;
