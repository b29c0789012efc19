//! The attitude errors of the built-in filters on a scene's readings.

use super::variant::Variant;
use crate::filters::{self, FILTERS, FilterKind, Readings, SIX};
use crate::geometry::{Attitude, Nav, Vector};
use crate::parallel::{self, Progress};
use crate::scene::{Plan, SceneError};
use crate::sensor::{Measurement, SensorKind};
use crate::time::{NANOS, SimTime};
use std::convert::Infallible;

/// Errors count from here on, or from a quarter of the scene on if that is sooner: a filter starts from the first noisy
/// readings.
const SETTLE: SimTime = SimTime(5 * NANOS);

/// A filter, with the magnetometer or without.
#[derive(Clone, Copy)]
pub struct Run {
    kind: &'static FilterKind,
    with_mag: bool,
}

impl Run {
    /// As users call it: `vqf`, `vqf-6d`.
    pub fn name(&self) -> String {
        format!("{}{}", self.kind.name, if self.with_mag { "" } else { SIX })
    }

    /// Whether it reads this sensor, if one is meant.
    pub fn reads(&self, sensor: Option<SensorKind>) -> bool {
        let of = |kind| match kind {
            SensorKind::Mag => self.with_mag,
            kind => kind == SensorKind::Gyro || kind == SensorKind::Accel,
        };
        sensor.is_none_or(of)
    }

    /// The errors of its attitudes, rad: in total, or of the inclination where nothing tells it north.
    fn error(&self, truth: Attitude, estimate: Attitude) -> f64 {
        if self.with_mag { truth.angle_to(estimate) } else { tilt(truth, estimate) }
    }
}

/// Between the directions in the body that two attitudes take for down, rad.
fn tilt(truth: Attitude, estimate: Attitude) -> f64 {
    let down = |attitude: Attitude| attitude.inverse().apply(Vector::<Nav>::new(0.0, 0.0, 1.0)).v;
    let (a, b) = (down(truth), down(estimate));
    libm::atan2(a.cross(b).length(), a.dot(b))
}

/// Every filter that the scene's sensors can feed: each needs gyroscope and accelerometer.
pub fn runs(plan: &Plan) -> Vec<Run> {
    let has = |kind| plan.sensors.iter().any(|sensor| sensor.kind == kind);
    if !has(SensorKind::Gyro) || !has(SensorKind::Accel) {
        return Vec::new();
    }
    let ways: &[bool] = if has(SensorKind::Mag) { &[true, false] } else { &[false] };
    let of = |with_mag: &bool| FILTERS.map(|kind| Run { kind, with_mag: *with_mag });
    ways.iter().flat_map(of).collect()
}

/// RMS attitude errors, degrees.
#[derive(Clone, Debug, Default)]
pub struct Scores(Vec<Vec<f64>>);

impl Scores {
    /// Of a run, a number a seed.
    pub fn of(&self, run: usize) -> Vec<f64> {
        self.0.iter().map(|of_seed| of_seed[run]).collect()
    }
}

/// What the filters are run on.
pub struct Trials<'a> {
    /// The filters.
    pub runs: &'a [Run],
    /// Seeds, as what is added to the scene's own.
    pub seeds: std::ops::Range<u64>,
    /// How long it is played.
    pub end: SimTime,
    /// On how many threads.
    pub threads: usize,
}

impl Trials<'_> {
    /// The scores of each variant, at every seed.
    ///
    /// # Errors
    /// A variant that is no scene.
    pub fn of(&self, variants: &[&Variant], progress: Progress) -> Result<Vec<Scores>, SceneError> {
        let seeds: Vec<u64> = self.seeds.clone().collect();
        let count = variants.len() * seeds.len();
        let errors = parallel::map(self.threads, count, progress, |job| {
            self.errors(variants[job / seeds.len()], seeds[job % seeds.len()])
        });
        let errors = errors.into_iter().collect::<Result<Vec<_>, _>>()?;
        Ok(errors.chunks(seeds.len().max(1)).map(|of| Scores(of.to_vec())).collect())
    }

    /// The error of each filter on one run of a scene.
    fn errors(&self, variant: &Variant, seed: u64) -> Result<Vec<f64>, SceneError> {
        let plan = variant.plan(seed)?;
        let (readings, truth) = played(variant, &plan, self.end);
        let field = plan.trajectory.field().v;
        let declination = libm::atan2(field.y, field.x);
        let settled = SETTLE.min(SimTime(self.end.0 / 4));
        let error = |run: &Run| {
            let attitudes = filters::run(
                run.kind,
                &readings,
                &filters::Options { with_mag: run.with_mag, declination, start: None },
            );
            let settled = attitudes.iter().zip(&truth).filter(|((t, _), _)| *t >= settled);
            let errors: Vec<f64> =
                settled.map(|((_, estimate), truth)| run.error(*truth, *estimate)).collect();
            let squares: f64 = errors.iter().map(|error| error * error).sum();
            libm::sqrt(squares / errors.len().max(1) as f64).to_degrees()
        };
        Ok(self.runs.iter().map(error).collect())
    }
}

/// What the filters read, and the true attitude at each reading of the gyro.
fn played(variant: &Variant, plan: &Plan, end: SimTime) -> (Readings, Vec<Attitude>) {
    let (mut readings, mut truth) = (Readings::default(), Vec::new());
    let each = variant.player(plan, end, &[]).play(|moment| {
        for reading in moment.readings {
            let Measurement::Triad(triad) = reading.measurement else { continue };
            let column = match reading.kind {
                SensorKind::Gyro => &mut readings.gyro,
                SensorKind::Accel => &mut readings.accel,
                SensorKind::Mag => &mut readings.mag,
                _ => continue,
            };
            column.push((moment.t, triad.value));
            if reading.kind == SensorKind::Gyro {
                truth.push(moment.truth.attitude);
            }
        }
        Ok::<(), Infallible>(())
    });
    each.unwrap_or_else(|never| match never {});
    (readings, truth)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::exp;
    use glam::DVec3;

    #[test]
    fn a_turn_about_the_vertical_is_no_tilt_and_one_about_level_is_all_of_it() {
        let truth = Attitude::from_quat(exp(DVec3::new(0.3, -0.2, 1.0)));
        for (turn, expected) in [(DVec3::Z * 0.7, 0.0), (DVec3::X * 0.01, 0.01), (DVec3::Y * 1.5, 1.5)] {
            let estimate = Attitude::from_quat(exp(turn) * truth.q);
            assert!((tilt(truth, estimate) - expected).abs() < 1e-12, "{turn}");
        }
    }
}
