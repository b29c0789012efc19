//! `ratetable listen` against `ratetable run`, two processes and a link: what is sent is what is counted.

use serde_json::Value;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};

/// Gyro, accel and mag at rates of their own, sent as fast as it is read: no test here goes by the wall clock.
const RUN: &[&str] =
    &["run", "still", "--for", "2s", "--speed", "max", "--json", "--set", "accel.rate='500 Hz'"];

fn ratetable(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_ratetable"));
    command.args(arguments).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

/// A program that has said where its link is.
struct Started {
    child: Child,
    place: String,
    said: BufReader<std::process::ChildStderr>,
}

impl Drop for Started {
    /// A test that fails leaves nothing running.
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Starts it and reads on until it says `ready: PROTOCOL@PLACE` or `listening: PROTOCOL@PLACE`.
fn start(arguments: &[&str]) -> Started {
    let mut child = ratetable(arguments).spawn().unwrap();
    let said = BufReader::new(child.stderr.take().unwrap());
    let mut started = Started { child, place: String::new(), said };
    let mut all = String::new();
    while started.place.is_empty() {
        let mut line = String::new();
        assert!(started.said.read_line(&mut line).unwrap() > 0, "{arguments:?} ended: {all}");
        all += &line;
        if line.starts_with("ready: ") || line.starts_with("listening: ") {
            started.place = line.trim_end().split_once('@').unwrap().1.to_string();
        }
    }
    started
}

/// Its exit code, its report and what it said.
fn ended(mut started: Started) -> (i32, Value, String) {
    let (mut out, mut text) = (String::new(), String::new());
    started.child.stdout.take().unwrap().read_to_string(&mut out).unwrap();
    started.said.read_to_string(&mut text).unwrap();
    let code = started.child.wait().unwrap().code().unwrap();
    (code, serde_json::from_str(&out).unwrap_or_else(|error| panic!("{error}: {out}{text}")), text)
}

fn whole(arguments: &[&str]) -> (i32, String, String) {
    let Output { status, stdout, stderr } = ratetable(arguments).output().unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    (status.code().unwrap(), text(stdout), text(stderr))
}

/// The number at a dotted place.
fn at<'v>(report: &'v Value, place: &str) -> &'v Value {
    place.split('.').fold(report, |value, step| match step.parse::<usize>() {
        Ok(i) => &value[i],
        Err(_) => &value[step],
    })
}

/// What was sent came, to the sample, the packet and the byte, and nothing was lost.
fn agree(sent: &Value, heard: &Value) {
    let (asked, seen) = (sent["sensors"].as_array().unwrap(), heard["sensors"].as_array().unwrap());
    assert_eq!(asked.len(), seen.len(), "{heard}");
    for (asked, seen) in asked.iter().zip(seen) {
        assert_eq!(asked["name"], seen["name"]);
        assert_eq!(asked["sent"], seen["received"], "{}", asked["name"]);
        assert!(asked["sent"].as_u64().unwrap() > 0);
        let (asked, seen) = (asked["rate_hz"].as_f64().unwrap(), seen["rate_hz"].as_f64().unwrap());
        assert!((seen / asked - 1.0).abs() < 1e-6, "by the sample times {seen} of {asked} Hz");
    }
    for place in ["links.0.packets", "links.0.bytes"] {
        assert_eq!(at(sent, place), at(heard, place), "{place}");
    }
    assert_eq!((at(heard, "links.0.crc_errors"), at(heard, "links.0.joined_midway")), (&0.into(), &0.into()));
    assert!(at(heard, "links.0.lost_seq").as_u64().is_none_or(|lost| lost == 0));
    assert_eq!((sent["ok"].as_bool(), heard["ok"].as_bool()), (Some(true), Some(true)), "{heard}");
}

#[test]
fn over_a_pty_by_its_path_every_protocol_arrives_whole() {
    for protocol in ["mpu", "mavlink", "csv", "jsonl"] {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("imu");
        let to = format!("{protocol}@pty:{}", path.display());
        let run = start(&[RUN, &["--to", &to]].concat());
        let listen = start(&["listen", &format!("{protocol}@{}", path.display()), "--json"]);
        let ((sent_code, sent, _), (code, heard, text)) = (ended(run), ended(listen));
        // MAVLink goes at the gyro's ticks, which are the fastest here, so no sample is replaced.
        agree(&sent, &heard);
        assert_eq!((sent_code, code), (0, 0), "{text}");
        assert!(at(&heard, "links.0.utilisation").is_null(), "a pty has no baud rate");
    }
}

