//! The program's guidance as a process: help with examples that work, completions, manual pages, lists, and messages
//! for what cannot be.

use assert_cmd::Command as Asserted;
use std::ffi::OsStr;
use std::os::unix::ffi::OsStrExt;
use std::path::Path;
use std::process::{Child, Command, Stdio};

const COMMANDS: [&str; 10] =
    ["run", "timing", "generate", "check", "listen", "score", "study", "list", "completions", "man"];

struct Said {
    code: i32,
    out: String,
    err: String,
}

fn ratetable_in(folder: &Path, arguments: &[impl AsRef<OsStr>]) -> Said {
    let output =
        Asserted::cargo_bin("ratetable").unwrap().current_dir(folder).args(arguments).output().unwrap();
    Said {
        code: output.status.code().unwrap_or(-1),
        out: String::from_utf8(output.stdout).unwrap(),
        err: String::from_utf8_lossy(&output.stderr).into_owned(),
    }
}

fn ratetable(arguments: &[&str]) -> Said {
    ratetable_in(Path::new("."), arguments)
}

/// The commands below `Examples` in a help.
fn examples(help: &str) -> Vec<String> {
    let below = help.split_once("Examples").map_or("", |(_, below)| below);
    below.lines().map(str::trim).filter(|line| line.starts_with("ratetable ")).map(String::from).collect()
}

/// What an example needs that is not on every machine.
fn needs(example: &str) -> bool {
    ["/dev/tty", "udpin", "mine.csv", "/tmp/imu", "px4"].iter().any(|what| example.contains(what))
        // As long as it takes, and shown by other tests.
        || ["ratetable run", "ratetable study all --out study"].contains(&example)
}

#[test]
fn every_help_has_three_to_five_examples_that_fit_a_terminal() {
    for command in COMMANDS {
        let help = ratetable(&[command, "--help"]);
        let found = examples(&help.out);
        assert!((2..=5).contains(&found.len()), "{command}: {found:?}");
        let widest = help.out.lines().map(|line| line.chars().count()).max().unwrap();
        assert!(widest <= 100, "{command}: a line of {widest} characters:\n{}", help.out);
        assert!(found.iter().all(|example| example.len() <= 78), "{command}: {found:?}");
    }
}

#[test]
fn every_example_of_a_help_that_needs_nothing_works_as_it_stands() {
    let folder = tempfile::tempdir().unwrap();
    let first =
        ratetable_in(folder.path(), &["generate", "table-1", "--out", "flight", "--set", "duration=8 s"]);
    assert_eq!(first.code, 0, "{}", first.err);
    let readings = ["run", "still", "--to", "csv@file:readings.csv", "--speed", "max", "--for", "1s"];
    assert_eq!(ratetable_in(folder.path(), &readings).code, 0);
    let mut ran = 0;
    for command in COMMANDS {
        for example in examples(&ratetable(&[command, "--help"]).out) {
            // The dataset that other examples rest on is there already, and timing has tests of its own.
            if needs(&example) || example.contains("--out flight") || command == "timing" {
                continue;
            }
            let bin = assert_cmd::cargo::cargo_bin("ratetable");
            let line = example.replacen("ratetable", "\"$RATETABLE\"", 1);
            let mut shell = Command::new("bash");
            let done =
                shell.arg("-c").arg(&line).env("RATETABLE", bin).current_dir(folder.path()).output().unwrap();
            assert!(done.status.success(), "{example}: {}", String::from_utf8_lossy(&done.stderr));
            ran += 1;
        }
    }
    assert!(ran >= 20, "{ran} examples were run");
}

#[test]
fn an_example_that_needs_hardware_is_understood_and_says_what_lacks() {
    let folder = tempfile::tempdir().unwrap();
    for command in COMMANDS {
        let found = examples(&ratetable(&[command, "--help"]).out);
        for example in found.iter().filter(|example| example.contains("/dev/ttyUSB")) {
            let words: Vec<&str> = example.split(' ').skip(1).filter(|word| !word.is_empty()).collect();
            let said = ratetable_in(folder.path(), &words);
            assert_eq!(said.code, 2, "{example}: {}", said.err);
            assert!(
                said.err.contains("/dev/ttyUSB") && !said.err.contains("Usage"),
                "{example}: {}",
                said.err
            );
        }
    }
}

/// Whether there is such a program.
fn there_is(program: &str) -> bool {
    let mut command = Command::new(program);
    command.arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok()
}

