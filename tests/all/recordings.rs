//! `ratetable listen` on what others recorded: a ground station's logs, streams of every message, clocks that step.
//!
//! One test needs `pymavlink`, of `firmware-host-tests/tests/requirements.txt`: `RATETABLE_PYTHON`, which `tests/run.sh`
//! sets. Where there is none the test says so and passes, unless `RATETABLE_REQUIRE_PYTHON` is set.

use ratetable_protocols::mavlink::{self, Header, Message, Version, hil_sensor, raw_imu};
use serde_json::Value;
use std::path::Path;
use std::process::{Command, Stdio};

/// The exit code of `listen PROTOCOL@file:…`, its report and what it said, of these bytes.
fn listen(protocol: &str, bytes: &[u8]) -> (i32, Value, String) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("recorded");
    std::fs::write(&path, bytes).unwrap();
    listen_to(protocol, &path)
}

fn listen_to(protocol: &str, path: &Path) -> (i32, Value, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_ratetable"));
    command.args(["listen", &format!("{protocol}@file:{}", path.display()), "--json"]).stdin(Stdio::null());
    let output = command.output().unwrap();
    let text = String::from_utf8(output.stderr).unwrap();
    let report = serde_json::from_slice(&output.stdout).unwrap_or_else(|error| panic!("{error}: {text}"));
    (output.status.code().unwrap(), report, text)
}

/// Packets, lost ones and damaged ones.
fn counts(report: &Value) -> [u64; 3] {
    ["packets", "lost_seq", "crc_errors"].map(|field| report["links"][0][field].as_u64().unwrap())
}

fn figure(report: &Value, sensor: usize, field: &str) -> f64 {
    let value = field.split('.').fold(&report["sensors"][sensor], |value, step| &value[step]);
    value.as_f64().unwrap_or_else(|| panic!("{field} of {report}"))
}

fn packet(seq: u8, message: &Message) -> Vec<u8> {
    let header = Header { version: Version::V2, seq, system: 1, component: 1 };
    let mut bytes = [0; mavlink::MAX_LEN];
    let len = mavlink::encode(&header, message, &mut bytes).unwrap();
    bytes[..len].to_vec()
}

fn hil(seq: u8, time_usec: u64) -> Vec<u8> {
    let fields_updated = hil_sensor::GYRO | hil_sensor::ACCEL;
    packet(
        seq,
        &Message::HilSensor(hil_sensor::Repr {
            time_usec,
            fields_updated,
            accel: [0.5, 0.0, -9.8],
            ..Default::default()
        }),
    )
}

/// A MAVLink 2 packet of any id, its checksum by this last byte.
fn frame(seq: u8, id: u32, extra: u8, payload: &[u8]) -> Vec<u8> {
    let [a, b, c, _] = id.to_le_bytes();
    let mut frame = vec![0xfd, payload.len() as u8, 0, 0, seq, 1, 1, a, b, c];
    frame.extend(payload);
    let crc = frame[1..].iter().chain([&extra]).fold(0xffff_u16, |crc, byte| {
        let t = byte ^ crc as u8;
        let t = u16::from(t ^ (t << 4));
        (crc >> 8) ^ (t << 8) ^ (t << 3) ^ (t >> 4)
    });
    frame.extend(crc.to_le_bytes());
    frame
}

/// 2023-11-14, µs.
const START_US: u64 = 1_700_000_000_000_000;

fn stamped(us: u64, packet: &[u8]) -> Vec<u8> {
    [&us.to_be_bytes()[..], packet].concat()
}

