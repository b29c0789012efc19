//! `ratetable score` on clocks, units and delays: what real controllers told of their attitude since boot, files whose
//! times name no unit, estimates that are late, and what nothing can tell.
//!
//! `tests/controllers` holds the attitudes that PX4 and ArduPilot told while they were fed the scene beside them, in
//! seconds or microseconds since their boot.

use assert_cmd::Command;
use glam::{DQuat, DVec3};
use ratetable::dataset::read;
use ratetable::geometry::{Attitude, exp};
use ratetable::scene::Plan;
use ratetable::time::SimTime;
use serde_json::Value;
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

/// The report, what was said, the exit code.
struct Scored {
    report: Value,
    said: String,
    code: Option<i32>,
}

impl Scored {
    /// A field of the first estimate, by its dotted name.
    fn figure(&self, field: &str) -> f64 {
        self.field(field).as_f64().unwrap_or_else(|| panic!("{field}: {} {}", self.report, self.said))
    }

    fn field(&self, field: &str) -> &Value {
        field.split('.').fold(&self.report["estimates"][0], |value, step| &value[step])
    }
}

fn score(arguments: &[&str]) -> Scored {
    let output =
        Command::cargo_bin("ratetable").unwrap().arg("score").args(arguments).arg("--json").output().unwrap();
    Scored {
        report: serde_json::from_slice(&output.stdout).unwrap_or_default(),
        said: String::from_utf8_lossy(&output.stderr).into_owned(),
        code: output.status.code(),
    }
}

struct Bench {
    home: tempfile::TempDir,
}

impl Bench {
    fn new() -> Bench {
        Bench { home: tempfile::tempdir().unwrap() }
    }

    /// A dataset of a scene.
    fn dataset(&self, scene: &str, sets: &[&str]) -> PathBuf {
        let dir = self.home.path().join("dataset");
        let mut command = Command::cargo_bin("ratetable").unwrap();
        command.args(["generate", scene, "--force", "--out"]).arg(&dir);
        sets.iter().for_each(|set| _ = command.args(["--set", set]));
        command.assert().success();
        dir
    }

    fn put(&self, name: &str, text: &str) -> String {
        let path = self.home.path().join(name);
        fs::write(&path, text).unwrap();
        path.display().to_string()
    }
}

fn near(value: f64, right: f64) -> bool {
    (value - right).abs() <= (0.03 * right).max(0.02)
}

/// A quaternion as a row has it.
fn row(t: impl std::fmt::Display, q: DQuat) -> String {
    format!("{t},{},{},{},{}\n", q.w, q.x, q.y, q.z)
}

#[test]
fn real_controllers_are_judged_on_their_own_clock() {
    // Right values by an independent scorer that matches angular rates: offset s, RMS, inclination, heading, deg.
    for (case, offset, rms, inclination, heading) in [
        ("ardupilot-magnetic-disturbance", 5.60, 11.71, 0.227, 11.71),
        ("ardupilot-coning-mems", 5.64, 0.363, 0.251, 0.262),
        ("px4-level-then-turn", 8.11, 2.54, 0.638, 2.45),
        ("px4-vibration", 25.91, 3.96, 3.29, 2.20),
    ] {
        let bench = Bench::new();
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/controllers").join(case);
        let truth = bench.dataset(folder.join("scene.toml").to_str().unwrap(), &[]);
        let scored = score(&[truth.to_str().unwrap(), folder.join("estimate.csv").to_str().unwrap()]);
        assert_eq!(scored.code, Some(0), "{case}: {}", scored.said);
        assert!((scored.figure("clock_offset_s") - offset).abs() < 0.05, "{case}: {}", scored.said);
        for (field, right) in
            [("rms_deg", rms), ("inclination_rms_deg", inclination), ("heading_rms_deg", heading)]
        {
            let value = scored.figure(field);
            assert!(near(value, right), "{case}: {field} {value}, not {right}: {}", scored.said);
        }
        assert!(scored.figure("coverage") > 0.98 && scored.field("fitted").is_null(), "{case}");
        assert!(scored.said.contains("its delay is part of that"), "{}", scored.said);
    }
}

