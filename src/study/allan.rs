//! Allan deviation of a scene's sensors, beside what their error terms should give.
//!
//! `σ²(τ) = ½·⟨(ȳ_{k+1} − ȳ_k)²⟩` of the error (reading less the error-free reading) averaged over neighbouring
//! intervals of length τ, for τ of 1, 2, 4 … samples (D. W. Allan, *Statistics of atomic frequency standards*, Proc. IEEE
//! 54, 1966). Averages are made from those of half the length, so that a sensor of any rate takes a few numbers of memory
//! however long it is watched. Of n differences of neighbours the deviation has a standard error of about `σ/√(2n)`.

use crate::motion::Wants;
use crate::player::{BLOCK, Player};
use crate::scene::Plan;
use crate::sensor::{BIAS_INSTABILITY, CORRELATION_TIME, is_flicker};
use crate::sensor::{SensorKind, SensorPlan, bias_step, lsb, white_noise};
use crate::time::{NANOS, SimTime};
use serde::Serialize;

/// Fewer differences than this say little.
const FEWEST: u64 = 9;

/// One point of one axis: a line of `allan.csv`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Point {
    /// `gyro`, `accel`, `mag`.
    pub sensor: &'static str,
    /// `x`, `y`, `z`.
    pub axis: &'static str,
    /// Averaging time, s.
    pub tau_s: f64,
    /// Allan deviation in the reading's unit (rad/s, m/s², µT).
    pub deviation: f64,
    /// That of white noise, counts, bias walk and Gauss-Markov bias together, by their closed forms.
    pub theory: f64,
    /// Differences of neighbouring averages.
    pub differences: u64,
}

/// How long a scene is watched if it ends before, s.
#[derive(Clone, Copy, Debug)]
pub struct Effort(i64);

impl Effort {
    /// An hour.
    pub const FULL: Effort = Effort(3600);
    /// A minute.
    pub const QUICK: Effort = Effort(60);
}

/// Watches every sensor of the scene; after its motions the vehicle holds.
pub fn run(plan: &Plan, effort: Effort) -> Vec<Point> {
    let end = plan.duration.max(SimTime(effort.0 * NANOS));
    let mut watched: Vec<[Octaves; 3]> = plan.sensors.iter().map(|_| Default::default()).collect();
    let mut player = Player::new(plan, end, BLOCK);
    while let Some(columns) = player.play_columns(Wants::NONE) {
        for (octaves, block) in watched.iter_mut().zip(columns.sensors()) {
            for (axis, octaves) in octaves.iter_mut().enumerate() {
                let pairs = block.reading[axis].iter().zip(&block.truth[axis]);
                pairs.for_each(|(reading, truth)| octaves.add(reading - truth));
            }
        }
    }
    let mut points = Vec::new();
    for (sensor, octaves) in plan.sensors.iter().zip(&watched) {
        for (axis, octaves) in octaves.iter().enumerate().take(sensor.kind.axes().len()) {
            points.extend(octaves.points(plan, sensor, axis));
        }
    }
    points
}

/// Averages over 1, 2, 4 … values, and the squares of the differences of neighbours.
#[derive(Clone, Debug, Default)]
struct Octaves(Vec<Octave>);

#[derive(Clone, Copy, Debug, Default)]
struct Octave {
    /// The first of a pair whose second is still to come.
    half: Option<f64>,
    last: Option<f64>,
    squares: f64,
    differences: u64,
}

impl Octaves {
    fn add(&mut self, value: f64) {
        let mut average = value;
        for level in 0.. {
            if level == self.0.len() {
                self.0.push(Octave::default());
            }
            let octave = &mut self.0[level];
            if let Some(last) = octave.last.replace(average) {
                octave.squares += (average - last) * (average - last);
                octave.differences += 1;
            }
            match octave.half.take() {
                Some(first) => average = 0.5 * (first + average),
                None => {
                    octave.half = Some(average);
                    return;
                }
            }
        }
    }

    fn points<'a>(
        &'a self,
        plan: &'a Plan,
        sensor: &'a SensorPlan,
        axis: usize,
    ) -> impl Iterator<Item = Point> + 'a {
        let enough = self.0.iter().enumerate().take_while(|(_, octave)| octave.differences >= FEWEST);
        enough.map(move |(level, octave)| {
            let tau_s = libm::exp2(level as f64) * sensor.rate.period();
            Point {
                sensor: sensor.kind.name(),
                axis: sensor.kind.axes()[axis],
                tau_s,
                deviation: libm::sqrt(0.5 * octave.squares / octave.differences as f64),
                theory: libm::sqrt(variance(plan, sensor, axis, tau_s)),
                differences: octave.differences,
            }
        })
    }
}

