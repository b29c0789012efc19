//! `ratetable score` as a process: filters and files against a dataset, limits, mistakes, and a ULog that another
//! reader reads as well.
//!
//! The last needs `pyulog`, of `firmware-host-tests/tests/requirements.txt`: `RATETABLE_PYTHON`, which `tests/run.sh`
//! sets. Where there is none the test says so and passes, unless `RATETABLE_REQUIRE_PYTHON` is set.

use assert_cmd::Command;
use glam::{DQuat, DVec3};
use ratetable::dataset::read;
use ratetable::geometry::{Attitude, Axes, Euler, exp};
use ratetable::time::SimTime;
use serde_json::Value;
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Stdio;

fn ratetable(arguments: &[&str]) -> std::process::Output {
    Command::cargo_bin("ratetable").unwrap().args(arguments).output().unwrap()
}

/// A dataset of a scene, and what of the folder is to be kept.
struct Flight {
    home: tempfile::TempDir,
    dir: PathBuf,
}

impl Flight {
    fn of(scene: &str, sets: &[&str]) -> Flight {
        let home = tempfile::tempdir().unwrap();
        let dir = home.path().join("flight");
        let mut arguments = vec!["generate", scene, "--out", dir.to_str().unwrap()];
        sets.iter().for_each(|set| arguments.extend(["--set", set]));
        let output = ratetable(&arguments);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        Flight { home, dir }
    }

    fn path(&self) -> &str {
        self.dir.to_str().unwrap()
    }

    fn truth(&self) -> Vec<(SimTime, Attitude)> {
        read::truth(&self.dir).unwrap().attitudes
    }

    /// A file beside the dataset.
    fn put(&self, name: &str, contents: impl AsRef<[u8]>) -> String {
        let path = self.home.path().join(name);
        fs::write(&path, contents).unwrap();
        path.to_str().unwrap().to_string()
    }

    /// Every tenth attitude of the truth, changed and `late` ns late, as a table in ENU-FLU.
    fn table(&self, name: &str, late: i64, change: impl Fn(f64, DQuat) -> DQuat) -> String {
        let mut text = String::from("t_ns,qw,qx,qy,qz\n");
        for (t, attitude) in self.truth().iter().step_by(10) {
            let changed = Attitude::from_quat(change(t.seconds(), attitude.q));
            let q = Axes::EnuFlu.attitude_out(changed);
            writeln!(text, "{},{},{},{},{}", t.0 + late, q.w, q.x, q.y, q.z).unwrap();
        }
        self.put(name, text)
    }

    fn score(&self, arguments: &[&str]) -> (Value, String, Option<i32>) {
        let output = ratetable(&[&["score", self.path(), "--json"], arguments].concat());
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        (serde_json::from_slice(&output.stdout).unwrap_or(Value::Null), said, output.status.code())
    }
}

fn figure(report: &Value, estimate: &str, field: &str) -> f64 {
    let estimates = report["estimates"].as_array().expect("estimates");
    let found = estimates.iter().find(|found| found["name"] == estimate).expect(estimate);
    let value = field.split('.').fold(found, |value, step| &value[step]);
    value.as_f64().unwrap_or_else(|| panic!("{field} of {found}"))
}

#[test]
fn the_four_filters_are_compared_on_table_1() {
    let flight = Flight::of("table-1", &[]);
    let out = flight.home.path().join("out");
    let names = ["vqf", "fusion", "madgwick", "mahony"];
    let more = ["--settle", "5s", "--out", out.to_str().unwrap()];
    let (report, said, code) = flight.score(&[&names[..], &more].concat());
    assert_eq!(code, Some(0), "{said}");
    for name in names {
        let rms = figure(&report, name, "rms_deg");
        // Gyro biases of 0.03 deg/s against gains of 0.5 rad/s and below: under a degree; noise alone is above 1e-3.
        assert!((1e-3..1.5).contains(&rms), "{name}: {rms}");
        assert!(
            figure(&report, name, "inclination_rms_deg") <= rms && rms <= figure(&report, name, "max_deg")
        );
        assert!(figure(&report, name, "delay_ms") == 0.0 && said.contains(name));
    }
    for file in ["report.json", "errors.csv", "attitude.svg", "error.svg"] {
        assert!(fs::metadata(out.join(file)).unwrap().len() > 1000, "{file}");
    }
    let errors = fs::read_to_string(out.join("errors.csv")).unwrap();
    let samples: f64 = names.iter().map(|name| figure(&report, name, "samples")).sum();
    assert_eq!(errors.lines().count() as f64, samples + 1.0);
    assert!(fs::read_to_string(out.join("attitude.svg")).unwrap().contains("mahony"));
}

