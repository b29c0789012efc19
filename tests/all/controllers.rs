//! `ratetable run` with flight controllers at the other end: they speak first or are asked, the vehicle is held still,
//! each packet is answered, and a ground station listens in. The controllers here are scripts of what is said; their
//! estimators are the business of `firmware-host-tests`.

use ratetable_protocols::betaflight;
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
    for speed in ["max", "4"] {
        let run = Run::start(&format!("px4-sitl@tcpin:{port}"), &["--speed", speed]);
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
            if interrupted && fed > 220 && !std::mem::replace(&mut stopped, true) {
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

/// Betaflight's program, as far as it is spoken with: samples come on one socket, questions on another.
struct Sitl {
    samples: UdpSocket,
    words: TcpListener,
}

/// What came to it.
#[derive(Default)]
struct Fed {
    states: Vec<betaflight::state::Repr>,
    questions: usize,
}

impl Sitl {
    fn open() -> Sitl {
        let samples = UdpSocket::bind("127.0.0.1:0").unwrap();
        samples.set_read_timeout(Some(Duration::from_millis(1))).unwrap();
        Sitl { samples, words: TcpListener::bind("127.0.0.1:0").unwrap() }
    }

    /// Starts a run to it, with the scene in its file.
    fn start(&self, more: &[&str]) -> Run {
        let [samples, words] = [self.samples.local_addr(), self.words.local_addr()].map(Result::unwrap);
        let output =
            format!("[[output]]\nto = \"betaflight@udpout:{samples}\"\nanswers = \"tcpout:{words}\"\n");
        let folder = tempfile::tempdir().unwrap();
        let scene = folder.path().join("scene.toml");
        std::fs::write(&scene, format!("{SCENE}{output}")).unwrap();
        let mut command = Command::new(env!("CARGO_BIN_EXE_ratetable"));
        command.arg("run").arg(&scene).arg("--json").args(more);
        let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn();
        Run { folder, child: child.expect("the program starts") }
    }

    /// Answers until its client has left; level and north all the time. `also` sees what has come so far.
    fn serve(&self, senses: bool, mut also: impl FnMut(&Fed)) -> Fed {
        let (mut client, _) = self.words.accept().unwrap();
        client.set_nonblocking(true).unwrap();
        let (mut fed, mut decoder, mut open) = (Fed::default(), msp::Decoder::new(), true);
        let mut packet = [0; 1024];
        loop {
            // Only once nothing more waits has all been taken in that was sent before it left.
            match self.samples.recv(&mut packet) {
                Ok(len) => {
                    let payload = betaflight::state::Payload::new_checked(&packet[..len]).expect("144 bytes");
                    fed.states.push(betaflight::state::Repr::parse(&payload));
                }
                Err(_) if !open => return fed,
                Err(_) => {}
            }
            let mut bytes = [0; 1024];
            match client.read(&mut bytes) {
                Ok(0) => open = false,
                Ok(len) => decoder.feed(&bytes[..len], |received| {
                    fed.questions += 1;
                    let rate = fed.states.last().filter(|_| senses).map_or([0.0; 3], |state| state.gyro);
                    let _ = client.write_all(&answer(received.unwrap().command, rate));
                }),
                Err(error) if error.kind() == std::io::ErrorKind::WouldBlock => {}
                Err(_) => open = false,
            }
            also(&fed);
        }
    }
}

/// What Betaflight 2026.12 answers, its gyro reading the rate of the packet.
fn answer(command: u16, [p, q, r]: [f64; 3]) -> Vec<u8> {
    let counts = |rate: f64| (rate.to_degrees() * betaflight::GYRO_COUNTS) as i16;
    let reply = match command {
        2 => msp::Message::FcVariant(msp::fc_variant::Repr { name: *b"BTFL" }),
        3 => msp::Message::FcVersion(msp::fc_version::Repr { major: 26, minor: 12, patch: 0 }),
        101 => msp::Message::Status(msp::status::Repr { cycle_time: 1000, ..Default::default() }),
        102 => msp::Message::RawImu(msp::raw_imu::Repr {
            gyro: [counts(p), counts(-q), counts(r)],
            ..Default::default()
        }),
        167 => {
            let q = [32767, 0, 0, 0];
            msp::Message::AttitudeQuaternion(msp::attitude_quaternion::Repr { q })
        }
        other => panic!("asked for {other}"),
    };
    let mut bytes = [0; msp::MAX_LEN];
    let len = msp::encode(&reply, &mut bytes).unwrap();
    bytes[..len].to_vec()
}

fn interrupt(run: &Run) {
    let pid = rustix::process::Pid::from_child(&run.child);
    rustix::process::kill_process(pid, rustix::process::Signal::INT).unwrap();
}

#[test]
fn betaflight_is_spoken_with_beside_the_stream_and_left_at_rest_after_an_interrupt_too() {
    for interrupted in [false, true] {
        let sitl = Sitl::open();
        let run = sitl.start(&[
            "--rest",
            "1s",
            "--align",
            "none",
            "--for",
            if interrupted { "60s" } else { "1.5s" },
        ]);
        let mut stopped = false;
        let fed = sitl.serve(true, |fed| {
            if interrupted && fed.states.len() > 260 && !std::mem::replace(&mut stopped, true) {
                interrupt(&run);
            }
        });
        let report = run.report();
        let [before, last] = [fed.states[fed.states.len() - 2], fed.states[fed.states.len() - 1]];
        assert_eq!(last.gyro, [0.0; 3], "and is left at rest");
        assert!(fed.states.iter().all(|state| state.timestamp == last.timestamp));
        let sent = report["links"][0]["sent"].as_u64().unwrap();
        assert!(sent < fed.states.len() as u64, "the test rates are no part of the stream");
        assert!(report["links"][0]["replies"].as_u64().unwrap() >= fed.questions as u64, "{report}");
        let attitude = &report["attitude"];
        assert_eq!(attitude["estimator"], "betaflight");
        assert!(attitude["samples"].as_u64().unwrap() > 20, "{attitude}");
        if !interrupted {
            assert!((before.gyro[2] + 90f64.to_radians()).abs() < 0.05, "it turns to the end: {before:?}");
            // It says north all the time, and in the end the vehicle faces east.
            assert!((attitude["max_deg"].as_f64().unwrap() - 90.0).abs() < 5.0, "{attitude}");
        }
    }
}

#[test]
fn betaflight_is_left_at_rest_where_its_gyro_is_tried_and_the_user_ends_it() {
    let sitl = Sitl::open();
    let run = sitl.start(&[]);
    let mut stopped = false;
    let fed = sitl.serve(false, |fed| {
        let turns = fed.states.last().is_some_and(|state| state.gyro != [0.0; 3]);
        if turns && !std::mem::replace(&mut stopped, true) {
            interrupt(&run);
        }
    });
    assert!(
        stopped && fed.states.last().is_some_and(|state| state.gyro == [0.0; 3]),
        "{:?}",
        fed.states.last()
    );
    run.end();
}

#[test]
fn betaflight_that_does_not_run_or_does_not_sense_is_told_of() {
    let sitl = Sitl::open();
    let run = sitl.start(&["--wait", "5s"]);
    sitl.serve(false, |_| {});
    let output = run.end();
    assert_eq!(output.status.code(), Some(2));
    let (said, gone) = (said(&output), Sitl::open());
    assert!(
        said.contains("its gyro does not answer a test rate") && said.contains("a notice says why"),
        "{said}"
    );
    // Nobody listens any more on a port that was free a moment ago.
    let Sitl { samples, words } = gone;
    let to = format!("betaflight@udpout:{}", samples.local_addr().unwrap());
    let text =
        format!("{SCENE}[[output]]\nto = \"{to}\"\nanswers = \"tcpout:{}\"\n", words.local_addr().unwrap());
    drop(words);
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("scene.toml"), text).unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_ratetable"));
    let output = command.arg("run").arg(folder.path().join("scene.toml")).output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(said.contains("betaflight answers there: start it first"), "{said}");
}
