//! A model of noise is judged by its statistics, with bounds computed from the number of samples.

use super::*;
use crate::scene::Plan;

/// The one sensor of a scene with these keys, at work; `table` is such as `[gyro]`.
pub(super) fn sensor(table: &str, rate: &str, keys: &str, seed: u64) -> Sensor {
    let text = format!("seed = {seed}\nduration = \"1 s\"\n{table}\nrate = \"{rate}\"\n{keys}\n");
    let plan = Plan::parse(&text, "test", "test", &[]).unwrap_or_else(|error| panic!("{error}"));
    plan.build(&plan.sensors[0])
}

/// What a sensor makes of the same truth `n` times over.
pub(super) fn read(sensor: &mut Sensor, truth: [f64; 3], n: usize) -> Block {
    let mut block = Block::default();
    (0..n).for_each(|_| block.push(truth));
    sensor.read(&mut block);
    block
}

/// `n` readings of zero by a gyro with these keys: its errors.
pub(super) fn gyro(rate: &str, keys: &str, n: usize) -> [Vec<f64>; 3] {
    read(&mut sensor("[gyro]", rate, keys, 1), [0.0; 3], n).reading
}

/// The three axes, which are independent, one after another.
pub(super) fn joined(axes: &[Vec<f64>; 3]) -> Vec<f64> {
    axes.concat()
}

pub(super) fn variance(xs: &[f64]) -> f64 {
    let mean = xs.iter().sum::<f64>() / xs.len() as f64;
    xs.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (xs.len() - 1) as f64
}

/// Mean 0 and standard deviation `sigma`. Of N normal numbers the mean has σ/√N and the variance σ²·√(2/N); five
/// of each are allowed.
pub(super) fn spread(xs: &[f64], sigma: f64) -> Result<(), String> {
    let n = xs.len() as f64;
    let (mean, relative) = (xs.iter().sum::<f64>() / n, variance(xs) / (sigma * sigma) - 1.0);
    if mean.abs() > 5.0 * sigma / n.sqrt() {
        return Err(format!("the mean of {n} is {mean}, σ {sigma}"));
    }
    if relative.abs() > 5.0 * (2.0 / n).sqrt() {
        return Err(format!("the variance of {n} is off by {relative} of itself, σ {sigma}"));
    }
    Ok(())
}

/// The correlation of two runs of mean 0.
pub(super) fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    product(a, b) / (product(a, a) * product(b, b)).sqrt()
}

/// No sample says anything of a later one: of N white numbers each autocorrelation has σ = 1/√N; four are allowed.
pub(super) fn white(xs: &[f64]) -> Result<(), String> {
    let bound = 4.0 / (xs.len() as f64).sqrt();
    let at = |lag| correlation(&xs[..xs.len() - lag], &xs[lag..]);
    match (1..=20).map(|lag| (lag, at(lag))).find(|(_, r)| r.abs() > bound) {
        Some((lag, r)) => Err(format!("the autocorrelation at lag {lag} is {r}, beyond {bound}")),
        None => Ok(()),
    }
}

/// Squared Allan deviation from means of `m` samples, over the three axes, and how many differences it rests on.
pub(super) fn allan_variance(axes: &[Vec<f64>; 3], m: usize) -> (f64, usize) {
    let mut squares = Vec::new();
    for xs in axes {
        let means: Vec<_> = xs.chunks_exact(m).map(|chunk| chunk.iter().sum::<f64>() / m as f64).collect();
        squares.extend(means.windows(2).map(|pair| (pair[1] - pair[0]).powi(2) / 2.0));
    }
    (squares.iter().sum::<f64>() / squares.len() as f64, squares.len())
}

/// The Allan deviation over `m` samples is `expected`. Neighbouring differences of M means correlate by −½ at most,
/// so the variance of the estimate is at most (2 + 4·¼)/M = 3/M of its square; five sigma are allowed.
pub(super) fn allan(axes: &[Vec<f64>; 3], m: usize, expected: f64) -> Result<(), String> {
    let (found, count) = allan_variance(axes, m);
    let relative = found / (expected * expected) - 1.0;
    let bound = 5.0 * (3.0 / count as f64).sqrt();
    if relative.abs() > bound {
        return Err(format!("{} against {expected}: off by {relative}, beyond {bound}", found.sqrt()));
    }
    Ok(())
}