#[test]
fn a_clock_ahead_is_found_whatever_else_is_wrong() {
    let bench = Bench::new();
    let truth = bench.dataset("level-then-turn", &[]);
    let rows = read::truth(&truth).unwrap().attitudes;
    let ahead = |seconds: f64, change: &dyn Fn(DQuat) -> DQuat| {
        let mut text = String::from("t_s,qw,qx,qy,qz\n");
        for (t, Attitude { q, .. }) in rows.iter().step_by(16) {
            text += &row(t.seconds() + seconds, change(*q));
        }
        text
    };
    // The scene's seconds and the controller's overlap: that says nothing.
    for seconds in [5.63, -12.5, 700.0] {
        let same = bench.put("same.csv", &ahead(seconds, &|q| q));
        let scored = score(&[truth.to_str().unwrap(), &same]);
        assert!((scored.figure("clock_offset_s") - seconds).abs() < 1e-3, "{}", scored.said);
        assert!(scored.figure("rms_deg") < 0.01 && scored.field("clock_certain") == true);
        let turned = bench.put("turned.csv", &ahead(seconds, &|q| exp(DVec3::Z * 2.0) * q));
        let scored = score(&[truth.to_str().unwrap(), &turned]);
        assert!((scored.figure("clock_offset_s") - seconds).abs() < 1e-3, "{}", scored.said);
        assert!(near(scored.figure("rms_deg"), 2f64.to_degrees()), "{}", scored.said);
        assert!(scored.said.contains("--align heading removes it"), "{}", scored.said);
        // On request the times are taken for the truth's.
        let scored = score(&[truth.to_str().unwrap(), &same, "--clock", "truth"]);
        assert!(scored.code != Some(0) || scored.figure("rms_deg") > 1.0, "{}", scored.said);
    }
}

#[test]
fn what_cannot_be_known_is_no_figure_but_exit_code_1() {
    let bench = Bench::new();
    // Turns that come again and again, each from where the one before ended.
    let turn = "[[motion]]\nkind = \"rotate\"\nyaw = \"30 deg/s\"\nduration = \"2 s\"\n[[motion]]\nkind = \"hold\"\nduration = \"2 s\"\n";
    let scene = bench.put("turns.toml", &(turn.repeat(10) + "[gyro]\nrate = \"100 Hz\"\n"));
    let truth = bench.dataset(&scene, &[]);
    let rows = read::truth(&truth).unwrap().attitudes;
    let table = |seconds: f64| {
        let mut text = String::from("t_s,qw,qx,qy,qz\n");
        rows.iter().step_by(2).for_each(|(t, at)| {
            text += &row(t.seconds() + seconds, exp(DVec3::Z * 0.1) * at.q * exp(DVec3::X * 0.1))
        });
        text
    };
    let other = bench.put("other.csv", &table(5.63));
    let scored = score(&[truth.to_str().unwrap(), &other]);
    assert_eq!(scored.code, Some(1), "{}", scored.said);
    assert!(scored.field("rms_deg").is_null(), "no figure: {}", scored.report);
    assert!(
        scored.said.contains("the motion repeats") && scored.said.contains("--clock truth"),
        "{}",
        scored.said
    );
    // A limit of what is not known is not kept.
    let limited = score(&[truth.to_str().unwrap(), &other, "--limit", "rms_deg<1000"]);
    assert!(limited.code == Some(1) && limited.said.contains("not known"), "{}", limited.said);
    // That its times begin and end with the truth's is told, and enough.
    let own = bench.put("own.csv", &table(0.0));
    let scored = score(&[truth.to_str().unwrap(), &own]);
    assert_eq!(scored.code, Some(0), "{}", scored.said);
    assert!(scored.said.contains("start and end with the truth's"), "{}", scored.said);
    // And so is the rest before, where a run's report says how long it was.
    let mut text = String::from("t_s,qw,qx,qy,qz\n");
    let (_, first) = rows[0];
    (0..500).for_each(|k| text += &row(f64::from(k) * 0.02 - 10.0 + 5.63, first.q));
    rows.iter().step_by(2).for_each(|(t, at)| text += &row(t.seconds() + 5.63, at.q));
    let rested = bench.put("rested.csv", &text);
    fs::write(truth.join("report.json"), "{\"rest_s\": 12.0}").unwrap();
    let scored = score(&[truth.to_str().unwrap(), &rested]);
    assert!((scored.figure("clock_offset_s") - 5.63).abs() < 0.005, "{}", scored.said);
}

