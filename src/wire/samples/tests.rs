//! The output of every encoder comes back sample for sample; damage, gaps and arbitrary bytes.

use super::*;
use crate::scene::Plan;
use crate::sensor::Reading;
use crate::time::Rate;
use crate::wire::Protocol;
use crate::wire::controller_tests::TOGETHER;
use crate::wire::tests::{NOISY, plan, play};
use crate::wire::{Layout, Now, Packet, at_rest};
use proptest::prelude::*;
use ratetable_protocols::mavlink::{
    self, Header, Message, Version, highres_imu, raw_imu, scaled_imu, scaled_imu2, scaled_imu3,
};
use std::sync::OnceLock;

/// Sensors at unrelated rates, each axis and sensor with its own values.
const MIXED: &str = r#"
seed = 5
[[motion]]
kind = "rotate"
angular_rate = "[120, -310, 77] deg/s"
duration = "2.5 s"
[gyro]
rate = "400 Hz"
noise_std = "1 deg/s"
range = "500 deg/s"
mount = "rbd"
[accel]
rate = "400/3 Hz"
noise_std = "1 m/s^2"
range = "4 g"
mount = "flu"
[mag]
rate = "37 Hz"
noise_std = "1 uT"
mount = "luf"
"#;

fn assumed(plan: &Plan) -> Assumed {
    let mount = |kind| plan.sensors.iter().find(|sensor| sensor.kind == kind).and_then(|sensor| sensor.mount);
    let mounts = SensorKind::TRIADS.map(|kind| mount(kind).unwrap_or(Mount::flu()));
    Assumed { axes: plan.axes, mounts, ..Assumed::default() }
}

/// Everything in these bytes, fed in pieces of `piece` bytes.
fn read(mut samples: Samples, bytes: &[u8], piece: usize) -> (Vec<Sample>, Counts) {
    let mut all = Vec::new();
    bytes.chunks(piece.max(1)).for_each(|piece| samples.feed(piece, |sample| all.push(sample)));
    samples.finish(|sample| all.push(sample));
    (all, samples.counts().clone())
}

fn bytes(packets: &[Packet]) -> Vec<u8> {
    packets.iter().flat_map(|packet| packet.bytes().to_vec()).collect()
}

/// The allowed difference between a value and the reading that was sent: half a count, the rounding of an `f32`, or
/// nothing.
fn tolerance(protocol: Protocol, kind: SensorKind, reading: f64) -> f64 {
    let count = [1f64.to_radians() / 16.4, crate::earth::STANDARD_GRAVITY / 2048.0, 0.15][kind as usize];
    let msp = [1f64.to_radians() / 16.0, 1e-3 * crate::earth::STANDARD_GRAVITY, 0.0][kind as usize];
    // A millionth of a g of 9.8106 m/s², a hundred thousandth of a degree, ten nanotesla.
    let ilabs = [1e-5_f64.to_radians(), 9.8106e-6, 0.01][kind as usize];
    let betaflight = [1f64.to_radians() / 16.384, crate::earth::STANDARD_GRAVITY / 256.0, 0.0][kind as usize];
    match protocol {
        Protocol::Ilabs => 0.5 * ilabs * (1.0 + 1e-6),
        Protocol::Sbg if kind == SensorKind::Gyro => 0.5 / 67_108_864.0 * (1.0 + 1e-6),
        Protocol::Sbg if kind == SensorKind::Accel => 0.5 / 1_048_576.0 * (1.0 + 1e-6),
        Protocol::Betaflight => 0.5 * betaflight * (1.0 + 1e-9),
        Protocol::Mpu => 0.5 * count * (1.0 + 1e-9),
        Protocol::Msp => 0.5 * msp * (1.0 + 1e-9),
        Protocol::Mavlink | Protocol::Vectornav | Protocol::Mip | Protocol::Sbg => {
            2.0 * reading.abs() * f64::from(f32::EPSILON)
        }
        Protocol::Csv | Protocol::Jsonl | Protocol::Bus => 0.0,
    }
}