pub(super) const DEG: f64 = std::f64::consts::PI / 180.0;
const N: usize = 40_000;

#[test]
fn white_noise_has_the_size_that_each_spelling_says_and_no_memory() {
    for (rate, keys, sigma) in [
        ("1 kHz", "noise_std = \"0.002 rad/s\"", 0.002),
        ("50 Hz", "noise_std = \"0.002 rad/s\"", 0.002),
        ("1 kHz", "noise_variance = \"3e-6 rad^2/s^2\"", 3e-6f64.sqrt()),
        ("1 kHz", "noise_density = \"0.01 deg/s/√Hz\"", 0.01 * DEG * 500f64.sqrt()),
        ("200 Hz", "noise_density = \"0.01 deg/s/√Hz\"", 0.01 * DEG * 10.0),
        ("400/3 Hz", "angle_random_walk = \"0.3 deg/√h\"", 0.3 / 60.0 * DEG * (400f64 / 3.0).sqrt()),
    ] {
        let noise = gyro(rate, keys, N);
        spread(&joined(&noise), sigma).unwrap_or_else(|error| panic!("{keys} at {rate}: {error}"));
        noise.iter().for_each(|axis| white(axis).unwrap_or_else(|error| panic!("{keys} at {rate}: {error}")));
    }
}

#[test]
fn each_sensor_has_noise_in_its_own_unit() {
    for (table, keys, sigma) in [
        ("[accel]", "noise_density = \"300 µg/√Hz\"", 300e-6 * 9.80665 * 50f64.sqrt()),
        ("[accel]", "velocity_random_walk = \"0.03 m/s/√h\"", 0.03 / 60.0 * 10.0),
        ("[accel]", "noise_variance = \"1e-4 m^2/s^4\"", 0.01),
        ("[mag]", "noise_variance = \"0.04 uT^2\"", 0.2),
        ("[mag]", "noise_density = \"20 nT/√Hz\"", 0.02 * 50f64.sqrt()),
    ] {
        let noise = read(&mut sensor(table, "100 Hz", keys, 3), [0.0; 3], N).reading;
        spread(&joined(&noise), sigma).unwrap_or_else(|error| panic!("{table} {keys}: {error}"));
    }
}

#[test]
fn a_one_sided_density_is_the_root_of_two_times_the_random_walk() {
    let density = gyro("1 kHz", "noise_density = \"0.014142135623730951 deg/s/√Hz\"", 1000);
    let walk = gyro("1 kHz", "angle_random_walk = \"0.01 deg/√s\"", 1000);
    for (a, b) in joined(&density).iter().zip(joined(&walk)) {
        assert!((a - b).abs() <= 1e-14 * b.abs(), "{a} against {b}");
    }
}

#[test]
fn the_checks_themselves_refuse_noise_that_is_wrong() {
    let mut noise = gyro("1 kHz", "noise_std = \"0.002 rad/s\"", N);
    assert!(spread(&joined(&noise), 0.002 * 1.03).is_err(), "3 % more");
    assert!(spread(&joined(&noise), 0.002f64.sqrt()).is_err(), "a variance taken for a standard deviation");
    assert!(
        allan(&noise, 100, 0.002 / 100f64.sqrt() * std::f64::consts::SQRT_2).is_err(),
        "one-sided for two-sided"
    );
    let shifted: Vec<_> = noise[0].iter().map(|x| x + 0.0002).collect();
    assert!(spread(&shifted, 0.002).is_err(), "a mean of a tenth");
    for axis in &mut noise {
        let before = axis.clone();
        axis.iter_mut()
            .skip(1)
            .zip(before)
            .for_each(|(x, before)| *x = (*x + 0.05 * before) / 1.05f64.sqrt());
    }
    assert!(noise.iter().any(|axis| white(axis).is_err()), "a twentieth of the sample before");
}

#[test]
fn the_allan_deviation_does_not_depend_on_the_rate() {
    let (seconds, tau) = (200, 0.5);
    for (rate, hz) in [("100 Hz", 100), ("1 kHz", 1000), ("8 kHz", 8000)] {
        let m = hz / 2;
        let white = gyro(rate, "angle_random_walk = \"0.01 rad/√s\"", seconds * hz);
        allan(&white, m, 0.01 / f64::sqrt(tau))
            .unwrap_or_else(|error| panic!("white noise at {rate}: {error}"));
        let walk = gyro(rate, "bias_random_walk = \"0.01 rad/s/√s\"", seconds * hz);
        allan(&walk, m, 0.01 * (tau / 3.0f64).sqrt())
            .unwrap_or_else(|error| panic!("walk at {rate}: {error}"));
    }
}

