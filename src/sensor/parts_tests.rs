//! The data files of parts: every value has a source, every part loads, and its counts are the datasheet's.

use super::parts;
use super::*;
use crate::keys::Name;
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
            let places = [" p. ", " page of ", " section ", " specifications"];
            let has_place = places.iter().any(|place| value.source.contains(place));
            assert!(
                has_place || value.source.starts_with("assumed: "),
                "{} {}.{}: `{}`",
                part.file,
                value.sensor,
                value.key,
                value.source
            );
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

const DPS: f64 = std::f64::consts::PI / 180.0;
const G: f64 = 9.80665;
const MPU_GYRO: &[(&str, f64)] = &[
    ("250 deg/s", DPS / 131.0),
    ("500 deg/s", DPS / 65.5),
    ("1000 deg/s", DPS / 32.8),
    ("2000 deg/s", DPS / 16.4),
];
const BOSCH_GYRO: &[(&str, f64)] = &[
    ("125 deg/s", DPS / 262.144),
    ("250 deg/s", DPS / 131.072),
    ("500 deg/s", DPS / 65.536),
    ("1000 deg/s", DPS / 32.768),
    ("2000 deg/s", DPS / 16.384),
];
const ACCEL: &[(&str, f64)] =
    &[("2 g", G / 16384.0), ("4 g", G / 8192.0), ("8 g", G / 4096.0), ("16 g", G / 2048.0)];
/// Ranges and counts, of each part's sensors, the widest last.
type Scales = &'static [(&'static str, f64)];
const SCALES: &[(&str, Scales, Scales, Scales)] = &[
    ("MPU-6050", MPU_GYRO, ACCEL, &[]),
    ("MPU-6500", MPU_GYRO, ACCEL, &[]),
    ("MPU-9250", MPU_GYRO, ACCEL, &[("4912 uT", 0.15)]),
    ("ICM-20948", MPU_GYRO, ACCEL, &[("4900 uT", 0.15)]),
    (
        "ICM-42688-P",
        &[("15.625 deg/s", DPS / 2097.2), ("125 deg/s", DPS / 262.0), ("2000 deg/s", DPS / 16.4)],
        ACCEL,
        &[],
    ),
    ("BMI088", BOSCH_GYRO, &[("3 g", G / 10920.0), ("24 g", G / 1365.0)], &[]),
    (
        "BMI160",
        &[("125 deg/s", DPS / 262.4), ("500 deg/s", DPS / 65.6), ("2000 deg/s", DPS / 16.4)],
        ACCEL,
        &[],
    ),
    ("BMI270", BOSCH_GYRO, ACCEL, &[]),
    (
        "LSM6DSO",
        &[("125 deg/s", 4.375e-3 * DPS), ("500 deg/s", 17.5e-3 * DPS), ("2000 deg/s", 70e-3 * DPS)],
        &[("2 g", 0.061e-3 * G), ("16 g", 0.488e-3 * G)],
        &[],
    ),
    (
        "LSM9DS1",
        &[("245 deg/s", 8.75e-3 * DPS), ("500 deg/s", 17.5e-3 * DPS), ("2000 deg/s", 70e-3 * DPS)],
        &[("2 g", 0.061e-3 * G), ("16 g", 0.732e-3 * G)],
        &[("4 G", 0.014), ("16 G", 0.058)],
    ),
    ("ADIS16470", &[("2000 deg/s", 0.1 * DPS)], &[("40 g", G / 800.0)], &[]),
];

