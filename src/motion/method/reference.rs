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

/// The attitude at the ticks of `rate` in `[0, end)`, integrated from the true gyroscope by the method called
/// `method`, from the true attitude at 0 on.
///
/// A method of rates is given the truth at the times it asks for, to the nanosecond; one of increments the true
/// means times their intervals, and it has an attitude only at the ends of its steps, every few ticks. At a seam of the
/// trajectory a sample is that of the segment which begins, as a gyroscope's is. What is given back is of unit
/// norm; the method's own state is kept as it leaves it. Its sign is continuous in time.
pub fn reference(
    trajectory: &Trajectory,
    rate: Rate,
    end: SimTime,
    method: &str,
) -> Result<Vec<(SimTime, Attitude)>, ReferenceError> {
    let method = find(method).ok_or_else(|| ReferenceError::UnknownMethod { name: method.to_string() })?;
    let samples = method.input.samples() as u64;
    let ticks = rate.ticks_before(SimTime::ZERO, end);
    let start = trajectory.at(SimTime::ZERO).attitude.q;
    let mut series = Vec::with_capacity((ticks / samples) as usize + 1);
    let mut q = Quaternion::<f64>::from(start);
    let mut inputs = Vec::with_capacity(method.input.count());
    for tick in (0..ticks).step_by(samples as usize) {
        push(&mut series, rate.tick(tick), DQuat::from(q.normalised()));
        if tick + samples < ticks {
            let (from, to) = (rate.tick(tick), rate.tick(tick + samples));
            gather(trajectory, rate, tick, method, &mut inputs);
            q = method.run(q, (to - from).seconds(), &inputs).map_err(|refused| ReferenceError::Refused {
                method: method.name,
                t: from,
                refused,
            })?;
        }
    }
    Ok(series)
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
/// Its sign is continuous in time. Where gravity or field vanish or lie along each other there is none, and the
/// error says which.
pub fn from_accel_mag(
    trajectory: &Trajectory,
    rate: Rate,
    end: SimTime,
) -> Result<Vec<(SimTime, Attitude)>, ReferenceError> {
    let (up, north) = (-trajectory.gravity(), trajectory.field());
    let ticks = rate.ticks_before(SimTime::ZERO, end);
    let mut series = Vec::with_capacity(ticks as usize);
    for t in (0..ticks).map(|tick| rate.tick(tick)) {
        let truth = trajectory.at(t);
        let attitude = ecompass(truth.attitude.inverse().apply(up), truth.field, up, north)
            .map_err(|why| ReferenceError::Degenerate { t, why })?;
        push(&mut series, t, attitude.q);
    }
    Ok(series)
}

/// Adds `q` with the sign nearer to the last.
fn push(series: &mut Vec<(SimTime, Attitude)>, t: SimTime, q: DQuat) {
    let turned = series.last().is_some_and(|(_, last)| last.q.dot(q) < 0.0);
    series.push((t, Attitude::from_quat(if turned { -q } else { q })));
}
