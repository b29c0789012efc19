//! What reaches the sensing element and how it answers, against closed forms; each with what must not pass.

use super::tests::{DEG, sensor};
use super::*;
use crate::geometry::Vector;
use crate::player::Player;
use crate::scene::Plan;
use glam::DVec3;
use std::convert::Infallible;

const G: f64 = 9.80665;

pub(super) fn plan(text: &str) -> Plan {
    Plan::parse(text, "test", "test", &[]).unwrap_or_else(|error| panic!("{error}"))
}

/// What a sensor makes of one error-free reading.
fn one(table: &str, keys: &str, truth: [f64; 3]) -> DVec3 {
    let mut block = Block::default();
    block.push(truth);
    sensor(table, "100 Hz", keys, 1).read(&mut block);
    DVec3::from_array(block.reading.map(|axis| axis[0]))
}

/// Every reading of the only sensor of a scene.
pub(super) fn played(text: &str) -> Vec<Reading> {
    in_blocks(&plan(text), 256)
}

pub(super) fn in_blocks(plan: &Plan, block: usize) -> Vec<Reading> {
    let mut readings = Vec::new();
    let Ok(()) = Player::new(plan, plan.duration, block).play(|moment| {
        readings.extend_from_slice(moment.readings);
        Ok::<(), Infallible>(())
    });
    readings
}

fn near(found: DVec3, expected: [f64; 3], within: f64) {
    assert!(
        (found - DVec3::from_array(expected)).abs().max_element() <= within,
        "{found} is not {expected:?}"
    );
}

#[test]
fn a_scale_error_stretches_each_axis_by_its_own_share() {
    near(one("[gyro]", "scale_error = \"[1, -2, 0] %\"", [1.0, 2.0, 3.0]), [1.01, 1.96, 3.0], 1e-15);
    near(one("[accel]", "scale_error = \"500 ppm\"", [1.0, 2.0, 3.0]), [1.0005, 2.001, 3.0015], 1e-15);
    assert_eq!(sensor("[gyro]", "100 Hz", "scale_error = \"0 %\"", 1).terms(), [""; 0]);
}

#[test]
fn a_misaligned_sensor_sees_a_vector_from_axes_turned_the_other_way() {
    // Axes turned by +θ about z see a vector along x turned by −θ.
    let (sine, cosine) = DEG.sin_cos();
    let seen = one("[gyro]", "misalignment = \"[0, 0, 1] deg\"", [1.0, 0.0, 0.0]);
    near(seen, [cosine, -sine, 0.0], 1e-15);
    // Whatever the angles, no vector changes its length; with a scale error it does.
    let truth = [0.3, -1.2, 2.0];
    let length = |keys: &str| one("[mag]", keys, truth).length() / DVec3::from_array(truth).length() - 1.0;
    assert!(length("misalignment = \"[3, -2, 5] deg\"").abs() < 1e-15);
    assert!(length("misalignment = \"[3, -2, 5] deg\"\nscale_error = \"1 ppm\"").abs() > 1e-7);
}

