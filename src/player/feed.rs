//! What a sensor is given at its ticks: its error-free reading and, where its terms need it, more of the truth.

use super::sensed;
use crate::geometry::{Body, Vector};
use crate::motion::{Trajectory, Truth};
use crate::sensor::block::{self, Block, Column};
use crate::sensor::{Sampling, Sensor, SensorKind, SensorPlan, at_arm, delay, lever_arm};
use crate::time::SimTime;
use glam::DVec3;

/// Fills a sensor's blocks from the truth, in order of time.
#[derive(Debug)]
pub struct Feed {
    kind: SensorKind,
    sampling: Sampling,
    /// How long before its tick a sample is sensed.
    delay: SimTime,
    force: bool,
    arm: Option<DVec3>,
    /// The tick before, for the mean.
    last: Option<SimTime>,
}

impl Feed {
    /// For a plan's sensor, before its first tick.
    pub fn new(plan: &SensorPlan, sensor: &Sensor) -> Feed {
        let arm = lever_arm(&plan.values).filter(|_| sensor.needs(Column::LeverArm));
        let delay = if sensor.needs(Column::Late) { delay(&plan.values) } else { SimTime::ZERO };
        let force = sensor.needs(Column::Force);
        Feed { kind: plan.kind, sampling: plan.sampling, delay, force, arm, last: None }
    }

    /// Whether a sample follows from the truth at its tick alone, so that [`Feed::extend`] will do.
    pub(super) fn is_plain(&self) -> bool {
        self.sampling == Sampling::Point && self.delay == SimTime::ZERO && self.arm.is_none()
    }

    /// Adds samples that are the truth at their ticks.
    pub(super) fn extend<'t>(&self, truth: impl Iterator<Item = &'t Truth> + Clone, block: &mut Block) {
        block::extend(&mut block.truth, truth.clone().map(|truth| sensed(self.kind, truth)));
        if self.force {
            block::extend(&mut block.force, truth.map(|truth| truth.force));
        }
    }

    /// Adds the sample at `t`, at which this is the truth.
    pub fn push(&mut self, t: SimTime, truth: &Truth, path: &Trajectory, block: &mut Block) {
        let last = self.last.replace(t).filter(|_| self.sampling == Sampling::Average);
        let seen = last.map_or(*truth, |last| path.mean(last, t));
        block.push(sensed(self.kind, &seen).v.to_array());
        let earlier = |t: SimTime| (t - self.delay).max(SimTime::ZERO);
        let late = if self.delay == SimTime::ZERO {
            seen
        } else {
            let late = last.map_or_else(|| path.at(earlier(t)), |last| path.mean(earlier(last), earlier(t)));
            block::push(&mut block.late, sensed(self.kind, &late).v.to_array());
            late
        };
        if self.force {
            block::push(&mut block.force, late.force.v.to_array());
        }
        if let Some(arm) = self.arm {
            let felt = |t| at_arm(arm, path.kinematics(t).rate, path.angular_acceleration(t));
            let felt: Vector<Body> = match last {
                Some(last) => path.mean_of(earlier(last), earlier(t), felt),
                None => felt(earlier(t)),
            };
            block::push(&mut block.arm, felt.v.to_array());
        }
    }
}
