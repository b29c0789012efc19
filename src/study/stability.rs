//! Where methods fail: each is put through what breaks methods, and its verdict is *stable*, *degraded* or *fails*.
//!
//! The limits of the verdicts are [`Limits`]'s constants and nowhere else. A method fails at the first step after
//! which its figure is above the limit, or at which it refuses what it was rightly given; refusing what nobody can
//! step through (no time, a NaN) is stable, going on with it fails.

mod cases;
mod trials;

pub use cases::CASES;

use crate::motion::method::{METHODS, MethodKind};
use crate::parallel::{self, Progress};
use serde::Serialize;

/// A line of `stability.csv`; the fields are its columns.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// The method's name.
    pub method: &'static str,
    /// The case's name.
    pub case: &'static str,
    /// How it did.
    pub verdict: Verdict,
    /// In the unit that the case's description names; infinite where no attitude came out.
    pub figure: f64,
    /// Counted from 1; none unless it fails.
    pub first_failing_step: Option<u64>,
}

/// How a method did in a case.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// As good as if nothing were the matter.
    Stable,
    /// Worse, and the figure says how much.
    Degraded,
    /// Not to be used so.
    Fails,
}

/// Up to `stable` a figure is stable, above `fails` it fails, between them it is degraded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// The largest stable figure.
    pub stable: f64,
    /// The largest degraded figure.
    pub fails: f64,
}

impl Limits {
    /// Attitude, degrees. 0.001 is what `method = "auto"` is asked for by default; past 1 an attitude reference
    /// judges nothing any more.
    pub const ANGLE: Limits = Limits { stable: 1e-3, fails: 1.0 };
    /// ||q| − 1|. A rotation matrix made from such a quaternion scales a vector by twice as much.
    pub const NORM: Limits = Limits { stable: 1e-6, fails: 1e-2 };
    /// An error as a part of the whole.
    pub const RELATIVE: Limits = Limits { stable: 1e-6, fails: 0.1 };
    /// Bad inputs that were not refused.
    pub const REFUSAL: Limits = Limits { stable: 0.0, fails: 0.0 };

    fn verdict(self, figure: f64) -> Verdict {
        match () {
            () if figure <= self.stable => Verdict::Stable,
            () if figure <= self.fails => Verdict::Degraded,
            () => Verdict::Fails,
        }
    }
}

/// One thing that breaks methods.
#[derive(Debug)]
pub struct Case {
    /// As in the table.
    pub name: &'static str,
    /// What is done, and what the figure is and in which unit.
    pub about: &'static str,
    /// What the figure is held against.
    pub limits: Limits,
    trial: fn(&MethodKind, &Limits, Effort) -> Outcome,
}

/// How much of it is done.
#[derive(Clone, Copy, Debug)]
pub struct Effort {
    /// The steps of norm drift that are made; the rest of the billion is extrapolated from them.
    pub drift_steps: u64,
    /// The seconds of the hour in single precision that are made.
    pub single_s: u64,
}

impl Effort {
    /// Ten million steps of drift, the whole hour.
    pub const FULL: Effort = Effort { drift_steps: 10_000_000, single_s: 3600 };
    /// A million steps of drift, the whole hour.
    pub const QUICK: Effort = Effort { drift_steps: 1_000_000, single_s: 3600 };
}

#[derive(Clone, Copy, Debug)]
struct Outcome {
    figure: f64,
    /// From 1.
    failed_at: Option<u64>,
}

/// Every method through every case, with `threads` threads.
pub fn run(effort: Effort, threads: usize, progress: Progress) -> Vec<Row> {
    let jobs: Vec<_> = CASES.iter().flat_map(|case| METHODS.map(|method| (method, case))).collect();
    parallel::map(threads, jobs.len(), progress, |index| {
        let (method, case) = jobs[index];
        case.row(method, effort)
    })
}

impl Case {
    /// One method through this case.
    pub fn row(&self, method: &MethodKind, effort: Effort) -> Row {
        let Outcome { figure, failed_at } = (self.trial)(method, &self.limits, effort);
        let verdict = self.limits.verdict(figure);
        let first_failing_step = failed_at.filter(|_| verdict == Verdict::Fails);
        Row { method: method.name, case: self.name, verdict, figure, first_failing_step }
    }
}

#[cfg(test)]
mod tests;