/// The biases after `k` samples in each of `runs` runs, which differ by their seed alone; three a run.
fn over_seeds(rate: &str, keys: &str, k: usize, runs: u64) -> Vec<f64> {
    let run = |seed| {
        let block = read(&mut sensor("[gyro]", rate, keys, seed), [0.0; 3], k + 1);
        block.bias.map(|axis| axis[k])
    };
    (0..runs).flat_map(run).collect()
}

#[test]
fn a_bias_walk_by_steps_has_a_variance_of_k_steps_after_k_samples() {
    for k in [1, 25, 400] {
        let biases = over_seeds("100 Hz", "bias_step_std = \"0.001 rad/s\"", k, 400);
        spread(&biases, 0.001 * (k as f64).sqrt()).unwrap_or_else(|error| panic!("after {k}: {error}"));
    }
    assert_eq!(
        over_seeds("100 Hz", "bias_step_std = \"0.001 rad/s\"", 0, 3),
        [0.0; 9],
        "the first sample has no step"
    );
}

#[test]
fn a_bias_walk_by_time_grows_as_the_root_of_time_at_any_rate() {
    for (rate, hz) in [("50 Hz", 50), ("400 Hz", 400)] {
        for seconds in [1, 4] {
            let biases = over_seeds(rate, "bias_random_walk = \"0.01 rad/s/√s\"", seconds * hz, 300);
            spread(&biases, 0.01 * (seconds as f64).sqrt())
                .unwrap_or_else(|error| panic!("{rate}, {seconds} s: {error}"));
        }
    }
}

const WANDERING: &str = "bias_instability = \"0.01 rad/s\"\ncorrelation_time = \"1 s\"";

#[test]
fn a_gauss_markov_bias_has_its_spread_from_the_first_sample_on() {
    for (rate, k) in [("100 Hz", 0), ("100 Hz", 30), ("100 Hz", 300), ("1 kHz", 300), ("10 Hz", 30)] {
        spread(&over_seeds(rate, WANDERING, k, 400), 0.01)
            .unwrap_or_else(|error| panic!("{rate}, {k}: {error}"));
    }
}

#[test]
fn a_gauss_markov_bias_may_start_from_zero() {
    let keys = format!("{WANDERING}\nbias_instability_start = \"zero\"");
    assert_eq!(over_seeds("100 Hz", &keys, 0, 3), [0.0; 9]);
    // σ²·(1 − e^(−2t/τ)) after t.
    for (k, t) in [(20, 0.2f64), (600, 6.0)] {
        let sigma = 0.01 * (1.0 - (-2.0 * t).exp()).sqrt();
        spread(&over_seeds("100 Hz", &keys, k, 400), sigma)
            .unwrap_or_else(|error| panic!("after {t} s: {error}"));
    }
}

/// The autocorrelation of an AR(1) run at `lag` is φ^lag; Bartlett's formula gives the variance of its estimate,
/// of which five sigma are allowed.
fn remembers(xs: &[f64], phi: f64, lag: usize) -> Result<(), String> {
    let (n, at_lag) = (xs.len() as f64, phi.powi(lag as i32));
    let squares = at_lag * at_lag;
    let wide = (1.0 + phi * phi) * (1.0 - squares) / (1.0 - phi * phi) - 2.0 * lag as f64 * squares;
    let found = correlation(&xs[..xs.len() - lag], &xs[lag..]);
    let bound = 5.0 * (wide / n).sqrt();
    if (found - at_lag).abs() > bound {
        Err(format!("{found} against {at_lag}, beyond {bound}"))
    } else {
        Ok(())
    }
}

#[test]
fn a_gauss_markov_bias_forgets_all_but_one_in_e_within_its_correlation_time() {
    for (rate, hz) in [("10 Hz", 10), ("100 Hz", 100), ("1 kHz", 1000)] {
        let bias = gyro(rate, WANDERING, 1000 * hz);
        for axis in &bias {
            let phi = (-1.0 / hz as f64).exp();
            remembers(axis, phi, hz).unwrap_or_else(|error| panic!("{rate}: {error}"));
            assert!(remembers(axis, phi, hz * 2 / 3).is_ok());
            assert!(
                remembers(axis, (-2.0 / hz as f64).exp(), hz).is_err(),
                "half the correlation time is another"
            );
        }
    }
}

