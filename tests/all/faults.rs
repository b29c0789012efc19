//! Faults of sensors and outputs in a whole run: what the report and the manifest tell, and what is counted as made.

use serde_json::{Value, json};
use std::path::Path;
use std::process::Command;

const SCENE: &str = r#"
duration = "2 s"
[gyro]
rate = "100 Hz"
noise_std = "1 deg/s"
[accel]
rate = "100 Hz"
[mag]
rate = "50 Hz"
"#;

/// A fault that withholds samples, one that changes them, one that never begins, one at random, and one of packets.
const FAULTS: &str = r#"
[[fault]]
sensor = "gyro"
kind = "off"
start = "500 ms"
duration = "250 ms"
[[fault]]
sensor = "accel"
kind = "stuck"
start = "1 s"
[[fault]]
sensor = "accel"
kind = "wrong"
start = "5 s"
[[fault]]
sensor = "mag"
kind = "intermittent"
share = "40 %"
[[fault]]
kind = "drop"
start = "1 s"
duration = "500 ms"
share = "100 %"
[[fault]]
output = "csv@pty"
kind = "drop"
"#;

/// Plays a scene as text into a file, without waiting: exit code, report, what was said, the lines of each sensor.
fn run(folder: &Path, faults: &str, more: &[&str]) -> (i32, Value, String, [usize; 3]) {
    let (scene, lines) = (folder.join("scene.toml"), folder.join("lines"));
    std::fs::write(&scene, format!("{SCENE}{faults}")).unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_ratetable"))
        .args(["run", &scene.display().to_string(), "--to", &format!("csv@file:{}", lines.display())])
        .args(["--speed", "max", "--json"])
        .args(more)
        .output()
        .unwrap();
    let text = String::from_utf8(output.stderr).unwrap();
    let report = serde_json::from_slice(&output.stdout).unwrap_or_else(|error| panic!("{error}: {text}"));
    let lines = std::fs::read_to_string(lines).unwrap();
    let of = |sensor: &str| lines.lines().filter(|line| line.split(',').nth(1) == Some(sensor)).count();
    (output.status.code().unwrap(), report, text, ["gyro", "accel", "mag"].map(of))
}

fn made(report: &Value) -> [u64; 3] {
    [0, 1, 2].map(|i| {
        let sensor = &report["sensors"][i];
        let count = |field: &str| sensor[field].as_u64().unwrap();
        assert_eq!(count("made"), count("sent") + count("dropped") + count("queued"));
        count("made")
    })
}

#[test]
fn what_acted_is_told_and_what_was_withheld_was_never_made() {
    let folder = tempfile::tempdir().unwrap();
    let (code, report, _, lines) = run(folder.path(), "", &[]);
    assert_eq!((code, &report["faults"], made(&report)), (0, &json!([]), [200, 200, 100]), "control");
    assert_eq!(lines, [200, 200, 100]);
    assert!(report["links"][0].get("faults").is_none());

    let out = folder.path().join("flight");
    let (code, report, text, lines) = run(folder.path(), FAULTS, &["--out", &out.display().to_string()]);
    assert_eq!(code, 0, "a fault that was asked for is no failure: {text}");
    let to = report["links"][0]["to"].as_str().unwrap();
    let acted = [
        "gyro off from 0.5 s to 0.75 s".to_string(),
        "accel stuck from 1 s".into(),
        "mag intermittent from 0 s".into(),
        format!("{to} drop from 1 s to 1.5 s"),
    ];
    assert_eq!(report["faults"], json!(acted), "and not the one that never began");
    acted.iter().for_each(|fault| assert!(text.contains(&format!("fault: {fault}\n")), "{text}"));
    let warning = "the fault drop from 0 s of output csv@pty concerns no output of this run";
    assert!(text.contains(warning), "{text}");
    // 25 of the gyro are off and 50 dropped on their way; of 100 of the mag about 60 are left before that.
    let [gyro, accel, mag] = made(&report);
    assert_eq!((gyro, accel), (125, 150));
    assert!((20..=70).contains(&mag), "75 times 60 % within five standard deviations: {mag}");
    assert_eq!(lines.map(|count| count as u64), [gyro, accel, mag]);
    let dropped = report["links"][0]["faults"]["drop"].as_u64().unwrap();
    let manifest: Value = serde_json::from_slice(&std::fs::read(out.join("manifest.json")).unwrap()).unwrap();
    assert_eq!(manifest["faults"], report["faults"]);
    // A dataset holds what was read, whatever became of it on its way.
    let samples: Vec<_> = (0..3).map(|i| manifest["sensors"][i]["samples"].as_u64().unwrap()).collect();
    assert_eq!(samples[..2], [175, 200]);
    assert_eq!(samples.iter().sum::<u64>(), gyro + accel + mag + dropped);

    // What ends before a fault begins does not tell of it.
    let (_, report, _, _) = run(folder.path(), FAULTS, &["--for", "600ms"]);
    assert_eq!(report["faults"], json!([acted[0], acted[2]]));
}

