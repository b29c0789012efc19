//! The whole board over bytes, a file and a pty.

use std::fs;
use std::io::Cursor;
use std::os::fd::OwnedFd;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use super::common::{Body, DECLINATION_RAD, G, TURNING};
use ratetable_firmware_host_tests::ahrs::Kind;
use ratetable_firmware_host_tests::board::Source;
use ratetable_firmware_host_tests::quaternion::angle_between;
use ratetable_firmware_host_tests::{Board, Options, Protocol, Sample, Step};
use ratetable_protocols::mavlink::{self, Header, Message, Version, hil_sensor};
use ratetable_protocols::mpu::{self, Packet, accel, config, gyro, mag, registers};
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};

const EVERY_US: [u64; 3] = [2_000, 4_000, 10_000];
const SECONDS: u64 = 12;

const CONFIG: config::Repr = config::Repr {
    who_am_i: registers::WHO_MPU9250,
    smplrt_div: 0,
    config: 1,
    gyro_config: 0x00,
    accel_config: 0x08,
    mag_who: registers::WHO_AK8963,
    cntl1: 0x16,
    asa: [176, 178, 168],
};

/// The packets that an MPU-9250 mounted forward-left-up would give.
fn mpu_packets(samples: &[Sample]) -> Vec<Vec<u8>> {
    let mut packets = vec![(0, Packet::Config(CONFIG))];
    for sample in samples {
        packets.extend(mpu_of(sample).into_iter().map(|packet| (sample.t_us, packet)));
    }
    let numbered = packets.into_iter().enumerate();
    numbered
        .map(|(seq, (t_us, packet))| {
            let mut bytes = [0; mpu::MAX_LEN];
            let len = mpu::encode(seq as u8, t_us as u32, &packet, &mut bytes).unwrap();
            bytes[..len].to_vec()
        })
        .collect()
}

fn mpu_of(sample: &Sample) -> Vec<Packet> {
    let chip = |[x, y, z]: [f64; 3]| [x, -y, -z];
    let mut packets = Vec::new();
    if let Some(rate) = sample.gyro {
        let lsb = registers::gyro_lsb_per_dps(CONFIG.gyro_config);
        let gyro = chip(rate).map(|w| registers::nearest(w.to_degrees() * lsb));
        packets.push(Packet::Gyro(gyro::Repr { gyro }));
    }
    if let Some(force) = sample.accel {
        let lsb = registers::accel_lsb_per_g(CONFIG.accel_config);
        let accel = chip(force).map(|f| registers::nearest(f / G * lsb));
        packets.push(Packet::Accel(accel::Repr { accel }));
    }
    if let Some(field) = sample.mag {
        let own = registers::swap_mag_axes(chip(field));
        let field = std::array::from_fn(|i| registers::mag_raw(own[i], CONFIG.asa[i]));
        packets.push(Packet::Mag(mag::Repr { st1: 1, field, st2: registers::ST2_16_BIT }));
    }
    packets
}

/// The messages that a simulator would send: one at each gyro tick.
fn mavlink_packets(samples: &[Sample]) -> Vec<Vec<u8>> {
    let gyro_ticks = samples.iter().filter(|sample| sample.gyro.is_some());
    let numbered = gyro_ticks.enumerate();
    numbered
        .map(|(seq, sample)| {
            let bit = |there: bool, bits: u32| if there { bits } else { 0 };
            let message = Message::HilSensor(hil_sensor::Repr {
                time_usec: sample.t_us,
                gyro: sample.gyro.unwrap_or_default().map(|w| w as f32),
                accel: sample.accel.unwrap_or_default().map(|f| f as f32),
                mag: sample.mag.unwrap_or_default().map(|m| (m / 100.0) as f32),
                fields_updated: hil_sensor::GYRO
                    | bit(sample.accel.is_some(), hil_sensor::ACCEL)
                    | bit(sample.mag.is_some(), hil_sensor::MAG),
                ..Default::default()
            });
            let seq = seq as u8;
            let header = Header { version: Version::V2, seq, system: 9, component: 1 };
            let mut bytes = [0; mavlink::MAX_LEN];
            let len = mavlink::encode(&header, &message, &mut bytes).unwrap();
            bytes[..len].to_vec()
        })
        .collect()
}

