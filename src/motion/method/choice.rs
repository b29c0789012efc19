//! `method = "auto"`: the cheapest method and step that keep a reference within a tolerance in one scene.
//!
//! A method's error depends on the motion and the truth is available, so no formula estimates it: each candidate,
//! the cheapest first, runs over the whole scene until it leaves the tolerance. Most leave it early, so the search
//! costs about as much as one run of the result.

use super::{METHODS, MethodKind, integrated};
use crate::motion::Trajectory;
use crate::time::{Rate, SimTime};
use std::fmt;

/// A step lasts at most 2¹⁰ of the sensor's intervals …
const LONGEST: u32 = 10;
/// … and at least 2⁻⁴ of one: a sensor may be too slow for the motion, but its reference need not be.
const SHORTEST: u32 = 4;
/// Fewer steps than this show nothing about a method.
const FEWEST_STEPS: u64 = 8;
/// The most readings for a comparison of methods, about half a minute of work: 14 hours at 1 kHz.
const MOST_STEPS: u64 = 50_000_000;

/// The chosen method, and why.
#[derive(Clone, Copy, Debug)]
pub struct Choice {
    /// The method.
    pub method: &'static MethodKind,
    /// The samples it reads a second; a method with increments makes one step of several.
    pub rate: Rate,
    /// The largest angle to the truth at the ends of its steps, degrees.
    pub error_deg: f64,
    /// Nanoseconds for a second of the scene, by [`MethodKind::ns_per_step`].
    pub ns_per_simulated_s: f64,
    /// The most expensive of the cheaper candidates, which left the tolerance; `None` if the cheapest of all stayed
    /// within.
    pub missed: Option<Missed>,
}

impl fmt::Display for Choice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Choice { method, rate, error_deg, ns_per_simulated_s, missed } = self;
        write!(
            f,
            "{} at {rate} is at most {error_deg:.1e} deg off in this scene and takes {:.2} us per second of scene; ",
            method.name,
            ns_per_simulated_s * 1e-3
        )?;
        match missed {
            None => write!(f, "nothing is cheaper"),
            Some(Missed { method, rate, among: 1 }) => {
                write!(f, "the one that is cheaper, {} at {rate}, exceeds the tolerance", method.name)
            }
            Some(Missed { method, rate, among }) => {
                write!(
                    f,
                    "the {among} that are cheaper, up to {} at {rate}, exceed the tolerance",
                    method.name
                )
            }
        }
    }
}

/// A candidate that left the tolerance.
#[derive(Clone, Copy, Debug)]
pub struct Missed {
    /// The method.
    pub method: &'static MethodKind,
    /// The samples it reads a second.
    pub rate: Rate,
    /// How many candidates were cheaper than the chosen one.
    pub among: usize,
}

/// No method stays within the tolerance.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum ToleranceError {
    /// Every candidate left it.
    #[error(
        "no method at any rate up to {fastest} stays within {tolerance_deg} deg in this scene: raise the tolerance"
    )]
    Unmet {
        /// The requested tolerance, degrees.
        tolerance_deg: f64,
        /// The highest rate tried.
        fastest: Rate,
    },
    /// The scene is longer than the limit for a comparison.
    #[error(
        "choosing a method compares many over all of {end} at {rate}, {ticks} steps each, above the limit of {MOST_STEPS}: name a `method`, or shorten the scene"
    )]
    TooLong {
        /// The end of the scene.
        end: SimTime,
        /// The rate of the readings.
        rate: Rate,
        /// The readings.
        ticks: u64,
    },
    /// The scene ends before a method shows its error.
    #[error("no method makes {FEWEST_STEPS} steps in {end}: name a method, or lengthen the scene")]
    TooShort {
        /// The end of the scene.
        end: SimTime,
    },
}

/// The cheapest method and step whose attitude, starting from the truth at 0, stays within `tolerance_deg` of the
/// truth at the ends of its steps in `[0, end)`. Steps are from 2¹⁰ to 2⁻⁴ intervals of `rate`.
///
/// The same must hold with steps half as long: a step as long as an oscillation's period meets the truth by chance.
///
/// # Errors
/// No method qualifies, the scene is longer than the limit, or `end` comes before eight steps of any method.
pub fn choose(
    trajectory: &Trajectory,
    rate: Rate,
    end: SimTime,
    tolerance_deg: f64,
) -> Result<Choice, ToleranceError> {
    let ticks = rate.ticks_before(SimTime::ZERO, end);
    if ticks > MOST_STEPS {
        return Err(ToleranceError::TooLong { end, rate, ticks });
    }
    let candidates = candidates(rate, end);
    if candidates.is_empty() {
        return Err(ToleranceError::TooShort { end });
    }
    for (cheaper, candidate) in candidates.iter().enumerate() {
        let Candidate { method, rate, .. } = *candidate;
        let Some(error_deg) = error(trajectory, rate, end, method, tolerance_deg) else { continue };
        let half = rate.times(2, 1);
        if half.is_none_or(|half| error(trajectory, half, end, method, tolerance_deg).is_none()) {
            continue;
        }
        let missed = cheaper.checked_sub(1).map(|last| {
            let Candidate { method, rate, .. } = candidates[last];
            Missed { method, rate, among: cheaper }
        });
        let ns_per_simulated_s = candidate.ns_per_simulated_s();
        return Ok(Choice { method, rate, error_deg, ns_per_simulated_s, missed });
    }
    let fastest = rate.times(1 << SHORTEST, 1).unwrap_or(rate);
    Err(ToleranceError::Unmet { tolerance_deg, fastest })
}

/// A method at a rate.
#[derive(Clone, Copy, Debug)]
struct Candidate {
    method: &'static MethodKind,
    rate: Rate,
}

impl Candidate {
    fn ns_per_simulated_s(&self) -> f64 {
        f64::from(self.method.ns_per_step) * self.rate.as_hz() / self.method.input.samples() as f64
    }
}

/// Every method at every step that fits into the scene often enough, the cheapest first.
fn candidates(rate: Rate, end: SimTime) -> Vec<Candidate> {
    let coarse = (0..=LONGEST).map(|k| rate.times(1, 1 << k));
    let fine = (1..=SHORTEST).map(|k| rate.times(1 << k, 1));
    let mut candidates = Vec::new();
    for rate in coarse.chain(fine).flatten() {
        let ticks = rate.ticks_before(SimTime::ZERO, end);
        for method in METHODS {
            if ticks > FEWEST_STEPS * method.input.samples() as u64 {
                candidates.push(Candidate { method, rate });
            }
        }
    }
    candidates.sort_by(|a, b| a.ns_per_simulated_s().total_cmp(&b.ns_per_simulated_s()));
    candidates
}

/// The largest angle to the truth in degrees; `None` if it exceeds the tolerance or a step fails.
fn error(
    trajectory: &Trajectory,
    rate: Rate,
    end: SimTime,
    method: &'static MethodKind,
    tolerance_deg: f64,
) -> Option<f64> {
    let mut largest = 0f64;
    for step in integrated(trajectory, rate, end, method) {
        let step = step.ok()?;
        let error = step.attitude.angle_to(trajectory.at(step.t).attitude).to_degrees();
        // Written so that NaN fails too.
        let within = error <= tolerance_deg;
        if !within {
            return None;
        }
        largest = largest.max(error);
    }
    Some(largest)
}