/// The first difference between the samples and the readings that were sent.
fn difference(protocol: Protocol, sent: &[(SimTime, Reading)], samples: &[Sample]) -> Option<String> {
    for kind in SensorKind::TRIADS.into_iter().filter(|kind| protocol.carries(*kind)) {
        let sent: Vec<_> = sent.iter().filter(|(_, reading)| reading.kind == kind).collect();
        let came: Vec<_> = samples.iter().filter(|sample| sample.kind == kind).collect();
        if sent.len() != came.len() {
            return Some(format!("{} {kind} of {}", came.len(), sent.len()));
        }
        for ((t, reading), sample) in sent.into_iter().zip(came) {
            let unit = match protocol {
                Protocol::Mpu | Protocol::Mavlink | Protocol::Sbg => Some(1000),
                Protocol::Vectornav | Protocol::Csv | Protocol::Jsonl => Some(1),
                Protocol::Ilabs => Some(1_000_000),
                Protocol::Msp | Protocol::Mip | Protocol::Betaflight | Protocol::Bus => None,
            };
            if sample.t != unit.map(|unit| SimTime(t.0 / unit * unit)) {
                return Some(format!("{kind} at {:?}, sent for {t}", sample.t));
            }
            let expected = reading.body().unwrap().value.v.to_array();
            if (protocol, kind) == (Protocol::Msp, SensorKind::Mag) && sample.value.is_none() {
                continue;
            }
            let Some(value) = sample.value.and_then(Sensed::body) else {
                return Some(format!("{kind} at {t} without a value"));
            };
            let off = |(seen, sent): (f64, f64)| (seen - sent).abs() > tolerance(protocol, kind, sent);
            if value.v.to_array().into_iter().zip(expected).any(off) {
                return Some(format!("{kind} at {t}: {value:?} of {expected:?}"));
            }
        }
    }
    None
}

#[test]
fn every_sample_comes_back_with_its_time_and_value() {
    let scenes = [NOISY, MIXED, TOGETHER].map(String::from);
    let turned = [NOISY, MIXED, TOGETHER].map(|scene| format!("axes = \"enu-flu\"\n{scene}"));
    for plan in scenes.iter().chain(&turned).map(|text| plan(text)) {
        for protocol in Protocol::STREAMS {
            let (packets, readings) = play(&plan, protocol, None);
            // In these a sensor's sample leaves at the next tick of the gyro: compare where both tick.
            if matches!(protocol, Protocol::Mavlink | Protocol::Sbg)
                && plan.sensors[1].rate != plan.sensors[0].rate
            {
                continue;
            }
            // These carry every sensor in every packet, at most 100 times a second: compare where all are new.
            let tells_all = matches!(
                protocol,
                Protocol::Msp | Protocol::Vectornav | Protocol::Mip | Protocol::Ilabs | Protocol::Betaflight
            );
            if tells_all && plan.sensors[2].rate != Rate::hz(100) {
                continue;
            }
            let bytes = bytes(&packets);
            for piece in [bytes.len(), 1, 7, 1000] {
                let (samples, counts) = read(Samples::assuming(protocol, &assumed(&plan)), &bytes, piece);
                assert_eq!(difference(protocol, &readings, &samples), None, "{protocol:?}");
                assert_eq!((counts.packets, counts.bytes), (packets.len() as u64, bytes.len() as u64));
                assert_eq!((counts.damaged, counts.joined_midway, counts.lost), (0, 0, 0));
                assert_eq!(counts.numbered, matches!(protocol, Protocol::Mpu | Protocol::Mavlink));
            }
        }
    }
}

/// Negative control: a round trip with a mistake in axes, sign or scale fails.
#[test]
fn a_swapped_axis_is_noticed() {
    let plan = plan(TOGETHER);
    for protocol in Protocol::STREAMS {
        let (packets, readings) = play(&plan, protocol, None);
        let (samples, _) = read(Samples::new(protocol), &bytes(&packets), 4096);
        assert_eq!(difference(protocol, &readings, &samples), None);
        let changes: [fn([f64; 3]) -> [f64; 3]; 4] = [
            |[x, y, z]| [y, x, z],
            |[x, y, z]| [x, -y, z],
            |[x, y, z]| [y, z, x],
            |[x, y, z]| [1.01 * x, 1.01 * y, 1.01 * z],
        ];
        for change in changes {
            // The field in `msp` has no value to be wrong, and `betaflight` has no field.
            let has_value = |kind: &SensorKind| {
                protocol.carries(*kind) && (protocol, *kind) != (Protocol::Msp, SensorKind::Mag)
            };
            for kind in SensorKind::TRIADS.into_iter().filter(has_value) {
                let changed = |sample: &Sample| match sample.value {
                    Some(value) if sample.kind == kind => {
                        let [x, y, z] = change(value.body().unwrap().v.to_array());
                        Sample { value: Some(Sensed::Body(Vector::new(x, y, z))), ..*sample }
                    }
                    _ => *sample,
                };
                let changed: Vec<_> = samples.iter().map(changed).collect();
                assert!(difference(protocol, &readings, &changed).is_some(), "{protocol:?} {kind}");
            }
        }
    }
    let (packets, readings) = play(&plan, Protocol::Mpu, None);
    let upside_down = Assumed { mounts: [Mount::default(); 3], ..Assumed::default() };
    let (samples, _) = read(Samples::assuming(Protocol::Mpu, &upside_down), &bytes(&packets), 99);
    assert!(difference(Protocol::Mpu, &readings, &samples).is_some(), "another mount");
}

