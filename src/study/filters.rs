//! Every built-in filter on every scene: how accurate at which rate, and at what cost.
//!
//! A filter runs over a scene's readings as `score` would run it, at each rate of the gyro and for several seeds. Its
//! error is the root mean square over the scene from [`START_UP`] on, against the exact attitude when the gyro was
//! read. A filter without the magnetometer (`-6d`) has no north: its heading counts from where it is at [`START_UP`],
//! so that only its drift is left. Errors are found on all threads at once, costs afterwards one by one.
//!
//! [`stability`] tries what breaks filters.
//!
//! ```
//! use ratetable::study::filters::{Effort, run, scenes, subjects};
//! use std::time::Instant;
//!
//! let mut scenes = scenes::built_in(true)?;
//! scenes.truncate(1);
//! scenes[0].rates = vec![100];
//! let start = Instant::now();
//! let effort = Effort { seeds: 1, threads: 1 };
//! let rows = run(&scenes, &subjects()[..2], effort, &|| start.elapsed(), &|_, _| ())?;
//! assert_eq!((rows.len(), rows[0].filter.as_str()), (2, "vqf"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod cost;
mod judge;
pub(super) mod play;
pub mod scenes;
pub mod stability;

use crate::filters::{self, FILTERS, FilterKind, Options, SIX};
use crate::parallel::{self, Progress};
use crate::scene::SceneError;
use crate::time::SimTime;
use cost::Clip;
use judge::{Errors, judge};
use play::play;
use scenes::Scene;
use serde::Serialize;
use std::time::Duration;

/// Errors count from here on: every scene holds still until then.
pub const START_UP: SimTime = SimTime(5_000_000_000);

/// A line of `filters.csv`; the fields are its columns.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// Such as `vqf` or `vqf-6d`.
    pub filter: String,
    /// The scene's name.
    pub scene: String,
    /// Gyro readings a second.
    pub rate_hz: u32,
    /// Root mean square of the attitude error, degrees, the mean over the seeds; none where an attitude is no number.
    pub error_deg: Option<f64>,
    /// Of the tilt alone.
    pub inclination_deg: Option<f64>,
    /// Of the turn about the vertical alone; of its drift without a magnetometer.
    pub heading_deg: Option<f64>,
    /// Standard deviation of `error_deg` over the seeds; none of a single one.
    pub spread_deg: Option<f64>,
    /// Nanoseconds for a gyro reading and those of the other sensors that fall to it.
    pub ns_per_update: f64,
    /// Nanoseconds that a second of the scene takes.
    pub ns_per_simulated_s: f64,
}

/// How much of it is done.
#[derive(Clone, Copy, Debug)]
pub struct Effort {
    /// Runs of each scene, each with its own noise.
    pub seeds: u64,
    /// Threads that find the errors.
    pub threads: usize,
}

/// A filter with or without the magnetometer.
#[derive(Clone, Copy)]
pub struct Subject {
    /// The filter.
    pub kind: &'static FilterKind,
    /// Whether it gets the magnetometer's readings.
    pub with_mag: bool,
}

impl Subject {
    /// As users write it: `vqf-6d`.
    pub fn name(&self) -> String {
        format!("{}{}", self.kind.name, if self.with_mag { "" } else { SIX })
    }
}

/// Every filter with the magnetometer, then every filter without.
pub fn subjects() -> Vec<Subject> {
    [true, false].into_iter().flat_map(|with_mag| FILTERS.map(|kind| Subject { kind, with_mag })).collect()
}