#[test]
fn over_tcp_either_side_may_listen() {
    let run = start(&[RUN, &["--to", "mavlink@tcpin:0"]].concat());
    let listen = start(&["listen", &format!("mavlink@tcpout:{}", run.place), "--json"]);
    agree(&ended(run).1, &ended(listen).1);

    let listen = start(&["listen", "mavlink@tcpin:0", "--json"]);
    let run = start(&[RUN, &["--to", &format!("mavlink@tcpout:{}", listen.place)]].concat());
    agree(&ended(run).1, &ended(listen).1);
}

/// So few datagrams that a socket holds them all while nobody reads.
const FEW: &[&str] =
    &["--set", "gyro.rate='50 Hz'", "--set", "accel.rate='50 Hz'", "--set", "mag.rate='10 Hz'"];

#[test]
fn over_udp_the_listener_waits_or_greets() {
    let listen = start(&["listen", "mavlink@udpin:0", "--json", "--for", "3s"]);
    let run = start(&[RUN, FEW, &["--to", &format!("mavlink@udpout:{}", listen.place)]].concat());
    agree(&ended(run).1, &ended(listen).1);

    let run = start(&[RUN, FEW, &["--to", "mavlink@udpin:0"]].concat());
    let listen = start(&["listen", &format!("mavlink@udpout:{}", run.place), "--json", "--for", "3s"]);
    agree(&ended(run).1, &ended(listen).1);
}

/// The bytes of a run, played into a file.
fn recorded(folder: &Path, protocol: &str) -> (Vec<u8>, String) {
    let path = folder.join(protocol).display().to_string();
    let (code, _, text) = whole(&[RUN, &["--to", &format!("{protocol}@file:{path}")]].concat());
    assert_eq!(code, 0, "{text}");
    (std::fs::read(&path).unwrap(), path)
}

#[test]
fn injected_damage_and_loss_are_counted_exactly() {
    let folder = tempfile::tempdir().unwrap();
    let (bytes, path) = recorded(folder.path(), "mpu");
    let mut packets: Vec<Vec<u8>> = bytes.split_inclusive(|&byte| byte == 0).map(Vec::from).collect();
    let gyro = |packet: &Vec<u8>| packet.len() == 16 && packet[1] == 3;
    let places: Vec<usize> = (100..packets.len()).filter(|&i| gyro(&packets[i])).collect();
    let (hurt, taken) = (&places[..7], &places[20..31]);
    for &i in hurt {
        // In the checksum, and to no zero.
        packets[i][14] = if packets[i][14] == 0x55 { 0x56 } else { 0x55 };
    }
    let changed: Vec<u8> = packets
        .iter()
        .enumerate()
        .filter(|(i, _)| !taken.contains(i))
        .flat_map(|(_, packet)| packet.clone())
        .collect();
    std::fs::write(&path, &changed).unwrap();
    let from = format!("mpu@file:{path}");
    let (code, out, text) = whole(&["listen", &from, "--json"]);
    let report: Value = serde_json::from_str(&out).unwrap();
    let check = |report: &Value| {
        assert_eq!(at(report, "links.0.crc_errors"), 7);
        assert_eq!(at(report, "links.0.lost_seq"), 18, "eleven taken out and seven that were no use");
        assert_eq!(at(report, "links.0.packets"), packets.len() - 18);
        let received: Vec<_> = (0..3).map(|i| report["sensors"][i]["received"].as_u64().unwrap()).collect();
        assert_eq!(received, [2000 - 18, 1000, 200]);
        assert_eq!(report["sensors"][0]["missing"], 18, "by the sample times too");
        assert_eq!(
            report["failed"],
            serde_json::json!(["links.0.lost_seq = 18 > 0", "links.0.crc_errors = 7 > 0"])
        );
    };
    check(&report);
    assert_eq!(code, 1, "{text}");
    assert!(report["sensors"][0]["received_hz"].is_null() && text.contains("recording"), "{text}");

    let listen = start(&["listen", "mpu@tcpin:0", "--json"]);
    let mut sender = TcpStream::connect(&listen.place).unwrap();
    changed.chunks(777).for_each(|piece| sender.write_all(piece).unwrap());
    drop(sender);
    let (code, report, _) = ended(listen);
    check(&report);
    assert!(code == 1 && report["sensors"][0]["received_hz"].is_f64());
}

