//! What depends on time: filters, delays, lever arms, vibration, 1/f bias; against closed forms.

use super::signal_tests::{in_blocks, plan, played};
use super::tests::{DEG, allan_variance, read, sensor, spread};
use super::*;
use crate::geometry::{Vector, rotate};
use crate::scene::Plan;
use glam::DVec3;
use std::f64::consts::{PI, SQRT_2, TAU};

const RATES: [(&str, f64); 4] =
    [("100 Hz", 100.0), ("400/3 Hz", 400.0 / 3.0), ("1 kHz", 1000.0), ("8 kHz", 8000.0)];

/// What a gyro with these keys makes of a signal on its x axis.
fn answer(rate: &str, keys: &str, signal: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut block = Block::default();
    signal.for_each(|x| block.push([x, 0.0, 0.0]));
    sensor("[gyro]", rate, keys, 1).read(&mut block);
    block.reading[0].clone()
}

#[test]
fn a_filter_follows_a_ramp_late_by_its_delay_exactly_at_any_rate() {
    for (rate, hz) in RATES {
        for cut_off in [0.5, 5.0, 92.0, 5000.0] {
            let w = TAU * cut_off;
            for order in [1, 2] {
                let keys = format!("filter = {{ low_pass = \"{cut_off} Hz\", order = {order} }}");
                let seen = answer(rate, &keys, (0..2000).map(|k| f64::from(k) / hz));
                for (k, y) in seen.iter().enumerate() {
                    let t = k as f64 / hz;
                    // Settled at the start: the ramp's transient dies away.
                    let expected = match order {
                        1 => t - (1.0 - (-w * t).exp()) / w,
                        _ => {
                            let a = w * t / SQRT_2;
                            t - SQRT_2 / w + SQRT_2 / w * (-a).exp() * a.cos()
                        }
                    };
                    assert!(
                        (y - expected).abs() < 1e-11 * (1.0 + t),
                        "{keys} at {rate}, {t}: {y} against {expected}"
                    );
                }
            }
        }
    }
}

#[test]
fn a_filter_has_the_gain_and_phase_of_its_transfer_function_at_any_rate() {
    for (rate, hz) in RATES {
        for (cut_off, order, f) in
            [(20.0, 1, 7.0), (20.0, 2, 7.0), (5.0, 1, 5.0), (5.0, 2, 5.0), (4.0, 2, 9.0)]
        {
            let keys = format!("filter = {{ low_pass = \"{cut_off} Hz\", order = {order} }}");
            let n = (4.0 * hz) as usize;
            let seen = answer(rate, &keys, (0..n).map(|k| (TAU * f * k as f64 / hz).sin()));
            let r: f64 = f / cut_off;
            let (re, im) = if order == 1 { (1.0, r) } else { (1.0 - r * r, SQRT_2 * r) };
            let (gain, phase) = (1.0 / re.hypot(im), -im.atan2(re));
            // A sine is off the line from tick to tick by (W·dt)²/8 at most; the filter's gain is at most 1.
            let bound = (TAU * f / hz).powi(2) / 8.0 + 1e-9;
            let worst = |gain: f64, phase: f64| {
                let off = |k: usize| (seen[k] - gain * (TAU * f * k as f64 / hz + phase).sin()).abs();
                (n / 2..n).map(off).fold(0.0, f64::max)
            };
            assert!(worst(gain, phase) < bound, "{keys} at {rate}: {} of {bound}", worst(gain, phase));
            if hz >= 1000.0 {
                assert!(
                    worst(gain * 1.02, phase) > bound && worst(gain, phase + 0.03) > bound,
                    "{keys}: it can fail"
                );
                // Where the cut-off is, the gain is 1/√2.
                assert!((gain - 1.0 / SQRT_2).abs() < 1e-12 || f != cut_off);
            }
        }
    }
}