#[test]
fn bash_can_load_its_completions_and_every_command_is_in_them() {
    let script = ratetable(&["completions", "bash"]);
    let checked = Asserted::new("bash").arg("-n").write_stdin(script.out.clone()).output().unwrap();
    assert!(checked.status.success(), "{}", String::from_utf8_lossy(&checked.stderr));
    let broken = Asserted::new("bash").arg("-n").write_stdin("case x in\n").output().unwrap();
    assert!(!broken.status.success(), "bash -n notices a script that is none");
    let asks = "COMP_WORDS=(ratetable ge); COMP_CWORD=1; _ratetable ratetable ge ratetable; echo \"${COMPREPLY[@]}\"";
    let loaded = Command::new("bash").arg("-c").arg(format!("{}\n{asks}", script.out)).output().unwrap();
    assert_eq!(String::from_utf8_lossy(&loaded.stdout).trim(), "generate");
    for shell in ["zsh", "fish", "elvish", "powershell"] {
        let script = ratetable(&["completions", shell]);
        assert!(script.code == 0 && COMMANDS.iter().all(|command| script.out.contains(command)), "{shell}");
    }
}

#[test]
fn there_is_a_manual_page_for_each_command_and_man_renders_it() {
    let folder = tempfile::tempdir().unwrap();
    let made = ratetable_in(folder.path(), &["man", "--out", "man1"]);
    assert_eq!(made.code, 0, "{}", made.err);
    for command in COMMANDS {
        let path = folder.path().join(format!("man1/ratetable-{command}.1"));
        let page = std::fs::read_to_string(&path).unwrap();
        assert!(
            page.contains(&format!(".TH ratetable-{command} 1")) && page.contains(".SH SYNOPSIS"),
            "{command}"
        );
        assert!(page.contains("Examples"), "{command}: {page}");
        if there_is("man") && there_is("groff") {
            let shown = Command::new("man").arg("-l").arg(&path).env("MANPAGER", "cat").output().unwrap();
            let text = String::from_utf8_lossy(&shown.stdout);
            assert!(shown.status.success() && text.contains("SYNOPSIS"), "{command}: {text}");
        }
    }
    assert_eq!(
        std::fs::read_to_string(folder.path().join("man1/ratetable.1")).unwrap(),
        ratetable(&["man"]).out
    );
    let again = ratetable_in(folder.path(), &["man", "--out", "man1"]);
    assert_eq!(again.code, 2, "a folder that holds something is left alone");
}

#[test]
fn a_list_shows_one_of_it_by_name_with_all_that_is_known() {
    let part = ratetable(&["list", "parts", "mpu-9250"]).out;
    for what in
        ["gyro noise_density = 0.01 deg/s/", "gyro scales:", "gyro rates:", "gyro filters:", "PS-MPU-9250A"]
    {
        assert!(part.contains(what), "{what}: {part}");
    }
    let inside = ratetable(&["list", "parts", "AK09916"]).out;
    assert!(inside.starts_with("AK09916: the mag of the ICM-20948") && !inside.contains("gyro "), "{inside}");
    let key = ratetable(&["list", "keys", "gyro.white_noise"]);
    assert_eq!(key.code, 2, "{}", key.out);
    let key = ratetable(&["list", "keys", "mag.hard_iron"]).out;
    assert!(key.contains("[mag]") && key.lines().count() == 2, "{key}");
    // A scene comes out as a file that can be played.
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("mine.toml"), ratetable(&["list", "scenes", "still"]).out).unwrap();
    assert_eq!(ratetable_in(folder.path(), &["check", "mine.toml"]).code, 0);
    let formats = ratetable(&["list", "formats"]).out;
    let help = ratetable(&["generate", "--help"]).out;
    for format in ["csv", "npy", "mat", "tum", "resd", "parquet", "mcap"] {
        assert!(formats.contains(format) && help.contains(format), "{format} is there, or is told to lack");
    }
    assert!(ratetable(&["list", "fields", "run"]).out.contains("  sensors.NAME.late_us.p99: µs\n"));
    assert!(ratetable(&["list", "targets", "inav"]).out.contains("115200 baud"));
}