#[test]
fn a_gauss_markov_bias_has_its_allan_hump_of_0_617_sigma_at_1_89_tau() {
    let bias = gyro("100 Hz", WANDERING, 400_000);
    allan(&bias, 189, 0.617 * 0.01).unwrap();
    let [before, peak, after] = [30, 189, 1200].map(|m| allan_variance(&bias, m).0);
    assert!(before < peak && after < peak, "{before} {peak} {after}");
}

#[test]
fn a_bias_drawn_once_a_run_stays_through_the_run_and_spreads_over_seeds() {
    let keys = "bias = \"[0.1, 0, 0] rad/s\"\nbias_std = \"[0.02, 0.02, 0] rad/s\"";
    let runs: Vec<_> =
        (0..500).map(|seed| read(&mut sensor("[gyro]", "100 Hz", keys, seed), [0.0; 3], 2).bias).collect();
    assert!(runs.iter().all(|axes| axes.iter().all(|axis| axis[0] == axis[1])));
    spread(&runs.iter().map(|axes| axes[0][0] - 0.1).collect::<Vec<_>>(), 0.02).unwrap();
    spread(&runs.iter().map(|axes| axes[1][0]).collect::<Vec<_>>(), 0.02).unwrap();
    assert!(runs.iter().all(|axes| axes[2][0] == 0.0), "an axis without spread");
}

#[test]
fn an_axis_without_noise_is_exact() {
    let keys = "noise_std = \"[0.01, 0, 0.02] rad/s\"\nbias_step_std = \"[0, 0, 1e-3] rad/s\"\nbias_instability = \"[0.1, 0, 0] rad/s\"\ncorrelation_time = \"10 s\"";
    let truth = [0.3, std::f64::consts::PI / 7.0, -0.1];
    let block = read(&mut sensor("[gyro]", "100 Hz", keys, 1), truth, 500);
    assert!(block.reading[1].iter().all(|x| x.to_bits() == truth[1].to_bits()));
    assert!(block.reading[0].iter().skip(1).all(|x| *x != truth[0]));
}

#[test]
fn a_sensor_has_the_terms_its_scene_uses_and_no_others() {
    let none = sensor("[gyro]", "100 Hz", "noise_std = \"0 rad/s\"\nbias_step_std = \"0 rad/s\"", 1);
    assert_eq!(none.terms(), [""; 0]);
    let some = sensor(
        "[gyro]",
        "100 Hz",
        "noise_std = \"1 rad/s\"\nresolution = \"1 mrad/s\"\nbias = \"1 rad/s\"",
        1,
    );
    assert_eq!(some.terms(), ["bias", "white_noise", "resolution"]);
}

#[test]
fn two_spellings_of_white_noise_share_out_the_axes_but_never_meet() {
    let keys = "noise_std = \"[0.5, 0, 0] rad/s\"\nnoise_density = \"[0, 0.1, 0] rad/s/√Hz\"\nangle_random_walk = \"[0, 0, 0.1] rad/√s\"";
    let noise = gyro("200 Hz", keys, N);
    for (axis, sigma) in noise.iter().zip([0.5, 1.0, 0.1 * 200f64.sqrt()]) {
        spread(axis, sigma).unwrap();
    }
    let three = keys.replace("[0, 0, 0.1]", "[0.1, 0, 0.1]");
    let text = format!("duration = \"1 s\"\n[gyro]\nrate = \"1 Hz\"\n{three}");
    let error = Plan::parse(&text, "s", "s", &[]).unwrap_err().to_string();
    assert!(error.contains("already given by `noise_std`"), "the first meets the third: {error}");
}

