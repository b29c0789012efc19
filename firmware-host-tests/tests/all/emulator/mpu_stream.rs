//! The `mpu` stream as it comes off the pty, read by a decoder that was written for this test alone.

use ratetable::scene::Plan;
use ratetable::sensor::{Reading, SensorKind};
use ratetable_firmware_host_tests::Protocol;

use crate::emulator::play::{readings, scene, stream};

/// CRC-16/IBM-3740, bit by bit.
fn crc(bytes: &[u8]) -> u16 {
    bytes.iter().fold(0xffff, |crc, &byte| {
        (0..8).fold(
            crc ^ u16::from(byte) << 8,
            |crc, _| if crc & 0x8000 != 0 { crc << 1 ^ 0x1021 } else { crc << 1 },
        )
    })
}

/// A stuffed packet, its closing zero left out, as it was before: each run's first byte says where the next zero is.
fn unstuffed(mut stuffed: &[u8]) -> Vec<u8> {
    let mut plain = Vec::new();
    while let [run, rest @ ..] = stuffed {
        let (data, next) = rest.split_at(usize::from(*run) - 1);
        plain.extend_from_slice(data);
        if *run < 255 && !next.is_empty() {
            plain.push(0);
        }
        stuffed = next;
    }
    plain
}

/// A packet: type, sequence number, time in µs, payload.
struct Packet {
    kind: u8,
    seq: u8,
    t_us: u32,
    payload: Vec<u8>,
}

fn packets(bytes: &[u8]) -> Vec<Packet> {
    let Some((0, all)) = bytes.split_last() else { panic!("the stream does not end with a packet's end") };
    let decode = |stuffed| {
        let plain = unstuffed(stuffed);
        let (body, sum) = plain.split_at(plain.len() - 2);
        assert_eq!(crc(body).to_le_bytes(), sum, "checksum");
        let t_us = u32::from_le_bytes(body[2..6].try_into().unwrap());
        Packet { kind: body[0], seq: body[1], t_us, payload: body[6..].to_vec() }
    };
    all.split(|&byte| byte == 0).map(decode).collect()
}

/// Three big-endian counts, as the MPU's registers hold them.
fn big(bytes: &[u8]) -> [i16; 3] {
    [0, 2, 4].map(|at| i16::from_be_bytes([bytes[at], bytes[at + 1]]))
}

/// Three little-endian counts, as the AK8963's registers hold them.
fn little(bytes: &[u8]) -> [i16; 3] {
    [0, 2, 4].map(|at| i16::from_le_bytes([bytes[at], bytes[at + 1]]))
}

/// What one count is, by sensor, as the register map says of a `config` packet: rad/s, m/s², µT.
fn units(config: &[u8]) -> [f64; 3] {
    let scale = |register: u8| usize::from(register >> 3 & 3);
    let dps = [131.0, 65.5, 32.8, 16.4][scale(config[3])];
    let g = [16384.0, 8192.0, 4096.0, 2048.0][scale(config[4])];
    assert_eq!(
        (config[0], config[5], config[6]),
        (0x71, 0x48, 0x16),
        "an MPU-9250 with its AK8963 at 16 bits, 100 Hz"
    );
    assert_eq!(config[7..10], [128; 3], "no sensitivity adjustment");
    [(1.0f64 / dps).to_radians(), 9.80665 / g, 0.15]
}

/// A reading in counts along the axes of its chip, which lies with x forward, y left and z up; the AK8963 in it has
/// its x and y exchanged and z down.
fn counts(reading: &Reading, unit: f64) -> [f64; 3] {
    let [forward, right, down] = reading.body().unwrap().value.v.to_array().map(|component| component / unit);
    match reading.kind {
        SensorKind::Gyro | SensorKind::Accel => [forward, -right, -down],
        SensorKind::Mag => [-right, forward, down],
        _ => panic!("not in `mpu`"),
    }
}

/// Every sample of a stream: time, sensor, counts.
fn samples(packets: &[Packet]) -> Vec<(u32, SensorKind, [i16; 3])> {
    let mut samples = Vec::new();
    for Packet { kind, t_us, payload, .. } in packets {
        match kind {
            1 => {
                samples.push((*t_us, SensorKind::Gyro, big(&payload[8..])));
                samples.push((*t_us, SensorKind::Accel, big(payload)));
                assert_eq!(payload[6..8], 1335i16.to_be_bytes(), "25 °C");
            }
            2 => {
                assert_eq!((payload[0], payload[7]), (1, 0x10), "new, not overflowed, 16 bits");
                samples.push((*t_us, SensorKind::Mag, little(&payload[1..])));
            }
            3 => samples.push((*t_us, SensorKind::Gyro, big(payload))),
            4 => samples.push((*t_us, SensorKind::Accel, big(payload))),
            5 => {}
            other => panic!("a packet of type {other:02x}"),
        }
    }
    samples
}

fn expected(plan: &Plan) -> Vec<(u32, Reading)> {
    let moments = readings(plan).into_iter();
    moments
        .flat_map(|(t, readings)| readings.into_iter().map(move |reading| ((t.0 / 1000) as u32, reading)))
        .collect()
}

#[test]
fn every_sample_is_the_datasets_reading_within_a_count_and_none_is_missing() {
    for (name, sets) in
        [("mpu-9250", &["mag.rate=70 Hz"][..]), ("manoeuvre", &[]), ("table-1", &["gyro.rate=1125 Hz"])]
    {
        let plan = scene(name, sets);
        let (outcome, bytes) = stream(&plan, Protocol::Mpu);
        let packets = packets(&bytes);
        assert_eq!(
            (packets.len() as u64, bytes.len() as u64),
            (outcome.links[0].packets, outcome.links[0].bytes)
        );
        for (number, packet) in packets.iter().enumerate() {
            assert_eq!(packet.seq, number as u8, "{name}: each packet has the next number");
        }
        let configs: Vec<&Packet> = packets.iter().filter(|packet| packet.kind == 5).collect();
        let seconds = plan.duration.0 as u64 / 1_000_000_000;
        assert_eq!(
            configs.iter().map(|config| config.t_us).collect::<Vec<_>>(),
            every_second(seconds),
            "{name}"
        );
        assert_eq!(packets[0].kind, 5, "{name}: scales come before readings");

        let units = units(&packets[0].payload);
        let (samples, expected) = (samples(&packets), expected(&plan));
        assert_eq!(samples.len(), expected.len(), "{name}");
        for ((t_us, kind, raw), (due_us, reading)) in samples.into_iter().zip(&expected) {
            assert_eq!((t_us, kind), (*due_us, reading.kind), "{name}");
            let exact = counts(reading, units[kind as usize]);
            let apart =
                exact.iter().zip(raw).map(|(exact, raw)| (exact - f64::from(raw)).abs()).fold(0.0, f64::max);
            assert!(apart <= 1.0, "{name}: {kind} at {t_us} µs is {raw:?} for {exact:?}");
        }
    }
}

fn every_second(seconds: u64) -> Vec<u32> {
    (0..seconds as u32).map(|second| second * 1_000_000).collect()
}
