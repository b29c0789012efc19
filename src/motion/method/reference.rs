//! The reference attitude as the paper computes it: from error-free readings, by a named method.
//!
//! It stands beside the exact truth, it never replaces it.

use super::{Degenerate, Input, METHODS, MethodKind, Quaternion, Refused, Triple, ecompass, find};
use crate::geometry::Attitude;
use crate::motion::Trajectory;
use crate::time::{Rate, SimTime};
use glam::DQuat;

/// Why there is no reference.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ReferenceError {
    /// No such method.
    #[error("no method `{name}`; the methods are {}", METHODS.map(|method| method.name).join(", "))]
    UnknownMethod {
        /// As asked for.
        name: String,
    },
    /// The method did not make a step.
    #[error("`{method}` at {t}: {refused}")]
    Refused {
        /// Which method.
        method: &'static str,
        /// When the step began.
        t: SimTime,
        /// Why.
        #[source]
        refused: Refused,
    },
    /// Accelerometer and magnetometer give no attitude.
    #[error("at {t}: {why}")]
    Degenerate {
        /// When.
        t: SimTime,
        /// Why.
        #[source]
        why: Degenerate,
    },
}

/// One attitude of a reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// When.
    pub t: SimTime,
    /// Of unit norm, its sign continuous in time.
    pub attitude: Attitude,
    /// The norm of the method's own state, which `attitude` is made from.
    pub norm: f64,
}

/// The attitude at the ticks of `rate` in `[0, end)`, integrated from the true gyroscope by `method`, from the true
/// attitude at 0 on; each is computed when it is asked for, and it stops at the first that is refused.
///
/// A method of rates is given the truth at the times it asks for, to the nanosecond; one of increments the true
/// means times their intervals, and it has an attitude only at the ends of its steps, every few ticks. At a seam of the
/// trajectory a sample is that of the segment which begins, as a gyroscope's is. The method's own state is kept as
/// it leaves it.
pub fn integrated(
    trajectory: &Trajectory,
    rate: Rate,
    end: SimTime,
    method: &'static MethodKind,
) -> impl Iterator<Item = Result<Step, ReferenceError>> {
    let samples = method.input.samples() as u64;
    let ticks = rate.ticks_before(SimTime::ZERO, end);
    let mut q = Quaternion::<f64>::from(trajectory.at(SimTime::ZERO).attitude.q);
    let mut inputs = Vec::with_capacity(method.input.count());
    let mut sign = Sign::default();
    (0..ticks).step_by(samples as usize).map(move |tick| {
        let t = rate.tick(tick);
        if let Some(before) = tick.checked_sub(samples) {
            let from = rate.tick(before);
            gather(trajectory, rate, before, method, &mut inputs);
            let refuse = |refused| ReferenceError::Refused { method: method.name, t: from, refused };
            q = method.run(q, (t - from).seconds(), &inputs).map_err(refuse)?;
        }
        let norm = DQuat::from(q).length();
        Ok(Step { t, attitude: sign.kept(DQuat::from(q.normalised())), norm })
    })
}

/// The attitudes of [`integrated`] by the method called `method`, together.
pub fn reference(
    trajectory: &Trajectory,
    rate: Rate,
    end: SimTime,
    method: &str,
) -> Result<Vec<(SimTime, Attitude)>, ReferenceError> {
    let method = find(method).ok_or_else(|| ReferenceError::UnknownMethod { name: method.to_string() })?;
    integrated(trajectory, rate, end, method).map(|step| step.map(|step| (step.t, step.attitude))).collect()
}

/// The inputs of the step that starts at `tick`.
fn gather(path: &Trajectory, rate: Rate, tick: u64, method: &MethodKind, inputs: &mut Vec<Triple<f64>>) {
    inputs.clear();
    match method.input {
        Input::Rate(fractions) => {
            let (from, to) = (rate.tick(tick), rate.tick(tick + 1));
            let at = |c: f64| from + SimTime(libm::round(c * (to - from).0 as f64) as i64);
            inputs.extend(fractions.iter().map(|&c| Triple::from(path.at(at(c)).rate.v)));
        }
        Input::Increments(count) => inputs.extend((tick..tick + count as u64).map(|k| {
            let (from, to) = (rate.tick(k), rate.tick(k + 1));
            Triple::from(path.mean(from, to).rate.v * (to - from).seconds())
        })),
    }
}

/// The attitude at the ticks of `rate` in `[0, end)` from the true accelerometer and magnetometer: [`ecompass`] on
/// gravity's reaction and the field, without forces and without the acceleration of the motion itself.
///
/// Where gravity or field vanish or lie along each other there is none, and the error says which.
pub fn from_accel_mag(
    trajectory: &Trajectory,
    rate: Rate,
    end: SimTime,
) -> impl Iterator<Item = Result<Step, ReferenceError>> {
    let (up, north) = (-trajectory.gravity(), trajectory.field());
    let mut sign = Sign::default();
    (0..rate.ticks_before(SimTime::ZERO, end)).map(move |tick| {
        let t = rate.tick(tick);
        let truth = trajectory.at(t);
        let attitude = ecompass(truth.attitude.inverse().apply(up), truth.field, up, north)
            .map_err(|why| ReferenceError::Degenerate { t, why })?;
        Ok(Step { t, attitude: sign.kept(attitude.q), norm: 1.0 })
    })
}

/// Keeps a quaternion's sign continuous.
#[derive(Default)]
struct Sign(Option<DQuat>);

impl Sign {
    /// `q` with the sign nearer to the last.
    fn kept(&mut self, q: DQuat) -> Attitude {
        let turned = self.0.is_some_and(|last| last.dot(q) < 0.0);
        let q = if turned { -q } else { q };
        self.0 = Some(q);
        Attitude::from_quat(q)
    }
}