#[test]
fn a_burst_gives_a_sample_of_each_at_every_packet_the_slower_one_held() {
    let plan = plan(&NOISY.replacen("200 Hz", "400 Hz", 1));
    let (packets, readings) = play(&plan, Protocol::Mpu, Some(Layout::Burst));
    let (samples, _) = read(Samples::new(Protocol::Mpu), &bytes(&packets), 100);
    let held: Vec<_> = readings
        .iter()
        .filter(|(_, reading)| reading.kind == SensorKind::Gyro)
        .map(|(t, _)| {
            let newest = |(due, reading): &&(SimTime, Reading)| due <= t && reading.kind == SensorKind::Accel;
            (*t, readings.iter().rfind(newest).unwrap().1)
        })
        .collect();
    let sent: Vec<_> =
        readings.into_iter().filter(|(_, reading)| reading.kind != SensorKind::Accel).chain(held).collect();
    assert_eq!(difference(Protocol::Mpu, &sent, &samples), None);
}

#[test]
fn mavlink_gives_only_what_a_message_says_is_new() {
    let plan = plan(MIXED);
    let (packets, _) = play(&plan, Protocol::Mavlink, None);
    let (samples, counts) = read(Samples::new(Protocol::Mavlink), &bytes(&packets), 50);
    for kind in SensorKind::TRIADS {
        let carried = packets.iter().filter(|packet| packet.carries.contains(kind)).count();
        assert_eq!(samples.iter().filter(|sample| sample.kind == kind).count(), carried, "{kind}");
    }
    let names: Vec<_> = counts.foreign.iter().map(|(name, count)| (name.as_str(), *count)).collect();
    assert_eq!(names, [("heartbeat", 3), ("system_time", 3)]);
}

#[test]
fn what_autopilots_send_of_their_own_sensors_is_read_in_our_units() {
    let message = |message: &Message| {
        let header = Header { version: Version::V2, seq: 0, system: 1, component: 1 };
        let mut bytes = [0; mavlink::MAX_LEN];
        let len = mavlink::encode(&header, message, &mut bytes).unwrap();
        read(Samples::new(Protocol::Mavlink), &bytes[..len], 300)
    };
    let scaled = |mag| scaled_imu::Repr {
        time_boot_ms: 1500,
        accel: [0, 500, -1000],
        gyro: [250, 0, -125],
        mag,
        temperature: 0,
    };
    let highres = |fields_updated| highres_imu::Repr {
        time_usec: 1_500_000,
        accel: [0.0, 4.0, -9.75],
        gyro: [0.25, 0.0, -0.125],
        mag: [0.25, 0.0, 0.5],
        fields_updated,
        ..Default::default()
    };
    let raw = raw_imu::Repr { time_usec: 1_500_000, mag: [1, 2, 3], id: 2, ..Default::default() };
    let (gyro, mag) = (Vector::new(0.25, 0.0, -0.125), Vector::new(25.0, 0.0, 50.0));
    let half_g = Vector::new(0.0, 0.5, -1.0) * crate::earth::STANDARD_GRAVITY;
    let all = highres_imu::GYRO | highres_imu::ACCEL | highres_imu::MAG;
    let scaled_imu::Repr { time_boot_ms, accel, gyro: mrad, .. } = scaled([0; 3]);
    let second = scaled_imu2::Repr { time_boot_ms, accel, gyro: mrad, mag: [0; 3], temperature: 0 };
    let third = scaled_imu3::Repr { time_boot_ms, accel, gyro: mrad, mag: [250, 0, 500], temperature: 0 };
    for (sent, values) in [
        (Message::ScaledImu2(second), [Some(gyro), Some(half_g)].to_vec()),
        (Message::ScaledImu3(third), [Some(gyro), Some(half_g), Some(mag)].to_vec()),
        (Message::ScaledImu(scaled([250, 0, 500])), [Some(gyro), Some(half_g), Some(mag)].to_vec()),
        (Message::ScaledImu(scaled([0; 3])), [Some(gyro), Some(half_g)].to_vec()),
        (
            Message::HighresImu(highres(all)),
            [Some(gyro), Some(Vector::new(0.0, 4.0, -9.75)), Some(mag)].to_vec(),
        ),
        (Message::HighresImu(highres(highres_imu::MAG)), [Some(mag)].to_vec()),
        (Message::RawImu(raw), [None; 3].to_vec()),
    ] {
        let (samples, counts) = message(&sent);
        assert_eq!(samples.len(), values.len(), "{sent:?}");
        assert!(
            counts.foreign.is_empty()
                && samples.iter().all(|sample| sample.t == Some(SimTime(1_500_000_000)))
        );
        for (sample, value) in samples.iter().zip(values) {
            let off = |value: Vector<Body>| (value - sample.value.unwrap().body().unwrap()).length();
            assert!(
                value.map_or(sample.value.is_none(), |value| off(value) < 1e-12),
                "{sample:?} of {value:?}"
            );
            assert_eq!(sample.source.message, sent.name());
        }
    }
    let (samples, counts) = message(&Message::HighresImu(highres(0)));
    assert!(samples.is_empty() && counts.foreign["highres_imu"] == 1, "nothing new in it");
}