#[test]
fn a_unit_of_time_that_is_not_named_is_the_one_in_which_files_overlap() {
    let bench = Bench::new();
    let motion = |t: f64| {
        exp(DVec3::new(0.4 * (0.7 * t).sin(), 0.0, 0.0)) * exp(DVec3::Z * (0.3 * t + 0.5 * (0.2 * t).sin()))
    };
    let table = |header: &str, per_second: f64, step: f64, from: f64, count: i32, late: f64| {
        let mut text = format!("{header},qw,qx,qy,qz\n");
        for k in 0..count {
            let t = from + f64::from(k) * step;
            text += &row((t * per_second).round(), motion(t - late));
        }
        text
    };
    let us = bench.put("us_100hz.csv", &table("timestamp", 1e6, 0.01, 1.0, 2001, 0.0));
    let us_10 = bench.put("us_10hz.csv", &table("timestamp", 1e6, 0.1, 1.0, 201, 0.0));
    let scored = score(&[&us, &us_10]);
    assert!(scored.figure("samples") == 201.0 && scored.figure("max_deg") < 1e-3, "{}", scored.said);
    assert!(scored.field("time_unit") == "us" && scored.report["truth_time_unit"] == "us");
    assert_eq!(scored.said.matches("its column `timestamp` is read as us").count(), 2, "{}", scored.said);
    // 10 Hz in ms, 200 ms late.
    let ms = bench.put("ms_10hz.csv", &table("timestamp", 1e3, 0.1, 1.0, 201, 0.0));
    let late = bench.put("late_ms.csv", &table("timestamp", 1e3, 0.1, 1.2, 201, 0.2));
    let scored = score(&[&ms, &late, "--settle", "5s"]);
    assert!(scored.field("time_unit") == "ms" && scored.figure("samples") > 100.0, "{}", scored.said);
    assert!((scored.figure("delay_ms") - 200.0).abs() < 2.0, "{}", scored.said);
    // Four rows are enough, named or not.
    let named = bench.put("named.csv", &table("timestamp_us", 1e6, 0.1, 1.0, 4, 0.0));
    let four = bench.put("four.csv", &table("timestamp", 1e6, 0.1, 1.0, 4, 0.0));
    let scored = score(&[&named, &four, "--clock", "truth"]);
    assert!(scored.figure("samples") == 4.0 && scored.figure("max_deg") < 1e-3, "{}", scored.said);
    // 4 Hz in ms for an hour is 4 kHz in us for seconds: nobody can tell, and the option says it.
    let both = bench.put("both.csv", &table("timestamp", 1e3, 0.25, 0.0, 14_400, 0.0));
    let asked = score(&[&both, &both]);
    assert!(
        asked.code == Some(2) && asked.said.contains("ms or us") && asked.said.contains("--time-unit"),
        "{}",
        asked.said
    );
    let told = score(&[&both, &both, "--time-unit", "ms"]);
    assert_eq!((told.code, told.field("time_unit")), (Some(0), &Value::from("ms")), "{}", told.said);
    let wrong = score(&[&both, &both, "--time-unit", "min"]);
    assert!(wrong.code == Some(2) && wrong.said.contains("write s, ms, us or ns"), "{}", wrong.said);
}

