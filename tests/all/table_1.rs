//! The built-in scene `table-1` against Table 1 of the seed paper (doi 10.18720/SPBPU/2/id24-105).

use ratetable::geometry::Axes;
use ratetable::player::{BLOCK, Player};
use ratetable::scene::Plan;
use ratetable::sensor::SensorKind;
use std::convert::Infallible;

/// Per axis: reading minus truth, and truth, in the scene's axes.
struct Seen {
    error: [Vec<f64>; 3],
    reading: [Vec<f64>; 3],
    truth: [Vec<f64>; 3],
}

fn table_1(sets: &[&str]) -> Plan {
    let sets: Vec<String> = sets.iter().map(|set| set.to_string()).collect();
    Plan::load("table-1", &sets).unwrap_or_else(|error| panic!("{error}"))
}

fn play(plan: &Plan, kind: SensorKind) -> Seen {
    let empty = || [Vec::new(), Vec::new(), Vec::new()];
    let mut seen = Seen { error: empty(), reading: empty(), truth: empty() };
    let Ok(()) = Player::new(plan, plan.duration, BLOCK).play(|moment| {
        for reading in moment.readings.iter().filter(|reading| reading.kind == kind) {
            let (value, truth) = (
                plan.axes.body_out(reading.body().unwrap().value),
                plan.axes.body_out(reading.body().unwrap().truth),
            );
            for axis in 0..3 {
                seen.error[axis].push(value[axis] - truth[axis]);
                seen.reading[axis].push(value[axis]);
                seen.truth[axis].push(truth[axis]);
            }
        }
        Ok::<(), Infallible>(())
    });
    seen
}

/// Whether N errors are white and normal-sized: the mean within 4 standard errors of `mean`, the variance within 4
/// of `variance` (its standard error is σ²·√(2/N) for normal numbers), the autocorrelation at lags 1 to 20 within
/// 4/√N of zero. A true sample fails one of 22 such bounds less than once in 700 seeds.
fn is_white(errors: &[f64], mean: f64, variance: f64) -> Result<(), String> {
    let n = errors.len() as f64;
    let found = errors.iter().sum::<f64>() / n;
    let centred: Vec<f64> = errors.iter().map(|error| error - found).collect();
    let power = centred.iter().map(|x| x * x).sum::<f64>() / (n - 1.0);
    if (found - mean).abs() > 4.0 * (variance / n).sqrt() {
        return Err(format!("mean {found}, not {mean}"));
    }
    if (power - variance).abs() > 4.0 * variance * (2.0 / n).sqrt() {
        return Err(format!("variance {power}, not {variance}"));
    }
    for lag in 1..=20 {
        let correlation = centred.iter().zip(&centred[lag..]).map(|(a, b)| a * b).sum::<f64>() / (n * power);
        if correlation.abs() > 4.0 / n.sqrt() {
            return Err(format!("autocorrelation {correlation} at lag {lag}"));
        }
    }
    Ok(())
}

#[test]
fn the_gyro_has_the_papers_bias_and_variance_and_is_white() {
    let seen = play(&table_1(&[]), SensorKind::Gyro);
    for (axis, bias) in [-0.0005, 0.0005, -0.0006].into_iter().enumerate() {
        is_white(&seen.error[axis], bias, 3e-6).unwrap_or_else(|why| panic!("axis {axis}: {why}"));
    }
}

#[test]
fn the_magnetometer_has_the_papers_variance_and_no_bias_and_is_white() {
    let seen = play(&table_1(&[]), SensorKind::Mag);
    for axis in 0..3 {
        is_white(&seen.error[axis], 0.0, 0.04).unwrap_or_else(|why| panic!("axis {axis}: {why}"));
    }
}

#[test]
fn the_accelerometer_is_exactly_truth_plus_bias() {
    let seen = play(&table_1(&[]), SensorKind::Accel);
    assert_eq!(seen.reading[0].len(), 30_000);
    for (axis, bias) in [0.0007, 0.00033, -0.00404].into_iter().enumerate() {
        for (reading, truth) in seen.reading[axis].iter().zip(&seen.truth[axis]) {
            assert_eq!(*reading, truth + bias, "axis {axis}");
        }
    }
    assert_eq!([0, 1, 2].map(|axis| seen.truth[axis][0]), [0.0, 0.0, 9.80665], "A_true = [0, 0, +g] at rest");
}

