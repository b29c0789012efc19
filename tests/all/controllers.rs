//! `ratetable run` with flight controllers at the other end: they speak first or are asked, the vehicle is held still,
//! each packet is answered, and a ground station listens in. The controllers here are scripts of what is said; their
//! estimators are the business of `firmware-host-tests`.

mod sitl;
mod vn100;

use ratetable_protocols::mavlink::{
    self, Header, Message, Version, attitude_quaternion, heartbeat, hil_actuator_controls, param_value,
};
use ratetable_protocols::msp::{self, simulator_reply};
use ratetable_protocols::vectornav;
use serde_json::Value;
use std::fs::File;
use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream, UdpSocket};
use std::os::unix::fs::OpenOptionsExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::thread;
use std::time::Duration;

/// Half a second at rest and a turn, with noise.
const SCENE: &str = "seed = 3\n[[motion]]\nkind = \"hold\"\nduration = \"0.5 s\"\n[[motion]]\nkind = \"rotate\"\nyaw = \"90 deg/s\"\nduration = \"1 s\"\n[gyro]\nrate = \"100 Hz\"\nnoise_std = \"0.1 deg/s\"\n[accel]\nrate = \"100 Hz\"\nnoise_std = \"1 mg\"\n[mag]\nrate = \"50 Hz\"\nnoise_std = \"0.1 uT\"\n";

/// A run under way, in a folder with the scene and the pty.
struct Run {
    folder: tempfile::TempDir,
    child: Child,
}

impl Run {
    fn start(to: &str, more: &[&str]) -> Run {
        let folder = tempfile::tempdir().unwrap();
        let scene = folder.path().join("scene.toml");
        std::fs::write(&scene, SCENE).unwrap();
        let to = to.replace("PTY", &format!("pty:{}", folder.path().join("port").display()));
        let mut command = Command::new(env!("CARGO_BIN_EXE_ratetable"));
        command.arg("run").arg(&scene).args(["--to", &to, "--json"]).args(more);
        let child =
            command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the program starts");
        Run { folder, child }
    }

    /// Of a scene with outputs of its own.
    fn of(scene: &str, more: &[&str]) -> Run {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("scene.toml");
        std::fs::write(&path, scene).unwrap();
        let mut command = Command::new(env!("CARGO_BIN_EXE_ratetable"));
        command.arg("run").arg(&path).arg("--json").args(more);
        let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn();
        Run { folder, child: child.expect("the program starts") }
    }

    fn port(&self) -> PathBuf {
        self.folder.path().join("port")
    }

    fn end(self) -> Output {
        self.child.wait_with_output().unwrap()
    }