#[test]
fn a_filter_starts_settled_and_leaves_noise_alone() {
    let still = answer("1 kHz", "filter = \"10 Hz\"", std::iter::repeat_n(0.7, 100));
    assert!(still.iter().all(|y| (y - 0.7).abs() < 1e-14));
    let noise = "noise_std = \"0.1 rad/s\"\nbias = \"0.2 rad/s\"";
    let filtered = answer("1 kHz", &format!("{noise}\nfilter = \"10 Hz\""), std::iter::repeat_n(0.0, 100));
    assert_eq!(filtered, answer("1 kHz", noise, std::iter::repeat_n(0.0, 100)));
    for (bad, why) in [
        ("{ order = 2 }", "`low_pass`"),
        ("{ low_pass = \"9 Hz\", order = 3 }", "from 1 to 2"),
        ("\"0 Hz\"", "not above zero"),
    ] {
        let text = format!("duration = \"1 s\"\n[gyro]\nrate = \"1 Hz\"\nfilter = {bad}");
        let error = Plan::parse(&text, "s", "s", &[]).unwrap_err().to_string();
        assert!(error.contains(why), "{bad}: {error}");
    }
}

const CONE: &str =
    "[[motion]]\nkind = \"cone\"\nhalf_angle = \"20 deg\"\nfrequency = \"3 Hz\"\nduration = \"0.5 s\"\n";

#[test]
fn a_delay_is_exact_in_ticks_and_between_them() {
    for sampling in ["point", "average"] {
        let scene = |delay: &str| {
            played(&format!("{CONE}[gyro]\nrate = \"1 kHz\"\nsampling = \"{sampling}\"\ndelay = \"{delay}\""))
        };
        let (now, late) = (scene("0 s"), scene("3 ms"));
        for k in 0..now.len() {
            assert_eq!(
                late[k].body().unwrap().value,
                now[k.saturating_sub(3)].body().unwrap().value,
                "{sampling} {k}"
            );
            assert_eq!(late[k].body().unwrap().truth, now[k].body().unwrap().truth, "the truth is not late");
        }
        assert_ne!(
            late[100].body().unwrap().value,
            now[98].body().unwrap().value,
            "two ticks are another delay"
        );
    }
    let text = format!("{CONE}[accel]\nrate = \"100 Hz\"\ndelay = \"12.345678 ms\"");
    let path = plan(&text).trajectory;
    for (k, reading) in played(&text).iter().enumerate() {
        let t = SimTime((k as i64 * 10_000_000 - 12_345_678).max(0));
        assert_eq!(reading.body().unwrap().value, path.at(t).force);
    }
}

#[test]
fn a_spinning_lever_arm_feels_its_centripetal_acceleration() {
    for sampling in ["point", "average"] {
        let text = format!(
            "[[motion]]\nkind = \"rotate\"\nyaw = \"300 deg/s\"\nduration = \"1 s\"\n[accel]\nrate = \"100 Hz\"\nsampling = \"{sampling}\"\nlever_arm = \"[0.1, 0.02, 0.5] m\""
        );
        let w = 300.0 * DEG;
        for reading in played(&text) {
            let felt = (reading.body().unwrap().value - reading.body().unwrap().truth).v;
            assert!((felt + w * w * DVec3::new(0.1, 0.02, 0.0)).length() < 1e-13, "{sampling}: {felt}");
        }
    }
}

