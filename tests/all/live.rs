//! The live page and its port, judged from outside: a browser, a viewer of another make, and whoever should not be
//! there (`tests/live/*.py`).

use serde_json::Value;
use std::env;
use std::path::Path;
use std::process::{Command, Stdio};

/// Runs a script of `tests/live` with the program and these arguments; what it prints, or `None` where the machine lacks
/// what it needs: a module, or a program.
fn judged(script: &str, arguments: &[&str], module: &str, programs: &[&str]) -> Option<Value> {
    let python = env::var("RATETABLE_PYTHON").unwrap_or("python3".into());
    let works = |command: &mut Command| {
        command.stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok_and(|status| status.success())
    };
    let import = format!("import {module}");
    let mut lacking = Vec::new();
    if !works(Command::new(&python).args(["-c", &import])) {
        assert!(env::var_os("RATETABLE_REQUIRE_PYTHON").is_none(), "`{python}` cannot `{import}`");
        lacking.push(format!("`{python}` cannot `{import}`; tests/run.sh makes a Python that can"));
    }
    for program in programs {
        if !works(Command::new(program).arg("--version")) {
            assert!(env::var_os("RATETABLE_REQUIRE_BROWSER").is_none(), "`{program}` is missing");
            lacking.push(format!(
                "`{program}` is missing (Debian and Ubuntu: apt install chromium chromium-driver)"
            ));
        }
    }
    if !lacking.is_empty() {
        eprintln!("NOT TESTED: {script}: {}", lacking.join("; "));
        return None;
    }
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/live").join(script);
    let mut command = Command::new(&python);
    command.arg(path).arg(assert_cmd::cargo::cargo_bin("ratetable")).args(arguments);
    let output = command.output().expect("Python starts");
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{script}: {said}");
    Some(serde_json::from_slice(&output.stdout).unwrap_or_else(|error| panic!("{error}: {said}")))
}

#[test]
fn a_browser_shows_what_plays_and_what_was_played() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path().join("browser");
    let programs = ["chromium", "chromedriver"];
    if let Some(found) = judged("browser.py", &[folder.to_str().unwrap()], "json", &programs) {
        assert_eq!(found["checked"].as_array().map(Vec::len), Some(6), "{found}");
    }
}

#[test]
fn a_viewer_of_another_make_reads_every_channel_and_finds_the_datasets_numbers() {
    for subprotocol in ["foxglove.sdk.v1", "foxglove.websocket.v1"] {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("run");
        let arguments = [out.to_str().unwrap(), subprotocol];
        let Some(found) = judged("viewer.py", &arguments, "websockets, mcap_ros2", &[]) else { return };
        assert_eq!(found["wrong"].as_array().map(Vec::len), Some(0), "{found}");
        // Six seconds, less what went by before it came.
        let channels = found["channels"].as_object().unwrap();
        assert_eq!(channels.len(), 10, "{found}");
        assert!(channels.values().all(|count| count.as_u64().unwrap() >= 2), "{found}");
        assert!(found["compared"].as_u64().unwrap() > 10_000, "{found}");
        assert!(found["answers"].as_u64().unwrap() > 100, "{found}");
    }
}

#[test]
fn who_should_not_be_there_is_refused_and_disturbs_nothing() {
    let Some(found) = judged("hostile.py", &[], "json", &[]) else { return };
    assert!(found["turned away"].as_u64().unwrap() > 800, "{found}");
}

#[test]
fn a_port_that_is_taken_and_an_address_that_is_none_are_told_in_words() {
    let taken = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let port = taken.local_addr().unwrap().port();
    for (at, words) in [
        (format!("--live=127.0.0.1:{port}"), format!("127.0.0.1:{port} is in use")),
        ("--live=192.0.2.1:8420".into(), "cannot serve on 192.0.2.1:8420".into()),
        ("--live=here".into(), "`here` is no address".into()),
        ("--live=127.0.0.1".into(), "`127.0.0.1` is no address".into()),
    ] {
        let run = Command::new(assert_cmd::cargo::cargo_bin("ratetable"))
            .args(["run", "table-1", "--for", "1s", &at])
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&run.stderr);
        assert!(run.status.code() == Some(2) && said.contains(&words), "{at}: {said}");
    }
}
