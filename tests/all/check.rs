//! `ratetable check` as a process: what a person reads of the effects, and what a program does.

use assert_cmd::Command;
use serde_json::Value;
use std::collections::BTreeSet;

const SCENE: &str = r#"
name = "yawing"
limits = ["sensors.gyro.dropped<1"]
[[motion]]
kind = "rotate"
yaw = "30 deg/s"
duration = "10 s"
[gyro]
part = "MPU-9250"
rate = "200 Hz"
bias = "0 deg/s"
bias_instability = "3 deg/h"
correlation_time = "300 s"
[accel]
rate = "100 Hz"
phase = "2 ms"
sampling = "average"
[reference]
method = "magnus-4"
"#;

fn check(arguments: &[&str]) -> String {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("yawing.toml");
    std::fs::write(&scene, SCENE).unwrap();
    let mut command = Command::cargo_bin("ratetable").unwrap();
    let done = command.arg("check").arg(&scene).args(arguments).assert().success();
    String::from_utf8(done.get_output().stdout.clone()).unwrap()
}

fn json(arguments: &[&str]) -> Value {
    serde_json::from_str(&check(&[arguments, &["--json"]].concat())).unwrap()
}

fn effect<'a>(plan: &'a Value, sensor: &str, name: &str) -> &'a Value {
    let found = plan["effects"].as_array().unwrap().iter();
    let mut found = found.filter(|effect| effect["sensor"] == sensor && effect["effect"] == name);
    let one = found.next().unwrap_or_else(|| panic!("{sensor}: {name}"));
    assert!(found.next().is_none(), "{name} is there once");
    one
}

#[test]
fn a_program_reads_each_effect_with_its_size_what_it_is_set_against_and_its_verdict() {
    let plan = json(&[]);
    let wander = effect(&plan, "gyro", "bias_instability");
    let size = wander["size"].as_f64().unwrap();
    assert!((size - (3.0f64 / 3600.0).to_radians()).abs() < 1e-12, "{wander}");
    assert_eq!((&wander["unit"], &wander["modelled"]), (&"rad/s".into(), &true.into()));
    // 16.4 LSB/(deg/s), and 0.01 deg/s/√Hz at 200 Hz.
    let against = |key: &str| wander["against"][key].as_f64().unwrap().to_degrees();
    assert!((against("resolution") * 16.4 - 1.0).abs() < 1e-9 && (against("noise") - 0.1).abs() < 1e-12);
    assert_eq!(
        (&wander["verdict"], &wander["key"]),
        (&"modelled but below".into(), &"gyro.bias_instability".into())
    );

    let bias = effect(&plan, "gyro", "bias");
    assert_eq!(bias["verdict"], "left out but would be seen", "the datasheet's tolerance: {bias}");
    let spin = effect(&plan, "accel", "lever_arm");
    assert!(
        spin["key"] == "accel.lever_arm"
            && spin["against"]["noise"].is_null()
            && spin["against"]["resolution"].is_null()
    );

    let louder = json(&["--set", "gyro.bias_instability=2 deg/s"]);
    assert_eq!(effect(&louder, "gyro", "bias_instability")["verdict"], "modelled and seen");
}

#[test]
fn a_program_reads_the_rest_of_the_plan() {
    let plan = json(&[]);
    assert_eq!(
        plan["reference"],
        serde_json::json!({ "from": "gyro", "method": "magnus-4", "rate_hz": 200.0, "chosen": null })
    );
    assert_eq!(plan["limits"], serde_json::json!(["sensors.gyro.dropped<1"]));
    let [gyro, accel] = [&plan["sensors"][0], &plan["sensors"][1]];
    assert_eq!(
        (&gyro["sampling"], &gyro["mount"], &gyro["phase_s"]),
        (&"point".into(), &"flu".into(), &0.0.into())
    );
    assert!((gyro["range"].as_f64().unwrap().to_degrees() - 2000.0).abs() < 1e-9);
    assert_eq!(
        (&accel["sampling"], &accel["mount"], &accel["phase_s"]),
        (&"average".into(), &Value::Null, &0.002.into())
    );
    assert!((plan["earth"]["gravity_m_s2"].as_f64().unwrap() - 9.80665).abs() < 1e-12);
    assert_eq!(plan["moving_until_s"], 10.0);
}

