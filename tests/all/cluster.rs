//! The examples of `docs/howto/cluster.md`, run as they stand in the page: their shares are together the whole.
//!
//! The one with Ray needs a Python that has it: `RATETABLE_PYTHON`. Where there is none the test says so and passes,
//! unless `RATETABLE_REQUIRE_PYTHON` is set, as `tests/run.sh` does, which makes one.

use std::collections::BTreeMap;
use std::env;
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

const PAGE: &str = include_str!("../../docs/howto/cluster.md");
const SCENE: &str = r#"
duration = "0.5 s"
[gyro]
part = "MPU-9250"
rate = "100 Hz"
[sweep]
gyro.noise_std = ["1 mrad/s", "2 mrad/s"]
"#;

/// The page's first block of that language.
fn example(language: &str) -> String {
    let (_, rest) = PAGE.split_once(&format!("```{language}\n")).expect("an example");
    rest.split_once("```").expect("its end").0.to_string()
}

/// `PATH` with the program's own folder first.
fn path() -> OsString {
    let program = assert_cmd::cargo::cargo_bin("ratetable");
    let own = program.parent().expect("a folder").to_path_buf();
    let others = env::var_os("PATH").unwrap_or_default();
    env::join_paths([own].into_iter().chain(env::split_paths(&others))).expect("a path")
}

/// Every file below a folder, by its path.
fn tree(dir: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut files = BTreeMap::new();
    let mut folders = vec![dir.to_path_buf()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                folders.push(path);
            } else {
                let name = path.strip_prefix(dir).expect("below").to_path_buf();
                files.insert(name, fs::read(&path).expect("a file"));
            }
        }
    }
    files
}

/// A folder with the scene and the whole of `runs` runs of it, made at once.
fn whole(runs: &str, format: &str) -> (tempfile::TempDir, BTreeMap<PathBuf, Vec<u8>>) {
    let home = tempfile::tempdir().expect("a folder");
    fs::write(home.path().join("scene.toml"), SCENE).expect("a scene");
    let mut command = assert_cmd::Command::cargo_bin("ratetable").expect("the program");
    let arguments = ["generate", "scene.toml", "--runs", runs, "--format", format, "--out", "whole"];
    command.current_dir(home.path()).args(arguments).assert().success();
    let whole = tree(&home.path().join("whole"));
    (home, whole)
}

#[test]
fn an_array_of_slurm_jobs_makes_the_whole() {
    let (home, whole) = whole("12", "npy");
    let script = home.path().join("script.sh");
    fs::write(&script, example("sh").replace("--runs 100000", "--runs 12")).expect("a script");
    for task in ["3", "1", "2"] {
        let done = Command::new("bash")
            .arg(&script)
            .current_dir(home.path())
            .env("PATH", path())
            .envs([("SLURM_ARRAY_TASK_ID", task), ("SLURM_ARRAY_TASK_COUNT", "3")])
            .env("SCRATCH", home.path())
            .status();
        assert!(done.expect("bash").success());
    }
    assert!(tree(&home.path().join("runs")) == whole);
}

/// The interpreter, or `None` after having said that there is none.
fn python() -> Option<String> {
    let python = env::var("RATETABLE_PYTHON").unwrap_or("python3".into());
    let found = Command::new(&python).args(["-c", "import ray"]).stderr(Stdio::null()).status();
    if found.is_ok_and(|status| status.success()) {
        return Some(python);
    }
    let why = format!("`{python}` cannot `import ray`");
    assert!(env::var_os("RATETABLE_REQUIRE_PYTHON").is_none(), "{why}");
    eprintln!("NOT TESTED with Ray: {why}; tests/run.sh makes a Python that can");
    None
}

#[test]
fn two_workers_of_ray_make_the_whole() {
    let Some(python) = python() else { return };
    let (home, whole) = whole("12", "csv");
    let program = home.path().join("shares.py");
    // On one machine with two workers, and no dashboard to serve.
    let two = "ray.init(num_cpus=2, include_dashboard=False, _node_ip_address=\"127.0.0.1\")";
    let text = example("python");
    assert!(text.contains("ray.init()"));
    fs::write(&program, text.replace("ray.init()", two)).expect("a program");
    let runs = home.path().join("runs");
    let output = Command::new(python)
        .arg(&program)
        .arg(home.path().join("scene.toml"))
        .args([runs.as_os_str(), "12".as_ref(), "4".as_ref()])
        .env("PATH", path())
        .env("RAY_USAGE_STATS_ENABLED", "0")
        .output()
        .expect("the program starts");
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{said}{}", String::from_utf8_lossy(&output.stderr));
    assert!(said.lines().any(|line| line == "2 workers"), "{said}");
    assert!(tree(&runs) == whole);
}