#[test]
fn a_ground_stations_log_is_heard_by_its_stamps() {
    // 200 HIL_SENSOR at 100 Hz, each arriving 3 ms late every other time, and 200 of an id that nobody knows.
    let records: Vec<Vec<u8>> = (0..200u64)
        .flat_map(|k| {
            let (seq, us) = ((2 * k) as u8, 10_000 * k);
            let late = if k % 2 == 0 { 0 } else { 3000 };
            let unknown = frame(seq.wrapping_add(1), 9999, 77, &[1, 2, 3]);
            [stamped(START_US + us + late, &hil(seq, us)), stamped(START_US + us + late + 40, &unknown)]
        })
        .collect();
    let (code, report, text) = listen("mavlink", &records.concat());
    assert_eq!((code, counts(&report)), (0, [400, 0, 0]), "{text}");
    assert_eq!(report["links"][0]["unchecked"], 200);
    assert!(text.contains(".tlog") && !text.contains("no times of arrival"), "{text}");
    assert!((figure(&report, 0, "rate_hz") - 100.0).abs() < 1e-9);
    assert!((figure(&report, 0, "received_hz") - 100.0).abs() < 0.2);
    assert!((figure(&report, 0, "interval_us.min") - 7000.0).abs() < 10.0, "{report}");
    assert!((figure(&report, 0, "interval_us.max") - 13_000.0).abs() < 20.0, "{report}");
    assert!((figure(&report, 0, "jitter_us.p50") - 3000.0).abs() < 5.0, "{report}");
    assert!(report["sensors"][0]["burst_share"].is_null(), "a log says nothing of reads");
    assert!((report["duration_s"].as_f64().unwrap() - 1.99304).abs() < 1e-9, "{report}");

    // Joined in the middle of a packet and cut in one, stamps that go back by a year and on again, two packets hurt: a
    // packet that cannot be checked is not believed behind damage, so each hides the one behind it too, and so does where the log was joined.
    let mut hurt = records.clone();
    hurt[100][30] ^= 0x10;
    hurt[142][33] ^= 0x10;
    for record in &mut hurt[200..210] {
        let us = u64::from_be_bytes(record[..8].try_into().unwrap()) - 31_536_000_000_000;
        record[..8].copy_from_slice(&us.to_be_bytes());
    }
    let bytes = hurt.concat();
    let (code, report, text) = listen("mavlink", &bytes[13..bytes.len() - 5]);
    assert_eq!((code, counts(&report)), (1, [393, 4, 4]), "{text}");
    assert_eq!(
        (&report["links"][0]["joined_midway"], &report["links"][0]["stamp_steps"]),
        (&1.into(), &2.into())
    );
    assert!((figure(&report, 0, "rate_hz") - 100.0).abs() < 1e-9);
    assert!((figure(&report, 0, "received_hz") - 100.0).abs() < 2.0, "{report}");
    assert!(figure(&report, 0, "interval_us.max") < 30_000.0, "{report}");
    assert!(text.contains("stamps went back"), "{text}");

    // Negative control: the same packets without stamps are a recording without arrivals.
    let plain: Vec<u8> = records.iter().flat_map(|record| record[8..].to_vec()).collect();
    let (code, report, text) = listen("mavlink", &plain);
    assert_eq!((code, counts(&report)), (0, [400, 0, 0]), "{text}");
    assert!(report["sensors"][0]["received_hz"].is_null() && report["duration_s"].is_null());
}

#[test]
fn a_log_given_as_another_protocol_is_named_for_what_it_is() {
    let log: Vec<u8> =
        (0..50u64).flat_map(|k| stamped(START_US + 10_000 * k, &hil(k as u8, 10_000 * k))).collect();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("flight.tlog");
    std::fs::write(&path, log).unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_ratetable"));
    let output = command.args(["listen", &format!("mpu@file:{}", path.display())]).output().unwrap();
    let text = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.code() == Some(2) && text.contains("read as mavlink"), "{text}");
}

#[test]
fn a_bit_flipped_in_the_header_of_any_message_of_the_dialects_costs_that_one() {
    // VFR_HUD and GLOBAL_POSITION_INT, which are not read here; a bit of the number, of system and of component.
    for (id, extra) in [(74, 20), (33, 104)] {
        for (byte, bit) in [(4, 6), (5, 0), (6, 3), (2, 5), (1, 7)] {
            let mut frames: Vec<Vec<u8>> = (0..100u8)
                .flat_map(|k| [hil(2 * k, 10_000 * u64::from(k)), frame(2 * k + 1, id, extra, &[1; 20])])
                .collect();
            frames[101][byte] ^= 1 << bit;
            let (code, report, text) = listen("mavlink", &frames.concat());
            assert_eq!((code, counts(&report)), (1, [199, 1, 1]), "{id} byte {byte} bit {bit}: {text}");
        }
    }
}