#[test]
fn limits_hold_for_what_faults_did_and_mistakes_are_placed() {
    let folder = tempfile::tempdir().unwrap();
    let (code, report, _, _) = run(folder.path(), FAULTS, &["--limit", "links.0.faults.drop<1"]);
    assert_eq!(code, 1);
    assert!(report["failed"][0].as_str().unwrap().starts_with("links.0.faults.drop = "), "{report}");
    let scene = folder.path().join("scene.toml");
    let check = Command::new(env!("CARGO_BIN_EXE_ratetable")).arg("check").arg(&scene).output().unwrap();
    let text = String::from_utf8(check.stdout).unwrap();
    for asked in ["accel wrong from 5 s", "drop from 1 s to 1.5 s of every output", "of output csv@pty"] {
        assert!(
            text.lines().any(|line| line.starts_with("fault: ") && line.ends_with(asked)),
            "{asked}: {text}"
        );
    }
    let output = "[[output]]\nto = \"mpu@pty\"\n";
    for (fault, why) in [
        ("kind = \"drop\"\nsensor = \"gyro\"", "drop is a packet fault"),
        ("kind = \"off\"\noutput = 0\nsensor = \"gyro\"", "off is a sensor fault"),
        ("kind = \"drop\"\noutput = 1", "matches none of the scene's outputs, which are 0 \"mpu@pty\""),
        ("kind = \"drop\"\noutput = \"mpu@/dev/ttyACM0\"", "matches none of the scene's outputs"),
        ("kind = \"drop\"\noutput = \"nothing\"", "is not PROTOCOL@LINK"),
        ("kind = \"drop\"\noutput = true", "its number in the scene, from 0"),
        ("kind = \"drop\"\nshare = \"120 %\"", "at most 100 %"),
        ("kind = \"drop\"\nbits = 3", "`bits` is not a key of"),
        ("kind = \"corrupt\"\nbits = 65", "from 1 to 64"),
        ("kind = \"corrupt\"\nhurts = \"all\"", "takes packet or framing"),
        ("kind = \"stall\"", "a stall lasts 10 s at most"),
        ("kind = \"stall\"\nduration = \"11 s\"", "a stall lasts 10 s at most"),
        ("kind = \"split\"\npieces = 1", "from 2 to 16"),
        ("kind = \"duplicat\"", "did you mean `duplicate`"),
    ] {
        let scene = folder.path().join("bad.toml");
        std::fs::write(&scene, format!("{SCENE}{output}[[fault]]\n{fault}\n")).unwrap();
        let output = Command::new(env!("CARGO_BIN_EXE_ratetable")).arg("check").arg(&scene).output().unwrap();
        let text = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{fault}");
        assert!(text.contains(why) && text.contains("bad.toml:"), "{fault}: {text}");
    }
}