/// A stream of each numbered protocol.
fn numbered() -> &'static [(Protocol, Vec<Packet>); 2] {
    static PLAYED: OnceLock<[(Protocol, Vec<Packet>); 2]> = OnceLock::new();
    PLAYED.get_or_init(|| {
        let plan = plan(NOISY);
        [Protocol::Mpu, Protocol::Mavlink].map(|protocol| (protocol, play(&plan, protocol, None).0))
    })
}

#[test]
fn a_gap_in_the_sequence_is_counted_to_the_packet() {
    for (protocol, packets) in numbered() {
        for (from, count) in [(1, 1), (10, 3), (200, 254), (250, 12)] {
            let mut left = packets.clone();
            left.drain(from..from + count);
            let (_, counts) = read(Samples::new(*protocol), &bytes(&left), 64);
            assert_eq!((counts.lost, counts.damaged), (count as u64, 0), "{protocol:?} {count} from {from}");
        }
        let mut left = packets.clone();
        left.drain(100..100 + 255);
        let (_, counts) = read(Samples::new(*protocol), &bytes(&left), 64);
        assert_eq!(counts.lost, 0, "255 lost look like a packet sent twice");
    }
}

#[test]
fn a_damaged_packet_costs_itself_and_is_counted() {
    for (protocol, packets) in numbered() {
        let packets = &packets[..20];
        let whole = read(Samples::new(*protocol), &bytes(packets), 64).0;
        for hurt in [1, 5, 13] {
            for bit in 0..packets[hurt].bytes().len() * 8 {
                let mut damaged: Vec<_> = packets.iter().map(|packet| packet.bytes().to_vec()).collect();
                damaged[hurt][bit / 8] ^= 1 << (bit % 8);
                let (samples, counts) = read(Samples::new(*protocol), &damaged.concat(), 4096);
                let cost = packets[hurt].carries.len();
                assert_eq!(samples.len(), whole.len() - cost, "{protocol:?} packet {hurt} bit {bit}");
                // A message with an unknown id cannot be checked; it counts under that id, and fills its gap.
                let unknown = counts.foreign.keys().any(|name| name.starts_with("message"));
                let damaged = counts.damaged >= 1 && counts.lost == 1;
                assert!(damaged != unknown, "{protocol:?} {counts:?}");
                assert_eq!((counts.unchecked, unknown && counts.lost > 0), (u64::from(unknown), false));
                let id = *protocol == Protocol::Mavlink && (7..10).contains(&(bit / 8));
                assert!(!unknown || id, "only where the id itself is hurt: bit {bit}");
            }
        }
    }
}

