//! `ratetable generate` as a process: what a killed one leaves, and runs in shares.

use assert_cmd::Command;
use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

fn generate(arguments: &[&str]) -> assert_cmd::assert::Assert {
    Command::cargo_bin("ratetable").unwrap().arg("generate").args(arguments).assert()
}

fn names(dir: &Path) -> Vec<String> {
    let entries = fs::read_dir(dir).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<_> = entries.collect();
    names.sort();
    names
}

/// Starts a dataset that takes long and kills it, without warning, once `begun` says that it is at work.
fn killed(out: &Path, more: &[&str], begun: impl Fn() -> bool) {
    let mut child = std::process::Command::new(assert_cmd::cargo::cargo_bin("ratetable"))
        .args(["generate", "table-1", "--set", "duration=20000 s", "--out"])
        .arg(out)
        .args(more)
        .stderr(std::process::Stdio::null())
        .spawn()
        .unwrap();
    let patience = Instant::now() + Duration::from_secs(60);
    while !begun() {
        assert!(Instant::now() < patience && child.try_wait().unwrap().is_none(), "it never began");
        std::thread::sleep(Duration::from_millis(5));
    }
    child.kill().unwrap();
    child.wait().unwrap();
}

#[test]
fn a_killed_dataset_leaves_nothing_under_its_name_and_does_not_stand_in_the_way() {
    let home = tempfile::tempdir().unwrap();
    let out = home.path().join("flight");
    let path = out.to_str().unwrap();
    killed(&out, &["--format", "csv,npy,mat"], || !names(home.path()).is_empty());
    assert!(!out.exists());
    assert!(names(home.path()).iter().all(|name| name == ".flight.incomplete"));
    generate(&["table-1", "--set", "duration=0.1 s", "--out", path]).success();
    assert!(out.join("manifest.json").exists());

    // Over one that is there: it stands as it was until the new one is whole.
    let before = fs::read(out.join("gyro.csv")).unwrap();
    killed(&out, &["--force"], || names(&out).iter().any(|name| name == ".incomplete"));
    assert_eq!(fs::read(out.join("gyro.csv")).unwrap(), before);
    assert!(out.join("manifest.json").exists());
    generate(&["table-1", "--set", "duration=0.2 s", "--force", "--out", path]).success();
    assert!(fs::read(out.join("gyro.csv")).unwrap().len() > before.len());
}

#[test]
fn killed_runs_are_complete_or_absent_and_the_same_command_makes_the_rest() {
    let home = tempfile::tempdir().unwrap();
    let (out, whole) = (home.path().join("runs"), home.path().join("whole"));
    let path = out.to_str().unwrap();
    let begun = || out.exists() && names(&out).iter().any(|name| name.starts_with(".run-"));
    killed(&out, &["--runs", "50"], begun);
    assert!(names(&out).iter().all(|name| name.starts_with(".run-")), "{:?}", names(&out));
    let short = ["--set", "duration=0.1 s", "--runs", "4"];
    let run =
        |path, shard: &[&str]| generate(&[&["table-1", "--out", path], &short[..], shard].concat()).success();
    run(path, &["--shard", "1/2"]);
    run(path, &["--shard", "2/2"]);
    run(whole.to_str().unwrap(), &[]);
    assert_eq!(names(&out), names(&whole));
    assert_eq!(names(&out), ["run-000000", "run-000001", "run-000002", "run-000003", "runs.csv"]);
    for name in names(&out.join("run-000003")) {
        let read = |dir: &Path| fs::read(dir.join("run-000003").join(&name)).unwrap();
        assert_eq!(read(&out), read(&whole), "{name}");
    }
}

#[test]
fn a_mistake_of_the_command_line_says_what_would_be_right() {
    let home = tempfile::tempdir().unwrap();
    let out = home.path().join("out");
    let out = out.to_str().unwrap();
    for (arguments, says) in [
        (vec!["table-1", "--out", out, "--shard", "1/2"], "--runs 100"),
        (vec!["table-1", "--out", out, "--runs", "2", "--shard", "3/2"], "write I/N"),
        (vec!["table-1", "--out", out, "--runs", "0"], "write a whole number of 1 or more"),
        (vec!["table-1", "--out", out, "--format", "npz"], "perhaps `npy`"),
        (vec!["table-1", "--out", out, "--runs", "2", "--set", "sweep.gyro.rate='1 Hz'"], "write a list"),
    ] {
        let failed = generate(&arguments).failure();
        let said = String::from_utf8_lossy(&failed.get_output().stderr).to_string();
        assert!(said.contains(says), "{arguments:?}: {said}");
    }
    if cfg!(not(feature = "mcap")) {
        let failed = generate(&["table-1", "--out", out, "--format", "mcap"]).failure();
        assert!(String::from_utf8_lossy(&failed.get_output().stderr).contains("--features mcap"));
    }
    assert!(names(home.path()).is_empty());
}