#[test]
fn nothing_is_taken_out_of_the_datasets_own_clock_unless_asked() {
    let bench = Bench::new();
    let truth = bench.dataset("level-then-turn", &[]);
    let mut text = String::from("t_ns,qw,qx,qy,qz\n");
    let rows = read::truth(&truth).unwrap().attitudes;
    for (t, at) in rows.iter().step_by(10) {
        let late = rows.partition_point(|(other, _)| *other < *t - SimTime(80_000_000));
        let _ = write!(text, "{}", row(t.0, if t.0 < 80_000_000 { at.q } else { rows[late].1.q }));
    }
    let late = bench.put("late.csv", &text);
    let truth = truth.to_str().unwrap();
    let plain = score(&[truth, &late]);
    let (given, fitted) = (plain.figure("rms_deg"), plain.figure("fitted.rms_deg"));
    assert!(
        given > 0.5 && fitted < 0.05 && (plain.figure("fitted.delay_ms") - 80.0).abs() < 2.0,
        "{}",
        plain.said
    );
    assert!(plain.said.contains("late less delay"), "both are told: {}", plain.said);
    for delay in ["0", "fit", "80ms"] {
        let scored = score(&[truth, &late, "--delay", delay]);
        assert!((scored.figure("rms_deg") - given).abs() < 1e-9, "{delay}: as given, {}", scored.said);
        assert!(scored.figure("fitted.rms_deg") < 0.05, "{delay}: {}", scored.said);
    }
    // Rows are without it where that was asked.
    let out = bench.home.path().join("out");
    let largest = |delay: &str| {
        score(&[truth, &late, "--delay", delay, "--force", "--out", out.to_str().unwrap()]);
        let errors = fs::read_to_string(out.join("errors.csv")).unwrap();
        errors
            .lines()
            .skip(1)
            .map(|line| line.split(',').nth(2).unwrap().parse::<f64>().unwrap())
            .fold(0.0, f64::max)
    };
    assert!(largest("0") > 2.0 && largest("fit") < 0.2 && largest("80ms") < 0.2);
    let wrong = score(&[truth, &late, "--delay", "soon"]);
    assert!(wrong.code == Some(2) && wrong.said.contains("or fit to estimate it"), "{}", wrong.said);
}

#[test]
fn what_is_covered_is_told_and_can_be_limited() {
    let bench = Bench::new();
    let truth = bench.dataset("level-then-turn", &[]);
    let truth = truth.to_str().unwrap();
    let rows = read::truth(Path::new(truth)).unwrap().attitudes;
    let mut text = String::from("t_ns,qw,qx,qy,qz\n");
    rows.iter().step_by(10).filter(|(t, _)| t.seconds() >= 25.0).for_each(|(t, at)| text += &row(t.0, at.q));
    let half = bench.put("half.csv", &text);
    let scored = score(&[truth, &half]);
    assert!(
        (scored.figure("coverage") - 0.5).abs() < 0.01 && scored.said.contains("50 %"),
        "{}",
        scored.said
    );
    let limited = score(&[truth, &half, "--limit", "coverage>0.9"]);
    assert!(limited.code == Some(1) && limited.said.contains("coverage = 0.5"), "{}", limited.said);
}

#[test]
fn constant_rotations_are_taken_out_and_named_by_their_angles() {
    let bench = Bench::new();
    let truth = bench.dataset("level-then-turn", &[]);
    let rows = read::truth(&truth).unwrap().attitudes;
    let truth = truth.to_str().unwrap();
    let (world, body) = (exp(DVec3::X * 40f64.to_radians()), exp(DVec3::Y * 10f64.to_radians()));
    let mut text = String::from("t_ns,qw,qx,qy,qz\n");
    rows.iter().step_by(10).for_each(|(t, at)| text += &row(t.0, world * at.q * body));
    let turned = bench.put("turned.csv", &text);
    let given = score(&[truth, &turned]);
    assert!(
        given.figure("rms_deg") > 30.0 && given.said.contains("--align frames removes it"),
        "{}",
        given.said
    );
    let aligned = score(&[truth, &turned, "--align", "frames"]);
    assert!(aligned.figure("rms_deg") < 1e-3, "{}", aligned.said);
    assert!(
        near(aligned.figure("aligned.world_deg"), 40.0) && near(aligned.figure("aligned.body_deg"), 10.0)
    );
    let world_alone = score(&[truth, &turned, "--align", "world"]);
    assert!(world_alone.figure("rms_deg") > 1.0 && world_alone.figure("aligned.body_deg") == 0.0);
}