#[test]
fn a_matrix_comes_after_scale_error_and_misalignment_and_may_be_written_four_ways() {
    let rows = "matrix = [[1, 0.02, 0], [0, 1, 0], [-0.01, 0, 1]]";
    near(one("[gyro]", rows, [1.0, 2.0, 3.0]), [1.04, 2.0, 2.99], 1e-15);
    for same in [
        "matrix = \"[[1, 0.02, 0], [0, 1, 0], [-0.01, 0, 1]]\"",
        "matrix = [\"[100, 2, 0] %\", [0, 1, 0], \"[-1, 0, 100] %\"]",
        "matrix = \"[[100, 2, 0], [0, 100, 0], [-1, 0, 100]] %\"",
    ] {
        near(one("[gyro]", same, [1.0, 2.0, 3.0]), [1.04, 2.0, 2.99], 1e-15);
    }
    near(one("[gyro]", "matrix = \"[2, 3, 4]\"", [1.0, 1.0, 1.0]), [2.0, 3.0, 4.0], 0.0);
    let both = one("[gyro]", &format!("{rows}\nscale_error = \"[0, 100, 0] %\""), [1.0, 2.0, 3.0]);
    near(both, [1.08, 4.0, 2.99], 1e-15);
    for (bad, why) in [
        ("matrix = [[1, 0, 0], [0, 1, 0]]", "2 rows"),
        ("matrix = \"[[1, 0, 0], [0, 1, 0]]\"", "3 rows of 3 values, not 2"),
        ("matrix = [[1, 0], [0, 1, 0], [0, 0, 1]]", "a vector has 3 values"),
        ("matrix = [[1, 0, 0], [0, 1, 0], [0, 0, 0]]", "no inverse"),
        ("scale_error = \"-100 %\"", "no inverse"),
        ("matrix = true", "`matrix` is true or false"),
    ] {
        let text = format!("duration = \"1 s\"\n[gyro]\nrate = \"1 Hz\"\n{bad}");
        let error = Plan::parse(&text, "s", "s", &[]).unwrap_err().to_string();
        assert!(error.contains(why), "{bad}: {error}");
    }
}

/// A scene in Forward-Left-Up means its own axes by every vector and matrix.
#[test]
fn vectors_and_matrices_are_in_the_axes_of_the_scene() {
    let keys = "misalignment = \"[1, -2, 3] deg\"\nmatrix = [[1, 0.1, 0.2], [0.3, 1, 0.4], [0.5, 0.6, 1]]\nscale_error = \"[1, 2, 3] %\"\nbias_temperature = \"[0.1, 0.2, -0.3] deg/s/K\"\ntemperature = \"35 degC\"\n";
    let scene = |axes: &str, rate: [f64; 3]| {
        let text = format!(
            "axes = \"{axes}\"\n[[motion]]\nkind = \"rotate\"\nangular_rate = \"{rate:?} rad/s\"\nduration = \"10 ms\"\n[gyro]\nrate = \"100 Hz\"\n{keys}"
        );
        let plan = plan(&text);
        plan.axes.body_out(played(&text)[0].body().unwrap().value)
    };
    let ned = scene("ned-frd", [1.0, 2.0, 3.0]);
    assert!((scene("enu-flu", [1.0, 2.0, 3.0]) - ned).length() < 1e-14);
    assert!((scene("enu-flu", [1.0, -2.0, -3.0]) - ned).length() > 0.1, "another vector is another reading");
}

#[test]
fn soft_iron_stretches_the_field_then_hard_iron_adds_to_it_then_the_sensor_errs() {
    let keys = "soft_iron = [[1.1, 0.2, 0], [0, 0.9, 0], [0, 0, 1]]\nhard_iron = \"[5, -10, 20] uT\"";
    near(one("[mag]", keys, [20.0, 10.0, 40.0]), [29.0, -1.0, 60.0], 1e-13);
    let scaled = format!("{keys}\nscale_error = \"10 %\"");
    near(one("[mag]", &scaled, [20.0, 10.0, 40.0]), [31.9, -1.1, 66.0], 1e-13);
    for key in ["soft_iron = 2", "hard_iron = \"1 uT\""] {
        let text = format!("duration = \"1 s\"\n[accel]\nrate = \"1 Hz\"\n{key}");
        let error = Plan::parse(&text, "s", "s", &[]).unwrap_err().to_string();
        assert!(error.contains("magnetometer"), "{error}");
    }
}