#[test]
fn a_person_reads_the_same_grouped_by_sensor_with_the_rule_beneath() {
    let text = check(&[]);
    for line in [
        "reference.csv: from gyro by magnus-4 at 200 Hz",
        "gyro: the value at the tick, within ±2000 deg/s, mounted flu",
        "accel: the mean since the tick before, from 0.002 s on",
        "consider gyro.bias; the",
        "consider accel.lever_arm",
        "gyro: half a count is 0.03049 deg/s, a tenth of the noise 0.01 deg/s",
        "accel: neither noise nor resolution: an ideal sensor shows everything",
        "at least half a count and a tenth of one sample's white noise",
        "limit: sensors.gyro.dropped<1",
    ] {
        assert!(text.contains(line), "{line} in\n{text}");
    }
    let column = |line: &str| line.split_whitespace().next().map(str::to_string);
    let table = text.lines().skip_while(|line| !line.starts_with("sensor  effect")).skip(1);
    // What a row goes on with has no size.
    let begins = |line: &&str| ["deg/s", "m/s²"].iter().any(|unit| line.contains(unit));
    let rows: Vec<_> = table.take_while(|line| !line.is_empty()).filter(begins).collect();
    let groups: Vec<_> =
        rows.iter().filter(|row| !row.starts_with(' ')).filter_map(|row| column(row)).collect();
    assert_eq!(groups, ["gyro", "accel"], "each sensor is named once:\n{text}");

    let plan = json(&[]);
    assert_eq!(plan["effects"].as_array().unwrap().len(), rows.len());
    let verdicts: BTreeSet<_> = plan["effects"]
        .as_array()
        .unwrap()
        .iter()
        .map(|effect| effect["verdict"].as_str().unwrap())
        .collect();
    assert_eq!(verdicts.len(), 4, "this scene has each of them: {verdicts:?}");
    for verdict in verdicts {
        // The table is wrapped at 120 characters: a verdict begins in its row.
        let begins = verdict.split(' ').take(3).collect::<Vec<_>>().join(" ");
        assert!(rows.iter().any(|row| row.contains(&begins)), "{verdict} in\n{text}");
    }
}

#[test]
fn a_reference_that_is_chosen_is_shown_with_its_error_and_why() {
    let auto = ["--set", "reference.method=auto", "--set", "reference.tolerance=1e-6 deg"];
    let chosen = &json(&auto)["reference"];
    assert_ne!(chosen["method"], "auto");
    assert!(chosen["chosen"]["max_error_deg"].as_f64().unwrap() <= 1e-6, "{chosen}");
    let text = check(&auto);
    let method = chosen["method"].as_str().unwrap();
    assert!(text.contains(&format!("reference.csv: from gyro by {method} at ")), "{text}");
    assert!(text.contains(&format!("chosen: {method} at ")), "{text}");
}

fn check_of(scene: &str, arguments: &[&str]) -> std::process::Output {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.toml");
    std::fs::write(&path, scene).unwrap();
    Command::cargo_bin("ratetable").unwrap().arg("check").arg(&path).args(arguments).output().unwrap()
}

const SWEPT: &str = r#"
duration = "1 s"
[gyro]
rate = "100 Hz"
noise_std = { uniform = ["0.05 deg/s", "0.15 deg/s"] }
bias_temperature = { uniform = ["-0.05 deg/s/K", "0.05 deg/s/K"] }
bias = { normal = ["[0, 0, 0] mrad/s", "[20, 20, 30] mrad/s"] }
[mag]
part = "AK09916"
rate = "100 Hz"
[sweep]
gyro.noise_std = ["0.001 rad/s", "0.002 rad/s"]
gyro.rate = ["100 Hz", "200 Hz", "400 Hz"]
earth.gravity = { uniform = ["9.78 m/s^2", "9.83 m/s^2"] }
"#;