#[test]
fn a_stream_depends_on_no_other_term_and_no_other_sensor() {
    let play = |more: &str| {
        let text = format!(
            "seed = 5\nduration = \"2 s\"\n{more}\n[gyro]\nrate = \"1 kHz\"\nnoise_std = \"0.01 rad/s\"\n"
        );
        let plan = Plan::parse(&text, "s", "s", &[]).unwrap();
        let gyro = plan.sensors.iter().find(|sensor| sensor.kind == SensorKind::Gyro).unwrap();
        read(&mut plan.build(gyro), [0.0; 3], 2000).reading
    };
    let alone = play("");
    assert_eq!(alone, play("accel = { rate = \"1 kHz\", noise_std = \"1 m/s^2\" }"));
    let walk = read(
        &mut sensor("[gyro]", "1 kHz", "noise_std = \"0.01 rad/s\"\nbias_step_std = \"1e-3 rad/s\"", 5),
        [0.0; 3],
        2000,
    );
    for axis in 0..3 {
        for k in 0..2000 {
            let white = walk.reading[axis][k] - walk.bias[axis][k];
            assert!((white - alone[axis][k]).abs() < 1e-15, "the same white noise on top of a walk");
        }
    }
}

#[test]
fn axes_terms_sensors_and_seeds_are_uncorrelated() {
    let gyro_noise = gyro("1 kHz", "noise_std = \"1 rad/s\"", N);
    let accel_noise =
        read(&mut sensor("[accel]", "1 kHz", "noise_std = \"1 m/s^2\"", 1), [0.0; 3], N).reading;
    let other_seed = read(&mut sensor("[gyro]", "1 kHz", "noise_std = \"1 rad/s\"", 2), [0.0; 3], N).reading;
    let walk = gyro("1 kHz", "bias_step_std = \"1 rad/s\"", N + 1);
    let steps = walk.map(|axis| axis.windows(2).map(|pair| pair[1] - pair[0]).collect::<Vec<_>>());
    // One of 66 pairs.
    let bound = 5.0 / (N as f64).sqrt();
    let mut runs = Vec::new();
    for axes in [&gyro_noise, &accel_noise, &other_seed, &steps] {
        runs.extend(axes.iter());
    }
    for (i, a) in runs.iter().enumerate() {
        for (j, b) in runs.iter().enumerate().skip(i + 1) {
            assert!(correlation(a, b).abs() < bound, "{i} and {j}: {}", correlation(a, b));
        }
        assert!(correlation(a, a) > bound, "and the check can fail");
    }
}

#[test]
fn a_reading_beyond_the_range_stays_at_full_scale_and_is_flagged() {
    let mut clip = sensor("[gyro]", "100 Hz", "range = \"2 rad/s\"", 1);
    let block = read(&mut clip, [1.0, -2.0, 2.0], 1);
    assert_eq!((block.reading.map(|axis| axis[0]), block.clipped[0]), ([1.0, -2.0, 2.0], false));
    let block = read(&mut clip, [1.0, -3.0, 2.5], 1);
    assert_eq!((block.reading.map(|axis| axis[0]), block.clipped[0]), ([1.0, -2.0, 2.0], true));
}

#[test]
fn clipping_happens_on_the_chips_axes() {
    // Turned by 45° about z: the chip's x and y see (x ± y)/√2 of the body's.
    let (half, c) = (std::f64::consts::FRAC_PI_8, std::f64::consts::FRAC_1_SQRT_2);
    let keys = format!("range = \"1 rad/s\"\nmount = [{}, 0.0, 0.0, {}]", half.cos(), half.sin());
    let block = read(&mut sensor("[gyro]", "100 Hz", &keys, 1), [0.9, 0.9, 0.5], 1);
    let seen = block.reading.map(|axis| axis[0]);
    assert!(block.clipped[0], "neither body component is beyond 1, but 0.9·√2 on the chip's y is");
    // The chip reads (0, 1, 0.5), which is (c, c, 0.5) on the body's axes.
    for (x, expected) in seen.iter().zip([c, c, 0.5]) {
        assert!((x - expected).abs() < 1e-14, "{seen:?}");
    }
}

#[test]
fn sixteen_bits_at_16_4_counts_have_32767_at_the_top_and_32768_at_the_bottom() {
    let lsb = DEG / 16.4;
    let keys = "range = \"2000 deg/s\"\nresolution = \"16.4 LSB/(deg/s)\"";
    for (mount, signs) in [("frd", [1.0, 1.0, 1.0]), ("flu", [1.0, -1.0, -1.0])] {
        let mut chip = sensor("[gyro]", "1 kHz", &format!("{keys}\nmount = \"{mount}\""), 1);
        for (truth, counts) in
            [(2100.0, 32767.0), (-2100.0, -32768.0), (10.0, 164.0), (0.0299, 0.0), (-0.0311, -1.0)]
        {
            let block = read(&mut chip, signs.map(|sign| sign * truth * DEG), 1);
            let raw = [0, 1, 2].map(|axis| block.reading[axis][0] * signs[axis] / lsb);
            assert!(raw.iter().all(|raw| (raw - counts).abs() < 1e-9), "{mount} {truth}: {raw:?}");
            assert_eq!(block.clipped[0], truth.abs() > 2000.0, "{truth}");
        }
    }
}

