//! What a sensor meets in a scene: the truth at its own ticks, from which sizes of effects follow.
//!
//! No random number is drawn and nothing that plays is touched.

use crate::earth::STANDARD_GRAVITY;
use crate::geometry::{Body, Nav, Vector};
use crate::motion::{Trajectory, Truth};
use crate::player::sensed;
use crate::scene::Plan;
use crate::sensor::{Sampling, SensorKind, SensorPlan};
use crate::time::SimTime;
use glam::DVec3;

/// About how many ticks of a sensor are looked at: a scene with more is looked at evenly, and at every seam.
pub const TICKS: u64 = 20_000;

/// How many ticks of a sensor are looked at: fewer where the vehicle turns by many radians from one to the next, for
/// then a mean over that time takes as many steps.
pub(super) fn most(plan: &Plan, sensor: &SensorPlan) -> u64 {
    let steps = (plan.trajectory.fastest() * sensor.rate.period()).max(1.0);
    ((TICKS as f64 / steps) as u64).clamp(50, TICKS)
}

/// One tick that is looked at.
#[derive(Clone, Copy, Debug)]
pub struct Look {
    /// When.
    pub t: SimTime,
    /// The tick before, from which on an average is taken; none at the first tick.
    pub last: Option<SimTime>,
    /// The truth at `t`.
    pub truth: Truth,
}

/// A sensor in its scene.
#[derive(Debug)]
pub struct Survey<'a> {
    /// The scene.
    pub plan: &'a Plan,
    /// The sensor.
    pub sensor: &'a SensorPlan,
    /// The names of the error terms that it uses.
    pub terms: Vec<&'static str>,
    /// How many ticks it has in the scene.
    pub ticks: u64,
    /// The times at which a segment or a force begins or ends, in order.
    edges: Vec<SimTime>,
    /// The ticks looked at, in order of time.
    pub looks: Vec<Look>,
}

impl<'a> Survey<'a> {
    /// Looks at the sensor's ticks in the scene.
    pub fn new(plan: &'a Plan, sensor: &'a SensorPlan) -> Survey<'a> {
        let before = |end| sensor.ticks_before(end);
        let ticks = before(plan.duration);
        let most = most(plan, sensor);
        let mut chosen: Vec<u64> = (0..ticks).step_by(ticks.div_ceil(most).max(1) as usize).collect();
        // The last tick before a seam, and the first at or after it.
        let mut edges: Vec<_> = plan.trajectory.edges().collect();
        edges.sort_unstable();
        // A recorded log has a seam at each of its rows.
        let thin = edges.len().div_ceil(most as usize).max(1);
        let edges: Vec<_> = edges.into_iter().step_by(thin).collect();
        let seams = edges.iter().copied().chain([plan.duration]).map(before);
        chosen.extend(seams.flat_map(|k| [k.saturating_sub(1), k]).filter(|&k| k < ticks));
        chosen.sort_unstable();
        chosen.dedup();
        let due = |k| sensor.tick(k);
        let looks = chosen.into_iter().map(|k| {
            let last = k.checked_sub(1).map(due);
            Look { t: due(k), last, truth: plan.trajectory.at(due(k)) }
        });
        let looks = looks.collect();
        let terms = plan.build(sensor).terms().to_vec();
        Survey { plan, sensor, terms, ticks, edges, looks }
    }

    /// The same scene as another sensor of the same ticks would meet it.
    pub fn met_by<'b>(&self, sensor: &'b SensorPlan) -> Survey<'b>
    where
        'a: 'b,
    {
        let terms = self.plan.build(sensor).terms().to_vec();
        Survey {
            plan: self.plan,
            sensor,
            terms,
            ticks: self.ticks,
            edges: self.edges.clone(),
            looks: self.looks.clone(),
        }
    }

    /// What is true.
    pub fn trajectory(&self) -> &'a Trajectory {
        &self.plan.trajectory
    }

    /// Whether it is a sensor of this kind.
    pub fn is(&self, kind: SensorKind) -> bool {
        self.sensor.kind == kind
    }

    /// The first time after `t` at which a segment or a force begins or ends.
    pub fn edge_after(&self, t: SimTime) -> Option<SimTime> {
        self.edges.get(self.edges.partition_point(|&edge| edge <= t)).copied()
    }

    /// Seconds from the first tick to the last.
    pub fn span(&self) -> f64 {
        self.ticks.saturating_sub(1) as f64 * self.sensor.rate.period()
    }

    /// The error-free reading at the tick and the mean over the interval that ends there, in the sensor's unit.
    pub fn point_and_mean(&self, look: &Look) -> (DVec3, DVec3) {
        let kind = self.sensor.kind;
        let mean = look.last.map_or(look.truth, |last| self.trajectory().mean(last, look.t));
        (sensed(kind, &look.truth).v, sensed(kind, &mean).v)
    }

    /// The error-free reading, sampled as the sensor samples.
    pub fn error_free(&self, look: &Look) -> Vector<Body> {
        match (self.sensor.sampling, look.last) {
            (Sampling::Average, Some(_)) => Vector::from_vec(self.point_and_mean(look).1),
            _ => sensed(self.sensor.kind, &look.truth),
        }
    }

    /// The largest magnitude that something has at any tick looked at, each body axis by itself.
    pub fn largest(&self, what: impl FnMut(&Look) -> DVec3) -> DVec3 {
        self.looks.iter().map(what).fold(DVec3::ZERO, |most, v| most.max(v.abs()))
    }

    /// The largest components that a vector fixed in nav has on the body's axes.
    pub fn largest_of_nav(&self, v: Vector<Nav>) -> DVec3 {
        self.largest(|look| look.truth.attitude.inverse().apply(v).v)
    }

    /// A unit vector along gravity; straight down where the scene has none.
    pub fn down(&self) -> Vector<Nav> {
        let gravity = self.trajectory().gravity();
        match gravity.length() {
            g if g > 1e-9 * STANDARD_GRAVITY => gravity * (1.0 / g),
            _ => Vector::new(0.0, 0.0, 1.0),
        }
    }
}