/// A MAVLink 2 packet of any id with one byte of payload; `extra` is the last byte of its checksum input.
fn frame(seq: u8, id: u32, extra: u8) -> Vec<u8> {
    let [a, b, c, _] = id.to_le_bytes();
    let mut frame = vec![0xfd, 1, 0, 0, seq, 1, 1, a, b, c, 7];
    let seed = frame[1..].iter().chain([&extra]).fold(0xffff_u16, |crc, byte| {
        let t = byte ^ crc as u8;
        let t = u16::from(t ^ (t << 4));
        (crc >> 8) ^ (t << 8) ^ (t << 3) ^ (t >> 4)
    });
    frame.extend(seed.to_le_bytes());
    frame
}

/// VFR_HUD, which is not read here and whose checksum byte is 20, and an unassigned id.
const HUD: (u32, u8) = (74, 20);
const NOBODY: (u32, u8) = (50_000, 99);

#[test]
fn a_wrong_number_is_believed_of_no_packet() {
    for (id, extra) in [HUD, NOBODY] {
        for bit in 0..8 {
            let mut frames: Vec<Vec<u8>> = (0..100u8)
                .map(|seq| if seq % 2 == 0 { frame(seq, HUD.0, HUD.1) } else { frame(seq, id, extra) })
                .collect();
            frames[51][4] ^= 1 << bit;
            let (_, counts) = read(Samples::new(Protocol::Mavlink), &frames.concat(), 17);
            // Where it cannot be checked it counts as a normal packet, and its correct number is missing.
            let (packets, damaged, unchecked) = if id == HUD.0 { (99, 1, 0) } else { (100, 0, 50) };
            assert_eq!(
                (counts.packets, counts.damaged, counts.lost),
                (packets, damaged, 1),
                "{id} bit {bit}"
            );
            assert_eq!(counts.unchecked, unchecked);
        }
    }
}

#[test]
fn packets_that_cannot_be_checked_fill_the_gap_that_they_make() {
    let frames = |left_out: &[usize]| -> Vec<u8> {
        let of = |seq: usize| if seq.is_multiple_of(5) { HUD } else { NOBODY };
        let sent = (0..600).filter(|seq| !left_out.contains(seq));
        sent.flat_map(|seq| frame(seq as u8, of(seq).0, of(seq).1)).collect()
    };
    for left_out in [&[][..], &[12], &[15, 16, 17], &[255, 256, 257], &[400]] {
        let (_, counts) = read(Samples::new(Protocol::Mavlink), &frames(left_out), 64);
        assert_eq!(
            (counts.lost, counts.damaged, counts.out_of_order),
            (left_out.len() as u64, 0, 0),
            "{left_out:?}"
        );
    }
    // Nothing is known of a sender with no checkable packet.
    let alone: Vec<u8> =
        [1u8, 2, 9, 200].into_iter().flat_map(|seq| frame(seq, NOBODY.0, NOBODY.1)).collect();
    let (_, counts) = read(Samples::new(Protocol::Mavlink), &alone, 64);
    assert_eq!((counts.packets, counts.lost, counts.unchecked), (4, 0, 4));
}

#[test]
fn damaged_packets_side_by_side_are_counted_by_their_numbers() {
    for hurt in [&[50][..], &[50, 51], &[50, 51, 52, 53, 54], &[50, 51, 80], &[10, 11, 12, 60, 61]] {
        let mut frames: Vec<Vec<u8>> = (0..100u8).map(|seq| frame(seq, HUD.0, HUD.1)).collect();
        hurt.iter().for_each(|&at: &usize| frames[at][11] ^= 4);
        let (_, counts) = read(Samples::new(Protocol::Mavlink), &frames.concat(), 64);
        assert_eq!((counts.damaged, counts.lost), (hurt.len() as u64, hurt.len() as u64), "{hurt:?}");
    }
    // One damaged packet and three that never came count as one damaged; bytes between whole packets hide none.
    let mut frames: Vec<Vec<u8>> = (0..100u8).map(|seq| frame(seq, HUD.0, HUD.1)).collect();
    frames[50][11] ^= 4;
    frames.drain(51..54);
    frames[20].extend([0x5a; 100]);
    let (_, counts) = read(Samples::new(Protocol::Mavlink), &frames.concat(), 64);
    assert_eq!((counts.damaged, counts.lost), (2, 4));
}

/// A log of HIL_SENSOR packets, every 10 ms by stamp and by sample time.
fn log_of(packets: &[Packet]) -> Vec<Vec<u8>> {
    let stamped = |(k, packet): (usize, &Packet)| {
        let us = 1_700_000_000_000_000 + 10_000 * k as u64;
        [&us.to_be_bytes()[..], packet.bytes()].concat()
    };
    packets.iter().enumerate().map(stamped).collect()
}

