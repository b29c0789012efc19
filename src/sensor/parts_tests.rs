//! The data files of parts: every value has a source, every part loads, and its counts are the datasheet's.

use super::parts;
use super::*;
use crate::scene::{self, Plan};

fn plan(part: &str, kind: SensorKind, more: &str, seed: u64) -> Result<Plan, String> {
    let text = format!(
        "seed = {seed}\nduration = \"1 s\"\n[{kind}]\npart = \"{part}\"\nrate = \"100 Hz\"\n{more}\n"
    );
    Plan::parse(&text, "test", "test", &[]).map_err(|error| error.to_string())
}

/// The sensors a part's file has.
fn sensors(part: &parts::Part) -> Vec<SensorKind> {
    SensorKind::ALL.into_iter().filter(|kind| part.text.contains(&format!("[{kind}]"))).collect()
}

#[test]
fn every_value_of_every_part_names_its_source() {
    for part in parts::all() {
        let sourced = scene::parts::sources(part).unwrap_or_else(|mistake| panic!("{mistake}"));
        for value in &sourced {
            let has_page = value.source.contains(" p. ") || value.source.starts_with("assumed: ");
            assert!(has_page, "{} {}.{}: `{}`", part.file, value.sensor, value.key, value.source);
        }
        for kind in sensors(part) {
            assert!(
                sourced.iter().any(|value| value.sensor == kind && value.key == "range"),
                "{} {kind}",
                part.file
            );
        }
    }
    let unsourced = parts::Part {
        names: &["X"],
        inside: &[],
        about: "",
        file: "x.toml",
        text: "[gyro]\nrange = \"1 rad/s\"\n",
    };
    let mistake = scene::parts::sources(&unsourced).unwrap_err().to_string();
    assert_eq!(mistake, "x.toml:2:1: `range` needs a `value` and a `source`");
}

#[test]
fn every_part_loads_for_each_of_its_sensors_under_each_of_its_names() {
    for part in parts::all() {
        assert!(!sensors(part).is_empty());
        for (name, kind) in
            part.names.iter().flat_map(|name| sensors(part).into_iter().map(move |kind| (name, kind)))
        {
            let plan = plan(&name.to_lowercase(), kind, "", 1).unwrap_or_else(|error| panic!("{error}"));
            assert_eq!(plan.sensors[0].part, Some(part.names[0]));
            assert_eq!(plan.sensors[0].mount, Some(Mount::flu()), "{name}");
            let terms = plan.build(&plan.sensors[0]).terms().to_vec();
            assert!(terms.ends_with(&["white_noise", "range", "resolution"]), "{name} {kind}: {terms:?}");
        }
    }
}

#[test]
fn at_every_range_a_count_is_the_datasheets() {
    let dps = std::f64::consts::PI / 180.0;
    let g = 9.80665;
    let gyro = [
        ("250 deg/s", dps / 131.0),
        ("500 deg/s", dps / 65.5),
        ("1000 deg/s", dps / 32.8),
        ("2000 deg/s", dps / 16.4),
    ];
    let accel = [("2 g", g / 16384.0), ("4 g", g / 8192.0), ("8 g", g / 4096.0), ("16 g", g / 2048.0)];
    let mag = [("4912 uT", 0.15)];
    for part in parts::all() {
        for kind in sensors(part) {
            let scales: &[(&str, f64)] = match kind {
                SensorKind::Gyro => &gyro,
                SensorKind::Accel => &accel,
                SensorKind::Mag => &mag,
            };
            for (range, count) in scales {
                let plan = plan(part.names[0], kind, &format!("range = \"{range}\""), 1).unwrap();
                let found = lsb(&plan.sensors[0].values, kind).unwrap();
                assert!((found / count - 1.0).abs() < 1e-15, "{} {kind} at {range}: {found}", part.names[0]);
            }
            let default = plan(part.names[0], kind, "", 1).unwrap();
            let found = lsb(&default.sensors[0].values, kind).unwrap();
            assert!((found / scales[scales.len() - 1].1 - 1.0).abs() < 1e-15, "by default the widest");
        }
    }
}

/// N draws uniform in ±a have mean 0 ± a/√(3N) and variance a²/3 · (1 ± √(4/(5N))): the excess kurtosis of the
/// uniform distribution is −6/5. Five sigma are allowed.
fn uniform(draws: &[f64], a: f64) {
    let n = draws.len() as f64;
    let mean = draws.iter().sum::<f64>() / n;
    let variance = draws.iter().map(|x| x * x).sum::<f64>() / n;
    assert!(draws.iter().all(|x| x.abs() <= a));
    assert!(mean.abs() < 5.0 * a / (3.0 * n).sqrt(), "mean {mean} of ±{a}");
    assert!((variance / (a * a / 3.0) - 1.0).abs() < 5.0 * (0.8 / n).sqrt(), "variance {variance} of ±{a}");
}

#[test]
fn a_part_alone_draws_its_turn_on_bias_from_the_tolerance() {
    let dps = std::f64::consts::PI / 180.0;
    let mg = 9.80665e-3;
    for (part, kind, limits) in [
        ("MPU-6050", SensorKind::Gyro, [20.0 * dps; 3]),
        ("MPU-9250", SensorKind::Gyro, [5.0 * dps; 3]),
        ("MPU-6050", SensorKind::Accel, [50.0 * mg, 50.0 * mg, 80.0 * mg]),
        ("MPU-9250", SensorKind::Accel, [60.0 * mg, 60.0 * mg, 80.0 * mg]),
    ] {
        let draw =
            |seed| plan(part, kind, "", seed).unwrap().sensors[0].values.vector("bias").unwrap().to_array();
        let runs: Vec<_> = (0..300).map(draw).collect();
        for axis in 0..3 {
            uniform(&runs.iter().map(|run| run[axis]).collect::<Vec<_>>(), limits[axis] * (1.0 + 1e-12));
        }
    }
}

#[test]
fn the_noise_of_a_part_is_its_density_at_the_rate() {
    for (part, density) in [("MPU-6050", 0.005), ("MPU-9250", 0.01)] {
        let plan = plan(part, SensorKind::Gyro, "", 1).unwrap();
        let sigma =
            white_noise::sigma(&plan.sensors[0].values, SensorKind::Gyro, plan.sensors[0].rate).unwrap();
        assert!((sigma.x.to_degrees() / (density * 50f64.sqrt()) - 1.0).abs() < 1e-14);
    }
}

#[test]
fn a_part_inside_another_is_known_for_its_own_sensor_alone() {
    for part in parts::all() {
        for (name, kind) in part.inside {
            assert_eq!(plan(name, *kind, "", 1).unwrap().sensors[0].part, Some(part.names[0]));
            for other in SensorKind::ALL.into_iter().filter(|other| other != kind) {
                let error = plan(name, other, "", 1).unwrap_err();
                assert!(error.contains("is no part known here"), "{name} as {other}: {error}");
            }
        }
    }
}
