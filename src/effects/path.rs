//! Effects of what the vehicle does: what pushes it, where it goes, how its motion is sampled.

use super::survey::Look;
use super::{EffectKind, Found, Judge, Survey};
use crate::sensor::{Sampling, SensorKind, at_arm, lever_arm};
use glam::DVec3;

/// The scene's external forces: the largest sum of them at any tick.
pub(super) static FORCE: EffectKind = EffectKind {
    name: "force",
    judge: Judge::Both,
    find: |survey| {
        let forces = survey.trajectory().forces();
        if !survey.is(SensorKind::Accel) || forces.is_empty() {
            return None;
        }
        let at = |t| survey.trajectory().external(t).v;
        let mut size = survey.largest(|look| at(look.t));
        // A mean feels also what acts between two ticks.
        if survey.sensor.sampling == Sampling::Average {
            let starts = forces.iter().map(|force| force.start).filter(|&t| t < survey.plan.duration);
            size = starts.map(at).fold(size, |most, v| most.max(v.abs()));
        }
        Some(Found::modelled(size, "largest").by("force"))
    },
};

/// The acceleration of a vehicle that goes somewhere: V·dψ/dt towards the inside of a turn.
pub(super) static PATH_ACCELERATION: EffectKind = EffectKind {
    name: "path_acceleration",
    judge: Judge::Both,
    find: |survey| {
        let size = survey.is(SensorKind::Accel).then(|| {
            survey.largest(|look| {
                let now = survey.trajectory().kinematics(look.t);
                now.attitude.inverse().apply(now.acceleration).v
            })
        })?;
        (size != DVec3::ZERO).then(|| Found::modelled(size, "largest").by("motion"))
    },
};

/// Averaging: how far the mean over the interval that ends at a tick is from the value at the tick, while the motion
/// goes on without a seam.
pub(super) static AVERAGING: EffectKind = EffectKind {
    name: "averaging",
    judge: Judge::Both,
    find: |survey| Some(averaging(survey, false, "largest")),
};

/// Averaging over a seam: a sample at which the motion or a force begins or ends, such as a jump of the angular rate.
pub(super) static AVERAGING_OVER_SEAMS: EffectKind = EffectKind {
    name: "averaging_over_seams",
    judge: Judge::Both,
    find: |survey| {
        let found = averaging(survey, true, "largest, in one sample a seam");
        (found.size != DVec3::ZERO).then_some(found)
    },
};

fn averaging(survey: &Survey<'_>, over_seams: bool, statistic: &'static str) -> Found {
    let size = survey.largest(|look| {
        let (point, mean) = survey.point_and_mean(look);
        // The mean of what stands still differs by the rounding of its sum.
        let differs = (mean - point).length() > 1e-14 * point.length();
        let has_seam =
            look.last.is_some_and(|last| survey.edge_after(last).is_some_and(|edge| edge <= look.t));
        if differs && has_seam == over_seams { mean - point } else { DVec3::ZERO }
    });
    let modelled = survey.sensor.sampling == Sampling::Average;
    Found { modelled, ..Found::left_out(size, statistic) }.by(format!("{}.sampling", survey.sensor.kind))
}

/// Lever arm: an accelerometer at `r` from the point that moves feels `dw/dt × r + w × (w × r)` more (Titterton and
/// Weston, *Strapdown Inertial Navigation Technology*, 2nd ed., sec. 2.4). Without one in the scene, for 1 cm in the
/// worst direction; a jump of the angular rate, whose derivative has no bound, is left out.
pub(super) static LEVER_ARM: EffectKind = EffectKind {
    name: "lever_arm",
    judge: Judge::Both,
    find: |survey| {
        if !survey.is(SensorKind::Accel) {
            return None;
        }
        let felt = |look: &Look, arm| {
            at_arm(arm, look.truth.rate, survey.trajectory().angular_acceleration(look.t)).v
        };
        if let Some(arm) = lever_arm(&survey.sensor.values) {
            let size = survey.largest(|look| felt(look, arm));
            return Some(Found::modelled(size, "largest").by("accel.lever_arm"));
        }
        let size = survey.largest(|look| {
            let squares = DVec3::AXES.map(|r| felt(look, r)).iter().fold(DVec3::ZERO, |sum, v| sum + v * v);
            ARM * DVec3::from_array(squares.to_array().map(libm::sqrt))
        });
        let found = Found::left_out(size, "largest, for each cm").by("accel.lever_arm");
        Some(found.noting("if the accelerometer is off the motion's reference point"))
    },
};

/// m.
const ARM: f64 = 0.01;
