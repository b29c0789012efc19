//! The Allan deviation of a part at rest as allantools, a library of another make, computes it: at 0.1, 1 and 10 s
//! within what the length of the run allows, and 10 %, of what the datasheet makes it, whatever the rate.
//!
//! It needs a Python with the packages of `firmware-host-tests/tests/requirements.txt`, like `formats.rs`.

use ratetable::player::{BLOCK, Player};
use ratetable::scene::Plan;
use ratetable::sensor::lsb;
use serde_json::Value;
use std::env;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;
use std::process::{Command, Stdio};

const SCRIPT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/allan.py");

/// The interpreter, or `None` after having said that there is none.
fn python() -> Option<String> {
    let python = env::var("RATETABLE_PYTHON").unwrap_or("python3".into());
    let found = Command::new(&python).args(["-c", "import allantools"]).stderr(Stdio::null()).status();
    if found.is_ok_and(|status| status.success()) {
        return Some(python);
    }
    let why = format!("`{python}` cannot import allantools");
    assert!(env::var_os("RATETABLE_REQUIRE_PYTHON").is_none(), "{why}");
    eprintln!("NOT TESTED against allantools: {why}; tests/run.sh makes a Python that can");
    None
}

/// What a datasheet says of a gyro's noise.
struct Sheet {
    part: &'static str,
    /// One-sided, deg/s/√Hz.
    density: f64,
    /// The least Allan deviation, deg/s.
    stability: f64,
}

const MPU_9250: Sheet = Sheet { part: "MPU-9250", density: 0.01, stability: 0.0 };
const ADIS16470: Sheet = Sheet { part: "ADIS16470", density: 0.008, stability: 8.0 / 3600.0 };

/// A gyro at rest, and the counts that it gives, x, y, z, x …; the size of one in deg/s.
fn play(scene: &str, into: &Path) -> f64 {
    let plan = Plan::parse(scene, "test", "test", &[]).expect("a scene");
    let sensor = &plan.sensors[0];
    let lsb = lsb(&sensor.values, sensor.kind).expect("counts");
    let mut file = BufWriter::new(File::create(into).expect("a file"));
    let mut player = Player::new(&plan, plan.duration, BLOCK);
    while let Some(columns) = player.play_columns(ratetable::motion::Wants::NONE) {
        let [x, y, z] = &columns.sensor(0).reading;
        for ((x, y), z) in x.iter().zip(y).zip(z) {
            for reading in [x, y, z] {
                let count = (reading / lsb).round() as i16;
                file.write_all(&count.to_le_bytes()).expect("written");
            }
        }
    }
    file.flush().expect("written");
    lsb.to_degrees()
}

/// The points of the curve, each with its error and bound.
fn points(python: &str, sheet: &Sheet, rate: u32, seconds: u32, more: &str) -> Vec<Value> {
    let home = tempfile::tempdir().expect("a folder");
    let file = home.path().join("counts");
    let scene = format!(
        "seed = 5\nduration = \"{seconds} s\"\n[gyro]\npart = \"{}\"\nrate = \"{rate} Hz\"\n{more}",
        sheet.part
    );
    let lsb = play(&scene, &file);
    let numbers = [f64::from(rate), lsb, sheet.density, sheet.stability].map(|number| number.to_string());
    let mut command = Command::new(python);
    let output = command.arg(SCRIPT).arg(&file).args(numbers).stderr(Stdio::inherit()).output();
    let output = output.expect("the script starts");
    assert!(output.status.success(), "{}", output.status);
    let points: Vec<Value> = serde_json::from_slice(&output.stdout).expect("points");
    assert_eq!(points.len(), 3);
    points
}

/// Those that are off.
fn off(points: Vec<Value>) -> Vec<Value> {
    let number = |point: &Value, name: &str| point[name].as_f64().expect("a number");
    points.into_iter().filter(|point| number(point, "error").abs() > number(point, "bound")).collect()
}

#[test]
fn allantools_finds_the_datasheets_noise_at_every_rate() {
    let Some(python) = python() else { return };
    for (rate, seconds) in [(100, 6000), (1000, 3000), (8000, 2000)] {
        let points = points(&python, &MPU_9250, rate, seconds, "");
        eprintln!("{rate} Hz: {points:?}");
        let wrong = off(points);
        assert!(wrong.is_empty(), "{rate} Hz: {wrong:?}");
    }
}

#[test]
fn allantools_finds_the_bias_instability_of_the_datasheet_beside_its_noise() {
    let Some(python) = python() else { return };
    // 2 kHz is all that this part gives.
    for (rate, seconds) in [(100, 6000), (1000, 3000), (2000, 2000)] {
        let points = points(&python, &ADIS16470, rate, seconds, "");
        eprintln!("{rate} Hz: {points:?}");
        let wrong = off(points);
        assert!(wrong.is_empty(), "{rate} Hz: {wrong:?}");
    }
}

/// Negative control: noise that is a fifth off, and a bias that wanders where none should, are seen.
#[test]
fn allantools_sees_what_is_not_the_datasheets() {
    let Some(python) = python() else { return };
    for more in ["noise_density = \"0.012 deg/s/√Hz\"\n", "noise_density = \"0.008 deg/s/√Hz\"\n"] {
        assert_eq!(off(points(&python, &MPU_9250, 100, 6000, more)).len(), 3, "{more}");
    }
    let wandering = "bias_random_walk = \"0.003 deg/s/√s\"\n";
    assert!(!off(points(&python, &MPU_9250, 100, 6000, wandering)).is_empty());
    let steady = "bias_instability = \"0.01 deg/h\"\n";
    assert!(!off(points(&python, &ADIS16470, 100, 6000, steady)).is_empty());
}