fn packets(protocol: Protocol, body: Body) -> Vec<Vec<u8>> {
    let samples = body.samples(SECONDS, EVERY_US);
    match protocol {
        Protocol::Mpu => mpu_packets(&samples),
        Protocol::Mavlink => mavlink_packets(&samples),
    }
}

fn options(ahrs: Kind) -> Options {
    Options { ahrs, declination_rad: DECLINATION_RAD, ..Options::default() }
}

/// A board that has read these bytes to their end.
fn board_after(protocol: Protocol, ahrs: Kind, bytes: Vec<u8>) -> Board {
    let port = Box::new(Source(Cursor::new(bytes)));
    let mut board = Board::over(port, protocol, options(ahrs));
    board.run(&AtomicBool::new(false)).unwrap();
    board
}

/// The largest error of a board's history after 5 s, deg.
fn worst_deg(board: &Board, body: Body) -> f64 {
    let settled = board.history().iter().filter(|(t_us, _)| *t_us > 5_000_000);
    let errors = settled.map(|&(t_us, q)| angle_between(q, body.attitude(t_us as f64 * 1e-6)));
    errors.fold(0.0, f64::max).to_degrees()
}

#[test]
fn both_protocols_and_both_estimators_give_the_true_attitude() {
    for protocol in [Protocol::Mpu, Protocol::Mavlink] {
        for ahrs in [Kind::Vqf, Kind::Fusion] {
            let board = board_after(protocol, ahrs, packets(protocol, TURNING).concat());
            let worst = worst_deg(&board, TURNING);
            assert!(worst < 0.5, "{protocol} {ahrs}: {worst} deg");
            let counts = board.report().counts;
            let expected = [500, 250, 100].map(|rate| rate * SECONDS);
            assert_eq!([counts.gyro, counts.accel, counts.mag], expected);
            assert_eq!((counts.damaged, counts.lost, counts.skipped), (0, 0, 0));
            assert_eq!(board.history().len() as u64, counts.gyro);
        }
    }
}

#[test]
fn lost_and_damaged_packets_are_counted_and_cost_little() {
    for protocol in [Protocol::Mpu, Protocol::Mavlink] {
        let mut packets = packets(protocol, TURNING);
        for k in (100..packets.len() - 50).step_by(100) {
            let middle = packets[k].len() - 4;
            packets[k][middle] ^= 0x04;
            packets[k + 7].clear();
        }
        let damaged = (100..packets.len() - 50).step_by(100).count() as u64;
        let board = board_after(protocol, Kind::Vqf, packets.concat());
        let counts = board.report().counts;
        assert_eq!((counts.damaged, counts.lost), (damaged, 2 * damaged), "{protocol}");
        assert!(worst_deg(&board, TURNING) < 1.0, "{protocol}");
    }
}

#[test]
fn the_wrong_declination_is_seen_as_a_heading_error() {
    let bytes = packets(Protocol::Mpu, TURNING).concat();
    let port = Box::new(Source(Cursor::new(bytes)));
    let mut board = Board::over(port, Protocol::Mpu, Options::default());
    board.run(&AtomicBool::new(false)).unwrap();
    let worst = worst_deg(&board, TURNING);
    assert!((worst - DECLINATION_RAD.to_degrees()).abs() < 0.5, "{worst} deg");
}

