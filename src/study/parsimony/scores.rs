//! The attitude errors of the built-in filters on a scene's readings.

use super::variant::Variant;
use crate::filters;
use crate::geometry::{Attitude, AttitudeError};
use crate::parallel::{self, Progress};
use crate::scene::{Plan, SceneError};
use crate::sensor::SensorKind;
use crate::study::filters::play::{Played, play_by};
use crate::study::filters::{Subject, subjects};
use crate::time::{NANOS, SimTime};

/// Errors count from here on, or from a quarter of the scene on if that is sooner: a filter starts from the first noisy
/// readings.
const SETTLE: SimTime = SimTime(5 * NANOS);

/// Whether a filter reads this sensor, if one is meant.
pub fn reads(subject: &Subject, sensor: Option<SensorKind>) -> bool {
    let of = |kind| match kind {
        SensorKind::Mag => subject.with_mag,
        kind => kind == SensorKind::Gyro || kind == SensorKind::Accel,
    };
    sensor.is_none_or(of)
}

/// The error of its attitude, rad: in total, or of the inclination where nothing tells it north.
fn error(subject: &Subject, truth: Attitude, estimate: Attitude) -> f64 {
    let error = AttitudeError::between(truth, estimate);
    if subject.with_mag { error.total } else { error.inclination }
}

/// Every filter that the scene's sensors can feed: each needs gyroscope and accelerometer.
pub fn runs(plan: &Plan) -> Vec<Subject> {
    let has = |kind| plan.sensors.iter().any(|sensor| sensor.kind == kind);
    if !has(SensorKind::Gyro) || !has(SensorKind::Accel) {
        return Vec::new();
    }
    subjects().into_iter().filter(|subject| has(SensorKind::Mag) || !subject.with_mag).collect()
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
    pub runs: &'a [Subject],
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
        let Played { readings, truth, declination } = play_by(variant.player(&plan, self.end, &[]), &plan);
        let settled = SETTLE.min(SimTime(self.end.0 / 4));
        let rms = |run: &Subject| {
            let options = filters::Options { with_mag: run.with_mag, declination, start: None };
            let attitudes = filters::run(run.kind, &readings, &options);
            let settled = attitudes.iter().zip(&truth).filter(|((t, _), _)| *t >= settled);
            let errors: Vec<f64> =
                settled.map(|((_, estimate), (_, truth))| error(run, *truth, *estimate)).collect();
            let squares: f64 = errors.iter().map(|error| error * error).sum();
            libm::sqrt(squares / errors.len().max(1) as f64).to_degrees()
        };
        Ok(self.runs.iter().map(rms).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::exp;
    use glam::DVec3;

    #[test]
    fn a_turn_about_the_vertical_is_no_tilt_and_one_about_level_is_all_of_it() {
        let truth = Attitude::from_quat(exp(DVec3::new(0.3, -0.2, 1.0)));
        let without_mag = subjects().into_iter().find(|subject| !subject.with_mag).unwrap();
        for (turn, expected) in [(DVec3::Z * 0.7, 0.0), (DVec3::X * 0.01, 0.01), (DVec3::Y * 1.5, 1.5)] {
            let estimate = Attitude::from_quat(exp(turn) * truth.q);
            assert!((error(&without_mag, truth, estimate) - expected).abs() < 1e-12, "{turn}");
        }
    }
}