/// Every one of `subjects` on every scene at every rate; `now` is a clock that never goes back. A scene without a magnetometer
/// has the `-6d` filters alone. `progress` counts the runs of scenes.
///
/// # Errors
/// A scene that refuses one of its rates.
pub fn run(
    scenes: &[Scene],
    subjects: &[Subject],
    effort: Effort,
    now: &dyn Fn() -> Duration,
    progress: Progress,
) -> Result<Vec<Row>, SceneError> {
    let mut jobs = Vec::new();
    for scene in scenes {
        for &rate_hz in &scene.rates {
            jobs.extend((0..effort.seeds).map(|seed| Job { scene, subjects, rate_hz, seed }));
        }
    }
    // The longest first, so that no thread is left with one at the end.
    let mut order: Vec<usize> = (0..jobs.len()).collect();
    order.sort_by_key(|&index| std::cmp::Reverse(jobs[index].samples()));
    let found = parallel::map(effort.threads, order.len(), progress, |turn| jobs[order[turn]].run());
    let mut results: Vec<Option<Ran>> = (0..jobs.len()).map(|_| None).collect();
    for (index, ran) in order.into_iter().zip(found) {
        results[index] = Some(ran?);
    }
    let mut rows = Vec::new();
    for (jobs, ran) in jobs.chunks(effort.seeds as usize).zip(results.chunks(effort.seeds as usize)) {
        let ran: Vec<&Ran> = ran.iter().flatten().collect();
        rows.extend(jobs.first().map(|job| job.rows(&ran, now)).unwrap_or_default());
    }
    Ok(rows)
}

/// One run of a scene at a rate.
struct Job<'a> {
    scene: &'a Scene,
    subjects: &'a [Subject],
    rate_hz: u32,
    seed: u64,
}

/// What the filters made of it.
struct Ran {
    /// Of each of the job's subjects.
    errors: Vec<Option<Errors>>,
    /// Of the first seed: with and without the magnetometer.
    clips: Option<[Clip; 2]>,
}

impl Job<'_> {
    fn samples(&self) -> u64 {
        (self.scene.seconds() * f64::from(self.rate_hz)) as u64
    }

    fn subjects(&self) -> impl Iterator<Item = &Subject> {
        self.subjects.iter().filter(|subject| self.scene.has_mag() || !subject.with_mag)
    }

    fn run(&self) -> Result<Ran, SceneError> {
        let played = play(&self.scene.plan(self.rate_hz, self.seed)?);
        let error = |subject: &Subject| {
            let options =
                Options { with_mag: subject.with_mag, declination: played.declination, start: None };
            let estimates = filters::run(subject.kind, &played.readings, &options);
            judge(&played.truth, &estimates, START_UP, !subject.with_mag)
        };
        let clip = |with_mag| Clip::new(&played.readings, with_mag, self.rate_hz);
        Ok(Ran {
            errors: self.subjects().map(error).collect(),
            clips: (self.seed == 0).then(|| [clip(true), clip(false)]),
        })
    }

    fn rows(&self, ran: &[&Ran], now: &dyn Fn() -> Duration) -> Vec<Row> {
        let clips = ran.iter().find_map(|ran| ran.clips.as_ref());
        let row = |(i, subject): (usize, &Subject)| {
            let errors: Option<Vec<Errors>> = ran.iter().map(|ran| ran.errors[i]).collect();
            let mean = |of: fn(&Errors) -> f64| errors.as_ref().map(|errors| mean(errors, of));
            let clip = clips.map(|[with, without]| if subject.with_mag { with } else { without });
            let ns = clip.map_or(f64::NAN, |clip| clip.ns_per_update(subject.kind, now));
            Row {
                filter: subject.name(),
                scene: self.scene.name.clone(),
                rate_hz: self.rate_hz,
                error_deg: mean(|errors| errors.total),
                inclination_deg: mean(|errors| errors.inclination),
                heading_deg: mean(|errors| errors.heading),
                spread_deg: errors.as_deref().and_then(spread),
                ns_per_update: ns,
                ns_per_simulated_s: ns * f64::from(self.rate_hz),
            }
        };
        self.subjects().enumerate().map(row).collect()
    }
}

fn mean(errors: &[Errors], of: fn(&Errors) -> f64) -> f64 {
    errors.iter().map(of).sum::<f64>() / errors.len().max(1) as f64
}

/// The standard deviation of the total errors.
fn spread(errors: &[Errors]) -> Option<f64> {
    let mean = mean(errors, |errors| errors.total);
    let squares: f64 = errors.iter().map(|errors| (errors.total - mean) * (errors.total - mean)).sum();
    (errors.len() > 1).then(|| libm::sqrt(squares / (errors.len() - 1) as f64))
}

#[cfg(test)]
mod tests;
