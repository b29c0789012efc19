//! A dataset in RESD, read by a reader written from the format's page, holds the readings of the CSV: at the same times,
//! on the chip's axes, within half a unit.
//!
//! The reader needs Python alone: `RATETABLE_PYTHON`, or `python3`. Where there is none the tests say so and pass, unless
//! `RATETABLE_REQUIRE_PYTHON` is set.

use ratetable::dataset::{self, Format, Options};
use ratetable::scene::Plan;
use serde_json::Value;
use std::env;
use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};

const READER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/resd.py");

/// The interpreter, or `None` after having said that there is none.
fn python() -> Option<String> {
    let python = env::var("RATETABLE_PYTHON").unwrap_or("python3".into());
    let found = Command::new(&python).args(["-c", "import json"]).stderr(Stdio::null()).status();
    if found.is_ok_and(|status| status.success()) {
        return Some(python);
    }
    assert!(env::var_os("RATETABLE_REQUIRE_PYTHON").is_none(), "`{python}` does not start");
    eprintln!("NOT TESTED against another reader: `{python}` does not start");
    None
}

/// Rates with and without a whole number of nanoseconds a sample, a part in a package, a chip on its side, samples that
/// lack, a chip that warms up, sensors that the format has no sample for.
fn scene(axes: &str) -> String {
    format!(
        r#"
axes = "{axes}"
duration = "2 s"
[[motion]]
kind = "circle"
bank = "25 deg"
speed = "15 m/s"
duration = "5 s"
[gyro]
part = "ICM-20948"
rate = "1125 Hz"
temperature = {{ ambient = "25 degC", rise = "15 K", time_constant = "1 s" }}
[accel]
mount = "rbd"
rate = "200 Hz"
noise_std = "0.05 m/s^2"
[mag]
part = "ICM-20948"
rate = "70 Hz"
[baro]
rate = "50 Hz"
noise_std = "3 Pa"
temperature = "12.5 degC"
[gps]
[airspeed]
rate = "20 Hz"
[[fault]]
sensor = "accel"
kind = "intermittent"
share = "20 %"
[[fault]]
sensor = "gyro"
kind = "off"
start = "0.5 s"
duration = "0.25 s"
"#
    )
}

fn write(scene: &str, out: &Path) {
    let plan = Plan::parse(scene, "test", "test", &[]).expect("a scene");
    let formats = ["csv", "resd"].map(|name| Format::from_name(name).expect("a format")).to_vec();
    let mut progress = |_| {};
    dataset::write(&plan, plan.duration, out, Options { formats, ..Options::new(&mut progress) })
        .expect("a dataset");
}

fn reader(python: &str, folder: &Path, axes: &[&str]) -> Output {
    Command::new(python).arg(READER).arg(folder).args(axes).output().expect("the reader starts")
}

fn read(python: &str, folder: &Path, axes: &[&str]) -> Value {
    let output = reader(python, folder, axes);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("a report")
}

/// Which axes of the table the chips' are. In the ICM-20948 the magnetometer's y and z are opposite to the others'.
const NED_FRD: [&str; 4] = ["gyro=+x-y-z", "accel=+y-x+z", "mag=+x+y+z", "baro=pressure"];
const ENU_FLU: [&str; 4] = ["gyro=+x+y+z", "accel=-y-x-z", "mag=+x-y-z", "baro=pressure"];