#[test]
fn a_log_is_recognised_by_its_content_and_its_stamps_are_the_arrivals() {
    let (_, packets) = &numbered()[1];
    let records = log_of(&packets[..150]);
    let of = |bytes: &[u8]| {
        let all = [1, 7, 20_000].map(|piece| read(Samples::recorded(Protocol::Mavlink), bytes, piece));
        assert!(all.iter().all(|one| one == &all[0]), "however it is cut up");
        all[0].clone()
    };
    let (samples, counts) = of(&records.concat());
    assert_eq!((counts.packets, counts.damaged, counts.lost, counts.joined_midway), (150, 0, 0, 0));
    assert_eq!(counts.stamps.map(|stamps| (stamps.span_ns, stamps.steps)), Some((149 * 10_000_000, 0)));
    let arrived: Vec<_> = samples.iter().map(|sample| sample.packet.arrived.unwrap().0).collect();
    assert!(arrived.is_sorted() && arrived[0] >= 1_700_000_000_000_000_000);
    // From the middle of one packet to the middle of another.
    let cut = &records.concat()[20..];
    let (_, counts) = of(&cut[..cut.len() - 9]);
    assert_eq!((counts.packets, counts.damaged, counts.lost, counts.joined_midway), (148, 0, 0, 1));
    assert!(counts.stamps.is_some());
    // Damaged packets, damaged stamps, and stamps that step.
    let mut hurt = records.clone();
    [20, 21, 90].into_iter().for_each(|at: usize| hurt[at][8 + 12] ^= 1);
    hurt[40][0] = 0xff;
    let (_, counts) = of(&hurt.concat());
    assert_eq!((counts.packets, counts.damaged, counts.lost), (147, 3, 3));
    let mut stepped = records.clone();
    stepped[70..]
        .iter_mut()
        .for_each(|record| record[..8].copy_from_slice(&1_600_000_000_000_000_u64.to_be_bytes()));
    let (_, counts) = of(&stepped.concat());
    assert_eq!(counts.stamps.map(|stamps| (stamps.span_ns, stamps.steps)), Some((69 * 10_000_000, 1)));
    // Negative controls: the same packets without stamps, and a log read as a live stream.
    let (_, counts) = of(&bytes(&packets[..150]));
    assert_eq!((counts.packets, counts.damaged, counts.stamps), (150, 0, None));
    let (_, counts) = read(Samples::new(Protocol::Mavlink), &records.concat(), 64);
    assert!(counts.stamps.is_none() && counts.damaged > 100);
}

#[test]
fn fields_of_mip_that_tell_a_time_are_the_times_of_its_samples() {
    use ratetable_protocols::mip::{self, imu};
    let second = |time: fn(u64) -> imu::Time| {
        let packet = |k: u64| {
            let imu = imu::Repr { gyro: Some([0.0; 3]), time: Some(time(k)), ..Default::default() };
            let mut bytes = [0; mip::MAX_LEN];
            let len = mip::encode(&imu, &mut bytes).unwrap();
            bytes[..len].to_vec()
        };
        let bytes: Vec<u8> = (0..1000).flat_map(packet).collect();
        let samples = read(Samples::new(Protocol::Mip), &bytes, 33).0;
        samples.windows(2).map(|pair| pair[1].t.unwrap().0 - pair[0].t.unwrap().0).collect::<Vec<_>>()
    };
    let times: [fn(u64) -> imu::Time; 4] = [
        |k| imu::Time::Reference(k * 2_000_000),
        |k| imu::Time::External((1 << 60) + k * 2_000_000, 1),
        // Over the end of a week.
        |k| imu::Time::SharedGps((604_799.0 + 0.002 * k as f64) % 604_800.0, 2300 + (k / 500) as u16, 3),
        |k| imu::Time::Gps(5.0 + 0.002 * k as f64, 0, 0),
    ];
    for time in times {
        assert!(second(time).iter().all(|step| (step - 2_000_000).abs() <= 1), "{:?}", time(0));
    }
    let no_time =
        imu::Repr { gyro: Some([0.0; 3]), time: Some(imu::Time::Gps(f64::NAN, 1, 0)), ..Default::default() };
    let mut bytes = [0; mip::MAX_LEN];
    let len = mip::encode(&no_time, &mut bytes).unwrap();
    let (samples, _) = read(Samples::new(Protocol::Mip), &bytes[..len], 33);
    assert_eq!(samples.iter().map(|sample| sample.t).collect::<Vec<_>>(), [None], "seconds that are none");
}