/// Over full scale the deviation goes from −n to +n of it twice and its best straight line is zero.
#[test]
fn a_nonlinearity_is_the_greatest_deviation_from_the_best_straight_line() {
    for (keys, mount) in [("", ""), ("", "mount = \"flu\""), ("", "mount = [0.8, 0.0, 0.0, 0.6]")] {
        let keys = format!("{keys}nonlinearity = \"0.2 %\"\nrange = \"10 rad/s\"\n{mount}");
        let mut bent = sensor("[gyro]", "100 Hz", &keys, 1);
        let mut block = Block::default();
        let (n, on_z) = (4000, |i: i32| f64::from(i) / 400.0);
        (-n..=n).for_each(|i| block.push([0.0, 0.0, on_z(i)]));
        bent.read(&mut block);
        let deviation: Vec<f64> = (-n..=n).zip(&block.reading[2]).map(|(i, read)| read - on_z(i)).collect();
        // At full scale the range takes off what is beyond it.
        let inside = &deviation[200..deviation.len() - 200];
        let most = inside.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        assert!((most - 0.02).abs() < 1e-6, "{mount}: {most}");
        // Slope of the line through it, and its value at half scale.
        assert!(
            (deviation[n as usize + 2000] + 0.02).abs() < 1e-12
                && (deviation[n as usize - 2000] - 0.02).abs() < 1e-12
        );
        assert!(deviation[n as usize].abs() < 1e-15, "none at zero");
    }
    // Without a range there is no full scale to be a part of; far beyond it nothing folds back.
    let text = "duration = \"1 s\"\n[gyro]\nrate = \"1 Hz\"\nnonlinearity = \"1 %\"";
    assert!(Plan::parse(text, "s", "s", &[]).unwrap_err().to_string().contains("needs a `range`"));
    let beyond = one("[gyro]", "nonlinearity = \"-0.2 %\"\nrange = \"1 rad/s\"", [1000.0, -1000.0, 0.0]);
    near(beyond, [1.0, -1.0, 0.0], 0.0);
}

#[test]
fn acceleration_gives_a_gyro_a_bias_of_the_true_specific_force() {
    let scene = |keys: &str| {
        played(&format!(
            "[[motion]]\nkind = \"rotate\"\nroll = \"90 deg/s\"\nduration = \"1 s\"\n[gyro]\nrate = \"100 Hz\"\n{keys}"
        ))
    };
    for (k, reading) in scene("g_sensitivity = \"[0.1, 0.2, 0.3] deg/s/g\"").iter().enumerate() {
        // Level, then rolled by φ: the force is −g on z, then on y too.
        let (sine, cosine) = (k as f64 * 0.9 * DEG).sin_cos();
        near(reading.body().unwrap().bias.v, [0.0, -0.2 * DEG * sine, -0.3 * DEG * cosine], 1e-14);
        assert_eq!(
            reading.body().unwrap().value,
            reading.body().unwrap().truth + reading.body().unwrap().bias
        );
    }
    let across = scene("g_sensitivity = \"[[0, 0, 0.1], [0, 0, 0], [0, 0, 0]] deg/s/g\"");
    near(across[0].body().unwrap().bias.v, [-0.1 * DEG, 0.0, 0.0], 1e-15);
    assert!(scene("").iter().all(|reading| reading.body().unwrap().bias == Vector::ZERO));
}

#[test]
fn a_part_that_warms_up_follows_the_exponential_and_its_coefficients_with_it() {
    for (rate, phase, hz) in
        [("100 Hz", 0.0, 100.0), ("1 kHz", 0.0003, 1000.0), ("400/3 Hz", 0.0, 400.0 / 3.0)]
    {
        let text = format!(
            "duration = \"3 s\"\n[accel]\nrate = \"{rate}\"\nphase = \"{phase} s\"\ntemperature = {{ ambient = \"15 degC\", rise = \"20 K\", time_constant = \"0.7 s\" }}\nbias_temperature = \"[2, 0, -1] mg/K\"\nscale_temperature = \"[0, 0, 300] ppm/K\"\n"
        );
        for (k, reading) in played(&text).iter().enumerate() {
            let t = phase + k as f64 / hz;
            let expected = 15.0 + 20.0 * (1.0 - (-t / 0.7).exp());
            assert!((reading.temperature - expected).abs() < 1e-7, "{rate} {k}: {}", reading.temperature);
            let off = reading.temperature - 25.0;
            near(reading.body().unwrap().bias.v, [2e-3 * G * off, 0.0, -1e-3 * G * off], 1e-14);
            let z = -G * (1.0 + 300e-6 * off) - 1e-3 * G * off;
            near(reading.body().unwrap().value.v, [2e-3 * G * off, 0.0, z], 1e-13);
        }
    }
}

