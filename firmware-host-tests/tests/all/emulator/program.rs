//! The two programs themselves, as a user's one line of CI runs them: `ratetable run … -- board {}`.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::LazyLock;

use serde_json::Value;

/// The firmware.
const BOARD: &str = env!("CARGO_BIN_EXE_board");

/// The emulator. Cargo builds a package's programs for its own tests only, so this asks it for that of the package
/// above; where all of the workspace is tested it is there already.
pub(super) static RATETABLE: LazyLock<PathBuf> = LazyLock::new(|| {
    let manifest = Path::new(env!("CARGO_MANIFEST_DIR")).join("../Cargo.toml");
    let mut cargo = Command::new(env!("CARGO"));
    cargo.args(["build", "--quiet", "--package", "ratetable", "--bin", "ratetable", "--message-format=json"]);
    if !cfg!(debug_assertions) {
        cargo.arg("--release");
    }
    let output = cargo.arg("--manifest-path").arg(manifest).output().expect("cargo starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let said = String::from_utf8_lossy(&output.stdout);
    let mut messages = said.lines().filter_map(|line| serde_json::from_str::<Value>(line).ok());
    let program = messages.find_map(|message| message["executable"].as_str().map(PathBuf::from));
    program.expect("cargo says where the program is")
});

/// `ratetable run still --for 2s --to mpu@pty --speed max` with more arguments.
fn run(more: &[&str]) -> Output {
    let fixed = ["run", "still", "--for", "2s", "--to", "mpu@pty", "--speed", "max"];
    Command::new(&*RATETABLE).args(fixed).args(more).output().expect("the program starts")
}

/// Its exit code, after having made sure that it is this one.
fn assert_code(output: &Output, code: i32) -> String {
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(code), "{said}");
    said
}

#[test]
fn a_board_that_is_given_the_pty_reads_all_of_it_and_answers() {
    let output = run(&["--json", "--limit", "attitude.inclination_rms_deg<1", "--", BOARD, "{}"]);
    let said = assert_code(&output, 0);
    assert!(said.contains("ready: mpu@/dev/pts/"), "{said}");
    assert!(
        said.contains("0 damaged, 0 lost; readings: gyro 2000, accel 2000, mag 200, skipped 0"),
        "{said}"
    );
    let report: Value =
        serde_json::from_slice(&output.stdout).expect("nothing but the report on standard output");
    assert_eq!((&report["ok"], &report["failed"]), (&Value::from(true), &serde_json::json!([])));
    for (sensor, made) in [(0, 2000), (1, 2000), (2, 200)] {
        let sensor = &report["sensors"][sensor];
        let counts = ["made", "sent", "dropped", "queued"].map(|count| sensor[count].as_u64());
        assert_eq!(counts, [made, made, 0, 0].map(Some), "{sensor}");
    }
    // An answer every 20 ms of samples, from the first that the board has measured its rates with.
    assert!(
        report["attitude"]["samples"].as_u64().is_some_and(|answers| (95..=100).contains(&answers)),
        "{report}"
    );
}

#[test]
fn a_limit_that_does_not_hold_is_exit_code_1() {
    let said = assert_code(&run(&["--limit", "attitude.inclination_rms_deg<0.001", "--", BOARD, "{}"]), 1);
    assert!(said.contains("FAILED: attitude.inclination_rms_deg = "), "{said}");
}

#[test]
fn the_commands_own_exit_code_is_handed_on() {
    // One ends without having opened the link, the other after having read a part of it.
    for script in ["exit 3", "head -c 1000 < \"$0\" > /dev/null; exit 3"] {
        assert_code(&run(&["--", "sh", "-c", script, "{}"]), 3);
    }
    let told = "test \"$0\" = \"$RATETABLE_LINK\" && exit 7";
    assert_code(&run(&["--", "sh", "-c", told, "{}"]), 7);
}

#[test]
fn a_command_that_never_reads_is_no_success() {
    let said = assert_code(&run(&["--", "true"]), 1);
    assert!(said.contains("the command ended before anything was sent"), "{said}");
}

#[test]
fn nobody_on_the_pty_in_time_is_exit_code_2_and_says_where_nobody_came() {
    let said = assert_code(&run(&["--wait", "0.3s"]), 2);
    let ready = said.lines().find_map(|line| line.strip_prefix("ready: mpu@")).expect("a ready line");
    assert!(said.contains(&format!("nobody came to {ready} in 0.3 s")), "{said}");
}

#[test]
fn a_board_that_does_not_exist_is_exit_code_2() {
    let said = assert_code(&run(&["--", "/no/such/board", "{}"]), 2);
    assert!(said.contains("`/no/such/board` could not be started"), "{said}");
}

/// A stand-in for a flight controller.
pub(super) const STANDIN: &str = env!("CARGO_BIN_EXE_standin");

#[test]
fn px4_on_a_slow_link_is_told_of_with_the_parameter_to_change_and_is_exit_code_2() {
    let arguments =
        ["run", "--to", "px4@pty", "--wait", "12s", "--", STANDIN, "px4", "{}", "--param", "MAV_0_RATE=1200"];
    let output = Command::new(&*RATETABLE).args(arguments).output().expect("the program starts");
    let said = assert_code(&output, 2);
    assert!(said.contains("MAV_0_RATE is 1200 B/s") && said.contains("set MAV_0_RATE to 0"), "{said}");
    assert!(said.contains("the controller beats but does not answer samples"), "{said}");
}

#[test]
fn a_stand_in_reads_all_of_a_stream() {
    // Two seconds at 1 kHz, and the vehicle that has stopped; with sbgECom a magnetometer at 100 Hz that is a sample of
    // the accelerometer too, and packets without samples, among them an answer that may come late.
    // The rest before the scene is of whole seconds.
    for (to, standin, rest, samples, a_second) in [
        ("mip@pty", "ardupilot-mip", 0, 2001, 1000),
        ("ilabs@pty", "ardupilot-ilabs", 10, 2001, 1000),
        ("sbg@pty", "ardupilot-sbg", 10, 2001 + 201, 1100),
    ] {
        let arguments =
            ["run", "still", "--for", "2s", "--to", to, "--speed", "max", "--", STANDIN, standin, "{}"];
        let output = Command::new(&*RATETABLE).args(arguments).output().expect("the program starts");
        let said = assert_code(&output, 0);
        assert!(said.contains(" packets, 0 damaged"), "{to}: {said}");
        let used = said.split("samples: ").nth(1).and_then(|rest| rest.split(' ').next()).expect("a count");
        let more = used.parse::<u64>().expect("a count") - samples;
        assert_eq!(more % a_second, 0, "{to}: {said}");
        assert!(more / a_second >= rest && (rest > 0 || more == 0), "{to}: {said}");
    }
}
