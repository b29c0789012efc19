//! Every format of a dataset, read by readers of other makes (numpy, scipy, evo, pyarrow, the `mcap` packages), holds
//! the numbers of the CSV, bit for bit.
//!
//! It needs a Python with the packages of `firmware-host-tests/tests/requirements.txt`: `RATETABLE_PYTHON`, which
//! `tests/run.sh` sets. Where there is none the tests say so and pass, unless `RATETABLE_REQUIRE_PYTHON` is set.

use ratetable::dataset::{self, FORMATS, Format, Options};
use ratetable::geometry::Attitude;
use ratetable::scene::Plan;
use serde_json::Value;
use std::env;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

const READER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/formats.py");

/// The interpreter, or `None` after having said that there is none.
fn python() -> Option<String> {
    let python = env::var("RATETABLE_PYTHON").unwrap_or("python3".into());
    let import = "import numpy, scipy.io, evo, pyarrow.parquet, mcap_ros2";
    let found = Command::new(&python).args(["-c", import]).stderr(Stdio::null()).status();
    if found.is_ok_and(|status| status.success()) {
        return Some(python);
    }
    let why = format!("`{python}` cannot `{import}`");
    assert!(env::var_os("RATETABLE_REQUIRE_PYTHON").is_none(), "{why}");
    eprintln!("NOT TESTED against other readers: {why}; tests/run.sh makes a Python that can");
    None
}

/// Gyro and accelerometer tick alike or not; odd rates, an averaged gyro, a reference, a clipped accelerometer.
fn scene(accel: &str) -> String {
    format!(
        r#"
axes = "enu-flu"
duration = "0.7 s"
[[motion]]
kind = "circle"
bank = "25 deg"
speed = "15 m/s"
duration = "5 s"
[gyro]
rate = "1125 Hz"
sampling = "average"
noise_std = "0.002 rad/s"
bias = "[0, -0.1, 0.2] deg/s"
[accel]
{accel}
range = "10 m/s^2"
noise_std = "0.05 m/s^2"
[mag]
rate = "70 Hz"
noise_density = "0.1 uT/√Hz"
[baro]
rate = "50 Hz"
noise_std = "3 Pa"
[gps]
noise_std = "1 m"
velocity_noise_std = "0.1 m/s"
[reference]
"#
    )
}

fn write(scene: &str, out: &Path) {
    let plan = Plan::parse(scene, "test", "test", &[]).expect("a scene");
    let at = |t| plan.trajectory.at(t).attitude;
    let ticks = (0..50u64).map(|k| plan.sensors[0].rate.tick(7 * k));
    let estimates: Vec<_> = ticks.map(|t| (t, at(t))).chain([(plan.duration, Attitude::IDENTITY)]).collect();
    let formats = FORMATS.to_vec();
    let mut progress = |_| {};
    let options = Options { formats, estimates: &estimates, ..Options::new(&mut progress) };
    dataset::write(&plan, plan.duration, out, options).expect("a dataset");
}

/// Every format with the numbers of the CSV; those of RESD are rounded, and have a test of their own.
fn others() -> impl Iterator<Item = &'static Format> {
    FORMATS.iter().copied().filter(|format| !["csv", "resd"].contains(&format.name))
}

fn read(python: &str, folder: &Path) -> Value {
    let mut command = Command::new(python);
    command.arg(READER).arg(folder).args(others().map(|format| format.name));
    // evo keeps settings at home.
    command.env("HOME", folder);
    let output = command.stderr(Stdio::inherit()).output().expect("the reader starts");
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{}: {said}", output.status);
    serde_json::from_str(&said).expect("a report")
}

/// Samples of either that the other one has.
const WITHHELD: &str = r#"
[[fault]]
sensor = "gyro"
kind = "intermittent"
share = "20 %"
[[fault]]
sensor = "accel"
kind = "intermittent"
share = "20 %"
[[fault]]
sensor = "accel"
kind = "off"
start = "0.6 s"
"#;

#[test]
fn other_readers_find_the_numbers_of_the_csv_bit_for_bit() {
    let Some(python) = python() else { return };
    let home = tempfile::tempdir().expect("a folder");
    let alike = scene("rate = \"1125 Hz\"");
    for (name, scene) in [
        ("withheld", format!("{alike}{WITHHELD}")),
        ("alike", alike),
        ("apart", scene("rate = \"400/3 Hz\"\nphase = \"1.5 ms\"")),
    ] {
        let out = home.path().join(name);
        write(&scene, &out);
        let report = read(&python, &out);
        for format in others() {
            let found = &report[format.name];
            assert_eq!(found["wrong"], Value::Array(vec![]), "{} {name}", format.name);
            // At least the truth's time and attitude.
            assert!(
                found["same"].as_u64().is_some_and(|same| same > 5 * 780),
                "{} {name}: {found}",
                format.name
            );
        }
    }
}

#[test]
fn a_number_off_by_one_bit_is_found_in_every_format() {
    let Some(python) = python() else { return };
    let home = tempfile::tempdir().expect("a folder");
    let out = home.path().join("out");
    write(&scene("rate = \"1125 Hz\""), &out);
    let path = out.join("truth.csv");
    let text = fs::read_to_string(&path).expect("a truth");
    let mut lines: Vec<_> = text.lines().map(String::from).collect();
    let mut fields: Vec<_> = lines[300].split(',').map(String::from).collect();
    let qw: f64 = fields[1].parse().expect("qw");
    fields[1] = f64::from_bits(qw.to_bits() + 1).to_string();
    lines[300] = fields.join(",");
    fs::write(&path, lines.join("\n") + "\n").expect("rewritten");
    let report = read(&python, &out);
    for format in others() {
        let wrong = report[format.name]["wrong"].as_array().map_or(0, Vec::len);
        assert_eq!(wrong, 1, "{}: {}", format.name, report[format.name]);
    }
}