#[test]
fn faults_of_an_output_are_counted_at_the_other_end_of_a_pty_as_they_were_injected() {
    for kind in ["", "drop", "corrupt", "duplicate", "reorder", "stall", "split"] {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("imu").display().to_string();
        let fault =
            format!("[[fault]]\noutput = 0\nkind = \"{kind}\"\nstart = \"0.5 s\"\nduration = \"1 s\"\n");
        let share = if ["", "stall"].contains(&kind) { "" } else { "share = \"10 %\"\n" };
        let scene = format!(
            "duration = \"2 s\"\n[gyro]\nrate = \"1 kHz\"\nnoise_std = \"1 deg/s\"\n[accel]\nrate = \"1 kHz\"\n[[output]]\nto = \"mpu@pty:{path}\"\n{}{share}",
            if kind.is_empty() { "" } else { &fault }
        );
        let file = folder.path().join("scene.toml").display().to_string();
        std::fs::write(&file, scene).unwrap();
        let run = start(&["run", &file, "--speed", "max", "--json"]);
        let listen = start(&["listen", &format!("mpu@{path}"), "--json"]);
        let ((sent_code, sent, text), (code, heard, _)) = (ended(run), ended(listen));
        let acted = at(&sent, "links.0.faults").get(kind).map_or(0, |count| count.as_u64().unwrap());
        // A share of 1000 imu packets and a config: 10 % within five standard deviations, all of a stall.
        let bounds = match kind {
            "" => 0..=0,
            "stall" => 1001..=1001,
            _ => 50..=150,
        };
        assert!(bounds.contains(&acted), "{kind}: {acted}");
        let of = |injected: &[&str]| if injected.contains(&kind) { acted } else { 0 };
        let counted = |field: &str| at(&heard, &format!("links.0.{field}")).as_u64().unwrap();
        assert_eq!(counted("lost_seq"), of(&["drop", "corrupt"]), "{kind}");
        assert_eq!(counted("crc_errors"), of(&["corrupt"]), "{kind}");
        assert_eq!(counted("duplicates"), of(&["duplicate"]), "{kind}");
        assert_eq!(counted("out_of_order"), of(&["reorder"]), "{kind}");
        assert_eq!(counted("packets"), 2002 + of(&["duplicate"]) - of(&["drop", "corrupt"]), "{kind}");
        assert_eq!(at(&sent, "links.0.bytes"), at(&heard, "links.0.bytes"), "{kind}");
        let gyro = |field: &str| at(&heard, &format!("sensors.0.{field}")).as_u64().unwrap();
        // Of the packets that are hurt or missing at most two are the config's.
        let missing = gyro("missing");
        assert!(
            (of(&["drop", "corrupt"]) - missing.min(acted)) <= 1 && missing <= of(&["drop", "corrupt"]),
            "{kind}"
        );
        assert_eq!(at(&sent, "links.0.dropped"), 0, "a fault is no loss of ours");
        assert_eq!((sent_code, code), (0, i32::from(["drop", "corrupt"].contains(&kind))), "{kind}: {text}");
        let told = format!("mpu@pty:{path} {kind} from 0.5 s to 1.5 s");
        assert_eq!(
            sent["faults"],
            if kind.is_empty() { serde_json::json!([]) } else { serde_json::json!([told]) }
        );
        assert!(kind.is_empty() || text.contains(&format!("{kind} {acted}")), "{text}");
    }
}

#[test]
fn a_pipe_is_listened_to_as_it_comes() {
    let folder = tempfile::tempdir().unwrap();
    let (bytes, _) = recorded(folder.path(), "csv");
    let mut listen = ratetable(&["listen", "csv@-", "--json"]).stdin(Stdio::piped()).spawn().unwrap();
    listen.stdin.take().unwrap().write_all(&bytes).unwrap();
    let output = listen.wait_with_output().unwrap();
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(
        (at(&report, "sensors.0.received"), at(&report, "links.0.lost_seq")),
        (&2000.into(), &Value::Null)
    );
}

#[test]
fn a_pty_of_the_listeners_own_ends_when_its_writer_leaves() {
    let folder = tempfile::tempdir().unwrap();
    let (bytes, _) = recorded(folder.path(), "mpu");
    let path = folder.path().join("imu").display().to_string();
    let listen = start(&["listen", &format!("mpu@pty:{path}"), "--json"]);
    std::fs::OpenOptions::new().write(true).open(&path).unwrap().write_all(&bytes).unwrap();
    let (code, report, text) = ended(listen);
    assert_eq!((code, at(&report, "links.0.bytes")), (0, &bytes.len().into()), "{text}");
}

#[test]
fn ctrl_c_ends_with_the_report() {
    let listen = start(&["listen", "mpu@tcpin:0", "--json"]);
    let folder = tempfile::tempdir().unwrap();
    let (bytes, _) = recorded(folder.path(), "mpu");
    let mut sender = TcpStream::connect(&listen.place).unwrap();
    sender.write_all(&bytes).unwrap();
    // Once the socket is empty on our side it has been read, or waits to be.
    let pid = rustix::process::Pid::from_child(&listen.child);
    rustix::process::kill_process(pid, rustix::process::Signal::INT).unwrap();
    let (code, report, text) = ended(listen);
    assert!(text.contains("stopped by the user"), "{text}");
    // Where it was stopped before a sample came it says so.
    let heard = report["sensors"].as_array().is_some_and(|sensors| !sensors.is_empty());
    assert_eq!(code, i32::from(!heard), "{report}");
    drop(sender);
}