#[test]
fn a_lever_arm_feels_the_second_derivative_of_where_it_is() {
    let arm = DVec3::new(0.3, -0.2, 0.1);
    let text = format!("{CONE}[accel]\nrate = \"100 Hz\"\nlever_arm = \"[0.3, -0.2, 0.1] m\"");
    let path = plan(&text).trajectory;
    let place = |ns| rotate(path.at(SimTime(ns)).attitude.q, arm);
    let h = 20_000;
    let mut most = 0f64;
    for (k, reading) in played(&text).iter().enumerate().skip(1) {
        let t = k as i64 * 10_000_000;
        let second = (place(t + h) - 2.0 * place(t) + place(t - h)) / (h as f64 * 1e-9).powi(2);
        let expected = path.at(SimTime(t)).attitude.inverse().apply(Vector::from_vec(second)).v;
        let felt = (reading.body().unwrap().value - reading.body().unwrap().truth).v;
        // ε/h² of rounding.
        assert!((felt - expected).length() < 1e-5, "{k}: {felt} against {expected}");
        most = most.max(felt.length());
    }
    assert!(most > 10.0, "and it is not small: {most}");
    // A mean is the mean of the points.
    let mean = played(&format!("{text}\nsampling = \"average\""));
    let fine = played(&text.replace("100 Hz", "100 kHz"));
    let felt = |reading: &Reading| (reading.body().unwrap().value - reading.body().unwrap().truth).v;
    for k in 1..mean.len() {
        let points = &fine[(k - 1) * 1000..=k * 1000];
        let trapezia = (points[1..1000].iter().map(felt).sum::<DVec3>()
            + 0.5 * (felt(&points[0]) + felt(&points[1000])))
            / 1000.0;
        assert!((felt(&mean[k]) - trapezia).length() < 1e-4, "{k}");
    }
}

#[test]
fn a_vibration_is_its_sines_at_the_ticks_of_any_rate_folded_over_above_half_of_it() {
    let keys = "vibration = [{ frequency = \"37 Hz\", amplitude = \"[1, 0, 2] m/s^2\", phase = \"30 deg\" }, { frequency = \"1010 Hz\", amplitude = \"[0, 0.5, 0] m/s^2\" }]";
    for (rate, hz) in RATES {
        for (delay, sampling) in [(0.0, "point"), (0.0013, "point"), (0.0, "average")] {
            let text = format!(
                "duration = \"2 s\"\n[accel]\nrate = \"{rate}\"\nphase = \"0.3 ms\"\nsampling = \"{sampling}\"\ndelay = \"{delay} s\"\n{keys}"
            );
            for (k, reading) in played(&text).iter().enumerate() {
                let t = 0.0003 + k as f64 / hz - delay;
                let sine = |f: f64, phase: f64| match sampling {
                    "point" => (TAU * f * t + phase).sin(),
                    _ => (PI * f / hz).sin() / (PI * f / hz) * (TAU * f * (t - 0.5 / hz) + phase).sin(),
                };
                let expected = DVec3::new(1.0, 0.0, 2.0) * sine(37.0, 30.0 * DEG)
                    + DVec3::new(0.0, 0.5, 0.0) * sine(1010.0, 0.0);
                let felt = (reading.body().unwrap().value - reading.body().unwrap().truth).v;
                // A tick is a whole nanosecond: 2π·1010 Hz·0.5 ns.
                assert!(
                    (felt - expected).length() < 2e-5,
                    "{rate} {sampling} {k}: {felt} against {expected}"
                );
            }
        }
    }
    // 1010 Hz seen at 1 kHz is 10 Hz, unless the part's filter has taken it away before.
    let folded = |filter: &str| {
        let text = format!(
            "duration = \"1 s\"\n[gyro]\nrate = \"1 kHz\"\nvibration = {{ frequency = \"1010 Hz\", amplitude = \"1 rad/s\" }}\n{filter}"
        );
        played(&text).iter().map(|reading| reading.body().unwrap().value.v.x.abs()).fold(0.0, f64::max)
    };
    assert!((folded("") - 1.0).abs() < 1e-4);
    assert!((folded("filter = \"10.1 Hz\"") - 1.0 / 10001f64.sqrt()).abs() < 1e-5);
}