/// The Allan variance of the terms that have a closed form.
///
/// Over averages of m samples: white noise of σ a sample, `σ²/m`; rounding to counts adds `lsb²/12` to σ² where noise
/// makes it random; a walk of steps s, `s²·(2m² + 1)/(6m)`, which for long averages is IEEE Std 952-1997's `K²·τ/3`;
/// Gauss-Markov as [`wandering`]; a 1/f spectrum of B, within its band, `B²·2·ln 2/π`.
fn variance(plan: &Plan, sensor: &SensorPlan, axis: usize, tau: f64) -> f64 {
    let values = &sensor.values;
    let rate = sensor.rate.as_hz();
    let white = white_noise::sigma(values, sensor.kind, sensor.rate).map_or(0.0, |sigma| sigma[axis]);
    let count = lsb(values, sensor.kind).unwrap_or(0.0);
    let step = bias_step(values, &sensor.context(plan.seed))[axis];
    let wander = values.get(BIAS_INSTABILITY).unwrap_or_default()[axis];
    let time = values.get(CORRELATION_TIME).unwrap_or_default()[axis];
    let samples = tau * rate;
    let walked = step * step * (2.0 * samples * samples + 1.0) / (6.0 * samples);
    let mut variance = (white * white + count * count / 12.0) / samples + walked;
    if is_flicker(values) {
        // Flat within its band: 2·ln 2/π of its square.
        variance += wander * wander * 2.0 * std::f64::consts::LN_2 / std::f64::consts::PI;
    } else if wander > 0.0 && time > 0.0 {
        variance += wander * wander * wandering(samples, 1.0 / (rate * time));
    }
    variance
}

/// The Allan variance of a Gauss-Markov process of variance 1 over averages of m samples, each x correlation times
/// after the one before: the variance of an average less its covariance with the next,
/// `(m + (2ρ(m·a − A) − ρ·A²)/a²)/m²` with ρ = e^(−x), a = 1 − ρ and A = 1 − ρ^m. Where A is small, its beginning as a
/// walk, `x·(2m² + 1)/(3m)`.
fn wandering(m: f64, x: f64) -> f64 {
    if m * x < 1e-4 {
        return x * (2.0 * m * m + 1.0) / (3.0 * m);
    }
    let (one, all) = (-libm::expm1(-x), -libm::expm1(-m * x));
    let rho = 1.0 - one;
    (m + (2.0 * rho * (m * one - all) - rho * all * all) / (one * one)) / (m * m)
}

/// The unit of a sensor's deviations as a chart spells it.
pub fn unit(sensor: &str) -> &'static str {
    SensorKind::ALL.into_iter().find(|kind| kind.name() == sensor).map_or("", SensorKind::unit)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The points at which `measured` times what was measured is off theory by more than five standard errors. Neighbours
    /// share an average each, which widens the bound of independent ones by √1.5.
    fn off(scene: &str, measured: f64) -> Vec<Point> {
        let plan = Plan::parse(scene, "test", "test", &[]).unwrap();
        let points = run(&plan, Effort(600));
        assert!(points.len() > 30, "{}", points.len());
        let beyond = |point: &Point| {
            let error = (measured * point.deviation / point.theory - 1.0).abs();
            error > 5.0 * libm::sqrt(1.5 / (2.0 * point.differences as f64))
        };
        points.into_iter().filter(beyond).collect()
    }

    #[test]
    fn white_noise_walk_and_wandering_bias_are_as_theory_says_at_every_rate() {
        for rate in ["100 Hz", "1 kHz", "8 kHz"] {
            for terms in [
                "noise_density = \"0.01 deg/s/√Hz\"\n",
                "noise_density = \"0.01 deg/s/√Hz\"\nbias_random_walk = \"0.01 deg/s/√s\"\n",
                "noise_std = \"0.02 deg/s\"\nbias_instability = \"0.1 deg/s\"\ncorrelation_time = \"3 s\"\n",
                "noise_std = \"0.1 deg/s\"\nresolution = \"16.4 LSB/(deg/s)\"\n",
            ] {
                let scene = format!("duration = \"1 s\"\nseed = 3\n[gyro]\nrate = \"{rate}\"\n{terms}");
                let wrong = off(&scene, 1.0);
                assert!(wrong.is_empty(), "{rate}, {terms}: {wrong:?}");
                assert!(!off(&scene, 1.1).is_empty(), "{rate}, {terms}: a tenth more is not seen");
            }
        }
    }

    #[test]
    fn the_theory_of_a_wandering_bias_is_the_sum_over_its_samples() {
        for (m, x) in [(1u32, 0.003f64), (2, 0.4), (7, 0.1), (64, 0.002), (512, 0.05), (3, 4e-5), (3, 2e-5)] {
            // E[(second average − first)²]/2 from the correlation of every pair of samples.
            let sign = |i: u32| if i < m { -1.0 } else { 1.0 };
            let pair = |i: u32, j: u32| sign(i) * sign(j) * (-x * f64::from(i.abs_diff(j))).exp();
            let sum: f64 = (0..2 * m).flat_map(|i| (0..2 * m).map(move |j| pair(i, j))).sum();
            let expected = 0.5 * sum / f64::from(m * m);
            let found = wandering(f64::from(m), x);
            assert!((found / expected - 1.0).abs() < 1e-4, "{m} {x}: {found} {expected}");
        }
    }

    #[test]
    fn the_averages_are_those_of_the_definition() {
        let values = [3.0, 1.0, 4.0, 1.0, 5.0, 9.0, 2.0, 6.0, 5.0];
        let mut octaves = Octaves::default();
        values.iter().for_each(|&value| octaves.add(value));
        for (level, octave) in octaves.0.iter().enumerate() {
            let averages: Vec<f64> = values
                .chunks_exact(1 << level)
                .map(|chunk| chunk.iter().sum::<f64>() / chunk.len() as f64)
                .collect();
            let squares: f64 = averages.windows(2).map(|pair| (pair[1] - pair[0]).powi(2)).sum();
            assert_eq!(octave.differences as usize, averages.len() - 1);
            assert!((octave.squares - squares).abs() < 1e-12);
        }
    }
}