#[test]
fn the_folder_holds_the_report_and_the_chart() {
    let folder = tempfile::tempdir().unwrap();
    let (bytes, _) = recorded(folder.path(), "mpu");
    let out = folder.path().join("out").display().to_string();
    let listen = start(&["listen", "mpu@tcpin:0", "--json", "--out", &out]);
    TcpStream::connect(&listen.place).unwrap().write_all(&bytes).unwrap();
    let (code, report, _) = ended(listen);
    let written: Value =
        serde_json::from_slice(&std::fs::read(format!("{out}/report.json")).unwrap()).unwrap();
    assert_eq!((code, &written), (0, &report));
    let chart = std::fs::read_to_string(format!("{out}/intervals.svg")).unwrap();
    assert!(chart.starts_with("<svg") && chart.contains("gyro") && chart.contains("mag"));
    let page = std::fs::read_to_string(format!("{out}/report.html")).unwrap();
    let (_, messages) = page.split_once("id=\"messages\">").unwrap();
    let messages: Value = serde_json::from_str(messages.split_once("</script>").unwrap().0).unwrap();
    let link = &messages[1]["links"][0];
    for field in ["packets", "bytes"] {
        assert_eq!(link[field], report["links"][0][field], "the page has all that came: {link}");
    }
    let sensors = messages[0]["sensors"].as_array().unwrap();
    assert_eq!(sensors.len(), report["sensors"].as_array().unwrap().len());
    // All of it came at once, which may be one stretch of time.
    let readings = messages[1]["readings"].as_array().unwrap();
    assert!(readings.len() == sensors.len() && readings[0]["low"][2][0].is_number(), "and what it said");
    let (code, _, text) = whole(&["listen", "mpu@tcpin:0", "--wait", "1s", "--out", &out]);
    assert!(code == 2 && text.contains("--force"), "{text}");
}

#[test]
fn mistakes_say_what_would_be_right() {
    let folder = tempfile::tempdir().unwrap();
    let (_, path) = recorded(folder.path(), "mavlink");
    let noise = folder.path().join("noise").display().to_string();
    std::fs::write(&noise, [0x5a; 12_345]).unwrap();
    let empty = folder.path().join("empty").display().to_string();
    std::fs::write(&empty, []).unwrap();
    let cases: &[(&[&str], &[&str])] = &[
        (&["mpu"], &["PROTOCOL@LINK"]),
        (&["can@/dev/ttyUSB0"], &["`can` is not a protocol"]),
        (&["mpu@tcp:1"], &["is ambiguous"]),
        (&["mpu@/dev/ttyNONE7"], &["no port /dev/ttyNONE7"]),
        (&[&format!("mavlink@{path}")], &["a file, not a port", &format!("file:{path}")]),
        (&["mpu@file:/nowhere/at/all"], &["cannot read /nowhere/at/all"]),
        (&[&format!("mpu@file:{path}")], &["bytes came", "no valid mpu packet", "read as mavlink"]),
        (&[&format!("mpu@file:{noise}")], &["12345 bytes", "another protocol or another baud rate"]),
        (&[&format!("mpu@file:{empty}")], &["not a byte came", "empty"]),
        (&["mpu@udpin:0", "--wait", "100ms"], &["not a byte came", "within 0.1 s", "udpin:0.0.0.0"]),
        (&["mpu@pty", "--wait", "100ms"], &["not a byte came", "into the path"]),
        (
            &["mpu@udpin:0", "--limit", "sensors.gyro.late_us.p99<3"],
            &["`late_us` does not exist", "jitter_us"],
        ),
    ];
    for (arguments, says) in cases {
        let (code, _, text) = whole(&[&["listen"], *arguments].concat());
        assert_eq!(code, 2, "{arguments:?}: {text}");
        says.iter()
            .for_each(|part| assert!(text.contains(part), "{arguments:?}: {text:?} does not say {part:?}"));
    }
    let limits = ["--limit", "sensors.gyro.received<3", "--limit", "sensors.mag.missing<1"];
    let (code, _, text) = whole(&[&["listen", &format!("mavlink@file:{path}")], &limits[..]].concat());
    assert!(code == 1 && text.contains("FAILED: sensors.gyro.received = 2000 >= 3"), "{text}");
    assert!(!text.contains("mag.missing"), "that one is kept: {text}");
}
