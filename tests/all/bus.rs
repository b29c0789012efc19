//! `bus@LINK` as a user meets it: a driver started as the command, the report, the dataset, and what is refused.

use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output};

const CHIPS: [&str; 3] = ["gyro.part=MPU-9250", "accel.part=MPU-9250", "mag.part=MPU-9250"];

/// A driver in a few lines: it wakes the chip, sets ±500 °/s, DLPF 3 and 200 Hz, and reads bursts until the end.
const DRIVER: &str = r#"
import os, sys, time, tty
port = os.open(sys.argv[1], os.O_RDWR | os.O_NOCTTY)
def read(register, count):
    os.write(port, bytes([0x53, 0xd0, 1, register, 0x53, 0xd1, count, 0x50]))
    got = b""
    while len(got) < count:
        got += os.read(port, count - len(got))
    return got
assert read(0x75, 1) == b"\x71"
for register, value in [(0x6b, 1), (0x1b, 8), (0x1a, 3), (0x1d, 3), (0x19, 4)]:
    os.write(port, bytes([0x53, 0xd0, 2, register, value, 0x50]))
try:
    while True:
        read(0x3b, 14)
        time.sleep(0.002)
except OSError:
    pass
"#;

fn ratetable(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_ratetable")).args(arguments).output().unwrap()
}

fn refused(arguments: &[&str]) -> String {
    let output = ratetable(arguments);
    let text = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {text}");
    text
}

/// Runs a scene of two seconds with the driver in `folder`: the report.
fn run(folder: &Path, more: &[&str]) -> Value {
    let (driver, out) = (folder.join("driver.py"), folder.join("out"));
    std::fs::write(&driver, DRIVER).unwrap();
    let sets: Vec<&str> = CHIPS.iter().flat_map(|set| ["--set", set]).collect();
    let output = Command::new(env!("CARGO_BIN_EXE_ratetable"))
        .args([
            "run",
            "table-1",
            "--for",
            "2s",
            "--to",
            "bus@pty",
            "--json",
            "--out",
            &out.display().to_string(),
        ])
        .args(sets)
        .args(more)
        .args(["--", "python3", &driver.display().to_string(), "{}"])
        .output()
        .unwrap();
    let text = String::from_utf8(output.stderr).unwrap();
    serde_json::from_slice(&output.stdout).unwrap_or_else(|error| panic!("{error}: {text}"))
}

#[test]
fn the_report_and_the_dataset_say_how_the_driver_set_and_read_the_chips() {
    let folder = tempfile::tempdir().unwrap();
    let report = run(folder.path(), &["--limit", "sensors.gyro.read.overflowed<1"]);
    assert_eq!(report["ok"], true, "{report:#}");
    assert_eq!(report["settings"][0], "0 s gyro: 200 Hz, ±500 deg/s, low-pass 41 Hz");
    let (gyro, bus) = (&report["sensors"][0], &report["links"][0]["bus"]);
    let count = |value: &Value| value.as_u64().unwrap();
    assert_eq!(gyro["made"], 400);
    let read = &gyro["read"];
    let waiting = count(&gyro["queued"]);
    assert_eq!(count(&read["samples"]) + count(&read["missed"]) + waiting, 400, "{gyro:#}");
    assert_eq!(bus["chips"][0], "MPU-9250 at 0x68 (gyro, accel, mag)");
    assert!(count(&bus["transfers"]) >= count(&read["samples"]), "{bus:#}");
    // The dataset has what the chip measured, says when it was set, and its scene gives the same bytes.
    let out = folder.path().join("out");
    let manifest: Value = serde_json::from_slice(&std::fs::read(out.join("manifest.json")).unwrap()).unwrap();
    let settings = manifest["settings"].as_array().unwrap();
    assert_eq!(
        (&settings[0]["sensor"], &settings[0]["t_ns"], &settings[0]["rate"]),
        (&"gyro".into(), &0.into(), &"200 Hz".into())
    );
    let again = folder.path().join("again");
    let scene = out.join("scene.toml");
    let made = ratetable(&["generate", &scene.display().to_string(), "--out", &again.display().to_string()]);
    assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
    for file in ["gyro.csv", "accel.csv", "truth.csv"] {
        assert_eq!(
            std::fs::read(out.join(file)).unwrap(),
            std::fs::read(again.join(file)).unwrap(),
            "{file}"
        );
    }
    assert_eq!(std::fs::read_to_string(out.join("gyro.csv")).unwrap().lines().count(), 401);
    assert_eq!(std::fs::read_to_string(out.join("mag.csv")).unwrap().lines().count(), 1, "never switched on");
}

#[test]
fn what_a_bus_cannot_do_is_refused_with_what_would_be_right() {
    let with_parts = |more: &[&str]| {
        let sets: Vec<&str> = CHIPS.iter().flat_map(|set| ["--set", set]).collect();
        refused(&[&["run", "table-1", "--to", "bus@pty"], &sets[..], more].concat())
    };
    assert!(refused(&["run", "table-1", "--to", "bus@pty"]).contains("[gyro] has no part"));
    assert!(with_parts(&["--to", "mpu@pty"]).contains("mpu@pty cannot go with bus@pty"));
    assert!(with_parts(&["--speed", "max"]).contains("a driver on a bus asks"));
    assert!(with_parts(&["--attitude", "csv@pty"]).contains("nobody tells an attitude in `csv`"));
    assert!(with_parts(&["--set", "gyro.address=0x40"]).contains("answers at 0x68 or 0x69, not at 0x40"));
    assert!(refused(&["run", "table-1", "--to", "mpu6050-bus@file:x"]).contains("carries no questions"));
    assert!(
        refused(&["run", "table-1", "--to", "mpu9999-bus@pty"]).contains("`mpu9999` is not a known part")
    );
    assert!(
        refused(&[
            "run",
            "table-1",
            "--to",
            "icm42688-bus@pty",
            "--set",
            "gyro.part=MPU-9250",
            "--set",
            "accel.part=MPU-9250",
            "--set",
            "mag.part=MPU-9250"
        ])
        .contains("has no sensor")
    );
    assert!(refused(&["timing", "--to", "bus@pty"]).contains("sends no packets"));
    assert!(with_parts(&["--qgc"]).contains("leave it out"));
    assert!(refused(&["listen", "bus@pty"]).contains("send nothing by themselves"));
}

#[test]
fn a_chip_named_in_the_link_has_no_errors_of_a_part() {
    for (name, chip) in [
        ("lsm6dso", "LSM6DSO at 0x6a (gyro, accel)"),
        ("mpu", "MPU-9250 at 0x68 (gyro, accel, mag)"),
        ("bmi088", "BMI088 at 0x68 and 0x18 (gyro, accel)"),
    ] {
        let to = format!("{name}-bus@pty");
        let output = ratetable(&["run", "table-1", "--to", &to, "--wait", "0", "--for", "50ms", "--json"]);
        let report: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(report["links"][0]["bus"]["chips"], serde_json::json!([chip]), "{report:#}");
    }
}