#[test]
fn known_errors_delays_and_mistakes_come_back_through_files() {
    let flight = Flight::of("table-1", &[]);
    let turned = |angle: f64| move |_: f64, q: DQuat| exp(DVec3::Z * angle.to_radians()) * q;
    let late = flight.table("late.csv", 42_500_000, turned(2.0));
    let swapped = flight.table("swapped.csv", 0, |_, q| Axes::EnuFlu.attitude_in(q).q);
    let boot = flight.table("boot.csv", 300_000_000_000, turned(0.0));
    let poor = flight.table("poor.csv", 0, |t, q| exp(DVec3::X * 0.5 * libm::sin(0.7 * t)) * q);
    let (report, said, code) = flight.score(&[&late, &swapped, &boot, &poor]);
    assert_eq!(code, Some(0), "{said}");
    // The truth is a table at 1 kHz, interpolated.
    assert!((figure(&report, "late", "delay_ms") - 42.5).abs() < 0.02, "{said}");
    assert!((figure(&report, "late", "fitted.heading_rms_deg") - 2.0).abs() < 1e-3);
    assert!(figure(&report, "late", "fitted.inclination_max_deg") < 2e-3);
    // Nobody asked for it to be taken out.
    assert!(figure(&report, "late", "inclination_max_deg") > 0.5, "{said}");
    assert!((figure(&report, "boot", "clock_offset_s") - 300.0).abs() < 1e-4, "{said}");
    assert!(figure(&report, "boot", "max_deg") < 0.01);
    assert!(said.contains("swapped: estimate looks NED/ENU swapped ("), "{said}");
    assert!(!said.contains("swapped: its delay"), "of a mistaken attitude nothing is said of time: {said}");
    assert!(figure(&report, "poor", "rms_deg") > 10.0 && report["estimates"][3].get("looks").is_none());

    let (report, _, _) = flight.score(&[&late, "--align", "heading"]);
    assert!((figure(&report, "late", "heading_offset_deg") - 2.0).abs() < 0.1);
    assert!(figure(&report, "late", "fitted.rms_deg") < 2e-3);
    // Axes that are said wrong are recognised too.
    let (report, _, _) = flight.score(&[&late, "--axes", "ned-frd"]);
    assert_eq!(report["estimates"][0]["looks"], "NED/ENU swapped");
}

#[test]
fn euler_angles_tum_and_degrees_read_as_radians() {
    let flight = Flight::of("coning", &["axes=\"ned-frd\"", "duration=20 s"]);
    let angles = |name: &str, unit: &str, times: f64| {
        let mut text = format!("t_s,roll_{unit},pitch_{unit},yaw_{unit}\n");
        for (t, attitude) in flight.truth().iter().step_by(7) {
            let Euler { roll, pitch, yaw } = Euler::from_quat(attitude.q);
            // A heading that moves, for the unit to be seen in.
            let [roll, pitch, yaw] = [roll, pitch, yaw].map(|angle| angle * times);
            writeln!(text, "{},{roll},{pitch},{yaw}", t.seconds()).unwrap();
        }
        flight.put(name, text)
    };
    let right = angles("right.csv", "deg", 1f64.to_degrees());
    let mut tum = String::from("# t x y z qx qy qz qw\n");
    for (t, Attitude { q, .. }) in flight.truth().iter().step_by(5) {
        writeln!(tum, "{} 0 0 0 {} {} {} {}", t.seconds(), q.x, q.y, q.z, q.w).unwrap();
    }
    let tum = flight.put("flight.tum", tum);
    let (report, said, code) = flight.score(&[&right, &tum]);
    assert_eq!(code, Some(0), "{said}");
    assert!(
        figure(&report, "right", "max_deg") < 1e-3 && figure(&report, "flight", "max_deg") < 1e-3,
        "{said}"
    );
    let wrong = angles("wrong.csv", "rad", 1f64.to_degrees());
    let (report, said, _) = flight.score(&[&wrong]);
    assert_eq!(report["estimates"][0]["looks"], "in degrees read as radians", "{said}");
}

#[test]
fn a_limit_makes_the_exit_code() {
    let flight = Flight::of("table-1", &["duration=10 s"]);
    for (limit, code) in [
        ("estimates.vqf.rms_deg<5", 0),
        ("rms_deg<5", 0),
        ("estimates.vqf.rms_deg<1e-6", 1),
        ("max_deg<1e-6", 1),
        ("estimates.vqf.nonsense<1", 2),
        ("estimates.ekf.rms_deg<1", 2),
    ] {
        let (report, said, found) = flight.score(&["vqf", "mahony", "--limit", limit]);
        assert_eq!(found, Some(code), "{limit}: {said}");
        assert_eq!(said.contains("FAILED"), code == 1, "{limit}: {said}");
        if code == 1 {
            assert_eq!(report["ok"], false);
        }
    }
}