#[test]
fn damage_to_a_packet_without_a_number_costs_it_and_is_counted() {
    let plan = plan(TOGETHER);
    for protocol in [Protocol::Msp, Protocol::Vectornav, Protocol::Mip, Protocol::Ilabs] {
        let packets = &play(&plan, protocol, None).0[..16];
        let whole = read(Samples::new(protocol), &bytes(packets), 64).0;
        for hurt in [1, 4] {
            for bit in 0..packets[hurt].bytes().len() * 8 {
                let mut damaged: Vec<_> = packets.iter().map(|packet| packet.bytes().to_vec()).collect();
                damaged[hurt][bit / 8] ^= 1 << (bit % 8);
                let (samples, counts) = read(Samples::new(protocol), &damaged.concat(), 4096);
                let cost = if packets[hurt].carries.is_empty() { 0 } else { 3 };
                assert_eq!(samples.len(), whole.len() - cost, "{protocol:?} packet {hurt} bit {bit}");
                // A frame of `msp` in the other direction is whole but means something else.
                let turned = protocol == Protocol::Msp && counts.foreign.contains_key("reply 8223");
                assert_eq!(counts.damaged, u64::from(!turned), "{protocol:?} packet {hurt} bit {bit}");
                assert_eq!(counts.lost, 0);
            }
        }
    }
}

#[test]
fn a_stream_joined_midway_is_not_damaged_and_has_values_once_they_have_a_scale() {
    for (protocol, packets) in numbered() {
        let second = packets.iter().position(|packet| packet.due >= SimTime(crate::time::NANOS)).unwrap();
        let (samples, counts) = read(Samples::new(*protocol), &bytes(packets)[3..], 64);
        assert_eq!((counts.joined_midway, counts.damaged, counts.lost), (1, 0, 0), "{protocol:?}");
        let blind = samples.iter().filter(|sample| sample.value.is_none()).count();
        let before: usize = packets[1..second].iter().map(|packet| packet.carries.len()).sum();
        let expected = if *protocol == Protocol::Mpu { before } else { 0 };
        assert_eq!(blind, expected, "counts without a config have no unit");
    }
}

#[test]
fn time_goes_on_where_the_packets_clock_wraps() {
    let plan = plan("duration = \"4 s\"\n[gyro]\nrate = \"10 Hz\"\n");
    let mut encoder = crate::wire::encoder(Protocol::Mpu, &crate::wire::tests::setup(&plan, None));
    let (mut packets, mut times) = (Vec::new(), Vec::new());
    // From 1 s before the 32 bits of µs wrap, at an uptime beyond half their range.
    for k in 0..400i64 {
        let t = SimTime(4_294_000_000_000 + k * 100_000_000);
        times.push(Some(t));
        let readings = [Reading::zero(0, SensorKind::Gyro)];
        encoder.encode(&Now { t, truth: &at_rest(t), readings: &readings }, &mut packets);
    }
    let from = packets.iter().position(|packet| packet.due.0 >= 4_294_000_000_000).unwrap();
    let (samples, _) = read(Samples::new(Protocol::Mpu), &bytes(&packets[from..]), 64);
    assert_eq!(samples.iter().map(|sample| sample.t).collect::<Vec<_>>(), times);
}

#[test]
fn lines_of_others_are_read_as_far_as_they_are_samples() {
    for (protocol, text, kinds, foreign, damaged) in [
        (
            Protocol::Csv,
            "t_ns,sensor,x,y,z\n5,gyro,1,2,3,extra\r\n\n# remark\n6,sonar,1,2,3\n7,mag,1,2\n8,mag,1,2,3",
            2,
            1,
            1,
        ),
        (
            Protocol::Jsonl,
            "{\"y\":2,\"x\":1,\"z\":3,\"sensor\":\"gyro\",\"t_ns\":5,\"n\":null}\n{\"t_ns\":5}\n[]\n",
            1,
            0,
            2,
        ),
        (Protocol::Csv, "5,gyro,nan,1,2\n", 1, 0, 0),
    ] {
        let (samples, counts) = read(Samples::new(protocol), text.as_bytes(), 3);
        assert_eq!(
            (samples.len(), counts.foreign.values().sum(), counts.damaged),
            (kinds, foreign, damaged),
            "{text}"
        );
        assert_eq!(samples[0].t, Some(SimTime(5)));
        let value = (!text.contains("nan")).then(|| Sensed::Body(Vector::new(1.0, 2.0, 3.0)));
        assert_eq!(samples[0].value, value, "a value that is no number is none");
    }
}