#[test]
fn at_every_range_a_count_is_the_datasheets() {
    assert_eq!(SCALES.len(), parts::all().len());
    for (name, gyro, accel, mag) in SCALES {
        for (kind, scales) in SensorKind::ALL.into_iter().zip([gyro, accel, mag]) {
            for (range, count) in *scales {
                let plan = plan(name, kind, &format!("range = \"{range}\""), 1).unwrap();
                let found = lsb(&plan.sensors[0].values, kind).unwrap();
                assert!((found / count - 1.0).abs() < 1e-14, "{name} {kind} at {range}: {found}");
            }
            let Some((_, widest)) = scales.last() else { continue };
            let default = plan(name, kind, "", 1).unwrap();
            let found = lsb(&default.sensors[0].values, kind).unwrap();
            assert!((found / widest - 1.0).abs() < 1e-14, "by default the widest");
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
        let draw = |seed| plan(part, kind, "", seed).unwrap().sensors[0].values.get(BIAS).unwrap().to_array();
        let runs: Vec<_> = (0..300).map(draw).collect();
        for axis in 0..3 {
            uniform(&runs.iter().map(|run| run[axis]).collect::<Vec<_>>(), limits[axis] * (1.0 + 1e-12));
        }
    }
}

/// Every other value that is drawn is within its tolerance too, with either sign, and differs from axis to axis.
#[test]
fn a_scale_and_a_misalignment_are_drawn_from_the_tolerance_with_either_sign() {
    let scale_error = Name::<DVec3>::new("scale_error");
    for (part, kind, key, limit) in [
        ("MPU-6050", SensorKind::Gyro, scale_error, 0.03),
        ("MPU-9250", SensorKind::Accel, scale_error, 0.03),
        ("ICM-20948", SensorKind::Accel, scale_error, 0.005),
        ("MPU-9250", SensorKind::Gyro, Name::new("misalignment"), 0.02),
        ("MPU-6050", SensorKind::Gyro, NONLINEARITY, 0.002),
    ] {
        let draw = |seed| plan(part, kind, "", seed).unwrap().sensors[0].values.get(key).unwrap().to_array();
        let runs: Vec<_> = (0..300).map(draw).collect();
        for axis in 0..3 {
            uniform(&runs.iter().map(|run| run[axis]).collect::<Vec<_>>(), limit * (1.0 + 1e-12));
        }
    }
    let draw =
        |seed| plan("MPU-6050", SensorKind::Gyro, "", seed).unwrap().sensors[0].values.get(G_SENSITIVITY);
    let runs: Vec<_> = (0..300).filter_map(draw).collect();
    let limit = 0.1 * DPS / G * (1.0 + 1e-12);
    for axis in 0..3 {
        uniform(&runs.iter().map(|run| run.col(axis)[axis]).collect::<Vec<_>>(), limit);
        assert!(runs.iter().all(|run| run.col(axis)[(axis + 1) % 3] == 0.0), "along the same axis alone");
    }
}

#[test]
fn a_temperature_coefficient_of_a_sheet_acts_where_the_scene_gives_a_temperature() {
    let terms = |more: &str| {
        let plan = plan("MPU-9250", SensorKind::Gyro, more, 1).unwrap();
        plan.build(&plan.sensors[0]).terms().to_vec()
    };
    assert!(!terms("").iter().any(|term| term.ends_with("temperature")));
    assert!(terms("temperature = \"50 degC\"").contains(&"bias_temperature"));
    assert!(terms("temperature = \"50 degC\"").contains(&"scale_temperature"));
}

#[test]
fn the_noise_of_a_part_is_its_density_at_the_rate() {
    for (part, density) in [
        ("MPU-6050", 0.005),
        ("MPU-6500", 0.01),
        ("MPU-9250", 0.01),
        ("ICM-20948", 0.015),
        ("ICM-42688-P", 0.0028),
        ("BMI088", 0.014),
        ("BMI160", 0.007),
        ("BMI270", 0.007),
        ("LSM6DSO", 0.0038),
        ("ADIS16470", 0.008),
    ] {
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
            assert_eq!(plan(name, *kind, "", 1).unwrap().sensors[0].part, Some(*name));
            for other in SensorKind::TRIADS.into_iter().filter(|other| other != kind) {
                let error = plan(name, other, "", 1).unwrap_err();
                assert!(error.contains("is not a known part"), "{name} as {other}: {error}");
            }
        }
    }
}

