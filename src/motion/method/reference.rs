//! The reference attitude as the paper computes it: from error-free readings, by a named method.
//!
//! It supplements the exact truth and never replaces it.

use super::{Degenerate, Input, METHODS, MethodKind, Quaternion, Refused, Triple, ecompass, find};
use crate::geometry::Attitude;
use crate::motion::Trajectory;
use crate::time::{Rate, SimTime};
use glam::DQuat;

/// Why there is no reference.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ReferenceError {
    /// There is no such method.
    #[error("no method `{name}`; the methods are {}", METHODS.map(|method| method.name).join(", "))]
    UnknownMethod {
        /// The requested name.
        name: String,
    },
    /// The method failed at a step.
    #[error("`{method}` at {t}: {refused}")]
    Refused {
        /// The method.
        method: &'static str,
        /// The start of the step.
        t: SimTime,
        /// The reason.
        #[source]
        refused: Refused,
    },
    /// Accelerometer and magnetometer give no attitude.
    #[error("at {t}: {why}")]
    Degenerate {
        /// The time.
        t: SimTime,
        /// The reason.
        #[source]
        why: Degenerate,
    },
}

/// One attitude of a reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// The time.
    pub t: SimTime,
    /// Of unit norm; its sign is continuous in time.
    pub attitude: Attitude,
    /// The norm of the method's own state, before `attitude` is made from it.
    pub norm: f64,
}

/// The attitude at the ticks of `rate` in `[0, end)`, integrated by `method` from the true gyroscope, starting with
/// the true attitude at 0. It is lazy, and ends at the first failed step.
///
/// A method with rates reads the truth at the times it needs, to the nanosecond. One with increments reads the true
/// means times their intervals, and has an attitude only at the ends of its steps, every few ticks. At a seam of
/// the trajectory a sample belongs to the segment that begins, as with a gyroscope. The method's own state is not
/// modified between steps.
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

/// The attitudes of [`integrated`] by the method named `method`, collected.
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
/// Where gravity or field vanish or are parallel there is no attitude, and the error says which.
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
    /// `q` with the sign closer to the previous one.
    fn kept(&mut self, q: DQuat) -> Attitude {
        let turned = self.0.is_some_and(|last| last.dot(q) < 0.0);
        let q = if turned { -q } else { q };
        self.0 = Some(q);
        Attitude::from_quat(q)
    }
}