#[test]
fn a_sweep_is_shown_with_its_size_and_each_value() {
    let text = String::from_utf8(check_of(SWEPT, &[]).stdout).unwrap();
    for line in [
        "sweep: 6 combinations for `generate`; what follows is the scene without it",
        "  gyro.noise_std: 0.001 rad/s, 0.002 rad/s",
        "  gyro.rate: 100 Hz, 200 Hz, 400 Hz",
        "  earth.gravity: from 9.78 m/s^2 to 9.83 m/s^2, drawn for each run",
    ] {
        assert!(text.lines().any(|shown| shown == line), "{line}: {text}");
    }
    let json: Value = serde_json::from_slice(&check_of(SWEPT, &["--json"]).stdout).unwrap();
    assert_eq!(json["sweep"]["combinations"], 6);
    assert_eq!(json["sweep"]["keys"][1]["values"], serde_json::json!(["100 Hz", "200 Hz", "400 Hz"]));
    assert!(!check(&[]).contains("sweep:"), "a scene without one shows none");
}

#[test]
fn a_value_of_a_sweep_that_the_scene_cannot_have_is_refused_with_its_line() {
    let wrong = check_of(&SWEPT.replace("\"0.002 rad/s\"]", "\"0.002 m\"]"), &[]);
    let said = String::from_utf8(wrong.stderr).unwrap();
    assert_eq!(wrong.status.code(), Some(2), "{said}");
    assert!(said.contains("scene.toml:12:") && said.contains("`0.002 m` is a length"), "{said}");
}

#[test]
fn of_drawn_values_those_that_a_term_uses_are_shown_in_the_units_of_the_scene() {
    let text = String::from_utf8(check_of(SWEPT, &[]).stdout).unwrap();
    let drawn: Vec<_> = text.lines().filter_map(|line| line.strip_prefix("drawn: ")).collect();
    let of = |key: &str| drawn.iter().find(|line| line.starts_with(key)).copied();
    assert!(of("gyro.noise_std = [").is_some_and(|line| line.ends_with("] deg/s")), "{drawn:?}");
    assert!(of("gyro.bias = [").is_some_and(|line| line.ends_with("] mrad/s")), "{drawn:?}");
    assert!(of("mag.bias = [").is_some_and(|line| line.ends_with("] uT")), "{drawn:?}");
    // Nothing uses it: the scene has no temperature.
    assert_eq!(of("gyro.bias_temperature"), None, "{drawn:?}");
    let warm = SWEPT.replace("[mag]", "temperature = { ambient = \"40 degC\" }\n[mag]");
    let text = String::from_utf8(check_of(&warm, &[]).stdout).unwrap();
    assert!(text.contains("drawn: gyro.bias_temperature = [") && text.contains("] deg/s/K"), "{text}");
    // As drawn: the number in the unit shown is that of the scene as resolved.
    let json: Value = serde_json::from_slice(&check_of(SWEPT, &["--json"]).stdout).unwrap();
    let values = json["drawn"].as_array().unwrap();
    let bias = values.iter().find(|drawn| drawn["key"] == "gyro.bias").unwrap()["value"].as_str().unwrap();
    let first =
        |text: &str| text.split_once('[').unwrap().1.split(',').next().unwrap().parse::<f64>().unwrap();
    assert!((first(of("gyro.bias").unwrap()) / (first(bias) * 1e3) - 1.0).abs() < 1e-3, "{bias}");
}

#[test]
fn a_magnetometer_inside_a_part_is_called_by_its_own_name() {
    let text = String::from_utf8(check_of(SWEPT, &[]).stdout).unwrap();
    assert!(text.lines().any(|line| line.starts_with("mag ") && line.contains(" AK09916 ")), "{text}");
    let whole = SWEPT.replace("AK09916", "ICM-20948");
    let text = String::from_utf8(check_of(&whole, &[]).stdout).unwrap();
    assert!(text.lines().any(|line| line.starts_with("mag ") && line.contains(" ICM-20948 ")), "{text}");
}
