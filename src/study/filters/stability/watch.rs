//! Sees every attitude of a trial and judges at the end.

use super::{COME_BACK, FAILS, STABLE, Trial, Verdict};
use crate::geometry::{Attitude, AttitudeError};
use crate::time::SimTime;

/// An attitude that is no number is as wrong as one can be, degrees.
const NOWHERE: f64 = 180.0;

/// What is remembered of the attitudes so far.
pub(super) struct Watch<'a> {
    trial: &'a Trial,
    with_mag: bool,
    latest: SimTime,
    step: u64,
    /// The largest error that counts, degrees.
    worst: f64,
    /// The largest once it should be back.
    late: f64,
    /// The first step past [`FAILS`].
    past: Option<u64>,
    /// The first of the latest steps without a number.
    lost: Option<u64>,
}

impl<'a> Watch<'a> {
    pub fn new(trial: &'a Trial, with_mag: bool) -> Watch<'a> {
        let latest = SimTime(i64::MIN);
        Watch { trial, with_mag, latest, step: 0, worst: 0.0, late: 0.0, past: None, lost: None }
    }

    /// The attitude after a reading of the gyro; after one that comes late it is still that of the latest.
    pub fn see(&mut self, t: SimTime, attitude: Attitude) {
        self.latest = self.latest.max(t);
        let seconds = self.latest.seconds();
        if seconds < 0.0 {
            return;
        }
        self.step += 1;
        let is_number = attitude.q.is_finite();
        self.lost = if is_number { None } else { self.lost.or(Some(self.step)) };
        let error = if is_number { self.error(seconds, attitude) } else { NOWHERE };
        if seconds < self.trial.from {
            return;
        }
        self.worst = self.worst.max(error);
        if error > FAILS {
            self.past.get_or_insert(self.step);
        }
        if self.trial.over.is_some_and(|over| seconds > over + COME_BACK) {
            self.late = self.late.max(error);
        }
    }

    fn error(&self, seconds: f64, attitude: Attitude) -> f64 {
        let error = AttitudeError::between((self.trial.truth)(seconds), attitude);
        if self.with_mag { error.total.to_degrees() } else { error.inclination.to_degrees() }
    }

    /// The verdict, its figure and the step of a failure.
    pub fn verdict(&self, panicked: bool) -> (Verdict, f64, Option<u64>) {
        let lost = if panicked || self.step == 0 { Some(self.step + 1) } else { self.lost };
        match (lost, self.trial.over) {
            (Some(step), _) => (Verdict::Fails, NOWHERE, Some(step)),
            _ if self.worst <= STABLE => (Verdict::Stable, self.worst, None),
            (_, Some(_)) if self.late > STABLE => (Verdict::NeverComesBack, self.late, None),
            (_, None) if self.worst > FAILS => (Verdict::Fails, self.worst, self.past),
            _ => (Verdict::Degraded, self.worst, None),
        }
    }
}
