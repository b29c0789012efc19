//! The ways a case is run: along a path, beside an unharmed twin, over far more steps than there is time for, with
//! inputs that must be refused.

use super::super::accuracy::step_length;
use super::super::inputs::gather;
use super::super::motions::Path;
use super::{Limits, Outcome};
use crate::geometry::angle_between;
use crate::motion::method::{MethodKind, Quaternion, Real, Triple};
use glam::DQuat;
use std::collections::VecDeque;

/// No attitude came out of a step.
const NOTHING: f64 = f64::INFINITY;

/// Counts the worst figure and the first step past the limit.
struct Watch {
    limit: f64,
    worst: Outcome,
}

impl Watch {
    fn new(limits: &Limits) -> Watch {
        Watch { limit: limits.fails, worst: Outcome { figure: 0.0, failed_at: None } }
    }

    /// Takes the figure after `step` (from 1); a NaN is as bad as no figure at all.
    fn see(&mut self, step: u64, figure: f64) {
        let figure = if figure.is_nan() { NOTHING } else { figure };
        self.worst.figure = self.worst.figure.max(figure);
        if figure > self.limit {
            self.worst.failed_at.get_or_insert(step);
        }
    }
}

/// Degrees between two attitudes of any norm.
pub(super) fn error_deg(a: DQuat, b: DQuat) -> f64 {
    angle_between(a.normalize(), b.normalize()).to_degrees()
}

/// A motion sampled at `hz` for some steps.
#[derive(Clone, Copy)]
pub(super) struct Drive<'a> {
    pub path: &'a dyn Path,
    pub hz: f64,
    pub steps: u64,
    /// After how many steps the inputs are the same again, where that saves making them.
    pub repeats: Option<u64>,
}

/// Steps in one call where only the end counts.
pub(super) const DRIFT_STRIDE: u64 = 4096;

impl<'a> Drive<'a> {
    /// Every step's inputs made for it.
    pub fn new(path: &'a dyn Path, hz: f64, steps: u64) -> Drive<'a> {
        Drive { path, hz, steps, repeats: None }
    }

    /// Calls `see(step, t, q)` after every `stride` steps, which divide what repeats; or gives back the step that was
    /// refused.
    fn go<R: Real>(
        &self,
        method: &MethodKind,
        start: DQuat,
        stride: u64,
        mut see: impl FnMut(u64, f64, DQuat),
    ) -> Result<(), u64> {
        let h = step_length(method.input, self.hz);
        let mut q = Quaternion::<R>::from(start);
        let mut inputs = Vec::new();
        for first in (0..self.steps).step_by(stride as usize) {
            let steps = stride.min(self.steps - first);
            let from = match self.repeats {
                Some(period) if inputs.is_empty() => {
                    gather(self.path, method.input, self.hz, 0, period, &mut inputs);
                    0
                }
                Some(period) => first % period,
                None => {
                    gather(self.path, method.input, self.hz, first, steps, &mut inputs);
                    0
                }
            };
            let bounds = [from, from + steps].map(|step| step as usize * method.input.count());
            let read = &inputs[bounds[0]..bounds[1]];
            q = method.run(q, R::of(h), read).map_err(|refused| first + refused.step + 1)?;
            let step = (first + stride).min(self.steps);
            let samples = step * method.input.samples() as u64;
            see(step, samples as f64 / self.hz, DQuat::from(q));
        }
        Ok(())
    }

    /// The largest of `figure(truth, q)` after every `stride` steps.
    pub fn follow<R: Real>(
        &self,
        method: &MethodKind,
        limits: &Limits,
        stride: u64,
        figure: fn(DQuat, DQuat) -> f64,
    ) -> Outcome {
        let mut watch = Watch::new(limits);
        let path = self.path;
        let gone = self.go::<R>(method, path.attitude(0.0), stride, |step, t, q| {
            watch.see(step, figure(path.attitude(t), q));
        });
        if let Err(step) = gone {
            watch.see(step, NOTHING);
        }
        watch.worst
    }

    /// The largest of `figure(turn of the twin, turn)` after every `stride` steps: an unharmed `twin`, in double
    /// precision, goes beside this drive, each from its own start.
    pub fn beside<R: Real>(
        &self,
        twin: &Drive,
        method: &MethodKind,
        limits: &Limits,
        stride: u64,
        [start, of_twin]: [DQuat; 2],
        figure: fn(DQuat, DQuat) -> f64,
    ) -> Outcome {
        let mut watch = Watch::new(limits);
        let mut unharmed = VecDeque::with_capacity((self.steps / stride) as usize + 1);
        let gone = twin
            .go::<f64>(method, of_twin, stride, |_, _, q| unharmed.push_back(of_twin.conjugate() * q))
            .and_then(|()| {
                self.go::<R>(method, start, stride, |step, _, q| {
                    let figure =
                        unharmed.pop_front().map_or(NOTHING, |turn| figure(turn, start.conjugate() * q));
                    watch.see(step, figure);
                })
            });
        if let Err(step) = gone {
            watch.see(step, NOTHING);
        }
        watch.worst
    }

    /// ||q| − 1| after `target` steps, of which this drive makes its own number: the norm's logarithm grows by the
    /// same amount in all the rest. Steps past the limit are found in the same way.
    pub fn drift(&self, method: &MethodKind, limits: &Limits, target: u64) -> Outcome {
        let mut norm = 1.0;
        let gone = self.go::<f64>(method, DQuat::IDENTITY, DRIFT_STRIDE, |_, _, q| norm = q.length());
        if let Err(step) = gone {
            return Outcome { figure: NOTHING, failed_at: Some(step) };
        }
        let per_step = libm::log(norm) / self.steps as f64;
        let figure = libm::fabs(libm::expm1(per_step * target as f64));
        let failed_at = libm::ceil(libm::log1p(limits.fails) / libm::fabs(per_step)) as u64;
        Outcome { figure, failed_at: (figure > limits.fails).then_some(failed_at) }
    }
}

/// ||q| − 1|.
pub(super) fn norm_error(_: DQuat, q: DQuat) -> f64 {
    libm::fabs(q.length() - 1.0)
}

/// The error as a part of the turn since the identity.
pub(super) fn relative_error(truth: DQuat, q: DQuat) -> f64 {
    error_deg(truth, q) / error_deg(DQuat::IDENTITY, truth)
}

/// How many of these bad calls were not refused: each a start, a step, and what takes the place of one component
/// of the inputs' last.
pub(super) fn refusals(method: &MethodKind, calls: &[(DQuat, f64, f64)]) -> Outcome {
    let accepted = |&&(start, h, x): &&(DQuat, f64, f64)| {
        let mut inputs = vec![Triple { x: 0.1, y: -0.2, z: 0.3 }; method.input.count()];
        if let Some(last) = inputs.last_mut() {
            last.x = x;
        }
        method.run(Quaternion::<f64>::from(start), h, &inputs).is_ok()
    };
    let count = calls.iter().filter(accepted).count();
    Outcome { figure: count as f64, failed_at: (count > 0).then_some(1) }
}