#[test]
fn a_random_vibration_has_the_variance_of_its_density_over_its_band() {
    let keys =
        "vibration = { density = \"[0.01, 0.02, 0.01] m^2/s^4/Hz\", from = \"20 Hz\", to = \"220 Hz\" }";
    let run = |seed| {
        read(&mut sensor("[accel]", "1 kHz", keys, seed), [0.0; 3], 100)
            .reading
            .map(|axis| [axis[0], axis[77]])
    };
    let runs: Vec<_> = (0..600).map(run).collect();
    for k in [0, 1] {
        for (axis, variance) in [(0, 2.0f64), (1, 4.0), (2, 2.0)] {
            let values: Vec<_> = runs.iter().map(|run| run[axis][k]).collect();
            spread(&values, variance.sqrt()).unwrap_or_else(|why| panic!("axis {axis}: {why}"));
            assert!(spread(&values, (variance * 2.0).sqrt()).is_err(), "a two-sided density is another");
        }
    }
    // The same as a table of two points; and one that rises by 12 dB, falls again as 1/f, and leaves an axis out.
    let points = |points: &[(u32, &str)]| {
        let point = |(hz, density): &(u32, &str)| {
            format!("{{ frequency = \"{hz} Hz\", density = \"{density} m^2/s^4/Hz\" }}")
        };
        let points: Vec<_> = points.iter().map(point).collect();
        format!("vibration = {{ spectrum = [{}] }}", points.join(", "))
    };
    let flat = points(&[(20, "[0.01, 0.02, 0.01]"), (220, "[0.01, 0.02, 0.01]")]);
    assert_eq!(
        read(&mut sensor("[accel]", "1 kHz", &flat, 1), [0.0; 3], 100).reading,
        read(&mut sensor("[accel]", "1 kHz", keys, 1), [0.0; 3], 100).reading
    );
    let shaped = points(&[(10, "[1, 0, 4]"), (40, "[16, 0, 4]"), (160, "[4, 0, 1]")]);
    // x: S = (f/10)² up to 40 Hz: (40³ − 10³)/300 = 210; then 16·40/f: 640·ln 4. z: 4·30, then a quarter of 640·ln 4.
    let tail = 640.0 * 4f64.ln();
    let runs: Vec<_> = (0..600)
        .map(|seed| read(&mut sensor("[accel]", "1 kHz", &shaped, seed), [0.0; 3], 78).reading)
        .collect();
    for (axis, variance) in [(0, 210.0 + tail), (2, 120.0 + tail / 4.0)] {
        let values: Vec<_> = runs.iter().map(|run| run[axis][77]).collect();
        spread(&values, variance.sqrt()).unwrap_or_else(|why| panic!("axis {axis}: {why}"));
        assert!(spread(&values, (variance * 1.5).sqrt()).is_err(), "control");
    }
    assert!(runs.iter().all(|run| run[1].iter().all(|y| *y == 0.0)));
    // Nothing outside the band: 10 s of it correlate with no sine beyond, and with some inside.
    let long = &read(&mut sensor("[accel]", "1 kHz", keys, 1), [0.0; 3], 10_000).reading[0];
    let power = |f: f64| {
        let (mut re, mut im) = (0.0, 0.0);
        for (k, x) in long.iter().enumerate() {
            // A Hann window: leakage falls as 1/distance³.
            let window = (PI * k as f64 / long.len() as f64).sin().powi(2);
            let angle = TAU * f * k as f64 / 1000.0;
            (re, im) = (re + x * window * angle.cos(), im + x * window * angle.sin());
        }
        (re * re + im * im) / (long.len() as f64).powi(2)
    };
    let inside = (20..220).map(|f| power(f64::from(f))).fold(0.0, f64::max);
    for f in [5.0, 15.0, 230.0, 300.0, 450.0] {
        assert!(power(f) < 1e-6 * inside, "{f} Hz: {} of {inside}", power(f));
    }
    for (bad, why) in [
        ("{ frequency = \"9 Hz\" }", "`amplitude`"),
        ("{ density = \"1 m^2/s^4/Hz\", from = \"9 Hz\", to = \"8 Hz\" }", "`from` below `to`"),
        ("[\"9 Hz\"]", "is a string; write"),
        ("{ spectrum = [{ frequency = \"9 Hz\", density = \"1 m^2/s^4/Hz\" }] }", "two points"),
        ("{ spectrum = [{ frequency = \"9 Hz\" }, { frequency = \"10 Hz\" }] }", "and its `density`"),
        (
            "{ spectrum = [{ frequency = \"9 Hz\", density = \"1 m^2/s^4/Hz\" }, { frequency = \"8 Hz\", density = \"1 m^2/s^4/Hz\" }] }",
            "8 Hz follows 9 Hz",
        ),
        (
            "{ spectrum = [{ frequency = \"9 Hz\", density = \"1 m^2/s^4/Hz\" }, { frequency = \"10 Hz\", density = \"0 m^2/s^4/Hz\" }] }",
            "everywhere or nowhere",
        ),
        (
            "{ density = \"1 m^2/s^4/Hz\", frequency = \"8 Hz\", from = \"1 Hz\", to = \"2 Hz\" }",
            "an entry has",
        ),
    ] {
        let text = format!("duration = \"1 s\"\n[accel]\nrate = \"1 Hz\"\nvibration = {bad}");
        let error = Plan::parse(&text, "s", "s", &[]).unwrap_err().to_string();
        assert!(error.contains(why), "{bad}: {error}");
    }
}

