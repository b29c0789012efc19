//! The check that every estimator has to pass: its error against the truth stays within bounds.

use std::fmt;

use glam::DQuat;
use ratetable::geometry::Attitude;
use ratetable::scene::Plan;
use ratetable::score::AttitudeError;
use ratetable::time::SimTime;

/// The largest of something and its root mean square, deg.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deg {
    pub max: f64,
    pub rms: f64,
}

impl Deg {
    fn of(angles_rad: impl Iterator<Item = f64> + Clone) -> Self {
        let count = angles_rad.clone().count().max(1) as f64;
        let rms = (angles_rad.clone().map(|a| a * a).sum::<f64>() / count).sqrt();
        Self { max: angles_rad.map(f64::abs).fold(0.0, f64::max).to_degrees(), rms: rms.to_degrees() }
    }

    fn within(self, bound: Self) -> bool {
        self.max <= bound.max && self.rms <= bound.rms
    }
}

impl fmt::Display for Deg {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:.3} max, {:.3} rms", self.max, self.rms)
    }
}

/// Errors after settling, or the bounds of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Errors {
    /// The part that tilts.
    pub inclination: Deg,
    /// The part about the vertical.
    pub heading: Deg,
}

impl Errors {
    /// Of a board's history (µs; w, x, y, z) against the scene's truth at the same times, from `settled_s` on.
    ///
    /// `Err` unless there is an estimate for each of the scene's gyro ticks: one that says nothing has no error.
    pub fn of(history: &[(u64, [f64; 4])], plan: &Plan, settled_s: f64) -> Result<Self, String> {
        let gyro = &plan.sensors[0];
        let ticks = gyro.rate.ticks_before(gyro.phase, plan.duration);
        if history.len() as u64 != ticks {
            return Err(format!("{} estimates for {ticks} gyro readings", history.len()));
        }
        let settled = history.iter().filter(|(t_us, _)| *t_us as f64 * 1e-6 >= settled_s);
        let errors: Vec<AttitudeError> = settled
            .map(|&(t_us, [w, x, y, z])| {
                let truth = plan.trajectory.at(SimTime(t_us as i64 * 1000)).attitude;
                AttitudeError::between(truth, Attitude::from_quat(DQuat::from_xyzw(x, y, z, w)))
            })
            .collect();
        Ok(Self {
            inclination: Deg::of(errors.iter().map(|error| error.inclination)),
            heading: Deg::of(errors.iter().map(|error| error.heading)),
        })
    }

    /// Whether all are within `bound`, and if not, what they are.
    pub fn check(&self, bound: &Self) -> Result<(), String> {
        let fine = self.inclination.within(bound.inclination) && self.heading.within(bound.heading);
        if fine { Ok(()) } else { Err(format!("{self}; allowed: {bound}")) }
    }
}

impl fmt::Display for Errors {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "inclination {}, heading {} deg", self.inclination, self.heading)
    }
}