#[test]
fn what_cannot_be_scored_is_told_in_one_message_each() {
    let flight = Flight::of("table-1", &["duration=2 s"]);
    let empty = flight.put("empty.csv", "");
    let later = flight.put("later.csv", "t_s,qw,qx,qy,qz\n1,1,0,0,0\n");
    for (arguments, says) in [
        (
            vec!["vqd"],
            "`vqd` is neither a file nor a filter (vqf, fusion, madgwick, mahony, eskf, each also with -6d); did you mean `vqf`?",
        ),
        (vec![empty.as_str()], "is empty"),
        (
            vec![later.as_str(), "--settle", "1.5s"],
            "none of its 1 attitudes is at a time that the truth covers",
        ),
        (vec!["vqf", "--axes", "xyz"], "write ned-frd or enu-flu"),
        (vec!["vqf", "--limit", "rms<1"], "`rms` does not exist; name, source, samples, rms_deg"),
        (vec!["vqf", "--limit", "estimates.ekf.rms_deg<1"], "`ekf` does not exist; vqf"),
    ] {
        let (_, said, code) = flight.score(&arguments);
        assert_eq!(code, Some(2), "{arguments:?}: {said}");
        assert!(said.contains(says), "{arguments:?}: {said}");
    }
    let both = flight.score(&["vqd", &empty]).1;
    assert!(both.contains("vqd") && both.contains("is empty"), "every mistake is told: {both}");
    let output = ratetable(&["score", "/nowhere", "vqf"]);
    assert_eq!(output.status.code(), Some(2));
    let truth = flight.dir.join("truth.csv");
    fs::remove_file(flight.dir.join("manifest.json")).unwrap();
    let output = ratetable(&["score", truth.to_str().unwrap(), "vqf"]);
    assert!(String::from_utf8_lossy(&output.stderr).contains("needs readings: give a dataset's folder"));
}

/// A record of a ULog: size, type, payload.
fn record(kind: u8, payload: &[&[u8]]) -> Vec<u8> {
    let payload = payload.concat();
    [&(payload.len() as u16).to_le_bytes()[..], &[kind], &payload].concat()
}

/// A log of PX4's, of the truth from 412 s after boot on, as docs.px4.io has the format.
fn ulog(truth: &[(SimTime, Attitude)]) -> Vec<u8> {
    let mut log = [&b"ULog\x01\x12\x35\x01"[..], &[0; 8]].concat();
    log.extend(record(b'B', &[&[0; 40]]));
    log.extend(record(b'F', &[b"vehicle_attitude:uint64_t timestamp;uint64_t timestamp_sample;float[4] q;"]));
    log.extend(record(b'A', &[&[0, 0, 0], b"vehicle_attitude"]));
    for (t, Attitude { q, .. }) in truth {
        let sampled = 412_000_000 + t.0 as u64 / 1000;
        let q: Vec<u8> = [q.w, q.x, q.y, q.z].iter().flat_map(|c| (*c as f32).to_le_bytes()).collect();
        log.extend(record(b'D', &[&[0, 0], &(sampled + 400).to_le_bytes(), &sampled.to_le_bytes(), &q]));
    }
    log
}

#[test]
fn a_ulog_is_scored_on_its_own_clock_and_another_reader_reads_the_same() {
    let flight = Flight::of("table-1", &[]);
    let truth: Vec<_> = flight.truth().into_iter().step_by(10).collect();
    let log = flight.put("flight.ulg", ulog(&truth));
    let (report, said, code) = flight.score(&[&log]);
    assert_eq!(code, Some(0), "{said}");
    assert!((figure(&report, "flight", "clock_offset_s") - 412.0).abs() < 1e-3, "{said}");
    // Single precision and whole microseconds.
    assert!(figure(&report, "flight", "max_deg") < 0.01, "{said}");
    other_reader(Path::new(&log), &truth);
}

fn other_reader(log: &Path, truth: &[(SimTime, Attitude)]) {
    let python = std::env::var("RATETABLE_PYTHON").unwrap_or("python3".into());
    let script = "import sys, json, pyulog\n\
        d = pyulog.ULog(sys.argv[1]).get_dataset('vehicle_attitude').data\n\
        rows = zip(d['timestamp_sample'], d['q[0]'], d['q[1]'], d['q[2]'], d['q[3]'])\n\
        print(json.dumps([[int(r[0])] + [float(x) for x in r[1:]] for r in rows]))";
    let mut command = std::process::Command::new(&python);
    let output = command.args(["-c", script]).arg(log).stderr(Stdio::piped()).output().unwrap();
    if !output.status.success() {
        let why = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(std::env::var_os("RATETABLE_REQUIRE_PYTHON").is_none(), "{why}");
        eprintln!("NOT TESTED against pyulog: {why}; tests/run.sh makes a Python that can");
        return;
    }
    let rows: Vec<(i64, f32, f32, f32, f32)> = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(rows.len(), truth.len());
    for ((us, w, x, y, z), (t, Attitude { q, .. })) in rows.iter().zip(truth) {
        assert_eq!(*us, 412_000_000 + t.0 / 1000);
        assert_eq!([*w, *x, *y, *z], [q.w, q.x, q.y, q.z].map(|c| c as f32));
    }
}
