//! The input of a sensor at its ticks: its error-free reading and, where its error terms need it, more of the
//! truth.

use super::sensed;
use crate::earth::Place;
use crate::geometry::{Attitude, Body, Nav, Vector};
use crate::motion::{Course, Track, Trajectory, Truth, TruthColumns, Wants};
use crate::random::Normals;
use crate::sensor::block::{self, Block, Column};
use crate::sensor::{
    Air, InAir, Sampling, Senses, Sensor, SensorKind, SensorPlan, at_arm, delay, jitter, lever_arm,
};
use crate::time::SimTime;
use glam::DVec3;

/// Fills a sensor's blocks from the truth, in time order.
#[derive(Debug)]
pub struct Feed {
    kind: SensorKind,
    sampling: Sampling,
    sensing: Sensing,
    force: bool,
    arm: Option<DVec3>,
    /// The previous tick and its sensing time, for the mean.
    last: Option<[SimTime; 2]>,
    /// For a sensor whose truth is a position.
    aid: Option<Box<Aid>>,
}

impl Feed {
    /// The feed of a plan's sensor, before its first tick. `origin` is where the scene begins, `seed` is the
    /// scene's.
    pub fn new(plan: &SensorPlan, origin: Place, seed: u64, sensor: &Sensor) -> Feed {
        let arm = lever_arm(&plan.values).filter(|_| sensor.needs(Column::LeverArm));
        let sensing = if sensor.needs(Column::Late) { Sensing::of(plan, seed) } else { Sensing::default() };
        let force = sensor.needs(Column::Force);
        let aid = Aid::new(plan, origin).map(Box::new);
        Feed { kind: plan.kind, sampling: plan.sampling, sensing, force, arm, last: None, aid }
    }

    /// Goes on as `next`, which is the same sensor set to something else.
    pub(super) fn set(&mut self, next: Feed) {
        let before = std::mem::replace(self, next);
        self.last = before.last;
        self.aid = before.aid;
    }

    /// Whether a sample depends only on the truth at its tick, so that [`Feed::extend`] is enough.
    pub(super) fn is_plain(&self) -> bool {
        let at_ticks = self.sampling == Sampling::Point && self.sensing.is_at_ticks();
        at_ticks && self.arm.is_none() && self.aid.is_none()
    }

    /// What [`Feed::extend`] or [`Feed::push`] reads of the truth.
    pub(super) fn wants(&self) -> Wants {
        if !self.is_plain() {
            return Wants::ALL;
        }
        let senses = &self.kind.row().senses;
        Wants {
            attitude: false,
            rate: matches!(senses, Senses::Rate),
            force: self.force || matches!(senses, Senses::Force),
            field: matches!(senses, Senses::Field),
        }
    }

    /// Adds samples that equal the truth at the ticks whose mask in `due` has the bit `mine`.
    pub(super) fn extend(&self, truth: &TruthColumns, due: &[u32], mine: u32, block: &mut Block) {
        let source = match self.kind.row().senses {
            Senses::Rate => &truth.rate,
            Senses::Force => &truth.force,
            Senses::Field => &truth.field,
            Senses::Course | Senses::Air(_) => return,
        };
        let all = due.iter().fold(mine, |all, due| all & due) == mine;
        let copy = |from: &[Vec<f64>; 3], to: &mut [Vec<f64>; 3]| {
            for (from, to) in from.iter().zip(to) {
                if all {
                    to.extend_from_slice(from);
                } else {
                    let mine = from.iter().zip(due).filter(|(_, due)| *due & mine != 0);
                    to.extend(mine.map(|(value, _)| value));
                }
            }
        };
        copy(source, &mut block.truth);
        if self.force {
            copy(&truth.force, &mut block.force);
        }
    }

