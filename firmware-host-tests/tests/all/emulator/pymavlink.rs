//! pymavlink as the other side: a client of another make, in another language, in a process of its own.
//!
//! It needs a Python with `pymavlink` and `pyserial`: `RATETABLE_PYTHON`, or a `python3` that can import them. Where
//! there is none the tests say so and pass, unless `RATETABLE_REQUIRE_PYTHON` is set, as `tests/run.sh` does.

use std::env;
use std::process::{Command, Stdio};
use std::sync::Arc;

use ratetable::scene::Plan;
use ratetable::sensor::{Reading, SensorKind};
use ratetable::session::{Outcome, Speed};
use serde_json::Value;

use crate::emulator::play::{play, readings, scene};

const CLIENT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/pymavlink_client.py");
const IMPORT: &str = "import pymavlink.mavutil, serial";

/// The interpreter, or `None` after having said that there is none.
fn python() -> Option<String> {
    let python = env::var("RATETABLE_PYTHON").unwrap_or("python3".into());
    let found = Command::new(&python).args(["-c", IMPORT]).stderr(Stdio::null()).status();
    if found.is_ok_and(|status| status.success()) {
        return Some(python);
    }
    let why = format!("`{python}` cannot `{IMPORT}`");
    assert!(env::var_os("RATETABLE_REQUIRE_PYTHON").is_none(), "{why}");
    eprintln!("NOT TESTED against pymavlink: {why}; tests/run.sh makes a Python that can");
    None
}

/// Runs the client on a link; `scheme` is put before what one connects to.
fn receive(plan: &Arc<Plan>, to: &str, scheme: &'static str, speed: Speed) -> Option<(Outcome, Value)> {
    let python = python()?;
    let (outcome, output) = play(plan, to, speed, move |place| {
        Command::new(python).arg(CLIENT).arg(format!("{scheme}{place}")).stderr(Stdio::inherit()).output()
    });
    let output = output.expect("the client starts");
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{}: {said}", output.status);
    // pymavlink prints a line of its own when a TCP peer leaves; the report is the last.
    let report = said.lines().last().unwrap_or_default();
    Some((outcome, serde_json::from_str(report).unwrap_or_else(|error| panic!("{error}: {said}"))))
}

/// The client had every message, each right and in its place.
fn check(plan: &Plan, outcome: &Outcome, got: &Value) {
    let zero = Value::from(0);
    for damage in ["bad_data", "errors", "lost"] {
        assert_eq!(got[damage], zero, "{damage}: {got}");
    }
    assert_eq!((&got["version"], &got["in_order"]), (&"2.0".into(), &true.into()));

    let seconds = plan.duration.0 / 1_000_000_000;
    let [gyro, accel, mag] = [0, 1, 2].map(|i| outcome.sensors[i].made);
    assert_eq!(
        got["types"],
        serde_json::json!({ "HEARTBEAT": seconds, "SYSTEM_TIME": seconds, "HIL_SENSOR": gyro })
    );
    assert_eq!(got["fresh"], serde_json::json!({ "gyro": gyro, "accel": accel, "mag": mag }));
    // 250, 125 and 50 Hz: in every fifth message the magnetometer's bits, in every second the accelerometer's.
    let masks = serde_json::json!({ "0x38": gyro * 2 / 5, "0x3f": gyro * 2 / 5, "0x1f8": gyro / 10, "0x1ff": gyro / 10 });
    assert_eq!(got["masks"].as_object().map(|masks| masks.len()), Some(4));
    for (mask, count) in masks.as_object().expect("an object") {
        assert_eq!(&got["masks"][mask], count, "{mask}");
    }
    let rate = got["rate_hz"].as_f64().expect("a rate");
    assert!((rate - 250.0).abs() < 1e-6, "{rate} Hz by time_usec");
    check_values(plan, got);
}

/// First and last message against the dataset's readings.
fn check_values(plan: &Plan, got: &Value) {
    let all = readings(plan);
    let newest_at = |t_us: u64, kind: SensorKind| -> Reading {
        let until = all.iter().take_while(|(t, _)| t.0 as u64 / 1000 <= t_us);
        *until
            .flat_map(|(_, readings)| readings)
            .filter(|reading| reading.kind == kind)
            .last()
            .expect("a reading")
    };
    let last_us = plan.duration.0 as u64 / 1000 - 4000;
    for (which, t_us) in [("first", 0), ("last", last_us)] {
        let message = &got[which]["HIL_SENSOR"];
        assert_eq!(message["time_usec"], Value::from(t_us), "{which}");
        for (kind, names, scale) in [
            (SensorKind::Gyro, ["xgyro", "ygyro", "zgyro"], 1.0),
            (SensorKind::Accel, ["xacc", "yacc", "zacc"], 1.0),
            (SensorKind::Mag, ["xmag", "ymag", "zmag"], 100.0),
        ] {
            let reading = newest_at(t_us, kind).body().unwrap().value.v.to_array();
            for (name, value) in names.into_iter().zip(reading) {
                let field = message[name].as_f64().expect(name) * scale;
                assert!((field - value).abs() <= 1e-7 * value.abs(), "{which} {name}: {field} for {value}");
            }
        }
    }
    assert_eq!(got["first"]["HEARTBEAT"]["base_mode"], Value::from(32), "hardware in the loop");
    let last_s = plan.duration.0 as u64 / 1_000_000_000 - 1;
    assert_eq!(got["last"]["SYSTEM_TIME"]["time_boot_ms"], Value::from(last_s * 1000));
}

fn at_250_hz(seconds: u32) -> Arc<Plan> {
    let duration = format!("duration={seconds} s");
    scene("table-1", &["gyro.rate=250 Hz", "accel.rate=125 Hz", "mag.rate=50 Hz", &duration])
}

#[test]
fn pymavlink_opens_the_pty_by_its_path_and_follows_in_real_time() {
    let plan = at_250_hz(5);
    if let Some((outcome, got)) = receive(&plan, "mavlink@pty", "", Speed::Times(1.0)) {
        check(&plan, &outcome, &got);
    }
}

#[test]
fn pymavlink_gets_all_of_it_as_fast_as_it_reads() {
    let plan = at_250_hz(30);
    if let Some((outcome, got)) = receive(&plan, "mavlink@pty", "", Speed::Max) {
        check(&plan, &outcome, &got);
    }
}

#[test]
fn pymavlink_gets_all_of_it_over_tcp() {
    let plan = at_250_hz(30);
    if let Some((outcome, got)) = receive(&plan, "mavlink@tcpin:127.0.0.1:0", "tcp:", Speed::Max) {
        check(&plan, &outcome, &got);
    }
}

#[test]
fn pymavlink_is_answered_over_udp() {
    let plan = at_250_hz(2);
    if let Some((outcome, got)) = receive(&plan, "mavlink@udpin:127.0.0.1:0", "udpout:", Speed::Times(1.0)) {
        check(&plan, &outcome, &got);
    }
}