#[test]
fn every_setting_has_a_source_and_every_filter_a_rate_that_the_part_has() {
    for part in parts::all() {
        for kind in sensors(part) {
            let settings = scene::parts::settings(part, kind).unwrap_or_else(|mistake| panic!("{mistake}"));
            assert!(!settings.scales.is_empty() && !settings.rates.is_empty(), "{} {kind}", part.file);
            for filter in &settings.filters {
                assert!(filter.low_pass > 0.0);
                for at in &filter.at {
                    let known = settings.rates.iter().any(|output| output.rate == *at);
                    assert!(known, "{} {kind}: {filter}", part.file);
                }
            }
        }
    }
    for (text, says) in [
        ("[gyro]\nrates = 3\n", "x.toml:2:1: `rates` of gyro needs a `source`"),
        ("[gyro]\nrates = { settings = [] }\n", "x.toml:2:1: `rates` of gyro needs a `source`"),
        (
            "[gyro]\nrates = { source = \"s\", settings = [{ rate = \"3 kg\" }] }\n",
            "x.toml:2:37: this is not a setting",
        ),
    ] {
        let part = parts::Part { names: &["X"], inside: &[], about: "", file: "x.toml", text };
        let mistake = scene::parts::settings(&part, SensorKind::Gyro).unwrap_err().to_string();
        assert!(mistake.starts_with(says), "{mistake}");
    }
}

/// SMPLRT_DIV of the MPU family, GYRO_SMPLRT_DIV of the ICM-20948, the lists of the others: what they output is
/// played without a word, what they do not with their nearest rates.
#[test]
fn a_rate_that_the_part_has_not_is_told_with_its_nearest_ones() {
    let warnings = |part: &str, kind, rate: &str, more: &str| {
        let text = format!("duration = \"1 s\"\n[{kind}]\npart = \"{part}\"\nrate = \"{rate}\"\n{more}");
        Plan::parse(&text, "s.toml", "s", &[]).unwrap_or_else(|error| panic!("{error}")).warnings
    };
    use SensorKind::{Accel, Gyro, Mag};
    let dlpf_2 = "filter = \"DLPF 2\"\n";
    for (part, kind, rate, more) in [
        ("MPU-6050", Gyro, "8 kHz", ""),
        ("MPU-6050", Gyro, "2 kHz", ""),
        ("MPU-6050", Gyro, "500 Hz", "filter = \"DLPF 0\"\n"),
        ("MPU-6050", Accel, "4 Hz", ""),
        ("MPU-9250", Gyro, "32 kHz", ""),
        ("MPU-9250", Gyro, "1000/7 Hz", dlpf_2),
        ("MPU-9250", Accel, "4 kHz", ""),
        ("MPU-9250", Mag, "100 Hz", ""),
        ("ICM-20948", Gyro, "1125/11 Hz", "filter = \"DLPF 5\"\n"),
        ("ICM-20948", Gyro, "102.27 Hz", ""),
        ("ICM-42688-P", Gyro, "8 kHz", "filter = \"fixed\"\n"),
        ("MPU-6500", Gyro, "200 Hz", dlpf_2),
        ("MPU-6500", Accel, "4 kHz", "filter = \"Fchoice 0\"\n"),
        ("BMI160", Gyro, "3200 Hz", "filter = \"OSR2\"\n"),
        ("BMI160", Accel, "0.78125 Hz", ""),
        ("BMI270", Gyro, "1600 Hz", "filter = \"normal\"\n"),
        ("LSM6DSO", Gyro, "6664 Hz", "filter = \"LPF1 FTYPE 3\"\n"),
        ("LSM6DSO", Accel, "1.6 Hz", ""),
        ("BMI088", Accel, "12.5 Hz", "filter = \"OSR4\"\n"),
        ("LSM9DS1", Gyro, "59.5 Hz", ""),
        ("ADIS16470", Gyro, "2000/3 Hz", ""),
    ] {
        assert_eq!(warnings(part, kind, rate, more), [""; 0], "{part} {kind} {rate}");
    }
    for (part, kind, rate, more, says) in [
        ("MPU-9250", Gyro, "900 Hz", "", "are 500 Hz and 1000 Hz; it plays at 900 Hz anyway"),
        ("MPU-9250", Gyro, "8 kHz", dlpf_2, "with its filter `DLPF 2`: the nearest is 1000 Hz"),
        ("MPU-9250", Gyro, "500 Hz", "filter = \"DLPF 0\"\n", "the nearest is 8000 Hz"),
        ("MPU-9250", Mag, "50 Hz", "", "no mag samples at 50 Hz: the nearest are 8 Hz and 100 Hz"),
        ("MPU-6050", Accel, "2 kHz", "", "the nearest is 1000 Hz"),
        ("ICM-20948", Gyro, "1 kHz", "", "the nearest are 1125/2 Hz and 1125 Hz"),
        ("ICM-42688-P", Gyro, "400 Hz", "", "the nearest are 200 Hz and 500 Hz"),
        ("BMI270", Accel, "1 kHz", "", "the nearest are 800 Hz and 1600 Hz"),
        ("LSM6DSO", Gyro, "1 kHz", "", "the nearest are 833 Hz and 1666 Hz"),
        ("ADIS16470", Gyro, "8 kHz", "", "the nearest is 2000 Hz"),
    ] {
        let told = warnings(part, kind, rate, more);
        assert!(told.len() == 1 && told[0].starts_with("s.toml:4:8: ") && told[0].contains(says), "{told:?}");
    }
    assert_eq!(warnings("MPU-9250", Gyro, "900 Hz", "filter = \"33 Hz\"\n").len(), 1, "whatever the cut-off");
}

