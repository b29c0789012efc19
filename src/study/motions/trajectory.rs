//! A scene's own motion.

use super::Path;
use crate::motion::Trajectory;
use crate::time::{NANOS, SimTime};
use glam::{DQuat, DVec3};

/// A trajectory, asked at the nearest nanosecond.
#[derive(Clone, Copy, Debug)]
pub struct OfTrajectory<'a>(pub &'a Trajectory);

fn nearest(t: f64) -> SimTime {
    SimTime(libm::round(t * NANOS as f64) as i64)
}

impl Path for OfTrajectory<'_> {
    fn attitude(&self, t: f64) -> DQuat {
        self.0.at(nearest(t)).attitude.q
    }

    fn rate(&self, t: f64) -> DVec3 {
        self.0.at(nearest(t)).rate.v
    }

    fn increment(&self, from: f64, to: f64) -> DVec3 {
        let (from, to) = (nearest(from), nearest(to));
        self.0.mean(from, to).rate.v * (to - from).seconds()
    }
}
