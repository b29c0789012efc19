//! How far each method ends from the truth, and what each step of it costs.
//!
//! A method is run over a motion at a rate from t = 0 to the motion's end, or to the last whole step before it where a
//! step of several increments does not divide the time. `error_deg` is the angle from the truth at that time, after
//! renormalising; `norm_error` is |q| − 1 before. Errors are found on all threads at once, costs afterwards one by
//! one on a machine left alone: the least of several batches, each long enough for the clock.

use super::inputs::gather;
use super::motions::{Case, Path};
use crate::geometry::angle_between;
use crate::motion::method::{Input, METHODS, MethodKind, Precision, Quaternion, Real};
use crate::parallel::{self, Progress};
use glam::DQuat;
use serde::Serialize;
use std::hint::black_box;
use std::time::Duration;

/// A line of `accuracy.csv`; the fields are its columns.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// The method's name.
    pub method: &'static str,
    /// The motion's name.
    pub motion: String,
    /// Samples or increments a second.
    pub rate_hz: u32,
    /// `f64` or `f32`.
    pub precision: &'static str,
    /// The angle from the truth at the end, degrees; none where the method left the range of numbers.
    pub error_deg: Option<f64>,
    /// |q| − 1 at the end, before renormalising.
    pub norm_error: Option<f64>,
    /// Nanoseconds a step takes, checks included; a step may be several samples long.
    pub ns_per_step: f64,
    /// Nanoseconds that a second of motion takes.
    pub ns_per_simulated_s: f64,
}

/// Every method in every precision on every case at every rate, with `threads` threads; `now` is a clock that never
/// goes back. A method whose step is longer than the case has no line there. `progress` counts the runs for the errors.
pub fn run(cases: &[Case], threads: usize, now: &dyn Fn() -> Duration, progress: Progress) -> Vec<Row> {
    let jobs = jobs(cases);
    // The longest first, so that no thread is left with one at the end.
    let mut order: Vec<usize> = (0..jobs.len()).collect();
    order.sort_by_key(|&index| std::cmp::Reverse(jobs[index].samples()));
    let ends = parallel::map(threads, order.len(), progress, |turn| (order[turn], jobs[order[turn]].end()));
    let mut found = vec![None; jobs.len()];
    for (index, end) in ends {
        found[index] = end;
    }
    jobs.iter().zip(found).map(|(job, end)| job.row(end, job.cost(now))).collect()
}

fn jobs<'a>(cases: &'a [Case<'a>]) -> Vec<Job<'a>> {
    let mut jobs = Vec::new();
    for case in cases {
        for &rate_hz in &case.rates {
            for method in METHODS {
                for &precision in method.precisions {
                    let job = Job { case, rate_hz, method, precision };
                    if job.steps() > 0 {
                        jobs.push(job);
                    }
                }
            }
        }
    }
    jobs
}

struct Job<'a> {
    case: &'a Case<'a>,
    rate_hz: u32,
    method: &'static MethodKind,
    precision: Precision,
}

impl Job<'_> {
    /// How many samples the motion has.
    fn samples(&self) -> u64 {
        // A billionth absorbs the rounding of a duration that is a whole number of samples.
        (self.case.duration * f64::from(self.rate_hz) * (1.0 + 1e-12) + 1e-9) as u64
    }

    fn steps(&self) -> u64 {
        self.samples() / self.method.input.samples() as u64
    }

    fn end(&self) -> Option<End> {
        let hz = f64::from(self.rate_hz);
        match self.precision {
            Precision::Double => integrate::<f64>(self.method, &*self.case.path, hz, self.steps()),
            Precision::Single => integrate::<f32>(self.method, &*self.case.path, hz, self.steps()),
        }
    }

    fn cost(&self, now: &dyn Fn() -> Duration) -> f64 {
        let hz = f64::from(self.rate_hz);
        match self.precision {
            Precision::Double => cost::<f64>(self.method, &*self.case.path, hz, now),
            Precision::Single => cost::<f32>(self.method, &*self.case.path, hz, now),
        }
    }

    fn row(&self, end: Option<End>, ns_per_step: f64) -> Row {
        Row {
            method: self.method.name,
            motion: self.case.name.clone(),
            rate_hz: self.rate_hz,
            precision: self.precision.name(),
            error_deg: end.map(|end| end.error_deg),
            norm_error: end.map(|end| end.norm_error),
            ns_per_step,
            ns_per_simulated_s: ns_per_step * f64::from(self.rate_hz) / self.method.input.samples() as f64,
        }
    }
}

/// Where a method ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct End {
    /// Degrees from the truth, after renormalising.
    pub error_deg: f64,
    /// |q| − 1 before.
    pub norm_error: f64,
}

/// Runs `method` over `steps` steps of `path`, sampled at `hz`; `None` where it leaves the range of numbers.
pub fn integrate<R: Real>(method: &MethodKind, path: &dyn Path, hz: f64, steps: u64) -> Option<End> {
    const BLOCK: u64 = 256;
    let samples = method.input.samples() as u64;
    let h = R::of(step_length(method.input, hz));
    let mut q = Quaternion::<R>::from(path.attitude(0.0));
    let mut inputs = Vec::new();
    for first in (0..steps).step_by(BLOCK as usize) {
        gather(path, method.input, hz, first, BLOCK.min(steps - first), &mut inputs);
        q = method.run(q, h, &inputs).ok()?;
    }
    let q = DQuat::from(q);
    let truth = path.attitude((steps * samples) as f64 / hz);
    Some(End { error_deg: angle_between(truth, q.normalize()).to_degrees(), norm_error: q.length() - 1.0 })
}

/// The length of a step in seconds.
pub(super) fn step_length(input: Input, hz: f64) -> f64 {
    input.samples() as f64 / hz
}

/// Nanoseconds a step of `method` takes on samples of `path`: the least of seven batches of at least 0.2 ms.
///
/// The least, because whatever else runs on the machine only ever adds.
fn cost<R: Real>(method: &MethodKind, path: &dyn Path, hz: f64, now: &dyn Fn() -> Duration) -> f64 {
    const STEPS: u64 = 128;
    const BATCH: Duration = Duration::from_micros(200);
    let h = R::of(step_length(method.input, hz));
    let q = Quaternion::<R>::from(path.attitude(0.0));
    let mut inputs = Vec::new();
    gather(path, method.input, hz, 0, STEPS, &mut inputs);
    let time = |rounds: u32| {
        let start = now();
        for _ in 0..rounds {
            // A method that refuses is no cheaper: its steps up to there were made.
            let _ = black_box(method.run(black_box(q), black_box(h), black_box(&inputs)));
        }
        now().saturating_sub(start)
    };
    let mut rounds = 1;
    while time(rounds) < BATCH && rounds < 1 << 20 {
        rounds *= 2;
    }
    let best = (0..7).map(|_| time(rounds)).min().unwrap_or_default();
    best.as_nanos() as f64 / (f64::from(rounds) * STEPS as f64)
}

#[cfg(test)]
mod tests;