/// One name, another bandwidth at another rate: DS-000347 section 5.5, BST-BMI088-DS001 table 8, DS12140 tables 18 and 65.
#[test]
fn a_named_filter_is_the_one_of_the_rate() {
    let found = |part: &str, kind, rate: &str, name: &str| {
        let text = format!(
            "duration = \"1 s\"\n[{kind}]\npart = \"{part}\"\nrate = \"{rate}\"\nfilter = \"{name}\"\n"
        );
        let plan = Plan::parse(&text, "s.toml", "s", &[]).unwrap_or_else(|error| panic!("{error}"));
        let again = Plan::parse(&plan.resolved, "s.toml", "s", &[]).unwrap();
        let of = |plan: &Plan| {
            let values = &plan.sensors[0].values;
            let filter = values.get(FILTER).unwrap();
            (filter.get(LOW_PASS).unwrap(), filter.get(Name::<u64>::new("order")), delay(values))
        };
        assert_eq!(of(&plan), of(&again), "as resolved");
        of(&plan)
    };
    use SensorKind::{Accel, Gyro};
    for (part, kind, rate, name, hz, order, ms) in [
        ("ICM-42688-P", Gyro, "1 kHz", "BW 1", 230.7, 2, 2.1),
        ("ICM-42688-P", Accel, "500 Hz", "bw 1", 115.3, 2, 4.1),
        ("ICM-42688-P", Gyro, "25 Hz", "BW 15", 52.4, 2, 7.5),
        ("ICM-42688-P", Gyro, "1 kHz", "BW 1 order 1", 227.2, 1, 1.8),
        ("ICM-42688-P", Accel, "100 Hz", "BW 7 order 3", 10.1, 2, 35.2),
        ("ICM-42688-P", Gyro, "8 kHz", "fixed", 2096.3, 2, 0.2),
        ("BMI088", Accel, "400 Hz", "OSR2", 75.0, 2, 0.0),
        ("BMI270", Gyro, "200 Hz", "normal", 77.0, 2, 5.97),
        ("BMI270", Gyro, "200 Hz", "OSR4", 20.0, 2, 0.0),
        ("BMI270", Accel, "1600 Hz", "OSR2", 343.0, 2, 0.0),
        ("BMI160", Accel, "1600 Hz", "normal", 684.0, 2, 0.0),
        ("BMI160", Accel, "50 Hz", "OSR4", 5.06, 2, 0.0),
        ("LSM6DSO", Gyro, "6664 Hz", "LPF1 FTYPE 0", 335.5, 2, 0.0),
        ("LSM6DSO", Gyro, "416 Hz", "LPF2", 135.9, 2, 0.0),
        ("LSM6DSO", Accel, "104 Hz", "LPF2 ODR/4", 26.0, 2, 0.0),
        ("MPU-6500", Accel, "1 kHz", "DLPF 7", 460.0, 1, 1.94),
        ("ICM-20948", Gyro, "1125 Hz", "DLPF 3", 51.2, 1, 0.0),
        ("MPU-9250", Accel, "1 kHz", "DLPF 3", 44.8, 1, 4.88),
    ] {
        let (low_pass, of_order, rest) = found(part, kind, rate, name);
        assert_eq!((low_pass, of_order.unwrap_or(1)), (hz, order), "{part} {kind} {rate}");
        let own =
            1e3 * if order == 2 { std::f64::consts::SQRT_2 } else { 1.0 } / (std::f64::consts::TAU * hz);
        let total = own + rest.seconds() * 1e3;
        assert!((total - f64::max(ms, own)).abs() < 1e-5, "{part} {kind} {rate}: {total} ms");
    }
}