#[test]
fn a_name_that_a_list_does_not_have_is_told_with_the_nearest() {
    for (list, name, near) in [
        ("parts", "MPU9250", "MPU-9250"),
        ("keys", "gyro.noise_densty", "gyro.noise_density"),
        ("motions", "rotat", "rotate"),
        ("targets", "px5", "px4"),
        ("formats", "parket", "parquet"),
        ("protocols", "mavlnk", "mavlink"),
    ] {
        let said = ratetable(&["list", list, name]);
        assert_eq!((said.code, said.out.as_str()), (2, ""), "{list}");
        let expected = format!("did you mean `{near}`?");
        assert!(said.err.contains(name) && said.err.contains(&expected), "{}", said.err);
    }
}

#[test]
fn what_cannot_be_is_said_with_what_would_be_right() {
    let folder = tempfile::tempdir().unwrap();
    let runs = ["generate", "still", "--set", "duration=1 ms", "--out", "runs", "--shard", "0/1000000"];
    let many = ratetable_in(folder.path(), &[&runs[..], &["--runs", "1e6"]].concat());
    assert!(many.code == 0 && many.err.contains(": 1 run of 0.001 s"), "{}", many.err);
    for wrong in ["1.5", "0", "-1", "1e30", "many"] {
        let said = ratetable(&["generate", "still", "--out", "never", &format!("--runs={wrong}")]);
        assert_eq!(said.code, 2);
        assert!(
            said.err.contains(wrong) && said.err.contains("such as 1000 or 1e6"),
            "{wrong}: {}",
            said.err
        );
    }
    let broken = OsStr::from_bytes(b"sc\xffne.toml");
    let said = ratetable_in(folder.path(), &[OsStr::new("check"), broken]);
    assert_eq!(said.code, 2);
    assert!(said.err.contains("argument 2, \"sc\\xFFne.toml\", is not UTF-8"), "{}", said.err);
    let mut listen = Command::new(assert_cmd::cargo::cargo_bin("ratetable"));
    let nothing = listen.args(["listen", "csv@-"]).stdin(Stdio::null()).output().unwrap();
    let nothing = (nothing.status.code(), String::from_utf8_lossy(&nothing.stderr).into_owned());
    assert!(nothing.0 == Some(2) && nothing.1.contains("not a byte came from -"), "{nothing:?}");
}

/// What the program prints on a terminal of so many columns.
fn on_a_terminal(columns: u16, arguments: &[&str]) -> String {
    let text = through_a_terminal(columns, |command, slave| command.args(arguments).stdout(slave).spawn());
    text.replace('\r', "")
}

/// What a person sees of the program who looks on, escape sequences included; with these variables.
fn looked_on(columns: u16, arguments: &[&str], variables: &[(&str, &str)]) -> String {
    through_a_terminal(columns, |command, slave| {
        command.env("TERM", "xterm").envs(variables.iter().copied());
        command.args(arguments).stderr(slave).stdout(Stdio::null()).spawn()
    })
}

/// What arrives at a terminal that a program is started on.
fn through_a_terminal(
    columns: u16,
    start: impl FnOnce(&mut Command, Stdio) -> std::io::Result<Child>,
) -> String {
    use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
    let master = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY).unwrap();
    grantpt(&master).unwrap();
    unlockpt(&master).unwrap();
    let name = ptsname(&master, Vec::new()).unwrap().into_string().unwrap();
    let slave = std::fs::OpenOptions::new().read(true).write(true).open(name).unwrap();
    let size = rustix::termios::Winsize { ws_row: 50, ws_col: columns, ws_xpixel: 0, ws_ypixel: 0 };
    rustix::termios::tcsetwinsize(&slave, size).unwrap();
    let mut command = Command::new(assert_cmd::cargo::cargo_bin("ratetable"));
    let mut child = start(&mut command, Stdio::from(slave)).unwrap();
    // Nobody but the child has the other end now: it is over when the child is.
    drop(command);
    let mut text = Vec::new();
    let mut piece = [0; 4096];
    while let Ok(count @ 1..) = rustix::io::read(&master, &mut piece) {
        text.extend_from_slice(&piece[..count]);
    }
    child.wait().unwrap();
    String::from_utf8(text).unwrap()
}

/// Without what moves the cursor, clears and colours.
fn bare(text: &str) -> String {
    let mut bare = String::new();
    let mut characters = text.chars();
    while let Some(c) = characters.next() {
        match c {
            '\u{1b}' => drop(characters.by_ref().find(|c| c.is_ascii_alphabetic())),
            '\r' => bare.push('\n'),
            c => bare.push(c),
        }
    }
    bare
}

