//! Nothing is lost without a word: results that could not be written, files in the way, runs that somebody ends, and
//! scenes that nobody can play.

use assert_cmd::Command;
use std::fs::{self, File, OpenOptions};
use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};
use std::process::{Child, ExitStatus, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

const PATIENCE: Duration = Duration::from_secs(60);

/// A folder with a scene of its own in it.
struct Home(TempDir);

impl Home {
    fn new() -> Home {
        let home = Home(tempfile::tempdir().unwrap());
        home.put("scene.toml", "duration = \"2 s\"\n[gyro]\nrate = \"100 Hz\"\nnoise_std = \"1 deg/s\"\n");
        home
    }

    fn at(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn put(&self, name: &str, text: &str) {
        fs::write(self.at(name), text).unwrap();
    }

    fn text(&self, name: &str) -> String {
        fs::read_to_string(self.at(name)).unwrap()
    }

    fn names(&self, folder: &str) -> Vec<String> {
        let entries = fs::read_dir(self.at(folder)).unwrap();
        let mut names: Vec<_> =
            entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    /// The exit code and what was said on standard error.
    fn run(&self, arguments: &str) -> (i32, String) {
        let mut command = Command::cargo_bin("ratetable").unwrap();
        let done = command.current_dir(self.0.path()).args(arguments.split(' ')).output().unwrap();
        (done.status.code().unwrap(), String::from_utf8(done.stderr).unwrap())
    }

    fn refused(&self, arguments: &str, says: &[&str]) {
        let (code, said) = self.run(arguments);
        assert_eq!(code, 2, "{arguments}: {said}");
        says.iter().for_each(|word| assert!(said.contains(word), "{arguments}: no `{word}` in {said}"));
    }

    fn start(&self, arguments: &str) -> Running {
        let mut command = std::process::Command::new(assert_cmd::cargo::cargo_bin("ratetable"));
        command.current_dir(self.0.path()).args(arguments.split(' '));
        command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::piped());
        let mut child = command.spawn().unwrap();
        let said = BufReader::new(child.stderr.take().unwrap());
        Running { child, said, before: String::new() }
    }
}

/// A program at work.
struct Running {
    child: Child,
    said: BufReader<std::process::ChildStderr>,
    before: String,
}

impl Running {
    /// Reads on until it says so.
    fn until(&mut self, says: &str) -> &mut Running {
        while !self.before.contains(says) {
            let read = self.said.read_line(&mut self.before).unwrap();
            assert!(read > 0, "it ended without `{says}`: {}", self.before);
        }
        self
    }

    fn signal(&self, name: &str) {
        let sent = std::process::Command::new("kill").args([name, &self.child.id().to_string()]).status();
        assert!(sent.unwrap().success());
    }

    /// How it ended and all that it said.
    fn end(mut self) -> (ExitStatus, String) {
        let start = Instant::now();
        while self.child.try_wait().unwrap().is_none() {
            assert!(start.elapsed() < PATIENCE, "it does not end");
            std::thread::sleep(Duration::from_millis(5));
        }
        self.said.read_to_string(&mut self.before).unwrap();
        (self.child.wait().unwrap(), std::mem::take(&mut self.before))
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.child.kill();
    }
}

fn wait_for(what: &str, there: impl Fn() -> bool) {
    let start = Instant::now();
    while !there() {
        assert!(start.elapsed() < PATIENCE, "{what}");
        std::thread::sleep(Duration::from_millis(5));
    }
}

fn full() -> File {
    OpenOptions::new().write(true).open("/dev/full").unwrap()
}

/// Everything that a command prints as its result.
const PRINTS: [&str; 9] = [
    "check scene.toml",
    "check scene.toml --json",
    "list",
    "list parts",
    "--help",
    "run scene.toml --for 0.2s --speed max --to csv@file:packets --json",
    "run scene.toml --for 0.2s --to csv@-",
    "score truth vqf-6d --json",
    "listen csv@file:recording --json",
];

fn with_inputs() -> Home {
    let home = Home::new();
    home.put("both.toml", "duration = \"2 s\"\n[gyro]\nrate = \"100 Hz\"\n[accel]\nrate = \"100 Hz\"\n");
    assert_eq!(home.run("generate both.toml --out truth").0, 0);
    assert_eq!(home.run("run scene.toml --for 0.5s --speed max --to csv@file:recording").0, 0);
    home
}

#[test]
fn a_result_that_standard_output_does_not_take_is_exit_2_and_said() {
    let home = with_inputs();
    for arguments in PRINTS {
        let to = |stdout: Stdio| {
            let mut command = std::process::Command::new(assert_cmd::cargo::cargo_bin("ratetable"));
            command.current_dir(home.0.path()).args(arguments.split(' ')).stdin(Stdio::null());
            command.stdout(stdout).output().unwrap()
        };
        let done = to(full().into());
        let said = String::from_utf8_lossy(&done.stderr);
        assert_eq!(done.status.code(), Some(2), "{arguments}: {said}");
        assert!(said.contains("cannot write to standard output"), "{arguments}: {said}");
        assert!(!said.contains("panicked"), "{arguments}: {said}");
        // The same command with somewhere to write is content.
        assert_eq!(to(Stdio::null()).status.code(), Some(0), "{arguments}");
    }
}

#[test]
fn a_reader_that_has_enough_ends_it_quietly() {
    let home = with_inputs();
    for arguments in PRINTS.into_iter().chain(["run scene.toml --to csv@-"]) {
        let mut command = std::process::Command::new(assert_cmd::cargo::cargo_bin("ratetable"));
        command.current_dir(home.0.path()).args(arguments.split(' '));
        let (reader, writer) = std::io::pipe().unwrap();
        let mut child = command.stdin(Stdio::null()).stdout(writer).stderr(Stdio::piped()).spawn().unwrap();
        drop(command);
        let mut line = String::new();
        BufReader::new(reader).read_line(&mut line).unwrap();
        assert!(!line.is_empty(), "{arguments}");
        let mut said = String::new();
        child.stderr.take().unwrap().read_to_string(&mut said).unwrap();
        assert_eq!(child.wait().unwrap().code(), Some(0), "{arguments}: {said}");
        assert!(!said.contains("FAILED") && !said.contains("cannot write"), "{arguments}: {said}");
    }
}

#[test]
fn nobody_to_tell_is_no_reason_to_panic() {
    let home = with_inputs();
    for (arguments, code) in [
        ("check nowhere.toml", 2),
        ("run scene.toml --for 0.2s --to csv@file:packets", 0),
        ("run scene.toml --for 0.2s --to csv@file:packets --limit sensors.gyro.made<1", 1),
        ("generate scene.toml --out made", 0),
        ("score truth vqf-6d", 0),
        ("listen csv@file:recording", 0),
        ("no-such-command", 2),
    ] {
        for closed in [false, true] {
            let _ = fs::remove_dir_all(home.at("made"));
            let program = assert_cmd::cargo::cargo_bin("ratetable");
            let to = if closed { "2>&-" } else { "2>/dev/full" };
            let line =
                format!("exec '{}' {} >/dev/null {to}", program.display(), arguments.replace('<', "'<'"));
            let mut shell = std::process::Command::new("sh");
            let done = shell.current_dir(home.0.path()).args(["-c", &line]).status().unwrap();
            assert_eq!(done.code(), Some(code), "{arguments} {to}");
        }
    }
}

/// A real full disk, where this process may mount one in a name space of its own.
#[test]
fn a_disk_that_fills_up_is_said_and_leaves_no_half_of_a_dataset() {
    let home = Home::new();
    fs::create_dir(home.at("disk")).unwrap();
    let program = assert_cmd::cargo::cargo_bin("ratetable");
    let on_a_small_disk = |then: &str| {
        let line = format!("mount -t tmpfs -o size=64k none disk && {then}")
            .replace("ratetable", &program.display().to_string());
        let mut unshared = std::process::Command::new("unshare");
        unshared.args(["--user", "--map-root-user", "--mount", "sh", "-c", &line]);
        unshared.current_dir(home.0.path()).output()
    };
    let may = on_a_small_disk("true");
    if !may.is_ok_and(|done| done.status.success()) {
        eprintln!("NOT TESTED on a full disk: this process may not mount one");
        return;
    }
    for (then, says) in [
        ("ratetable generate scene.toml --set duration='60 s' --out disk/d; echo $? $(ls -A disk)", "2"),
        (
            "ratetable run scene.toml --set duration='600 s' --speed max --to csv@- >disk/packets; echo $?",
            "2",
        ),
        (
            "dd if=/dev/zero of=disk/fill bs=1k count=70 2>/dev/null; ratetable check scene.toml --json >disk/plan; echo $?",
            "2",
        ),
    ] {
        let done = on_a_small_disk(then).unwrap();
        let (out, said) = (String::from_utf8_lossy(&done.stdout), String::from_utf8_lossy(&done.stderr));
        assert_eq!(out.trim(), says, "{then}: {said}");
        assert!(said.to_lowercase().contains("no s"), "{then}: {said}");
    }
}

#[test]
fn an_output_is_neither_another_nor_what_the_scene_is_read_from_nor_in_the_output_folder() {
    let home = Home::new();
    home.put("log.csv", "t_s,wx_rad_s,wy_rad_s,wz_rad_s\n0,0.1,0.2,0.3\n1,0.1,0.2,0.3\n2,0.1,0.2,0.3\n");
    home.put(
        "imu.yaml",
        "update_rate: 100\ngyroscope_noise_density: 1e-3\ngyroscope_random_walk: 1e-5\naccelerometer_noise_density: 1e-2\naccelerometer_random_walk: 1e-4\n",
    );
    home.put(
        "named.toml",
        "[[motion]]\nkind = \"replay\"\nfile = \"log.csv\"\n[gyro]\npart = \"imu.yaml\"\n",
    );
    std::os::unix::fs::symlink(home.at("scene.toml"), home.at("link")).unwrap();
    fs::hard_link(home.at("log.csv"), home.at("hard")).unwrap();
    let before: Vec<_> = home.names(".").iter().map(|name| home.text(name)).collect();
    for (arguments, says) in [
        ("run scene.toml --to csv@file:scene.toml", "which the scene reads"),
        ("run scene.toml --to csv@file:link", "which the scene reads"),
        ("timing scene.toml --to csv@file:./scene.toml", "which the scene reads"),
        ("run named.toml --to csv@file:log.csv", "log.csv, which"),
        ("run named.toml --to csv@file:hard", "log.csv, which"),
        ("run named.toml --to csv@file:imu.yaml", "imu.yaml, which"),
        ("run scene.toml --to csv@- --to jsonl@-", "same place"),
        ("run scene.toml --to csv@file:a --to jsonl@file:./a", "same place"),
        ("run scene.toml --to csv@pty:a --to jsonl@file:a", "same place"),
        ("run scene.toml --to csv@udpout:localhost:9 --to mpu@udpout:127.0.0.1:9", "same place"),
        ("run scene.toml --out out --to csv@file:out/gyro.csv", "in the output folder"),
        ("run scene.toml --out out --to csv@file:out", "in the output folder"),
        ("timing scene.toml --out out --to csv@pty:out/imu", "in the output folder"),
    ] {
        home.refused(&format!("{arguments} --for 0.1s"), &[says]);
    }
    let after: Vec<_> = home.names(".").iter().map(|name| home.text(name)).collect();
    assert!(after == before, "nothing was touched");
    // Neighbours are no clash.
    let apart = "run named.toml --for 0.1s --speed max --out out --to csv@file:a --to jsonl@file:b --to mpu@file:/dev/null --to csv@file:/dev/null";
    let (code, said) = home.run(apart);
    assert_eq!(code, 0, "{said}");
}

#[test]
fn force_replaces_what_it_made_itself_and_nothing_else() {
    let home = with_inputs();
    let scene = home.text("scene.toml");
    home.put("README.md", "mine");
    home.refused("generate scene.toml --out . --force", &["`README.md`, `scene.toml`"]);
    home.refused("run scene.toml --for 0.1s --to csv@file:/dev/null --out . --force", &["`README.md`"]);
    assert_eq!((home.text("scene.toml"), home.text("README.md")), (scene, "mine".into()));
    // A dataset is replaced by a dataset, and by nothing else.
    home.refused("generate scene.toml --out truth", &["--force"]);
    home.refused("score truth vqf-6d --out truth --force", &["holds a dataset"]);
    home.refused("listen csv@file:recording --out truth --force", &["holds a dataset"]);
    home.refused("study cost --quick --out truth --force", &["holds a dataset"]);
    home.refused("timing --for 0.1s --out truth --force", &["holds a dataset"]);
    home.refused("generate truth/scene.toml --out truth --force", &["the scene reads it"]);
    assert_eq!(home.run("generate both.toml --out truth --force").0, 0);
    // Each command again over its own, and not over a report by hand.
    for command in
        ["score truth vqf-6d", "listen csv@file:recording", "timing --for 0.2s --to csv@file:/dev/null"]
    {
        let out = format!("of-{}", command.split(' ').next().unwrap());
        for force in ["", " --force"] {
            let (code, said) = home.run(&format!("{command} --out {out}{force}"));
            assert_eq!(code, 0, "{command}{force}: {said}");
        }
        assert!(home.text(&format!("{out}/manifest.json")).contains("report.json"));
        fs::remove_file(home.at(&out).join("manifest.json")).unwrap();
        home.refused(&format!("{command} --out {out} --force"), &["`report.json`"]);
    }
    // A table of runs by hand.
    fs::create_dir(home.at("runs")).unwrap();
    home.put("runs/runs.csv", "mine");
    home.refused("generate scene.toml --runs 2 --out runs --force", &["`runs.csv`"]);
    assert_eq!(home.text("runs/runs.csv"), "mine");
}

#[test]
fn a_terminal_that_is_closed_ends_a_run_as_it_should() {
    for signal in ["-HUP", "-TERM", "-INT"] {
        let home = Home::new();
        let long = "run scene.toml --set duration=10000s --to csv@pty:imu --out made -- sh -c";
        let mut arguments: Vec<&str> = long.split(' ').collect();
        arguments.push("echo $$ >child; exec cat {} >/dev/null");
        let mut command = std::process::Command::new(assert_cmd::cargo::cargo_bin("ratetable"));
        let mut child =
            command.current_dir(home.0.path()).args(&arguments).stderr(Stdio::piped()).spawn().unwrap();
        wait_for("the stream", || home.at("imu").is_symlink() && home.at("child").exists());
        wait_for("the child's number", || !home.text("child").is_empty());
        std::thread::sleep(Duration::from_millis(500));
        let sent =
            std::process::Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap();
        assert!(sent.success());
        let mut said = String::new();
        child.stderr.take().unwrap().read_to_string(&mut said).unwrap();
        child.wait().unwrap();
        assert!(said.contains("stopped by the user"), "{signal}: {said}");
        assert_eq!(home.names("."), ["child", "made", "scene.toml"], "{signal}");
        assert!(
            home.text("made/report.json").contains("\"duration_s\"") && home.at("made/gyro.csv").exists()
        );
        let process = format!("/proc/{}", home.text("child").trim());
        assert!(!Path::new(&process).exists(), "{signal}: the command still runs");
    }
}

#[test]
fn a_dataset_that_is_ended_leaves_nothing_hidden() {
    for (more, left) in [("", &[][..]), (" --figures", &[]), (" --runs 4", &["runs.csv"])] {
        for signal in ["-HUP", "-INT"] {
            let home = Home::new();
            let running = home.start(&format!("generate scene.toml --set duration=100000s --out made{more}"));
            let at_work = || {
                let inside = home.at("made").exists()
                    && home.names("made").iter().any(|name| name.contains("incomplete"));
                inside || home.names(".").iter().any(|name| name.contains("incomplete"))
            };
            wait_for("work", at_work);
            running.signal(signal);
            let (status, said) = running.end();
            assert_eq!(status.code(), Some(2), "{said}");
            assert!(said.contains("stopped"), "{said}");
            let there = if home.at("made").exists() { home.names("made") } else { Vec::new() };
            assert_eq!(there, left, "{more}");
            assert!(home.names(".").iter().all(|name| !name.starts_with('.')), "{:?}", home.names("."));
        }
    }
}

#[test]
fn a_second_ctrl_c_ends_it_at_once_and_one_alone_lets_it_end() {
    let home = Home::new();
    // A command that nothing but KILL ends keeps the program waiting for seconds.
    let mut program = std::process::Command::new(assert_cmd::cargo::cargo_bin("ratetable"));
    program.current_dir(home.0.path()).args([
        "run",
        "scene.toml",
        "--set",
        "duration=\"1e4 s\"",
        "--wait",
        "0",
    ]);
    program.args([
        "--to",
        "csv@file:packets",
        "--",
        "sh",
        "-c",
        "trap '' INT TERM HUP; echo $$ >child; exec sleep 60",
    ]);
    let mut child = program.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    wait_for("the child's number", || home.at("child").exists() && !home.text("child").is_empty());
    let interrupt =
        || std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    interrupt();
    std::thread::sleep(Duration::from_millis(300));
    interrupt();
    let start = Instant::now();
    let status = child.wait().unwrap();
    let number = home.text("child");
    let _ = std::process::Command::new("kill").args(["-KILL", number.trim()]).status();
    assert_eq!(status.code(), Some(130));
    assert!(start.elapsed() < PATIENCE);
}

#[test]
fn what_is_ended_before_anything_was_played_or_heard_is_exit_1() {
    let home = Home::new();
    for (arguments, ready) in [
        ("run scene.toml --to csv@pty:imu", "ready: "),
        ("run scene.toml --to csv@tcpin:0", "ready: "),
        ("timing scene.toml --to csv@tcpin:0", "ready: "),
        ("listen csv@udpin:0 --wait 0", "listening: "),
    ] {
        let mut running = home.start(arguments);
        running.until(ready).signal("-INT");
        let (status, said) = running.end();
        assert_eq!(status.code(), Some(1), "{arguments}: {said}");
        assert!(said.contains("FAILED"), "{arguments}: {said}");
    }
    // Ended in the midst of it, it is a shorter run and a good one.
    let mut running = home.start("run scene.toml --for forever --to csv@file:packets");
    running.until("ready: ");
    wait_for("packets", || fs::metadata(home.at("packets")).is_ok_and(|found| found.len() > 0));
    running.signal("-INT");
    let (status, said) = running.end();
    assert_eq!(status.code(), Some(0), "{said}");
}

#[test]
fn of_two_that_make_one_dataset_one_is_told_why_it_is_not_made() {
    let home = Home::new();
    let first = home.start("generate scene.toml --set duration=100000s --out made");
    wait_for("work", || home.at(".made.incomplete").exists());
    home.refused("generate scene.toml --out made", &["another process"]);
    first.signal("-INT");
    first.end();
    assert_eq!(home.run("generate scene.toml --out made").0, 0);
    assert_eq!(home.text("made/gyro.csv").lines().count(), 201);
}

#[test]
fn what_nobody_can_play_is_refused_at_once_and_says_why() {
    let home = Home::new();
    let motion = "[[motion]]\nkind = \"rotate\"\nduration = \"10 s\"\n";
    let sensor = "[gyro]\nrate = \"100 Hz\"\nsampling = \"average\"\n";
    home.put("fast.toml", &format!("{motion}roll = \"1e9 deg/s\"\n{sensor}"));
    home.put("cone.toml", &format!("[[motion]]\nkind = \"cone\"\nhalf_angle = \"5 deg\"\nfrequency = \"1e8 Hz\"\nduration = \"10 s\"\n{sensor}"));
    home.put("edge.toml", &format!("{motion}roll = \"1e6 deg/s\"\n{sensor}"));
    home.put("long.toml", "duration = \"2.5e6 h\"\n[gyro]\nrate = \"1 MHz\"\n");
    home.put(
        "auto.toml",
        "duration = \"20 h\"\n[gyro]\nrate = \"1 kHz\"\n[reference]\nmethod = \"auto\"\nfrom = \"gyro\"\n",
    );
    let list = vec!["\"1 deg/s\""; 16].join(", ");
    let lists: String = (0..16).map(|i| format!("\"gyro.k{i}\" = [{list}]\n")).collect();
    home.put("sweep.toml", &format!("duration = \"1 s\"\n[gyro]\nrate = \"1 Hz\"\n[sweep]\n{lists}"));
    for (arguments, says) in [
        ("check fast.toml", "1.000e9 deg/s"),
        ("generate fast.toml --out made", "1.000e9 deg/s"),
        ("check cone.toml", "above the limit of 1e6 deg/s"),
        ("check long.toml", "samples"),
        ("generate long.toml --out made", "TB"),
        ("check auto.toml", "name a `method`"),
        ("check sweep.toml", "64 bits"),
        ("generate sweep.toml --out made", "16 x 16"),
        ("generate scene.toml --out made --runs 18446744073709551615", "folders"),
        ("generate scene.toml --out made --runs 2000000", "above the limit of 1000000"),
        ("run scene.toml --to csv@file:/dev/null --speed 1e-12", "1e-6"),
        ("run scene.toml --to csv@file:/dev/null --speed 1e12", "1e6"),
    ] {
        home.refused(arguments, &[says]);
    }
    assert!(!home.at("made").exists());
    for arguments in ["check edge.toml", "run long.toml --for 0.01s --speed max --to csv@file:/dev/null"] {
        let (code, said) = home.run(arguments);
        assert_eq!(code, 0, "{arguments}: {said}");
    }
}

#[test]
fn check_says_how_much_a_dataset_comes_to_and_no_table_is_larger() {
    let home = Home::new();
    for scene in ["scene.toml", "table-1"] {
        let mut command = Command::cargo_bin("ratetable").unwrap();
        let done = command.current_dir(home.0.path()).args(["check", scene, "--json"]).output().unwrap();
        let plan: serde_json::Value = serde_json::from_slice(&done.stdout).unwrap();
        let out = format!("of-{scene}");
        assert_eq!(home.run(&format!("generate {scene} --out {out}")).0, 0);
        let manifest: serde_json::Value =
            serde_json::from_str(&home.text(&format!("{out}/manifest.json"))).unwrap();
        let samples: u64 = manifest["sensors"]
            .as_array()
            .unwrap()
            .iter()
            .map(|sensor| sensor["samples"].as_u64().unwrap())
            .sum();
        let tables = home.names(&out).into_iter().filter(|name| name.ends_with(".csv"));
        let bytes: u64 = tables.map(|name| fs::metadata(home.at(&out).join(name)).unwrap().len()).sum();
        assert_eq!(plan["bounds"]["samples"], samples);
        assert_eq!(plan["bounds"]["seconds"], plan["duration_s"]);
        let bound = plan["bounds"]["bytes"].as_u64().unwrap();
        assert!(bytes <= bound && bound < 5 * bytes, "{bytes} of {bound}");
    }
}

#[test]
fn the_tables_for_people_add_up() {
    let home = Home::new();
    home.put("mixed.toml", "duration = \"1e4 s\"\n[gyro]\nrate = \"1 kHz\"\n[mag]\nrate = \"50 Hz\"\n");
    let mut running = home.start("run mixed.toml --to csv@file:packets");
    running.until("ready: ");
    wait_for("packets", || fs::metadata(home.at("packets")).is_ok_and(|found| found.len() > 0));
    running.signal("-INT");
    let (_, said) = running.end();
    let mut lines = said.lines().skip_while(|line| !line.trim_start().starts_with("sensor"));
    let mut added = 0;
    while let Some(heading) = lines.next() {
        let columns: Vec<&str> = heading.split("  ").map(str::trim).filter(|cell| !cell.is_empty()).collect();
        let Some(made) = columns.iter().position(|cell| *cell == "made") else { continue };
        assert_eq!(&columns[made..made + 4], ["made", "sent", "dropped", "queued"]);
        for row in lines.by_ref().take_while(|line| !line.is_empty()) {
            let cells: Vec<&str> = row.split_whitespace().collect();
            let counts: Vec<u64> = cells[made..made + 4].iter().map(|cell| cell.parse().unwrap()).collect();
            assert_eq!(counts[0], counts[1..].iter().sum::<u64>(), "{row}");
            assert!(counts[3] > 0, "what was made ahead is seen: {row}");
            added += 1;
        }
    }
    assert_eq!(added, 3, "two sensors and a link: {said}");
}

#[test]
fn what_a_scene_asks_for_and_never_plays_is_told_by_check_and_run() {
    let home = Home::new();
    let motion = "[[motion]]\nkind = \"rotate\"\nyaw = \"1 deg/s\"\nduration = \"3 s\"\n";
    home.put(
        "odd.toml",
        &format!("duration = \"1 s\"\n{motion}{motion}[gyro]\nrate = \"10 Hz\"\n[mag]\nrate = \"10 Hz\"\nphase = \"2 s\"\n[[fault]]\nkind = \"off\"\nsensor = \"gyro\"\nstart = \"4 s\"\n"),
    );
    for arguments in ["check odd.toml", "run odd.toml --speed max --to csv@file:/dev/null"] {
        let mut command = Command::cargo_bin("ratetable").unwrap();
        let done = command.current_dir(home.0.path()).args(arguments.split(' ')).output().unwrap();
        let said = [done.stdout, done.stderr].concat();
        let said = String::from_utf8(said).unwrap();
        for word in ["a motion begins at 3 s", "mag never samples", "the fault gyro off from 4 s"] {
            assert!(said.contains(word), "{arguments}: no `{word}` in {said}");
        }
    }
    let (_, said) = home.run("run scene.toml --speed max --to csv@file:/dev/null");
    assert!(!said.contains("warning"), "{said}");
}