    fn report(self) -> Value {
        let output = self.end();
        let report = serde_json::from_slice(&output.stdout);
        let report: Value = report.unwrap_or_else(|error| panic!("{error}: {}", said(&output)));
        for entry in ["links", "sensors"].iter().flat_map(|list| report[list].as_array().unwrap()) {
            let [made, sent, dropped, queued] =
                ["made", "sent", "dropped", "queued"].map(|field| entry[field].as_u64().unwrap());
            assert_eq!(made, sent + dropped + queued, "{entry}");
        }
        report
    }
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Opens a port as soon as it is there, as firmware does: raw bytes, no controlling terminal.
fn open(path: &Path) -> File {
    for _ in 0..3000 {
        match File::options().read(true).write(true).custom_flags(libc::O_NOCTTY).open(path) {
            Ok(file) => {
                let mut raw = rustix::termios::tcgetattr(&file).unwrap();
                raw.make_raw();
                rustix::termios::tcsetattr(&file, rustix::termios::OptionalActions::Now, &raw).unwrap();
                return file;
            }
            Err(_) => thread::sleep(Duration::from_millis(10)),
        }
    }
    panic!("{} never came", path.display());
}

/// What comes next, or nothing when the other side has left.
fn next(stream: &mut impl Read) -> Option<Vec<u8>> {
    let mut buffer = [0; 4096];
    match stream.read(&mut buffer) {
        Ok(count @ 1..) => Some(buffer[..count].to_vec()),
        _ => None,
    }
}

fn packet(message: &Message) -> Vec<u8> {
    let mut bytes = [0; mavlink::MAX_LEN];
    let header = Header { version: Version::V2, seq: 0, system: 42, component: 1 };
    let len = mavlink::encode(&header, message, &mut bytes).unwrap();
    bytes[..len].to_vec()
}

fn beat() -> Vec<u8> {
    let heartbeat =
        heartbeat::Repr { kind: 2, autopilot: 12, base_mode: 0x20, mavlink_version: 3, ..Default::default() };
    packet(&Message::Heartbeat(heartbeat))
}

#[test]
fn px4_in_lockstep_gets_each_packet_after_its_answer_to_the_one_before() {
    // Any free port: the program says which it was given.
    let port = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
    let aside = UdpSocket::bind("127.0.0.1:0").unwrap();
    let ground = UdpSocket::bind("127.0.0.1:0").unwrap().local_addr().unwrap();
    for speed in ["max", "4"] {
        let output = format!("[[output]]\nto = \"px4-sitl@tcpin:{port}\"\nanswers = \"udpin:{ground}\"\n");
        let run = Run::of(&format!("{SCENE}{output}"), &["--speed", speed]);
        let mut stream = loop {
            match TcpStream::connect(("127.0.0.1", port)) {
                Ok(stream) => break stream,
                Err(_) => thread::sleep(Duration::from_millis(10)),
            }
        };
        stream.set_nodelay(true).unwrap();
        stream.write_all(&beat()).unwrap();
        let answer = packet(&Message::HilActuatorControls(hil_actuator_controls::Repr {
            flags: hil_actuator_controls::LOCKSTEP,
            ..Default::default()
        }));
        let (mut decoder, mut sensed, mut last, mut together) = (mavlink::Decoder::new(), 0_u64, 0, 0);
        while let Some(bytes) = next(&mut stream) {
            let mut now = 0;
            decoder.feed(&bytes, |received| {
                if let Some(Message::HilSensor(sensor)) = received.unwrap().message {
                    assert!(sensor.time_usec > last || sensed == 0, "time goes on through the seam");
                    last = sensor.time_usec;
                    now += 1;
                }
            });
            sensed += now;
            // Its estimator boots longer than it answers; then it tells that it is level and faces north.
            if sensed > 400 {
                let told = attitude_quaternion::Repr {
                    time_boot_ms: (last / 1000) as u32,
                    q: [1.0, 0.0, 0.0, 0.0],
                    ..Default::default()
                };
                aside.send_to(&packet(&Message::AttitudeQuaternion(told)), ground).unwrap();
            }
            // The first twenty go unanswered; a while after the first answer there is only ever one on its way.
            together = together.max(if sensed > 120 { now } else { 0 });
            for _ in 0..if sensed > 20 { now } else { 0 } {
                if stream.write_all(&answer).is_err() {
                    break;
                }
            }
        }
        let report = run.report();
        assert_eq!(together, 1, "at {speed}");
        assert_eq!(report["ok"], true, "{report}");
        assert_eq!(report["sensors"][0]["sent"].as_u64(), Some(sensed));
        let rest = report["rest_s"].as_f64().unwrap();
        assert!(rest >= 1.0 && rest.fract() == 0.0, "{rest}");
        assert!(sensed > 400, "it is held at rest until its attitude is heard");
        let attitude = &report["attitude"];
        assert!(attitude["samples"].as_u64().unwrap() > 100, "{attitude}");
        assert!((attitude["max_deg"].as_f64().unwrap() - 90.0).abs() < 4.0, "{attitude}");
        assert_eq!(report["links"][0]["answers"]["expected"], 150, "{report}");
        assert_eq!(sensed, 150 + (rest * 100.0) as u64, "the rest is in the counts");
        assert_eq!(report["duration_s"], 1.5, "and not in the duration");
    }
}

/// PX4 on its board: beats, answers parameters, and tells a steady attitude.
fn px4(mut port: File, turns: usize, mut also: impl FnMut(usize, &[u8])) {
    let mut decoder = mavlink::Decoder::new();
    let mut reader = port.try_clone().unwrap();
    let reading = thread::spawn(move || {
        let mut all = Vec::new();
        while let Some(bytes) = next(&mut reader) {
            all.push(bytes);
        }
        all
    });
    for turn in 0..turns {
        if turn % 25 == 0 && port.write_all(&beat()).is_err() {
            break;
        }
        let attitude = attitude_quaternion::Repr {
            time_boot_ms: turn as u32 * 20,
            q: [1.0, 0.0, 0.0, 0.0],
            ..Default::default()
        };
        if turn > 50 && port.write_all(&packet(&Message::AttitudeQuaternion(attitude))).is_err() {
            break;
        }
        also(turn, &[]);
        thread::sleep(Duration::from_millis(20));
    }
    drop(port);
    for bytes in reading.join().unwrap() {
        also(usize::MAX, &bytes);
        decoder.feed(&bytes, |received| {
            received.unwrap();
        });
    }
}

#[test]
fn px4_on_its_board_is_waited_for_held_still_and_bridged_to_a_ground_station() {
    let ground = UdpSocket::bind("127.0.0.1:0").unwrap();
    ground.set_read_timeout(Some(Duration::from_millis(1))).unwrap();
    let qgc = format!("--qgc={}", ground.local_addr().unwrap());
    let run = Run::start("px4@PTY", &[&qgc, "--wait", "60s"]);
    let port = open(&run.port());
    // The ground station sets a parameter: a frame that this program does not know.
    let order = packet(&Message::ParamValue(param_value::Repr { param_value: 7.0, ..Default::default() }));
    let (mut overheard, mut arrived) = (Vec::new(), Vec::new());
    px4(port, 1000, |turn, bytes| {
        arrived.extend_from_slice(bytes);
        let mut datagram = [0; 2048];
        if turn < usize::MAX
            && let Ok((count, from)) = ground.recv_from(&mut datagram)
        {
            overheard.push(datagram[..count].to_vec());
            if overheard.len() == 3 {
                ground.send_to(&order, from).unwrap();
            }
        }
    });
    let report = run.report();
    assert_eq!(report["ok"], true, "{report}");
    assert!(overheard.iter().any(|frame| *frame == beat()), "its heartbeat, bit for bit");
    assert!(arrived.windows(order.len()).any(|window| window == order), "the order arrived whole");
    let attitude = &report["attitude"];
    assert_eq!(attitude["estimator"], "px4");
    // It says level and north all the time, and in the end the vehicle faces east; 20 ms before, two degrees less.
    assert!(attitude["samples"].as_u64().unwrap() > 40, "{attitude}");
    assert!((attitude["max_deg"].as_f64().unwrap() - 90.0).abs() < 4.0, "{attitude}");
    assert!(report["rest_s"].as_f64().unwrap() >= 2.0 && report["links"][0]["replies"].as_u64().unwrap() > 0);
}

#[test]
fn ardupilot_is_answered_fed_at_the_rate_it_asks_for_and_left_at_rest() {
    let run = Run::start("ardupilot@PTY,115200", &["--rest", "1s"]);
    let mut port = open(&run.port());
    for command in [
        "VNASY,0",
        "VNWRG,06,0,1",
        "VNWRG,06,0,2",
        "VNRRG,01",
        "VNWRG,75,3,16,01,0721",
        "VNWRG,76,3,16,11,0001,0106",
        "VNASY,1",
    ] {
        let sum = command.bytes().fold(0, |sum, byte| sum ^ byte);
        let line = format!("${command}*{sum:02X}\r\n");
        let expected =
            if command == "VNRRG,01" { "$VNRRG,01,VN-100T-CR*32\r\n".to_string() } else { line.clone() };
        // Sent again every half second until it is answered.
        let mut answer = Vec::new();
        port.write_all(line.as_bytes()).unwrap();
        while answer.len() < expected.len() {
            answer.extend(next(&mut port).expect("an answer"));
        }
        assert_eq!(String::from_utf8_lossy(&answer[..expected.len()]), expected);
    }
    let (mut decoder, mut packets) = (vectornav::Decoder::new(), Vec::new());
    while let Some(bytes) = next(&mut port) {
        decoder.feed(&bytes, |received| packets.extend(received.ok()));
    }
    let imu: Vec<_> = packets
        .iter()
        .filter_map(|packet| match packet {
            vectornav::Packet::Imu(imu) => Some(imu),
            _ => None,
        })
        .collect();
    let report = run.report();
    assert_eq!(
        (&report["ok"], &report["rest_s"], &report["duration_s"]),
        (&true.into(), &1.0.into(), &1.5.into())
    );
    // 50 Hz of a scene at 100 Hz: every other sample is replaced, and that is no loss.
    assert!((imu.len() as i64 - 126).abs() <= 1, "{}", imu.len());
    let gyro = &report["sensors"][0];
    assert_eq!(gyro["dropped"], gyro["replaced"]);
    assert!(imu.windows(2).all(|pair| pair[0].time_ns < pair[1].time_ns));
    let [before, last] = [imu[imu.len() - 2], imu[imu.len() - 1]];
    assert!((before.gyro[2] - 90f32.to_radians()).abs() < 0.05, "it turns to the end: {before:?}");
    assert_eq!(last.gyro, [0.0; 3], "and is left at rest");
}

#[test]
fn inav_is_asked_until_it_answers_held_still_and_left_at_rest_after_an_interrupt_too() {
    for interrupted in [false, true] {
        let run =
            Run::start("inav@PTY", &["--rest", "1s", "--for", if interrupted { "60s" } else { "1.5s" }]);
        let mut port = open(&run.port());
        let (mut decoder, mut questions, mut fed, mut last) = (msp::Decoder::new(), 0, 0, None);
        let mut stopped = false;
        while let Some(bytes) = next(&mut port) {
            let mut answers = Vec::new();
            decoder.feed(&bytes, |received| match received.unwrap().message {
                Some(msp::Message::Simulator(simulator)) => {
                    fed += 1;
                    last = Some(simulator);
                    answers.push(msp::Message::SimulatorReply(simulator_reply::Repr::default()));
                }
                _ => {
                    questions += 1;
                    // It boots for a second, and then answers the next question.
                    if questions == 5 {
                        answers.push(msp::Message::Attitude(msp::attitude::Repr::default()));
                    }
                }
            });
            for answer in answers {
                let mut out = [0; msp::MAX_LEN];
                let len = msp::encode(&answer, &mut out).unwrap();
                let _ = port.write_all(&out[..len]);
            }
            if interrupted && fed > 450 && !std::mem::replace(&mut stopped, true) {
                let pid = rustix::process::Pid::from_child(&run.child);
                rustix::process::kill_process(pid, rustix::process::Signal::INT).unwrap();
            }
        }
        let report = run.report();
        assert!(questions >= 5);
        let rest = report["rest_s"].as_f64().unwrap();
        assert!(rest >= 1.0, "{rest}");
        let whole = 100.0 * (rest + report["duration_s"].as_f64().unwrap());
        assert!((f64::from(fed) - whole).abs() <= 3.0, "{fed} of {whole}");
        assert_eq!(last.unwrap().gyro, [0; 3], "the last packet has no rate: INAV would go on turning");
        assert_eq!(report["attitude"]["estimator"], "inav");
    }
}

#[test]
fn a_controller_that_says_nothing_or_nothing_that_is_understood_is_told_from_one_that_is_not_there() {
    let wait = ["--wait", "1s"];
    let nobody = Run::start("px4@PTY", &wait).end();
    assert_eq!(nobody.status.code(), Some(2));
    assert!(said(&nobody).contains("nobody came"), "{}", said(&nobody));

    for (speaks, expected) in
        [(&b""[..], "nothing came from it"), (b"login: ", "bytes came and no mavlink message among them")]
    {
        let run = Run::start("px4@PTY", &wait);
        let mut port = open(&run.port());
        thread::sleep(Duration::from_millis(300));
        port.write_all(speaks).unwrap();
        let output = run.end();
        assert_eq!(output.status.code(), Some(2), "{}", said(&output));
        assert!(said(&output).contains(expected), "{}", said(&output));
    }
    // One that beats and whose estimator never comes up.
    let run = Run::start("px4@PTY", &wait);
    let mut port = open(&run.port());
    for _ in 0..40 {
        let _ = port.write_all(&beat());
        thread::sleep(Duration::from_millis(100));
    }
    drop(port);
    let output = run.end();
    assert_eq!(output.status.code(), Some(2), "{}", said(&output));
    assert!(said(&output).contains("is not ready after"), "{}", said(&output));
}

#[test]
fn a_controllers_attitude_is_asked_for_and_recorded_for_score() {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let from = format!("mavlink@tcpout:{}", listener.local_addr().unwrap());
    let folder = tempfile::tempdir().unwrap();
    let record = folder.path().join("record");
    let child = Command::new(env!("CARGO_BIN_EXE_ratetable"))
        .args(["listen", &from, "--attitude", "--record"])
        .arg(&record)
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let (mut stream, _) = listener.accept().unwrap();
    let mut decoder = mavlink::Decoder::new();
    stream.write_all(&beat()).unwrap();
    let mut asked = Vec::new();
    while asked.is_empty() {
        let bytes = next(&mut stream).expect("a question");
        decoder.feed(&bytes, |received| {
            if let Some(Message::CommandLong(command)) = received.unwrap().message {
                asked.push((command.command, command.params[0]));
            }
        });
    }
    assert_eq!(asked[0], (511, 31.0), "SET_MESSAGE_INTERVAL of ATTITUDE_QUATERNION");
    // A quarter turn to the right about the vertical, told from 100 s after its boot on.
    let half = std::f32::consts::FRAC_PI_8;
    for k in 0..50 {
        let q = [half.cos(), 0.0, 0.0, half.sin()];
        let told = attitude_quaternion::Repr { time_boot_ms: 100_000 + 20 * k, q, ..Default::default() };
        stream.write_all(&packet(&Message::AttitudeQuaternion(told))).unwrap();
    }
    // Closed with something unread, a socket would reset the other side, which then loses what it has not read.
    stream.shutdown(std::net::Shutdown::Write).unwrap();
    while next(&mut stream).is_some() {}
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success(), "{}", said(&output));
    assert!(said(&output).contains("50 attitudes; `ratetable score TRUTH"), "{}", said(&output));
    let csv = std::fs::read_to_string(record.join("estimate.csv")).unwrap();
    let mut lines = csv.lines();
    assert_eq!(lines.next(), Some("t_ns,qw,qx,qy,qz"));
    let rows: Vec<Vec<f64>> =
        lines.map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect()).collect();
    assert_eq!((rows.len(), rows[49][0]), (50, 100.98e9));
    assert!(
        (rows[7][1] - f64::from(half.cos())).abs() < 1e-6
            && (rows[7][4] - f64::from(half.sin())).abs() < 1e-6
    );

    // In a scene written in east-north-up too, it is read as north-east-down.
    let truth = folder.path().join("truth");
    let scene = folder.path().join("scene.toml");
    let turned = "axes = \"enu-flu\"\n[start]\nattitude = \"[0, 0, 45] deg\"\n[[motion]]\nkind = \"hold\"\nduration = \"200 s\"\n[gyro]\nrate = \"10 Hz\"\n";
    std::fs::write(&scene, turned).unwrap();
    let generated = Command::new(env!("CARGO_BIN_EXE_ratetable"))
        .arg("generate")
        .arg(&scene)
        .arg("--out")
        .arg(&truth)
        .output();
    assert!(generated.unwrap().status.success());
    let score = Command::new(env!("CARGO_BIN_EXE_ratetable"))
        .arg("score")
        .args([&truth, &record])
        .arg("--json")
        .output();
    let score: Value = serde_json::from_slice(&score.unwrap().stdout).unwrap();
    assert!(score["estimates"][0]["rms_deg"].as_f64().is_none_or(|rms| rms < 1e-3), "{score}");
}