    /// Adds the sample at `t`, where this is the truth.
    pub fn push(&mut self, t: SimTime, truth: &Truth, path: &Trajectory, block: &mut Block) {
        let at = self.sensing.time(t);
        if let Some(aid) = &mut self.aid {
            let now = (t, truth.attitude);
            return aid.push(now, (!self.sensing.is_at_ticks()).then_some(at), path, block);
        }
        let last = self.last.replace([t, at]).filter(|_| self.sampling == Sampling::Average);
        let seen = last.map_or(*truth, |[last, _]| path.mean(last, t));
        block.push(sensed(self.kind, &seen).v.to_array());
        let late = if self.sensing.is_at_ticks() {
            seen
        } else {
            let late = last.map_or_else(|| path.at(at), |[_, last]| path.mean(last, at));
            block::push(&mut block.late, sensed(self.kind, &late).v.to_array());
            late
        };
        if self.force {
            block::push(&mut block.force, late.force.v.to_array());
        }
        if let Some(arm) = self.arm {
            let felt = |t| at_arm(arm, path.kinematics(t).rate, path.angular_acceleration(t));
            let felt: Vector<Body> = match last {
                Some([_, last]) => path.mean_of(last, at, felt),
                None => felt(at),
            };
            block::push(&mut block.arm, felt.v.to_array());
        }
    }
}

/// A sensor that depends on the vehicle's position and velocity.
struct Aid {
    origin: Place,
    /// What it senses of the air; `None` for a receiver, which senses its own course.
    air: Option<Air>,
    /// At the ticks, and at the sensing times: each goes forward.
    now: Option<Track>,
    late: Option<Track>,
}

impl std::fmt::Debug for Aid {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Aid").field("origin", &self.origin).finish_non_exhaustive()
    }
}

impl Aid {
    /// `None` for a sensor that depends only on the truth of an instant.
    fn new(plan: &SensorPlan, origin: Place) -> Option<Aid> {
        let air = match plan.kind.row().senses {
            Senses::Rate | Senses::Force | Senses::Field => return None,
            Senses::Course => None,
            Senses::Air(air) => Some(air(&plan.values)),
        };
        Some(Aid { origin, air, now: None, late: None })
    }

    /// Adds the sample of a tick with the attitude then, and the truth at `late`, if it is sensed at another time.
    fn push(
        &mut self,
        (t, attitude): (SimTime, Attitude),
        late: Option<SimTime>,
        path: &Trajectory,
        block: &mut Block,
    ) {
        let now = self.now.get_or_insert_with(|| Track::new(path)).at(path, t);
        block.push(self.sensed(now, attitude, path.wind()));
        let late = late.map(|late| {
            let then = self.late.get_or_insert_with(|| Track::new(path)).at(path, late);
            block::push(&mut block.late, self.sensed(then, path.at(late).attitude, path.wind()));
            then
        });
        if self.air.is_none() {
            block::push(&mut block.true_velocity, now.velocity.v.to_array());
            block::push(&mut block.velocity, late.unwrap_or(now).velocity.v.to_array());
        }
    }

    /// The error-free reading.
    fn sensed(
        &self,
        Course { position, velocity }: Course,
        attitude: Attitude,
        wind: Vector<Nav>,
    ) -> [f64; 3] {
        let Some(air) = &self.air else { return position.v.to_array() };
        let altitude = self.origin.altitude - position.v.z;
        [air(&InAir { altitude, airspeed: velocity - wind, attitude }), 0.0, 0.0]
    }
}

/// The sensing times of samples, which a delay and a clock's jitter shift from their ticks.
#[derive(Debug, Default)]
struct Sensing {
    delay: SimTime,
    /// Standard deviation and bound of the jitter, ns, and its random source.
    jitter: Option<(f64, f64, Normals)>,
}

impl Sensing {
    fn of(plan: &SensorPlan, seed: u64) -> Sensing {
        let normals = plan.context(seed).normals("clock_error", DVec3::X);
        let (sigma, bound) = (jitter(&plan.values) * 1e9, 0.4e9 * plan.clock().period());
        Sensing { delay: delay(&plan.values), jitter: (sigma > 0.0).then_some((sigma, bound, normals)) }
    }

    fn is_at_ticks(&self) -> bool {
        self.delay == SimTime::ZERO && self.jitter.is_none()
    }

    /// The sensing time of the next tick's sample, at `t`; never before the start.
    fn time(&mut self, t: SimTime) -> SimTime {
        let off = self.jitter.as_mut().map_or(0, |(sigma, bound, normals)| {
            let [n, ..] = normals.draw();
            libm::round((*sigma * n).clamp(-*bound, *bound)) as i64
        });
        SimTime((t - self.delay).0.saturating_add(off)).max(SimTime::ZERO)
    }
}
