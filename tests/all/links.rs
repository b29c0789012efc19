//! `ratetable run` as a user calls it: link budgets, a UART's time, a port that is unplugged, several outputs.

use rustix::pty::{OpenptFlags, openpt, ptsname, unlockpt};
use serde_json::Value;
use std::fs::File;
use std::io::Read;
use std::net::UdpSocket;
use std::os::fd::OwnedFd;
use std::os::unix::fs::{OpenOptionsExt, symlink};
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::thread;
use std::time::Duration;

/// Gyro and accel at 1 kHz, mag at 100 Hz: 25 820 bytes/s as `mpu`.
const SCENE: &str = "duration = \"1 s\"\nseed = 3\n[gyro]\nrate = \"1 kHz\"\nnoise_std = \"0.1 deg/s\"\n[accel]\nrate = \"1 kHz\"\nnoise_std = \"1 mg\"\n[mag]\nrate = \"100 Hz\"\nnoise_std = \"0.1 uT\"\n";

fn ratetable(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_ratetable"));
    command.args(arguments);
    command
}

fn run(arguments: &[&str]) -> Output {
    ratetable(arguments).output().expect("the program starts")
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn start(arguments: &[&str]) -> Child {
    ratetable(arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the program starts")
}

/// The report of a run that has `--json`.
fn report(child: Child) -> (Value, Option<i32>, String) {
    let output = child.wait_with_output().unwrap();
    let report =
        serde_json::from_slice(&output.stdout).unwrap_or_else(|error| panic!("{error}: {}", said(&output)));
    (report, output.status.code(), said(&output))
}

/// The scene in a file of its own.
fn scene(folder: &Path, text: &str) -> String {
    let path = folder.join("scene.toml");
    std::fs::write(&path, text).unwrap();
    path.to_str().unwrap().to_owned()
}

/// Opens a path as soon as something stands there, as firmware opens its port.
fn open_soon(path: &Path) -> File {
    for _ in 0..6000 {
        match File::options().read(true).custom_flags(libc::O_NOCTTY).open(path) {
            Ok(file) => return file,
            Err(_) => thread::sleep(Duration::from_millis(10)),
        }
    }
    panic!("{} never came", path.display());
}

/// Everything that comes until the other side closes.
fn read_all(mut file: File) -> Vec<u8> {
    let mut all = Vec::new();
    // A pty ends with an error when its master closes.
    let _ = file.read_to_end(&mut all);
    all
}

fn count(report: &Value, link: usize, field: &str) -> u64 {
    report["links"][link][field].as_u64().unwrap_or_else(|| panic!("{field} in {report}"))
}

/// Made is sent, dropped or queued, on every link and of every sensor.
fn check_identity(report: &Value) {
    for entry in ["links", "sensors"].iter().flat_map(|list| report[list].as_array().unwrap()) {
        let [made, sent, dropped, queued] =
            ["made", "sent", "dropped", "queued"].map(|field| entry[field].as_u64().unwrap());
        assert_eq!(made, sent + dropped + queued, "{entry}");
    }
}

#[test]
fn a_scene_that_its_baud_rate_does_not_carry_is_refused_with_what_would_do() {
    let folder = tempfile::tempdir().unwrap();
    let scene = scene(folder.path(), SCENE);
    let to = |to: &'static str| run(&["run", &scene, "--wait", "0.1s", "--to", to]);
    let refused = to("mpu@pty,115200");
    let text = said(&refused);
    assert_eq!(refused.status.code(), Some(2), "{text}");
    for part in [
        "mpu@pty,115200 needs 25820 bytes/s (1101 packets/s), and 115200 baud carries 11520 (8N1: 115200/10)",
        "224 %",
        "mpu@pty,460800 carries 46080 bytes/s",
        "no other packets: layout = \"separate\" needs",
        "take 2.241 times as long: overload = \"stretch\"",
        "--force, or force = true",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
    assert!(!text.contains("ready:"), "nothing was opened: {text}");

    // What is offered does, and the next rate up does not.
    let rate: u32 = text.split("gyro.rate='").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
    for (rate, fits) in [(rate, true), (rate + 1, false)] {
        let sets = [format!("gyro.rate={rate} Hz"), format!("accel.rate={rate} Hz")];
        let output = run(&[
            "run",
            &scene,
            "--wait",
            "0.1s",
            "--to",
            "mpu@pty,115200",
            "--set",
            &sets[0],
            "--set",
            &sets[1],
        ]);
        assert_eq!(said(&output).contains("ready:"), fits, "{rate} Hz: {}", said(&output));
    }
    assert!(said(&to("mpu@pty,460800")).contains("ready:"));
    // The baud rate before it does not, at twice the speed it does not either, and without a baud rate all is well.
    assert!(!said(&to("mpu@pty,230400")).contains("ready:"));
    let faster = run(&["run", &scene, "--wait", "0.1s", "--to", "mpu@pty,460800", "--speed", "2"]);
    assert!(said(&faster).contains("needs 51640 bytes/s"), "{}", said(&faster));
    assert!(said(&to("mpu@pty")).contains("ready:"));
}

#[test]
fn a_user_who_wants_to_lose_packets_says_so_on_the_line_or_in_the_scene() {
    let folder = tempfile::tempdir().unwrap();
    for (keys, more, but) in [
        ("", "--force", "the rest is lost"),
        ("force = true\n", "--json", "the rest is lost"),
        ("overload = \"stretch\"\n", "--json", "scene time is stretched"),
    ] {
        let scene = scene(folder.path(), &format!("{SCENE}[[output]]\nto = \"mpu@pty,115200\"\n{keys}"));
        let text = said(&run(&["run", &scene, "--wait", "0.1s", more]));
        assert!(
            text.contains("224 % of it; ") && text.contains(but) && text.contains("ready:"),
            "{keys}: {text}"
        );
        let checked = run(&["check", &scene]);
        assert!(String::from_utf8_lossy(&checked.stdout).contains("mpu@pty,460800 carries 46080"));
    }
    // An output folder that exists is protected by the same word.
    let taken = folder.path().join("taken");
    std::fs::create_dir(&taken).unwrap();
    std::fs::write(taken.join("thesis.txt"), "mine").unwrap();
    let output = run(&["run", "still", "--for", "0.1s", "--to", "mpu@pty", "--out", taken.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(2), "{}", said(&output));
}

#[test]
fn a_pty_with_a_baud_rate_loses_exactly_what_a_uart_would_not_carry() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("imu");
    // A second of it is some nine kilobytes, so that a machine that is busy for half a second costs nothing.
    let text = "duration = \"1 s\"\n[gyro]\nrate = \"100 Hz\"\nnoise_std = \"0.1 deg/s\"\n";
    for (baud, carries) in [(19_200, false), (460_800, true)] {
        let to = format!("jsonl@pty:{},{baud}", path.display());
        let scene = scene(folder.path(), text);
        let child = start(&["run", &scene, "--to", &to, "--force", "--json"]);
        let received = read_all(open_soon(&path));
        let (report, code, text) = report(child);
        check_identity(&report);
        assert!(
            text.contains(&format!("the timing of a UART at {baud} baud: {} bytes/s", baud / 10)),
            "{text}"
        );
        assert_eq!(received.len() as u64, count(&report, 0, "bytes"), "what was sent arrived");
        assert_eq!(count(&report, 0, "paced_baud"), baud);
        let lines = received.iter().filter(|byte| **byte == b'\n').count() as u64;
        assert_eq!((lines, count(&report, 0, "made")), (count(&report, 0, "sent"), 100));
        assert_eq!(
            (code, count(&report, 0, "dropped") > 0),
            if carries { (Some(0), false) } else { (Some(1), true) }
        );
        if !carries {
            assert!(count(&report, 0, "queue_bytes") >= 4000, "{report}");
        }
    }
}

#[test]
fn a_stretched_scene_takes_the_time_its_line_needs_and_loses_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let there = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let table = format!("[[output]]\nto = \"mpu@pty:{},115200\"\noverload = \"stretch\"\n", there("imu"));
    let scene = scene(folder.path(), &format!("{SCENE}{table}"));
    let child = start(&["run", &scene, "--json"]);
    let received = read_all(open_soon(Path::new(&there("imu"))));
    let (report, code, text) = report(child);
    check_identity(&report);
    assert_eq!(code, Some(0), "{text}");
    let to = format!("mpu@file:{}", there("alone"));
    assert!(run(&["run", &scene, "--to", &to, "--speed", "max"]).status.success());
    assert!(received == std::fs::read(there("alone")).unwrap(), "the same bytes, later");
    // All but what the buffer (and the packet that it cut) held at the end has left at 11 520 bytes/s.
    let least = (received.len() as f64 - 4096.0 - 280.0) / 11_520.0 - 1.0;
    let stretched = report["stretched_s"].as_f64().unwrap();
    assert!(stretched > least && least > 0.8, "{stretched} s");
    assert!(text.contains("scene time stood still for"), "{text}");
}

/// A port of somebody else's, published at `path`: its master.
fn plug_in(path: &Path) -> OwnedFd {
    let master = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC).unwrap();
    unlockpt(&master).unwrap();
    let device = ptsname(&master, Vec::new()).unwrap().into_string().unwrap();
    let _ = std::fs::remove_file(path);
    symlink(device, path).unwrap();
    master
}

/// Reads lines until one that is due at `until_ms` or later has come, or the link ends; their times in ms.
fn times(port: &mut File, until_ms: i64) -> Vec<i64> {
    let (mut text, mut times) = (Vec::new(), Vec::new());
    let mut part = [0; 1024];
    while times.last().is_none_or(|last| *last < until_ms) {
        match port.read(&mut part) {
            Ok(count) if count > 0 => text.extend_from_slice(&part[..count]),
            _ => break,
        }
        while let Some(end) = text.iter().position(|byte| *byte == b'\n') {
            let line: Vec<u8> = text.drain(..=end).collect();
            let line: Value = serde_json::from_slice(&line).expect("whole lines");
            times.push(line["t_ns"].as_i64().unwrap() / 1_000_000);
        }
    }
    times
}

#[test]
fn a_port_that_is_unplugged_is_opened_again_and_the_gap_is_reported() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("adapter");
    // So few that a machine that is busy for a while loses none of them.
    let text = "duration = \"2 s\"\n[gyro]\nrate = \"100 Hz\"\nnoise_std = \"0.1 deg/s\"\n";
    let scene = scene(folder.path(), text);
    let mut port = File::from(plug_in(&path));
    let to = format!("jsonl@serial:{},1500000", path.display());
    let child = start(&["run", &scene, "--to", &to, "--json"]);
    let before = times(&mut port, 300);
    std::fs::remove_file(&path).unwrap();
    drop(port);
    thread::sleep(Duration::from_millis(300));
    let mut port = File::from(plug_in(&path));
    let reading = thread::spawn(move || times(&mut port, i64::MAX));
    let (report, code, text) = report(child);
    let after = reading.join().unwrap();
    check_identity(&report);
    assert_eq!(code, Some(1), "samples were lost");
    assert!(text.contains("was unplugged: it is opened again when it is back"), "{text}");
    assert!(text.contains("is back: the scene goes on where it is now"), "{text}");
    let gaps = &report["links"][0]["gaps"];
    assert_eq!(
        (gaps["count"].as_u64(), gaps["dropped"].as_u64()),
        (Some(1), Some(count(&report, 0, "dropped")))
    );
    let gap_ms = gaps["total_s"].as_f64().unwrap() * 1000.0;
    assert!(gap_ms >= 200.0, "{gap_ms} ms");
    // A packet each ten milliseconds: the scene went on meanwhile, and goes on from there without a hole.
    let (last, first) = (*before.last().unwrap(), after[0]);
    let missing = (first - last) / 10 - 1;
    assert!(
        first - last >= 200 && after.windows(2).all(|pair| pair[1] == pair[0] + 10),
        "{last}, then {first}"
    );
    // What the port had taken when it was pulled out counts as sent.
    assert!((0..missing + 1).contains(&(count(&report, 0, "dropped") as i64)), "{missing}: {report}");
    assert_eq!(
        count(&report, 0, "sent") as usize,
        before.len() + after.len() + (missing as usize - count(&report, 0, "dropped") as usize)
    );
    assert_eq!(after.last(), Some(&1990), "to the end");
}