#[test]
fn another_reader_finds_the_readings_of_the_csv_at_their_times_on_the_chips_axes() {
    let Some(python) = python() else { return };
    let home = tempfile::tempdir().expect("a folder");
    for (axes, chips) in [("ned-frd", NED_FRD), ("enu-flu", ENU_FLU)] {
        let out = home.path().join(axes);
        write(&scene(axes), &out);
        let report = read(&python, &out, &chips);
        let streams = report.as_object().expect("streams");
        let names: Vec<_> = streams.keys().map(String::as_str).collect();
        assert_eq!(names, ["accel", "baro", "gyro", "mag", "temperature:0", "temperature:3"], "{axes}");
        for (name, stream) in streams {
            assert_eq!(stream["wrong"], Value::Array(vec![]), "{axes} {name}");
        }
        let count = |name: &str, what: &str| report[name][what].as_u64().expect("a count");
        assert_eq!((count("baro", "samples"), count("baro", "blocks")), (100, 1));
        assert_eq!(count("gyro", "samples"), 2250 - 281, "281 ticks from 0.5 s on for 0.25 s");
        let accel = count("accel", "samples");
        assert!((270..370).contains(&accel), "four of five: {accel}");
        let manifest = fs::read_to_string(out.join("manifest.json")).expect("a manifest");
        let manifest: Value = serde_json::from_str(&manifest).expect("JSON");
        let all: u64 = streams.keys().map(|name| count(name, "samples")).sum();
        let files = manifest["files"].as_array().expect("files");
        let ours = files.iter().find(|file| file["name"] == "dataset.resd").expect("our file");
        assert_eq!((&ours["format"], ours["rows"].as_u64()), (&Value::from("resd"), Some(all)));
    }
}

/// Negative controls: a reading, a time, an axis and an end that are wrong are found.
#[test]
fn what_is_not_the_readings_of_the_csv_is_found() {
    let Some(python) = python() else { return };
    let home = tempfile::tempdir().expect("a folder");
    let out = home.path().join("out");
    write(&scene("ned-frd"), &out);
    let wrong = |name: &str, axes: &[&str]| {
        read(&python, &out, axes)[name]["wrong"].as_array().expect("mistakes").len()
    };
    let turned = ["gyro=+x+y-z", NED_FRD[1], NED_FRD[2], NED_FRD[3]];
    assert!(wrong("gyro", &turned) > 1000 && wrong("mag", &turned) == 0);

    let path = out.join("mag.csv");
    let text = fs::read_to_string(&path).expect("a table");
    let with = |column: usize, change: fn(f64) -> String| {
        let mut lines: Vec<_> = text.lines().map(String::from).collect();
        let mut fields: Vec<_> = lines[30].split(',').map(String::from).collect();
        fields[column] = change(fields[column].parse().expect("a number"));
        lines[30] = fields.join(",");
        fs::write(&path, lines.join("\n") + "\n").expect("rewritten");
    };
    with(2, |field| (field + 0.002).to_string());
    assert_eq!(wrong("mag", &NED_FRD), 1, "2 nT");
    with(0, |t| (t as i64 + 1).to_string());
    assert_eq!(wrong("mag", &NED_FRD), 1, "1 ns");
    fs::write(&path, &text).expect("as it was");

    let path = out.join("dataset.resd");
    let bytes = fs::read(&path).expect("a file");
    fs::write(&path, &bytes[..bytes.len() - 1]).expect("cut");
    assert!(!reader(&python, &out, &NED_FRD).status.success());
}

#[test]
fn a_dataset_in_resd_alone_knows_how_many_samples_it_has_and_says_why_it_is_not_scored() {
    let home = tempfile::tempdir().expect("a folder");
    let run = |arguments: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_ratetable"));
        command.current_dir(home.path()).args(arguments).output().expect("it runs")
    };
    let made =
        run(&["generate", "coning", "--set", "duration=\"1 s\"", "--format", "resd", "--out", "flight"]);
    assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
    let manifest = fs::read_to_string(home.path().join("flight/manifest.json")).expect("a manifest");
    let manifest: Value = serde_json::from_str(&manifest).expect("JSON");
    for sensor in manifest["sensors"].as_array().expect("sensors") {
        assert_eq!(sensor["samples"].as_f64(), sensor["rate_hz"].as_f64(), "{sensor}");
    }
    let scored = run(&["score", "flight", "vqf"]);
    let told = String::from_utf8_lossy(&scored.stderr).into_owned();
    assert!(scored.status.code() == Some(2) && told.contains("RESD holds the readings"), "{told}");
}