#[test]
fn a_constant_temperature_is_a_constant_bias_and_none_at_25_degrees() {
    let keys = "bias_temperature = \"0.1 deg/s/K\"";
    for (temperature, off) in [("35 degC", 10.0), ("298.15 K", 0.0), ("-15 degC", -40.0)] {
        let bias = one("[gyro]", &format!("{keys}\ntemperature = \"{temperature}\""), [0.0; 3]);
        near(bias, [0.1 * DEG * off; 3], 1e-14);
    }
    assert_eq!(
        sensor("[gyro]", "1 Hz", keys, 1).terms(),
        [""; 0],
        "a sheet's coefficient alone does nothing"
    );
    for (bad, why) in [
        ("{ rise = \"5 K\" }", "needs a `time_constant`"),
        ("{ ambient = \"5 K/s\" }", "temperature"),
        ("{ warm = 3 }", "`warm` is not a key of `temperature`"),
        ("true", "is true or false; write"),
        ("{ rise = \"5 K\", time_constant = \"0 s\" }", "not above zero"),
    ] {
        let text = format!("duration = \"1 s\"\n[gyro]\nrate = \"1 Hz\"\ntemperature = {bad}");
        let error = Plan::parse(&text, "s", "s", &[]).unwrap_err().to_string();
        assert!(error.contains(why), "{bad}: {error}");
    }
}

/// What each term does to a sensor of every kind, alone: the generic laws that all of them keep.
const ALONE: &[(&str, &str, &str)] = &[
    (
        "temperature",
        "[gyro]",
        "temperature = { rise = \"20 K\", time_constant = \"50 ms\" }\nbias_temperature = \"1 deg/s/K\"",
    ),
    ("clock_error", "[gyro]", "clock_error = { offset = \"300 ppm\", jitter = \"50 us\" }"),
    ("delay", "[gyro]", "delay = \"2.5 ms\""),
    ("lever_arm", "[accel]", "lever_arm = \"[0.1, 0.2, 0.3] m\""),
    ("filter", "[gyro]", "filter = { low_pass = \"20 Hz\", order = 2 }"),
    (
        "vibration",
        "[gyro]",
        "vibration = [{ frequency = \"33 Hz\", amplitude = \"1 rad/s\" }, { density = \"0.01 rad^2/s^2/Hz\", from = \"20 Hz\", to = \"90 Hz\" }]",
    ),
    ("flicker", "[gyro]", "bias_instability = \"1 deg/s\"\nflicker = true"),
    ("soft_iron", "[mag]", "soft_iron = [[1.1, 0.1, 0], [0, 1, 0], [0, 0, 1]]"),
    ("hard_iron", "[mag]", "hard_iron = \"[1, 2, 3] uT\""),
    ("matrix", "[gyro]", "scale_error = \"1 %\"\nmisalignment = \"[1, 2, 3] deg\""),
    ("scale_temperature", "[accel]", "scale_temperature = \"1 %/K\"\ntemperature = \"30 degC\""),
    ("nonlinearity", "[gyro]", "nonlinearity = \"1 %\"\nrange = \"10 rad/s\""),
    ("bias", "[gyro]", "bias = \"[1, 2, 3] deg/s\""),
    ("bias_instability", "[gyro]", "bias_instability = \"1 deg/s\"\ncorrelation_time = \"50 ms\""),
    ("bias_walk", "[gyro]", "bias_step_std = \"1 deg/s\""),
    ("bias_temperature", "[mag]", "bias_temperature = \"1 uT/K\"\ntemperature = \"0 degC\""),
    ("g_sensitivity", "[gyro]", "g_sensitivity = \"1 deg/s/g\""),
    ("white_noise", "[accel]", "noise_std = \"1 m/s^2\""),
    ("velocity_noise", "[gps]", "velocity_noise_std = \"1 m/s\""),
    ("clock_error", "[gps]", "clock_error = { offset = \"300 ppm\", jitter = \"50 us\" }"),
    ("bias_instability", "[gps]", "bias_instability = \"[1, 1, 2] m\"\ncorrelation_time = \"50 ms\""),
    ("resolution", "[gps]", "resolution = \"1 m\"\nvelocity_noise_std = \"1 m/s\""),
    ("filter", "[baro]", "filter = \"20 Hz\"\nnoise_std = \"1 Pa\""),
    ("bias_temperature", "[baro]", "bias_temperature = \"2 Pa/K\"\ntemperature = \"0 degC\""),
    ("flicker", "[baro]", "bias_instability = \"3 Pa\"\nflicker = true"),
    ("range", "[baro]", "range = \"900 hPa\""),
    ("range", "[gyro]", "range = \"1 rad/s\""),
    ("resolution", "[gyro]", "resolution = \"1 deg/s\""),
];

