//! Betaflight's program: samples on one socket, questions on another.

use super::*;
use ratetable_protocols::betaflight;

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
        Run::of(&format!("{SCENE}{output}"), more)
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
            if interrupted && fed.states.len() > 500 && !std::mem::replace(&mut stopped, true) {
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
