//! The error of a series of estimates.

use crate::geometry::{Attitude, AttitudeError, exp};
use crate::time::SimTime;
use glam::DVec3;

/// Root mean squares, degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Errors {
    /// Of the whole rotation.
    pub total: f64,
    /// Of the tilt.
    pub inclination: f64,
    /// Of the turn about the vertical.
    pub heading: f64,
}

/// The errors of `estimates` from the time `from` on; each stands beside its truth. Without a heading to go by
/// (`drifts`) heading counts from the one at `from`. `None` where an estimate is no number or none is so late.
pub fn judge(
    truth: &[(SimTime, Attitude)],
    estimates: &[(SimTime, Attitude)],
    from: SimTime,
    drifts: bool,
) -> Option<Errors> {
    let late = truth.iter().zip(estimates).filter(|((t, _), _)| *t >= from);
    let mut offset = None;
    let (mut squares, mut count) = ([0.0; 3], 0_u64);
    for ((_, truth), (_, estimate)) in late {
        if !estimate.q.is_finite() {
            return None;
        }
        let turn = *offset.get_or_insert_with(|| match drifts {
            true => exp(DVec3::Z * -AttitudeError::between(*truth, *estimate).heading),
            false => glam::DQuat::IDENTITY,
        });
        let error = AttitudeError::between(*truth, Attitude::from_quat(turn * estimate.q));
        for (sum, part) in squares.iter_mut().zip([error.total, error.inclination, error.heading]) {
            *sum += part * part;
        }
        count += 1;
    }
    let [total, inclination, heading] = squares.map(|sum| libm::sqrt(sum / count.max(1) as f64).to_degrees());
    (count > 0).then_some(Errors { total, inclination, heading })
}