#[test]
fn a_count_may_be_given_as_its_size_per_unit_or_by_bits() {
    for (keys, lsb) in [
        ("resolution = \"0.01 rad/s\"", 0.01),
        ("resolution = \"0.01 rad/s/LSB\"", 0.01),
        ("resolution = \"100 LSB/(rad/s)\"", 0.01),
        ("resolution = \"8 bit\"\nrange = \"1.28 rad/s\"", 0.01),
    ] {
        let mut chip = sensor("[gyro]", "100 Hz", keys, 1);
        for i in -20..20 {
            let truth = f64::from(i) * 0.0037;
            let seen = read(&mut chip, [truth; 3], 1).reading[0][0];
            assert!((seen - (truth / lsb).round() * lsb).abs() < 1e-15, "{keys}: {truth} became {seen}");
            assert!((seen - truth).abs() <= lsb / 2.0 + 1e-15);
        }
    }
}

/// A scene with every term at once.
const EVERYTHING: &str = r#"
seed = 9
[[motion]]
kind = "rotate"
angular_rate = "[20, -10, 300] deg/s"
duration = "0.4 s"
[gyro]
part = "MPU-9250"
rate = "1 kHz"
sampling = "average"
bias_std = "0.1 deg/s"
bias_step_std = "1e-5 rad/s"
bias_instability = "20 deg/h"
correlation_time = "5 s"
range = "250 deg/s"
[accel]
part = "MPU-9250"
rate = "333 Hz"
phase = "0.7 ms"
bias_random_walk = "1e-4 m/s^2/√s"
[mag]
part = "AK8963"
rate = "100 Hz"
"#;

#[test]
fn where_blocks_begin_changes_nothing() {
    let plan = Plan::parse(EVERYTHING, "s", "s", &[]).unwrap();
    let play = |block| {
        let mut all = Vec::new();
        let mut player = crate::player::Player::new(&plan, SimTime(600_000_000), block);
        let played: Result<(), ()> = player.play(|moment| {
            all.extend(moment.readings.iter().map(|reading| (moment.t, *reading)));
            Ok(())
        });
        played.unwrap();
        all
    };
    let whole = play(256);
    assert_eq!(whole.len(), 600 + 200 + 60);
    assert!(
        whole.iter().any(|(_, reading)| reading.clipped) && whole.iter().any(|(_, reading)| !reading.clipped)
    );
    for block in [1, 7, 1000] {
        assert_eq!(play(block), whole, "blocks of {block}");
    }
    let gyro_ticks: Vec<_> =
        whole.iter().filter(|(_, reading)| reading.sensor == 0).map(|(_, reading)| reading.k).collect();
    assert_eq!(gyro_ticks, (0..600).collect::<Vec<_>>());
}

#[test]
fn an_averaged_sample_is_the_mean_over_the_interval_that_ends_at_its_tick() {
    let scene = |sampling: &str| {
        let text = format!(
            "[[motion]]\nkind = \"rotate\"\nroll = \"10 deg/s\"\nduration = \"25 ms\"\n[[motion]]\nkind = \"rotate\"\nroll = \"50 deg/s\"\nduration = \"25 ms\"\n[gyro]\nrate = \"100 Hz\"\nsampling = \"{sampling}\"\n"
        );
        let plan = Plan::parse(&text, "s", "s", &[]).unwrap();
        let mut seen = Vec::new();
        let mut player = crate::player::Player::new(&plan, SimTime(60_000_000), 2);
        let played: Result<(), ()> = player.play(|moment| {
            seen.push((moment.readings[0].body().unwrap().value.v.x.to_degrees() * 1e6).round() / 1e6);
            Ok(())
        });
        played.unwrap();
        seen
    };
    assert_eq!(scene("point"), [10.0, 10.0, 10.0, 50.0, 50.0, 0.0]);
    assert_eq!(scene("average"), [10.0, 10.0, 10.0, 30.0, 50.0, 50.0], "half of 20 to 30 ms at each rate");
}