/// The filter of Bosch's sensors at an oversampling of 2 or 4 is the normal one of half or a quarter of the rate:
/// BST-BMI160-DS000 section 2.4.1.1.
#[test]
fn oversampling_is_the_normal_filter_of_a_slower_rate() {
    for part in ["BMI160", "BMI270"] {
        for kind in [SensorKind::Gyro, SensorKind::Accel] {
            let settings = scene::parts::settings(parts::find(part, kind).unwrap(), kind).unwrap();
            let low_pass = |name: &str, rate: f64| {
                let is = |filter: &&scene::parts::Filter| filter.name == name && filter.at[0].as_hz() == rate;
                settings.filters.iter().find(is).map(|filter| filter.low_pass)
            };
            let mut compared = 0;
            for filter in settings.filters.iter().filter(|filter| filter.name != "normal") {
                let (rate, by) = (filter.at[0].as_hz(), if filter.name == "OSR2" { 2.0 } else { 4.0 });
                let Some(normal) = low_pass("normal", rate / by) else { continue };
                assert_eq!(filter.low_pass, normal, "{part} {kind}: {filter}");
                compared += 1;
            }
            assert_eq!(compared, 7 + 6, "{part} {kind}: of eight rates, all but the slowest");
        }
    }
}

/// Bandwidth and delay of each DLPF_CFG: RM-MPU-9250A r1.4 p. 13, RM-MPU-6000A r4.2 p. 13.
#[test]
fn a_named_filter_has_the_bandwidth_and_the_delay_of_the_register_map() {
    for (part, kind, settings) in [
        (
            "MPU-9250",
            SensorKind::Gyro,
            [(250.0, 0.97), (184.0, 2.9), (92.0, 3.9), (41.0, 5.9), (20.0, 9.9), (10.0, 17.85), (5.0, 33.48)],
        ),
        (
            "MPU-6050",
            SensorKind::Accel,
            [(260.0, 0.0), (184.0, 2.0), (94.0, 3.0), (44.0, 4.9), (21.0, 8.5), (10.0, 13.8), (5.0, 19.0)],
        ),
    ] {
        for (i, (hz, ms)) in settings.into_iter().enumerate() {
            let plan = plan(part, kind, &format!("filter = \"dlpf {i}\""), 1).unwrap();
            let values = &plan.sensors[0].values;
            let low_pass = values.get(FILTER).and_then(|filter| filter.get(LOW_PASS)).unwrap();
            assert_eq!(low_pass, hz, "{part} {i}");
            let own = 1e3 / (std::f64::consts::TAU * hz);
            let total = delay(values).seconds() * 1e3 + own;
            assert!((total - f64::max(ms, own)).abs() < 1e-5, "{part} {i}: {total} ms");
            let terms = plan.build(&plan.sensors[0]).terms().to_vec();
            assert!(terms.contains(&"filter"), "{terms:?}");
        }
    }
    let mine = plan("MPU-9250", SensorKind::Gyro, "filter = \"DLPF 3\"\ndelay = \"1 ms\"", 1).unwrap();
    assert_eq!(delay(&mine.sensors[0].values), SimTime(1_000_000), "one's own delay wins");
    let cut_off = plan("MPU-9250", SensorKind::Gyro, "filter = \"33 Hz\"", 1).unwrap();
    assert_eq!(delay(&cut_off.sensors[0].values), SimTime::ZERO);
    let error = plan("MPU-9250", SensorKind::Gyro, "filter = \"DLPF 9\"", 1).unwrap_err();
    assert!(error.contains("`DLPF 9` is not a setting of the part: choose one of DLPF 0, "), "{error}");
    assert_eq!(error.lines().count(), 1, "said once: {error}");
}