/// The mean of many runs' squared Allan deviations with its standard error, from the runs' own scatter.
fn allan_of_runs(rate: &str, keys: &str, m: usize, n: usize, runs: u64) -> (f64, f64) {
    let run = |seed| allan_variance(&read(&mut sensor("[gyro]", rate, keys, seed), [0.0; 3], n).bias, m).0;
    let runs: Vec<f64> = (0..runs).map(run).collect();
    let mean = runs.iter().sum::<f64>() / runs.len() as f64;
    let scatter = runs.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (runs.len() - 1) as f64;
    (mean, (scatter / runs.len() as f64).sqrt())
}

#[test]
fn flicker_has_a_flat_allan_deviation_of_0_664_b_at_any_rate() {
    let keys = "bias_instability = \"0.01 rad/s\"\nflicker = true\nflicker_band = { from = \"0.01 Hz\", to = \"100 Hz\" }";
    let floor = 2.0 * 2f64.ln() / PI * 1e-4;
    for (rate, hz, taus) in [("100 Hz", 100, [2, 10, 20]), ("1 kHz", 1000, [1, 2, 5])] {
        for tenths in taus {
            let m = tenths * hz / 10;
            let (found, error) = allan_of_runs(rate, keys, m, 16 * m, 120);
            // Sums of processes ripple by a few per cent of the variance, and the band has ends: by the closed form of
            // the sum 2 to 6 % is missing up to 2 s, and 13 % at 5 s.
            let bound = 5.0 * error + 0.05 * floor;
            assert!(
                (found - floor).abs() < bound,
                "{rate}, {tenths}/10 s: {found} is not {floor} within {bound}"
            );
            assert!((found - 2.0 * floor).abs() > bound, "nor would it pass for one that is √2 larger");
        }
    }
    // A single Gauss-Markov process is not flat.
    let single = "bias_instability = \"0.01 rad/s\"\ncorrelation_time = \"1 s\"";
    let flat = |m| allan_of_runs("100 Hz", single, m, 16 * m, 100).0;
    assert!(flat(10) < 0.5 * flat(190) && flat(1000) < 0.6 * flat(190));
}

#[test]
fn flicker_needs_a_size_and_a_band_and_takes_the_place_of_the_gauss_markov_process() {
    let terms = |keys: &str| {
        let text = format!("duration = \"1 s\"\n[gyro]\nrate = \"10 Hz\"\n{keys}");
        Plan::parse(&text, "s", "s", &[]).map(|plan| plan.build(&plan.sensors[0]).terms().to_vec())
    };
    let of = |keys: &str| terms(keys).map_err(|error| error.to_string());
    assert_eq!(of("bias_instability = \"1 deg/h\"\nflicker = true").unwrap(), ["flicker"]);
    assert_eq!(
        of("bias_instability = \"1 deg/h\"\nflicker = false\ncorrelation_time = \"9 s\"").unwrap(),
        ["bias_instability"]
    );
    for (keys, why) in [
        ("flicker = true", "needs a `bias_instability`"),
        ("flicker = \"yes\"", "write true or false"),
        (
            "bias_instability = \"1 deg/h\"\nflicker = true\nflicker_band = { from = \"20 Hz\" }",
            "`from` below `to`",
        ),
    ] {
        assert!(of(keys).unwrap_err().contains(why), "{keys}: {:?}", of(keys));
    }
}

