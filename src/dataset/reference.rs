//! `reference.csv`: attitude as a method computes it from error-free readings, and how far that is from the truth.

use super::error::DatasetError;
use crate::motion::method::{ReferenceError, Step, from_accel_mag, integrated};
use crate::scene::{Plan, Reference};
use crate::time::SimTime;
use serde::Serialize;

/// How a reference was computed and how good it came out.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Quality {
    /// `gyro` or `accel-mag`.
    pub from: &'static str,
    /// The method's name.
    pub method: &'static str,
    /// The samples it reads a second.
    pub rate_hz: f64,
    /// Why, where method and rate were chosen for the scene.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub chosen: Option<String>,
    /// Angles from the exact truth.
    pub error_deg: Errors,
    /// |q| − 1 of the method's own state at the last row; the rows are of unit norm.
    pub norm_error: f64,
}

/// Angles from the exact truth over all rows, degrees.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Errors {
    /// Root of the mean square.
    pub rms: f64,
    /// The largest.
    pub max: f64,
    /// That of the last row.
    #[serde(rename = "final")]
    pub last: f64,
}

/// The plan's reference with nothing left open, and why it is that, where it was chosen.
pub(super) fn settled(plan: &Plan, end: SimTime) -> Result<Option<Settled>, DatasetError> {
    let settle = |reference: Reference| reference.settled(&plan.trajectory, end);
    let settled = plan.reference.map(settle).transpose().map_err(DatasetError::Tolerance)?;
    Ok(settled.map(|(reference, choice)| Settled { reference, chosen: choice.map(|it| it.to_string()) }))
}

/// What is computed.
pub(super) struct Settled {
    pub reference: Reference,
    chosen: Option<String>,
}

/// Gives every attitude of the reference before `end` to `row`; nothing without a reference.
pub(super) fn write(
    plan: &Plan,
    settled: Option<&Settled>,
    end: SimTime,
    mut row: impl FnMut(&Step) -> Result<(), DatasetError>,
) -> Result<Option<Quality>, DatasetError> {
    let Some(Settled { reference, chosen }) = settled else { return Ok(None) };
    let mut tally = Tally::default();
    for step in steps(plan, *reference, end) {
        let step = step.map_err(DatasetError::Reference)?;
        tally.see(&step, step.attitude.angle_to(plan.trajectory.at(step.t).attitude).to_degrees());
        row(&step)?;
    }
    Ok(Some(Quality {
        from: reference.from(),
        method: reference.method(),
        rate_hz: reference.rate().as_hz(),
        chosen: chosen.clone(),
        error_deg: tally.errors(),
        norm_error: tally.norm_error,
    }))
}

type Steps<'a> = Box<dyn Iterator<Item = Result<Step, ReferenceError>> + 'a>;

fn steps(plan: &Plan, reference: Reference, end: SimTime) -> Steps<'_> {
    match reference {
        Reference::Gyro { method, rate } => Box::new(integrated(&plan.trajectory, rate, end, method)),
        Reference::Auto { .. } => unreachable!("it has been settled"),
        Reference::AccelMag { rate } => Box::new(from_accel_mag(&plan.trajectory, rate, end)),
    }
}

#[derive(Default)]
struct Tally {
    rows: u64,
    squares: f64,
    max: f64,
    last: f64,
    norm_error: f64,
}

impl Tally {
    fn see(&mut self, step: &Step, error_deg: f64) {
        self.rows += 1;
        self.squares += error_deg * error_deg;
        self.max = self.max.max(error_deg);
        self.last = error_deg;
        self.norm_error = step.norm - 1.0;
    }

    fn errors(&self) -> Errors {
        let rms = libm::sqrt(self.squares / self.rows.max(1) as f64);
        Errors { rms, max: self.max, last: self.last }
    }
}
