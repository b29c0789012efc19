//! A controller that stops, stalls or restarts in the middle of a run, as measured on firmware: what `ratetable run`
//! makes of it.

use super::program::{RATETABLE, STANDIN};
use serde_json::Value;
use std::process::Command;

/// Exit code, report and messages of a run of so many seconds against a stand-in with a mishap.
fn run(to: &str, standin: &str, mishap: [&str; 2], seconds: u32) -> (i32, Value, String) {
    let span = format!("{seconds}s");
    let output = Command::new(&*RATETABLE)
        .args(["run", "level-then-turn", "--for", &span, "--to", to, "--rest", "2s", "--json", "--"])
        .args([STANDIN, standin, "{}"])
        .args(mishap)
        .output()
        .expect("the program starts");
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    let report = serde_json::from_slice(&output.stdout).unwrap_or_else(|error| panic!("{error}: {said}"));
    (output.status.code().unwrap_or(-1), report, said)
}

#[test]
fn an_inav_that_stops_answering_fails_the_run_and_says_when() {
    // It rests for two to three seconds: some four of the eight seconds of the scene are answered.
    let (code, report, said) = run("inav@pty", "inav", ["--stops", "7"], 8);
    assert_eq!(code, 1, "{said}");
    let answers = &report["links"][0]["answers"];
    let [expected, received] = ["expected", "received"].map(|field| answers[field].as_u64().unwrap());
    assert_eq!((expected, answers["expected_by"].as_str()), (800, Some("packets")), "{answers}");
    assert!((200..600).contains(&received), "{answers}");
    let stopped = answers["stopped_at_s"].as_f64().unwrap();
    assert!((stopped - received as f64 / 100.0).abs() < 0.5, "{answers}");
    assert!(answers["silent_longest_s"].as_f64().unwrap() > 2.0, "{answers}");
    assert!(report["failed"][0].as_str().unwrap().contains("stopped answering at"), "{report}");
    assert!(said.contains("no answer for 0.5 s (one every 10 ms is usual)"), "while it lasts: {said}");
    let attitude = &report["attitude"];
    let covered = attitude["coverage"].as_f64().unwrap();
    assert!((covered - stopped / 8.0).abs() < 0.1 && said.contains("% of the scene's 8 s"), "{attitude}");
}

#[test]
fn an_inav_that_stalls_and_comes_back_is_a_notice_and_a_count() {
    let (code, report, said) = run("inav@pty", "inav", ["--stalls", "6,1.5"], 8);
    let answers = &report["links"][0]["answers"];
    assert_eq!((answers["silences"].as_u64(), &answers["stopped_at_s"]), (Some(1), &Value::Null), "{said}");
    assert!(answers["received"].as_u64().unwrap() < 720, "{answers}");
    assert!(said.contains("answers again after 1."), "{said}");
    assert_eq!(code, 0, "a limit may ask for more: {said}");
}

#[test]
fn a_px4_that_restarts_within_its_heartbeats_is_noticed_and_asked_again() {
    let (code, report, said) = run("px4@pty", "px4", ["--restarts", "6,1"], 8);
    let answers = &report["links"][0]["answers"];
    assert_eq!(answers["restarts"], 1, "{said}");
    assert!(said.contains("the controller has restarted: its clock went back from"), "{said}");
    assert_eq!(answers["stopped_at_s"], Value::Null, "it answers again: {said}");
    assert!(answers["received"].as_u64().unwrap() > 250, "{answers}");
    assert_eq!(code, 0, "{said}");
}

#[test]
fn a_controller_that_answers_all_the_time_has_no_silence() {
    let (code, report, said) = run("inav@pty", "inav", ["--stops", "1000"], 4);
    let answers = &report["links"][0]["answers"];
    let [expected, received] = ["expected", "received"].map(|field| answers[field].as_u64().unwrap());
    assert!(expected == 400 && received.abs_diff(400) <= 2, "{answers}");
    assert_eq!(
        (code, answers["silences"].as_u64(), answers["restarts"].as_u64()),
        (0, Some(0), Some(0)),
        "{said}"
    );
    assert!(!said.contains("no answer for"), "{said}");
}