#[test]
fn several_outputs_of_one_scene_each_get_exactly_their_packets() {
    let folder = tempfile::tempdir().unwrap();
    let there = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let far = UdpSocket::bind("127.0.0.1:0").unwrap();
    far.set_read_timeout(Some(Duration::from_millis(100))).unwrap();
    let outputs = [
        format!("mpu@pty:{}", there("imu")),
        format!("csv@file:{}", there("all.csv")),
        format!("mavlink@udpout:{}", far.local_addr().unwrap()),
    ];
    let tables: String = outputs.iter().map(|to| format!("[[output]]\nto = \"{to}\"\n")).collect();
    // So little that the system's buffers hold all of it: what arrives does not depend on how busy the machine is.
    let scene = scene(folder.path(), &format!("{}{tables}", SCENE.replace("1 kHz", "200 Hz")));
    let child = start(&["run", &scene, "--json"]);
    let (done, over) = std::sync::mpsc::channel::<()>();
    let datagrams = thread::spawn(move || {
        let (mut all, mut packets, mut part) = (Vec::new(), 0, [0; 2000]);
        loop {
            match far.recv(&mut part) {
                Ok(count) => {
                    all.extend_from_slice(&part[..count]);
                    packets += 1;
                }
                Err(_) if over.try_recv() == Err(std::sync::mpsc::TryRecvError::Disconnected) => {
                    return (all, packets);
                }
                Err(_) => {}
            }
        }
    });
    let serial = read_all(open_soon(Path::new(&there("imu"))));
    let (report, code, text) = report(child);
    drop(done);
    let (udp, packets) = datagrams.join().unwrap();
    check_identity(&report);
    assert_eq!(code, Some(0), "{text}");
    let file = std::fs::read(there("all.csv")).unwrap();
    for (link, (protocol, received)) in
        [("mpu", serial), ("csv", file), ("mavlink", udp)].into_iter().enumerate()
    {
        let alone = there("alone");
        let output =
            run(&["run", &scene, "--to", &format!("{protocol}@file:{alone}"), "--speed", "max", "--json"]);
        assert_eq!(output.status.code(), Some(0), "{}", said(&output));
        assert!(
            received == std::fs::read(&alone).unwrap(),
            "{protocol}: the bytes of a run with that output alone"
        );
        assert_eq!(count(&report, link, "bytes"), received.len() as u64);
    }
    assert_eq!(packets, count(&report, 2, "sent"), "a datagram a packet");
}

#[test]
fn a_reader_that_stalls_costs_the_other_outputs_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let there = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let tables = format!(
        "[[output]]\nto = \"jsonl@pty:{}\"\noverload = \"drop-oldest\"\n[[output]]\nto = \"csv@file:{}\"\n",
        there("imu"),
        there("all.csv")
    );
    let scene = scene(folder.path(), &format!("{SCENE}{tables}"));
    let child = start(&["run", &scene, "--json"]);
    // It opens its port and never reads.
    let port = open_soon(Path::new(&there("imu")));
    let (report, code, text) = report(child);
    drop(port);
    check_identity(&report);
    assert_eq!(code, Some(1), "{text}");
    assert!(count(&report, 0, "dropped") > 500, "{report}");
    assert_eq!((count(&report, 1, "dropped"), count(&report, 1, "queued")), (0, 0));
    assert_eq!(count(&report, 0, "queued"), 64, "the newest wait for a reader to the end");
    let alone = there("alone");
    assert!(run(&["run", &scene, "--to", &format!("csv@file:{alone}"), "--speed", "max"]).status.success());
    assert!(std::fs::read(there("all.csv")).unwrap() == std::fs::read(alone).unwrap());
}
