//! Ways to make normal numbers: what each costs, and how far its distribution is from the normal one.
//!
//! Each makes 64 numbers at a time from the words of the same generators, in plain Rust that the compiler widens, so
//! that every processor gives the same bits. Four figures tell how good a way is. `error_sigma` is the largest
//! difference between a number and the exact transform of the same random bits. `ks` is the Kolmogorov-Smirnov
//! distance of many draws from the normal distribution, at 65 536 places; by chance alone it is below `ks_by_chance`
//! in 95 of 100 runs (1.358/√n). `tail_z` is the largest error of the counts beyond 3, 4, 5 and 6 σ in their standard
//! errors, and `variance_z` that of the variance.
//!
//! ```
//! use ratetable::study::normals::{Effort, run};
//! use std::time::Duration;
//!
//! let rows = run(Effort { draws: 64_000 }, 1, &|| Duration::ZERO, &|_, _| ());
//! let standard = rows.iter().find(|row| row.is_default).ok_or("no default")?;
//! assert!(standard.error_sigma.is_some_and(|error| error < 1e-9));
//! # Ok::<(), &str>(())
//! ```

mod histogram;
mod inverse;
mod makers;
mod pairs;
mod ways;
mod ziggurat;

pub(crate) use histogram::Histogram;

use crate::parallel::{self, Progress};
use makers::CHUNK;
use serde::Serialize;
use std::hint::black_box;
use std::time::Duration;
use ways::{WAYS, Way};

/// A line of `normals.csv`; the fields are its columns.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// The way's name.
    pub method: &'static str,
    /// Whether every scene uses it.
    pub is_default: bool,
    /// Nanoseconds a number, its random bits included.
    pub ns_per_number: f64,
    /// The largest difference from the exact transform of the same bits, σ; none for a way that rejects, which has no
    /// such transform and whose numbers are exact to their rounding.
    pub error_sigma: Option<f64>,
    /// Numbers drawn.
    pub draws: u64,
    /// The largest difference of the distribution function from the normal one.
    pub ks: f64,
    /// Below this it is in 95 of 100 runs by chance alone.
    pub ks_by_chance: f64,
    /// The worst count beyond 3, 4, 5 and 6 σ on either side, in standard errors of such a count.
    pub tail_z: f64,
    /// The error of the variance in its standard errors.
    pub variance_z: f64,
}

/// How much is drawn.
#[derive(Clone, Copy, Debug)]
pub struct Effort {
    /// Numbers of each way.
    pub draws: u64,
}

impl Effort {
    /// A thousand million: as many as a sensor of 1 kHz makes in twelve days.
    pub const FULL: Effort = Effort { draws: 1_000_000_000 };
    /// A fiftieth.
    pub const QUICK: Effort = Effort { draws: 20_000_000 };
}

/// Parts that draws are made in: each from a seed of its own.
const PARTS: u64 = 16;

/// Every way, with `threads` threads; `now` is a clock that never goes back. Costs are measured afterwards, one by one.
pub fn run(effort: Effort, threads: usize, now: &dyn Fn() -> Duration, progress: Progress) -> Vec<Row> {
    let jobs: Vec<(&Way, u64)> =
        WAYS.iter().flat_map(|way| (0..PARTS).map(move |part| (way, part))).collect();
    let drawn = parallel::map(threads, jobs.len(), progress, |job| {
        let (way, part) = jobs[job];
        draw(way, part, effort.draws / PARTS)
    });
    let histograms = drawn.chunks(PARTS as usize).map(|parts| {
        parts.iter().fold(Histogram::default(), |mut all, part| {
            all.add(part);
            all
        })
    });
    WAYS.iter().zip(histograms).map(|(way, histogram)| row(way, &histogram, cost(way, now))).collect()
}

fn draw(way: &Way, seed: u64, draws: u64) -> Histogram {
    let (mut maker, mut numbers) = ((way.make)(seed), [0.0; CHUNK]);
    let mut histogram = Histogram::default();
    for _ in 0..draws.div_ceil(CHUNK as u64) {
        maker.fill(&mut numbers);
        histogram.count(&numbers);
    }
    histogram
}

fn row(way: &Way, histogram: &Histogram, ns_per_number: f64) -> Row {
    Row {
        method: way.name,
        is_default: way.is_default,
        ns_per_number,
        error_sigma: way.error.map(|error| error()),
        draws: histogram.draws(),
        ks: histogram.ks(),
        ks_by_chance: 1.358 / libm::sqrt(histogram.draws() as f64),
        tail_z: histogram.tail_z(),
        variance_z: histogram.variance_z(),
    }
}

/// Nanoseconds a number: the least of many short batches, because whatever else runs only ever adds.
fn cost(way: &Way, now: &dyn Fn() -> Duration) -> f64 {
    const BATCH: u32 = 1000;
    let (mut maker, mut numbers) = ((way.make)(1), [0.0; CHUNK]);
    let mut batch = || {
        let start = now();
        for _ in 0..BATCH {
            maker.fill(&mut numbers);
            black_box(&numbers);
        }
        now().saturating_sub(start)
    };
    let least = (0..200).map(|_| batch()).min().unwrap_or_default();
    least.as_nanos() as f64 / f64::from(BATCH) / CHUNK as f64
}

#[cfg(test)]
mod tests;