/// Lines of a gyro with these times, ms.
fn lines(times: impl IntoIterator<Item = i64>) -> Vec<u8> {
    let lines = times.into_iter().map(|ms| format!("{},gyro,0,0,0\n", ms * 1_000_000));
    ["t_ns,sensor,x,y,z\n".to_string()].into_iter().chain(lines).collect::<String>().into_bytes()
}

#[test]
fn a_sender_that_begins_anew_or_sets_its_clock_keeps_its_rate() {
    let steady: Vec<i64> = (0..12).map(|k| 10 * k).collect();
    for (times, back, forward) in [
        // Four samples and again from the start; back by 30 ms; ahead by ten minutes; by a year, and back.
        ([&steady[..4], &steady[..4]].concat(), 1, 0),
        ([&steady[..], &[80, 90, 100, 110]].concat(), 1, 0),
        (steady.iter().copied().chain((12..24).map(|k| 600_000 + 10 * k)).collect(), 0, 1),
        (
            steady
                .iter()
                .copied()
                .chain((0..6).map(|k| 31_536_000_000 + 10 * k))
                .chain((13..20).map(|k| 10 * k))
                .collect(),
            1,
            1,
        ),
        (steady.clone(), 0, 0),
    ] {
        let (code, report, text) = listen("csv", &lines(times));
        assert!((figure(&report, 0, "rate_hz") - 100.0).abs() < 1e-9, "{text}");
        assert_eq!(report["sensors"][0]["missing"], 0, "{text}");
        assert_eq!(
            (figure(&report, 0, "steps_back"), figure(&report, 0, "steps_forward")),
            (back as f64, forward as f64)
        );
        let told =
            ["did not go on", "jumped ahead", "nothing here tells them"].map(|part| text.contains(part));
        assert_eq!(told, [back > 0, forward > 0, forward > 0], "{text}");
        assert_eq!((code, text.contains("time steps")), (0, back + forward > 0), "{text}");
    }
}

#[test]
fn raw_times_that_wrap_after_71_minutes_do_not_step() {
    let wrap = 1u64 << 32;
    let raw = |k: u64| {
        let time_usec = (wrap - 1_000_000 + 4000 * k) % wrap;
        packet(k as u8, &Message::RawImu(raw_imu::Repr { time_usec, ..Default::default() }))
    };
    let (code, report, text) = listen("mavlink", &(0..600).flat_map(raw).collect::<Vec<_>>());
    assert!((figure(&report, 0, "rate_hz") - 250.0).abs() < 1e-9, "{text}");
    assert_eq!(
        (code, figure(&report, 0, "steps_back"), figure(&report, 0, "missing")),
        (0, 0.0, 0.0),
        "{text}"
    );
}

/// The report of a scene played into a file in this protocol.
fn played(protocol: &str, scene: &str) -> Value {
    let folder = tempfile::tempdir().unwrap();
    let (scene_path, path) = (folder.path().join("scene.toml"), folder.path().join("recorded"));
    std::fs::write(&scene_path, scene).unwrap();
    let to = format!("{protocol}@file:{}", path.display());
    let mut command = Command::new(env!("CARGO_BIN_EXE_ratetable"));
    let output = command.arg("run").arg(&scene_path).args(["--to", &to, "--speed", "max"]).output().unwrap();
    // 1 where a sample was replaced before it was told.
    let code = output.status.code();
    assert!(code == Some(0) || code == Some(1), "{}", String::from_utf8_lossy(&output.stderr));
    listen_to(protocol, &path).1
}