#[test]
fn a_heading_off_by_the_scenes_declination_is_named_as_that() {
    let bench = Bench::new();
    let truth = bench.dataset("manoeuvre", &[]);
    let rows = read::truth(&truth).unwrap().attitudes;
    // Where the scene is the field points east of north; who does not know it takes magnetic for true north.
    let plan = Plan::load(truth.join("scene.toml").to_str().unwrap(), &[]).unwrap();
    let start = plan.trajectory.at(SimTime::ZERO);
    let field = start.attitude.apply(start.field).v;
    let declination = field.y.atan2(field.x);
    assert!(declination.abs() > 0.02, "{declination}");
    for (heading, names_it) in [(-declination, true), (declination, false), (0.7, false)] {
        let mut text = String::from("t_ns,qw,qx,qy,qz\n");
        rows.iter().step_by(40).for_each(|(t, at)| text += &row(t.0, exp(DVec3::Z * heading) * at.q));
        let off = bench.put("off.csv", &text);
        let scored = score(&[truth.to_str().unwrap(), &off, "--clock", "truth"]);
        assert_eq!(scored.said.contains("the scene's declination is"), names_it, "{}", scored.said);
        assert!(names_it || scored.said.contains("a constant heading of"), "{}", scored.said);
    }
}

#[test]
fn a_clock_that_wraps_goes_on_and_one_that_is_set_parts_a_log() {
    let bench = Bench::new();
    let truth = bench.dataset("level-then-turn", &[]);
    let rows = read::truth(&truth).unwrap().attitudes;
    let truth = truth.to_str().unwrap();
    // A counter of ms in 32 bits, 20 s before its end as the scene begins.
    let mut text = String::from("time_boot_ms,qw,qx,qy,qz\n");
    let ahead = 4_294_967_296_i64 - 20_000;
    for (t, at) in rows.iter().step_by(16).filter(|(t, _)| t.0 % 1_000_000 == 0) {
        text += &row((t.0 / 1_000_000 + ahead) % 4_294_967_296, at.q);
    }
    let wrapped = bench.put("wrapped.csv", &text);
    let scored = score(&[truth, &wrapped]);
    assert!((scored.figure("clock_offset_s") - ahead as f64 * 1e-3).abs() < 0.005, "{}", scored.said);
    assert!(scored.figure("coverage") > 0.99 && scored.figure("rms_deg") < 0.05, "{}", scored.said);
    // A clock that learns the date in mid-log, and one that begins anew: the longer part is judged.
    for (jump, from) in [(1.7e9, 18.0), (-15.0, 17.0)] {
        let mut text = String::from("time_s,qw,qx,qy,qz\n");
        for (t, at) in rows.iter().step_by(16) {
            let ahead = if t.seconds() < from { 40.0 } else { 40.0 + jump };
            text += &row(format!("{:.6}", t.seconds() + ahead), at.q);
        }
        let set = bench.put("set.csv", &text);
        let scored = score(&[truth, &set]);
        assert!((scored.figure("clock_offset_s") - 40.0 - jump).abs() < 0.005, "{}", scored.said);
        let covered = 1.0 - from / 50.0;
        assert!((scored.figure("coverage") - covered).abs() < 0.01, "{}", scored.said);
        assert!(scored.said.contains("only the longest stretch") && scored.figure("rms_deg") < 0.05);
    }
}

/// The figures of `run` are those of `score` on what it wrote.
#[test]
fn what_a_run_says_of_its_answers_score_says_too() {
    let bench = Bench::new();
    let out = bench.home.path().join("flight");
    let board = Path::new(env!("CARGO_BIN_EXE_ratetable")).parent().unwrap().join("board");
    if !board.exists() {
        assert!(
            std::env::var_os("CI").is_none(),
            "{} is not built: cargo build --workspace --bins",
            board.display()
        );
        eprintln!("NOT TESTED: {} is not built", board.display());
        return;
    }
    let output = Command::cargo_bin("ratetable")
        .unwrap()
        .args(["run", "table-1", "--for", "8s", "--speed", "max", "--json", "--to", "mpu@pty", "--out"])
        .arg(&out)
        .args(["--", board.to_str().unwrap(), "{}"])
        .output()
        .unwrap();
    let report: Value = serde_json::from_slice(&output.stdout).unwrap_or_default();
    let scored = score(&[out.to_str().unwrap(), out.join("estimate.csv").to_str().unwrap()]);
    for field in ["rms_deg", "inclination_rms_deg", "heading_rms_deg", "max_deg"] {
        let run = report["attitude"][field].as_f64().unwrap_or_else(|| panic!("{field}: {report}"));
        let value = scored.figure(field);
        assert!(
            (value - run).abs() < 1e-6 + 1e-4 * run,
            "{field}: run {run}, score {value}: {}",
            scored.said
        );
    }
}