#[test]
fn an_attitude_can_be_asked_for_over_mavlink_alone() {
    let output = Command::new(env!("CARGO_BIN_EXE_ratetable"))
        .args(["listen", "mpu@pty", "--attitude", "--record", "x"])
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(said(&output).contains("--attitude asks over MAVLink, not over `mpu`"), "{}", said(&output));
}

fn interrupt(run: &Run) {
    let pid = rustix::process::Pid::from_child(&run.child);
    rustix::process::kill_process(pid, rustix::process::Signal::INT).unwrap();
}

#[test]
fn the_last_packets_show_where_the_vehicle_was_when_it_was_stopped_and_leave_inavs_simulator() {
    // The producer is seconds ahead of what is sent, in which this scene rolls by more than a turn.
    let scene = "[[motion]]\nkind = \"rotate\"\nroll = \"90 deg/s\"\nduration = \"60 s\"\n[gyro]\nrate = \"100 Hz\"\n[accel]\nrate = \"100 Hz\"\n";
    let folder = tempfile::tempdir().unwrap();
    let port = folder.path().join("port");
    for at_end in ["leave", "hold"] {
        let output = format!("[[output]]\nto = \"msp@pty:{}\"\nat_end = \"{at_end}\"\n", port.display());
        let run = Run::of(&format!("{scene}{output}"), &[]);
        let mut file = open(&port);
        let (mut decoder, mut seen, mut stopped) = (msp::Decoder::new(), Vec::new(), false);
        while let Some(bytes) = next(&mut file) {
            decoder.feed(&bytes, |received| {
                if let Some(msp::Message::Simulator(simulator)) = received.unwrap().message {
                    seen.push(simulator);
                }
            });
            if seen.len() > 150 && !std::mem::replace(&mut stopped, true) {
                let pid = rustix::process::Pid::from_child(&run.child);
                rustix::process::kill_process(pid, rustix::process::Signal::INT).unwrap();
            }
        }
        let report = run.report();
        let leaves = at_end == "leave";
        assert_eq!(seen.last().unwrap().flags == 0, leaves, "{report}");
        let rest = if leaves { &seen[..seen.len() - 1] } else { &seen[..] };
        let [before, last] = [rest[rest.len() - 2], rest[rest.len() - 1]];
        assert_eq!(last.gyro, [0; 3]);
        let roll = |accel: [i16; 3]| f64::from(accel[1]).atan2(f64::from(accel[2])).to_degrees();
        let off = (roll(last.accel) - roll(before.accel) + 540.0).rem_euclid(360.0) - 180.0;
        // A packet or two at 90 deg/s.
        assert!(off.abs() < 3.0, "{at_end}: {off} deg from the packet before");
    }
}