#[test]
fn a_wrong_variance_a_wrong_bias_and_a_coloured_noise_would_be_seen() {
    let white = &play(&table_1(&[]), SensorKind::Gyro).error[0];
    let louder: Vec<f64> = white.iter().map(|x| -0.0005 + (x + 0.0005) * 1.03).collect();
    let shifted: Vec<f64> = white.iter().map(|x| x + 0.0005).collect();
    let smooth: Vec<f64> =
        white.windows(2).map(|pair| -0.0005 + (pair[0] + pair[1] + 0.001) / 2f64.sqrt()).collect();
    for (errors, says) in [(louder, "variance"), (shifted, "mean"), (smooth, "autocorrelation")] {
        let why = is_white(&errors, -0.0005, 3e-6).unwrap_err();
        assert!(why.contains(says), "{why}");
    }
}

/// A quaternion of its own, w first: nothing of the crate's geometry judges the crate's geometry.
type Q = [f64; 4];

fn mul(a: Q, b: Q) -> Q {
    [
        a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
        a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
        a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
        a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0],
    ]
}

/// Turned for `t` seconds at `rate` deg/s about the body's axes.
fn turned(rate: [f64; 3], t: f64) -> Q {
    let speed = rate.iter().map(|w| w * w).sum::<f64>().sqrt();
    if speed == 0.0 {
        return [1.0, 0.0, 0.0, 0.0];
    }
    let half = (speed * t / 2.0).to_radians();
    let [x, y, z] = rate.map(|w| w / speed * half.sin());
    [half.cos(), x, y, z]
}

fn angle_deg(a: Q, b: Q) -> f64 {
    let d = mul([a[0], -a[1], -a[2], -a[3]], b);
    2.0 * (d[1] * d[1] + d[2] * d[2] + d[3] * d[3]).sqrt().atan2(d[0].abs()).to_degrees()
}

/// The scene's motions as its file gives them: rates in deg/s and durations in s.
const MOTIONS: [([f64; 3], f64); 10] = [
    ([0.0, 0.0, 0.0], 2.0),
    ([20.0, 0.0, 0.0], 4.0),
    ([-20.0, 0.0, 0.0], 4.0),
    ([0.0, 15.0, 0.0], 4.0),
    ([0.0, -15.0, 0.0], 4.0),
    ([0.0, 0.0, 30.0], 3.0),
    ([10.0, -5.0, 20.0], 2.0),
    ([-10.0, 5.0, -20.0], 2.0),
    ([0.0, 25.0, -45.0], 1.0),
    ([0.0, 0.0, 0.0], 4.0),
];

fn closed_form(mut t: f64) -> Q {
    let mut q = [1.0, 0.0, 0.0, 0.0];
    for (rate, duration) in MOTIONS {
        q = mul(q, turned(rate, t.min(duration)));
        t -= duration;
        if t <= 0.0 {
            break;
        }
    }
    q
}

/// The largest difference from the closed form in degrees, over every tick.
fn worst(plan: &Plan, mut change: impl FnMut(Q) -> Q) -> f64 {
    let mut worst = 0.0f64;
    let Ok(()) = Player::new(plan, plan.duration, BLOCK).play(|moment| {
        let q = plan.axes.attitude_out(moment.truth.attitude);
        let expected = closed_form(moment.t.0 as f64 / 1e9);
        worst = worst.max(angle_deg(change([q.w, q.x, q.y, q.z]), expected));
        Ok::<(), Infallible>(())
    });
    worst
}

#[test]
fn the_reference_attitude_is_the_closed_form_in_both_axes() {
    // The same numbers, read in the other axes, are the same turns about those axes.
    for axes in Axes::NAMES {
        let plan = table_1(&[&format!("axes={axes}")]);
        assert_eq!(plan.axes.to_string(), axes);
        let error = worst(&plan, |q| q);
        assert!(error < 1e-9, "{axes}: {error} deg");
        let swapped = worst(&plan, |[w, x, y, z]| [w, y, x, z]);
        assert!(swapped > 10.0, "a swapped axis would be seen: {swapped} deg");
    }
}