#[test]
fn a_clock_that_is_off_misses_nothing_and_losses_slow_no_sensor() {
    // The accelerometer's clock is off, and in MAVLink it is told at the ticks of the gyro's.
    for ppm in [-200, 200] {
        for protocol in ["mpu", "mavlink", "csv"] {
            let report = played(
                protocol,
                &format!(
                    "duration = \"30 s\"\n[gyro]\nrate = \"1 kHz\"\n[accel]\nrate = \"1 kHz\"\nclock_error = \"{ppm} ppm\"\n"
                ),
            );
            let rate = figure(&report, 1, "rate_hz");
            // Told at the ticks of another, two samples in one tick are one: it cannot be faster than those.
            let expected =
                1000.0 * (1.0 + if protocol == "mavlink" { ppm.min(0) } else { ppm } as f64 * 1e-6);
            assert!((rate / expected - 1.0).abs() < 6e-5, "{protocol} {ppm}: {rate} of {expected}");
            assert_eq!(report["sensors"][1]["missing"], 0, "{protocol} {ppm}");
            assert_eq!(report["sensors"][0]["missing"], 0, "{protocol} {ppm}");
        }
    }
    let dropped = "duration = \"20 s\"\n[gyro]\nrate = \"1 kHz\"\n[accel]\nrate = \"400 Hz\"\n\
        [[fault]]\nkind = \"drop\"\nshare = \"5 %\"\n";
    for protocol in ["mpu", "mavlink", "csv"] {
        let report = played(protocol, dropped);
        for (i, rate, all) in [(0, 1000.0, 20_000), (1, 400.0, 8000)] {
            assert!((figure(&report, i, "rate_hz") / rate - 1.0).abs() < 1e-4, "{protocol}: {report}");
            // But for the few at either end.
            let [missing, received] = ["missing", "received"].map(|field| figure(&report, i, field) as u64);
            assert!((missing + received).abs_diff(all) <= 6 && missing > all / 30, "{protocol}: {report}");
        }
    }
}

#[test]
fn every_message_that_pymavlink_makes_is_checked_and_named() {
    let folder = tempfile::tempdir().unwrap();
    let python = std::env::var("RATETABLE_PYTHON").unwrap_or("python3".into());
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/listen/pymavlink_streams.py");
    let output =
        Command::new(&python).arg(script).arg(folder.path()).stderr(Stdio::piped()).output().unwrap();
    if !output.status.success() {
        let why = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(std::env::var_os("RATETABLE_REQUIRE_PYTHON").is_none(), "{why}");
        eprintln!("NOT TESTED against pymavlink: {why}; tests/run.sh makes a Python that can");
        return;
    }
    let made: Value = serde_json::from_slice(&output.stdout).unwrap();
    let table: Vec<(u32, u8, String)> = serde_json::from_value(made["table"].clone()).unwrap();
    let ours: Vec<_> =
        mavlink::KNOWN.iter().map(|known| (known.id, known.crc_extra, known.name.to_string())).collect();
    assert_eq!(ours, table);
    for name in ["v1.mav", "v2.mav", "signed.mav", "log.tlog"] {
        let (code, report, text) = listen_to("mavlink", &folder.path().join(name));
        let sent = &made[if name == "log.tlog" { "v2.mav" } else { name }];
        let all: u64 = sent.as_object().unwrap().values().map(|count| count.as_u64().unwrap()).sum();
        assert_eq!((code, counts(&report)), (0, [all, 0, 0]), "{name}: {text}");
        assert_eq!(report["links"][0]["unchecked"], 0, "{name}");
        // Each by its name, as many names as are kept apart.
        for (message, count) in report["links"][0]["foreign"].as_object().unwrap() {
            assert!(message == "others" || &sent[message] == count, "{name}: {message} {count}");
        }
        // Negative control: a bit hurt is a packet less; stamps and signatures are not covered by the checksum.
        if !name.starts_with('v') {
            continue;
        }
        let mut bytes = std::fs::read(folder.path().join(name)).unwrap();
        let middle = bytes.len() / 2;
        bytes[middle] ^= 8;
        let (code, report, text) = listen("mavlink", &bytes);
        assert_eq!((code, counts(&report)), (1, [all - 1, 1, 1]), "{name}: {text}");
    }
}