#[test]
fn a_term_that_is_not_used_has_nothing_filled_for_it() {
    let plan = plan(&format!("{CONE}[gyro]\nrate = \"100 Hz\"\nnoise_std = \"1 rad/s\""));
    let mut player = crate::player::Player::new(&plan, plan.duration, 64);
    let block =
        player.play_columns(crate::motion::Wants::NONE).map(|columns| columns.sensor(0).clone()).unwrap();
    assert!(!block.is_empty() && block.temperature.is_empty());
    assert!([&block.force, &block.late, &block.arm].iter().all(|columns| columns.iter().all(Vec::is_empty)));
    assert_eq!(in_blocks(&plan, 7), in_blocks(&plan, 64));
}

/// Tick k of a clock that is fast by e is due at k/(rate·(1 + e)), and what is read there is true there.
#[test]
fn a_fast_clock_ticks_early_and_reads_what_is_true_then() {
    for (offset, e) in [("50 ppm", 50e-6), ("-0.3 %", -0.003), ("0 ppm", 0.0)] {
        let text = format!("{CONE}[gyro]\nrate = \"400/3 Hz\"\nphase = \"1 ms\"\nclock_error = \"{offset}\"");
        let plan = plan(&text);
        let mut ticks = Vec::new();
        let Ok(()) = crate::player::Player::new(&plan, SimTime(3_000_000_000), 64).play(|moment| {
            assert_eq!(moment.readings[0].body().unwrap().value, plan.trajectory.at(moment.t).rate);
            ticks.push(moment.t.0);
            Ok::<(), std::convert::Infallible>(())
        });
        for (k, t) in ticks.iter().enumerate() {
            let due = 1e6 + k as f64 * 1e9 / (400.0 / 3.0 * (1.0 + e));
            assert!((*t as f64 - due).abs() < 0.6, "{offset}: tick {k} at {t}, not {due}");
        }
        let more = (ticks.len() as f64 - 400.0 * (1.0 + e)).abs();
        assert!(more < 1.0, "{offset}: {} ticks", ticks.len());
    }
    let error =
        Plan::parse("duration = \"1 s\"\n[gyro]\nrate = \"1 Hz\"\nclock_error = \"20 %\"", "s", "s", &[]);
    assert!(error.unwrap_err().to_string().contains("the limit is ±10 %"));
}

/// A jitter σ in time is an error of σ times how fast the signal changes.
#[test]
fn a_jittering_clock_errs_by_its_jitter_times_the_signals_slope() {
    let scene = |seed: u64, more: &str| {
        let rock =
            "[[motion]]\nkind = \"rock\"\namplitude = \"1 rad/s\"\nfrequency = \"2 Hz\"\nduration = \"20 s\"";
        played(&format!("seed = {seed}\n{rock}\n[gyro]\nrate = \"1 kHz\"\n{more}"))
    };
    let errors = |readings: &[Reading]| -> Vec<f64> {
        let slope = |k: usize| TAU * 2.0 * (TAU * 2.0 * k as f64 / 1000.0).cos();
        let steep = (1..readings.len()).filter(|&k| slope(k).abs() > 6.0);
        steep
            .map(|k| (readings[k].body().unwrap().value - readings[k].body().unwrap().truth).v.x / slope(k))
            .collect()
    };
    let jitter = errors(&scene(1, "clock_error = { jitter = \"20 us\" }"));
    spread(&jitter, 20e-6).unwrap();
    assert!(spread(&jitter, 21.5e-6).is_err(), "7 % more");
    assert!(errors(&scene(1, "")).iter().all(|error| *error == 0.0));
    let noisy = errors(&scene(1, "clock_error = { jitter = \"20 us\" }\nnoise_std = \"1e-9 rad/s\""));
    assert!(
        noisy.iter().zip(&jitter).all(|(a, b)| (a - b).abs() < 1e-8),
        "the same jitter beside another term"
    );
}