/// A manoeuvre on which every term shows, with a sensor that has these keys.
fn on_a_manoeuvre(table: &str, keys: &str) -> String {
    format!(
        "seed = 3\n[start]\nvelocity = \"[3, 2, 1] m/s\"\n[[motion]]\nkind = \"cone\"\nhalf_angle = \"20 deg\"\nfrequency = \"3 Hz\"\nduration = \"0.35 s\"\n[[motion]]\nkind = \"rock\"\namplitude = \"100 deg/s\"\nfrequency = \"5 Hz\"\nduration = \"0.4 s\"\n{table}\nrate = \"1 kHz\"\n{keys}\n"
    )
}

#[test]
fn every_term_does_something_is_named_and_does_not_care_where_blocks_begin() {
    let listed: Vec<_> = ALONE.iter().map(|(name, ..)| *name).collect();
    for term in TERMS {
        assert!(listed.contains(&term.name), "{} is not tried", term.name);
    }
    for (name, table, keys) in ALONE {
        let ways: &[_] = match *table {
            "[baro]" | "[gps]" => &[""],
            _ => &["sampling = \"point\"", "sampling = \"average\""],
        };
        for sampling in ways {
            let keys = format!("{keys}\n{sampling}");
            let plan = plan(&on_a_manoeuvre(table, &keys));
            assert!(plan.build(&plan.sensors[0]).terms().contains(name), "{name}");
            let blocks = |block| in_blocks(&plan, block);
            let whole = blocks(256);
            assert_eq!(in_blocks(&self::plan(&plan.resolved), 256), whole, "{name} of the scene as resolved");
            for block in [1, 7, 64, 1000] {
                assert_eq!(blocks(block), whole, "{name} in blocks of {block}");
            }
            let off = |reading: &Reading| match &reading.measurement {
                Measurement::Triad(triad) => triad.value != triad.truth,
                Measurement::Pressure(pressure) => pressure.value != pressure.truth,
                Measurement::Position(Position { fix, true_fix, .. }) => fix != true_fix,
            };
            assert!(whole.iter().any(off), "{name} does nothing");
        }
    }
}

/// A term's random numbers are its own: what it adds is the same on top of any other.
#[test]
fn adding_a_term_leaves_every_random_number_of_the_others() {
    // One that is linear in what comes before it, so that differences show it alone.
    let noise = "noise_std = \"0.1 rad/s\"";
    let readings = |keys: &str| played(&on_a_manoeuvre("[gyro]", keys));
    let alone: Vec<_> = readings(noise)
        .iter()
        .map(|reading| reading.body().unwrap().value - reading.body().unwrap().truth)
        .collect();
    let others = ALONE.iter().filter(|(name, table, _)| {
        *table == "[gyro]" && !["white_noise", "range", "resolution", "nonlinearity"].contains(name)
    });
    for (name, _, keys) in others {
        let with = readings(&format!("{keys}\n{noise}"));
        let without = readings(keys);
        for ((with, without), noise) in with.iter().zip(&without).zip(&alone) {
            let drawn = with.body().unwrap().value - without.body().unwrap().value;
            assert!((drawn - *noise).length() < 1e-13, "{name} changed the white noise: {drawn:?} {noise:?}");
        }
    }
}