#[test]
fn a_recorded_stream_is_read_by_path() {
    let path = std::env::temp_dir().join(format!("ratetable-board-{}.bin", std::process::id()));
    fs::write(&path, packets(Protocol::Mpu, TURNING).concat()).unwrap();
    let mut board = Board::open(&path, Protocol::Mpu, options(Kind::Vqf)).unwrap();
    let report = board.run(&AtomicBool::new(false)).unwrap();
    fs::remove_file(&path).unwrap();
    assert_eq!(report.counts.gyro, 500 * SECONDS);
    assert!(worst_deg(&board, TURNING) < 0.5);
}

/// A pty: the emulator's end and the path of the board's.
fn pty() -> (OwnedFd, String) {
    let flags = OpenptFlags::RDWR | OpenptFlags::NOCTTY;
    let master = openpt(flags).unwrap();
    grantpt(&master).unwrap();
    unlockpt(&master).unwrap();
    let path = ptsname(&master, Vec::new()).unwrap().into_string().unwrap();
    (master, path)
}

#[test]
fn a_board_on_a_pty_answers_with_the_echo_of_its_newest_sample() {
    let (master, path) = pty();
    let every_us = 20_000;
    let options = Options { answer_every_us: Some(every_us), ..options(Kind::Vqf) };
    let mut board = Board::open(&path, Protocol::Mpu, options).unwrap();
    let mut decoder = mpu::Decoder::new();
    let mut answers = Vec::new();
    for packet in packets(Protocol::Mpu, TURNING) {
        assert_eq!(rustix::io::write(&master, &packet).unwrap(), packet.len());
        assert!(matches!(board.step(Duration::from_secs(5)).unwrap(), Step::Data { .. }));
        if board.report().answers_sent > answers.len() as u64 {
            let mut bytes = [0; 256];
            let len = rustix::io::read(&master, &mut bytes).unwrap();
            decoder.feed(&bytes[..len], |received| answers.push(received.unwrap()));
        }
    }
    assert_eq!(board.step(Duration::ZERO).unwrap(), Step::Idle);
    drop(master);
    assert_eq!(board.step(Duration::from_secs(5)).unwrap(), Step::Closed);

    assert_eq!(board.report().answers_sent, answers.len() as u64);
    let spacing = answers.windows(2).map(|pair| u64::from(pair[1].t_us - pair[0].t_us));
    assert!(spacing.into_iter().all(|us| us == every_us));
    for (seq, answer) in answers.iter().enumerate() {
        assert_eq!(answer.seq, seq as u8);
        let Packet::Attitude(repr) = answer.packet else { panic!("{answer:?}") };
        let q = repr.q.map(f64::from);
        let error = angle_between(q, TURNING.attitude(f64::from(answer.t_us) * 1e-6));
        assert!(answer.t_us < 5_000_000 || error.to_degrees() < 0.5);
    }
    assert!(answers.len() > 500, "{}", answers.len());
}

#[test]
fn a_board_answers_over_mavlink_with_attitude_and_heartbeat() {
    let (master, path) = pty();
    let options = Options { answer_every_us: Some(100_000), ..options(Kind::Vqf) };
    let mut board = Board::open(&path, Protocol::Mavlink, options).unwrap();
    for packet in packets(Protocol::Mavlink, TURNING).iter().take(500) {
        assert_eq!(rustix::io::write(&master, packet).unwrap(), packet.len());
        board.step(Duration::from_secs(5)).unwrap();
    }
    let mut bytes = [0; 4096];
    let len = rustix::io::read(&master, &mut bytes).unwrap();
    let mut reader = mavlink::Decoder::new();
    let (mut beats, mut times_ms) = (0, Vec::new());
    reader.feed(&bytes[..len], |received| match received.unwrap().message {
        Some(Message::Heartbeat(_)) => beats += 1,
        Some(Message::AttitudeQuaternion(repr)) => times_ms.push(repr.time_boot_ms),
        other => panic!("{other:?}"),
    });
    assert!(beats >= 1);
    assert!(times_ms.len() >= 8, "{times_ms:?}");
    assert!(times_ms.windows(2).all(|pair| pair[1] - pair[0] == 100));
}