#[test]
fn what_moves_on_a_terminal_keeps_to_its_columns_and_tells_the_attitude() {
    for columns in [60, 80, 120] {
        let seen = looked_on(columns, &["run", "table-1", "--for", "1500ms"], &[]);
        assert!(seen.contains("\u{1b}["), "it moves: {seen:?}");
        // The second line of what moves follows the first, which is as wide as the terminal.
        let lines = bare(&seen).replace("roll, pitch, yaw", "\nroll, pitch, yaw");
        // What comes before and after the bar is folded nowhere: it can be searched for in a log.
        let moving = lines.lines().filter(|line| line.contains(" %  ") || line.contains("roll, pitch, yaw"));
        let moving: Vec<_> = moving.collect();
        let widest = moving.iter().map(|line| line.chars().count()).max().unwrap();
        assert!(widest <= usize::from(columns), "{columns}: {moving:?}");
        assert!(moving.iter().any(|line| line.contains("packets")), "{columns}: {moving:?}");
        let estimated = moving.iter().any(|line| line.contains("true") && line.contains("estimated"));
        assert_eq!(estimated, columns >= 80, "{columns}: {moving:?}");
    }
}

#[test]
fn a_wait_counts_down_where_it_is_seen_and_is_said_once_where_it_is_not() {
    let wait = ["run", "still", "--to", "mpu@tcpin:0", "--wait", "3s"];
    let seen = bare(&looked_on(80, &wait, &[]));
    for left in [3, 2, 1] {
        assert!(seen.contains(&format!(", {left} s left")), "{left} in {seen}");
    }
    for said in [ratetable(&wait).err, looked_on(80, &wait, &[("TERM", "dumb")])] {
        assert_eq!(said.matches("waiting for").count(), 1, "{said}");
        assert!(!said.contains('\u{1b}'), "{said:?}");
    }
}

#[test]
fn who_wants_no_colour_gets_none() {
    let colours = |variables: &[(&str, &str)]| {
        let seen = looked_on(80, &["run", "table-1", "--for", "300ms"], variables);
        // What sets a colour ends in `m`.
        seen.split("\u{1b}[")
            .skip(1)
            .filter(|rest| {
                let end = rest.find(|c: char| c.is_ascii_alphabetic());
                end.is_some_and(|end| rest[end..].starts_with('m') && !matches!(&rest[..end], "" | "0"))
            })
            .count()
    };
    assert_eq!(colours(&[("NO_COLOR", "1")]), 0);
    assert!(colours(&[("CLICOLOR_FORCE", "1")]) > 0, "control");
}

#[test]
fn tables_keep_to_60_80_and_120_columns_and_to_the_terminal() {
    let natural = ratetable(&["check", "mpu-9250"]).out;
    let numbers = |text: &str| {
        let mut numbers: Vec<String> =
            text.split_whitespace().filter(|word| word.parse::<f64>().is_ok()).map(String::from).collect();
        numbers.sort();
        numbers.dedup();
        numbers
    };
    let widest = |text: &str| text.lines().map(|line| line.chars().count()).max().unwrap();
    assert!(widest(&natural) <= 120, "in a pipe:\n{natural}");
    for columns in [60, 80, 120] {
        for arguments in
            [&["check", "mpu-9250"][..], &["list", "methods"], &["list", "parts"], &["list", "keys"]]
        {
            let text = on_a_terminal(columns, arguments);
            assert!(widest(&text) <= usize::from(columns), "{arguments:?} in {columns} columns:\n{text}");
        }
        assert_eq!(
            numbers(&on_a_terminal(columns, &["check", "mpu-9250"])),
            numbers(&natural),
            "no number is broken"
        );
    }
    assert!(widest(&on_a_terminal(120, &["check", "mpu-9250"])) > 80, "and uses what there is");
}

#[test]
fn a_reader_that_is_waited_for_is_asked_for_by_the_path_to_open() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("imu");
    let to = format!("mpu@pty:{}", path.display());
    let said = ratetable(&["run", "still", "--to", &to, "--wait", "1s"]);
    let expected = format!("waiting for a reader to open {}, 1 s left", path.display());
    assert!(said.code == 2 && said.err.contains(&expected), "{}", said.err);
    let said = ratetable(&["run", "still", "--to", "mpu@tcpin:0", "--wait", "1s"]);
    assert!(said.err.contains("waiting for somebody to connect to 127.0.0.1:"), "{}", said.err);
    let at_once =
        ratetable(&["run", "still", "--to", &to, "--wait", "0", "--for", "100ms", "--speed", "max"]);
    assert!(!at_once.err.contains("waiting for"), "{}", at_once.err);
}