#[test]
fn names_of_foreign_packets_do_not_fill_the_memory() {
    let mut samples = Samples::new(Protocol::Csv);
    for i in 0..10_000 {
        samples.feed(format!("{i},sensor{i},1,2,3\n").as_bytes(), |_| {});
    }
    let foreign = &samples.counts().foreign;
    assert_eq!((foreign.len(), foreign.values().sum::<u64>()), (Counts::NAMES + 1, 10_000));
}

proptest! {
    #[test]
    fn any_bytes_do_not_panic_and_read_the_same_however_cut(
        protocol in prop::sample::select(Protocol::STREAMS.to_vec()),
        bytes in prop::collection::vec(prop_oneof![Just(0u8), Just(b'\n'), Just(0xfd), Just(0xfe), Just(b','), any::<u8>()], 0..2000),
        piece in 1..300usize,
    ) {
        let whole = read(Samples::new(protocol), &bytes, bytes.len());
        let cut = read(Samples::new(protocol), &bytes, piece);
        prop_assert_eq!(whole.1, cut.1);
        prop_assert_eq!(format!("{:?}", whole.0), format!("{:?}", cut.0));
    }

    #[test]
    fn a_stream_with_holes_and_flips_gives_only_samples_that_were_sent(
        which in 0..2usize,
        flips in prop::collection::vec((any::<prop::sample::Index>(), 0..8u32), 0..20),
        holes in prop::collection::vec(any::<prop::sample::Index>(), 0..5),
    ) {
        let (protocol, packets) = &numbered()[which];
        let mut bytes = bytes(&packets[..100]);
        let sent = read(Samples::new(*protocol), &bytes, 4096).0;
        for (at, bit) in flips {
            let at = at.index(bytes.len());
            bytes[at] ^= 1 << bit;
        }
        for at in holes {
            let at = at.index(bytes.len());
            bytes.remove(at);
        }
        let (came, _) = read(Samples::new(*protocol), &bytes, 4096);
        let mut rest = sent.iter();
        for sample in came {
            prop_assert!(rest.any(|sent| sent.kind == sample.kind && sent.t == sample.t), "{sample:?} was not sent");
        }
    }
}

/// Pressure comes back in every protocol that carries it; of a fix, only its arrival and time.
#[test]
fn pressures_come_back_and_a_fix_is_counted() {
    let scene = format!(
        "{NOISY}[baro]\nrate = \"200 Hz\"\nnoise_std = \"3 Pa\"\ntemperature = \"30 degC\"\n[airspeed]\nrate = \"100 Hz\"\nnoise_std = \"5 Pa\"\n[gps]\n"
    );
    let plan = plan(&scene.replace("50 Hz", "200 Hz"));
    for protocol in [Protocol::Mavlink, Protocol::Csv, Protocol::Jsonl] {
        let (packets, readings) = play(&plan, protocol, None);
        let (samples, counts) = read(Samples::new(protocol), &bytes(&packets), 1000);
        assert_eq!(counts.damaged, 0);
        for kind in [SensorKind::Baro, SensorKind::Airspeed] {
            let sent = readings.iter().filter(|(_, reading)| reading.kind == kind);
            let came: Vec<_> = samples.iter().filter(|sample| sample.kind == kind).collect();
            assert!(came.len() > 200 && came.len() == sent.clone().count(), "{protocol:?}: {}", came.len());
            for ((t, reading), sample) in sent.zip(came) {
                let seen = sample.value.and_then(Sensed::pressure).unwrap();
                let sent = reading.pressure().unwrap().value;
                let slack = if protocol == Protocol::Mavlink { sent.abs() * 2e-7 } else { 0.0 };
                assert!((seen - sent).abs() <= slack, "{kind}: {seen} of {sent}");
                assert_eq!(sample.t, Some(*t));
            }
        }
        let fixes = samples.iter().filter(|sample| sample.kind == SensorKind::Gps).count();
        assert_eq!(fixes, if protocol == Protocol::Mavlink { 0 } else { 13 }, "{protocol:?}");
    }
}
