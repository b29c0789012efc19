//! What a unit sends, against golden packets of a real driver, over the end of its clock, and through damage.

use super::*;
use crate::geometry::{Attitude, Euler, Vector};
use crate::player::Player;
use crate::sensor::{Measured, Measurement, Reading};
use crate::time::NANOS;
use crate::wire::samples::{Assumed, Counts, Sample, Samples, Sensed};
use crate::wire::tests::{plan, play, setup};
use crate::wire::wrap::MICROS_32;
use crate::wire::{Controller, Options, Protocol, at_rest, encoder, load};
use proptest::prelude::{any, *};
use ratetable_protocols::sbg::{Decoder, Received};

/// Error-free sensors at the rates of a real unit.
const SCENE: &str =
    "duration = \"2 s\"\n[gyro]\nrate = \"200 Hz\"\n[accel]\nrate = \"200 Hz\"\n[mag]\nrate = \"50 Hz\"\n";

/// Gyro .219307, .000284, .064725 rad/s; accel 0, −.0430155, −9.806556 m/s².
const IMU: &str = "ff5a2c0020003fb38202ff0300000000cf4fffff591863ff1392e0006d4a0000594742000019e9b233";
/// 175.6, −130.6, 430.6 mG, and the same accel.
const MAG: &str = "ff5a04001e003fb38202ff01bea42f43289602c3d949d74300000000083130bda7e71cc10b3133";

const T: SimTime = SimTime(42_119_999_000);
const ACCEL: [f64; 3] = [0.0, -0.043_015_509_843_826_294, -9.806_555_747_985_84];

/// Gyro, accel and mag of the golden packets, in our units.
fn golden() -> [[f64; 3]; 3] {
    let gyro = [14_717_459, 19_053, 4_343_641].map(|count| f64::from(count) / imu_short::GYRO_SCALE);
    let mag = [175.643_52_f32, -130.586_55, 430.576_93].map(|milligauss| 0.1 * f64::from(milligauss));
    [gyro, ACCEL, mag]
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

fn readings(triads: [[f64; 3]; 3]) -> Vec<Reading> {
    let triad = |(i, [x, y, z]): (usize, [f64; 3])| {
        Reading::zero(i, SensorKind::TRIADS[i]).with_body(Vector::new(x, y, z))
    };
    triads.into_iter().enumerate().map(triad).collect()
}

/// The packets of readings of every sensor at once.
fn packets(options: Options, truth: &Truth, triads: [[f64; 3]; 3]) -> Vec<Packet> {
    let plan = plan(SCENE);
    let mut encoder = encoder(Protocol::Sbg, &Setup { options, ..setup(&plan, None) });
    let mut packets = Vec::new();
    encoder.encode(&Now { t: truth.t, truth, readings: &readings(triads) }, &mut packets);
    packets
}

fn said(packets: &[Packet]) -> Vec<sbg::Packet> {
    let mut all = Vec::new();
    let mut decoder = Decoder::new();
    for packet in packets {
        decoder.feed(packet.bytes(), |received| all.extend(received.unwrap().packet));
    }
    assert_eq!(all.len(), packets.len());
    all
}

#[test]
fn the_golden_packets_of_a_real_driver_are_sent_byte_for_byte() {
    let packets = packets(Options::default(), &at_rest(T), golden());
    let sent: Vec<_> = packets.iter().map(|packet| hex(packet.bytes())).collect();
    assert_eq!(sent[..2], [IMU, MAG]);
    let carries: Vec<_> = packets.iter().map(|packet| packet.carries).collect();
    assert_eq!(carries, [INERTIAL, SensorKind::Mag.into(), Kinds::NONE, Kinds::NONE]);
    let [_, _, sbg::Packet::AirData(air), sbg::Packet::Quat(_)] = said(&packets)[..] else { panic!("four") };
    assert_eq!((air.pressure, air.status), (101_325.0, 0x22));
}

/// Negative control: a mistake in axes, sign or unit makes other bytes.
#[test]
fn a_mistake_in_the_readings_is_not_golden() {
    let changes: [fn([f64; 3]) -> [f64; 3]; 4] =
        [|[x, y, z]| [y, x, z], |[x, y, z]| [x, -y, z], |[x, y, z]| [x, y, -z], |v| v.map(|x| 1.001 * x)];
    for kind in 0..3 {
        for change in changes {
            let mut triads = golden();
            triads[kind] = change(triads[kind]);
            let packets = packets(Options::default(), &at_rest(T), triads);
            let sent = [0, 1].map(|i| hex(packets[i].bytes()));
            assert_ne!(sent, [IMU, MAG], "{kind}");
        }
    }
}

#[test]
fn the_field_is_in_the_unit_that_the_driver_takes_it_for() {
    let field = |options: Options| {
        let packets = packets(options, &at_rest(T), golden());
        let Some(sbg::Packet::Mag(seen)) = said(&packets).get(1).copied() else { panic!("a field") };
        assert_eq!(seen.accel, ACCEL.map(|a| a as f32), "MAG is a sample of the accelerometer too");
        seen.field[0]
    };
    let default = Options::default();
    let by = |controller| Options { controller: Some(controller), ..default };
    let in_unit = |unit, options: Options| Options { mag: Some(unit), ..options };
    for (options, expected) in [
        (default, 175.643_52),
        (by(Controller::Ardupilot), 175.643_52),
        (by(Controller::Px4), 0.175_643_52),
        (in_unit(MagUnit::Gauss, default), 0.175_643_52),
        (in_unit(MagUnit::Milligauss, by(Controller::Px4)), 175.643_52),
    ] {
        assert!((field(options) / expected - 1.0).abs() < 1e-6, "{options:?}");
    }
}

#[test]
fn a_rate_beyond_32_rad_per_s_is_told_in_larger_counts() {
    let (slow, fast) = (imu_short::GOOD, imu_short::GOOD | imu_short::HIGH_RANGE);
    for (rate, status) in
        [(31.999, slow), (-31.999, slow), (32.0, fast), (-32.0, fast), (-174.0, fast), (170.0, fast)]
    {
        let triads = [[0.5, rate, -0.25], ACCEL, [0.0; 3]];
        let packets = packets(Options::default(), &at_rest(T), triads);
        let sbg::Packet::ImuShort(seen) = said(&packets)[0] else { panic!("the first") };
        assert_eq!(seen.status, status, "{rate}");
        let mut samples = Vec::new();
        Samples::new(Protocol::Sbg).feed(packets[0].bytes(), |sample| samples.push(sample));
        let gyro = samples[0].value.and_then(Sensed::body).unwrap().v.to_array();
        let off = gyro.iter().zip(triads[0]).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(off <= 0.5 / seen.gyro_scale() * (1.0 + 1e-9), "{rate}: {gyro:?}");
    }
    // The larger counts end at 10000 °/s.
    let far = packets(Options::default(), &at_rest(T), [[1e9, -1e9, f64::NAN], [1e9; 3], [0.0; 3]]);
    let sbg::Packet::ImuShort(seen) = said(&far)[0] else { panic!("the first") };
    assert_eq!((seen.gyro, seen.accel, seen.status), ([i32::MAX, i32::MIN, 0], [i32::MAX; 3], fast));
}

#[test]
fn quat_is_level_unless_the_truth_is_asked_for() {
    let attitude = Euler { roll: 0.3, pitch: -0.2, yaw: 2.0 }.to_quat();
    let truth = Truth { attitude: Attitude::from_quat(attitude), ..at_rest(T) };
    let told = |claim| {
        let packets = packets(Options { claim, ..Options::default() }, &truth, golden());
        let Some(sbg::Packet::Quat(seen)) = said(&packets).last().copied() else { panic!("an attitude") };
        (seen.wxyz, seen.status)
    };
    assert_eq!(told(Claim::Level), ([1.0, 0.0, 0.0, 0.0], 0), "and no solution");
    let ([w, x, y, z], status) = told(Claim::Truth);
    let q = glam::DQuat::from_xyzw(x.into(), y.into(), z.into(), w.into()).normalize();
    assert!(Attitude::from_quat(q).angle_to(truth.attitude) < 1e-6);
    assert_eq!(status, SOLVED);
}

#[test]
fn each_packet_has_its_own_rate() {
    let count = |scene: &str| {
        let mut count = [0; 4];
        for packet in said(&play(&plan(scene), Protocol::Sbg, None).0) {
            let i = match packet {
                sbg::Packet::ImuShort(_) => 0,
                sbg::Packet::Mag(_) => 1,
                sbg::Packet::AirData(_) => 2,
                sbg::Packet::Quat(_) => 3,
                other => panic!("{other:?}"),
            };
            count[i] += 1;
        }
        count
    };
    assert_eq!(count(SCENE), [400, 100, 20, 100], "in two seconds");
    assert_eq!(count(&format!("{SCENE}[baro]\nrate = \"25 Hz\"\n")), [400, 100, 50, 100]);
    assert_eq!(count("duration = \"2 s\"\n[accel]\nrate = \"40 Hz\"\n"), [80, 0, 20, 80]);
    assert_eq!(count("duration = \"2 s\"\n[mag]\nrate = \"100 Hz\"\n"), [0, 200, 20, 100]);
    let whole = plan(SCENE);
    let (bytes, _) = load(Protocol::Sbg, &setup(&whole, None));
    let by_hand = 200.0 * 41.0 + 50.0 * 39.0 + 10.0 * 35.0 + 50.0 * 45.0;
    assert!((bytes - by_hand).abs() < 1e-6, "{bytes} of {by_hand}");
}

#[test]
fn a_barometer_comes_back() {
    let plan = plan(&format!("{SCENE}[baro]\nrate = \"25 Hz\"\n"));
    let mut encoder = encoder(Protocol::Sbg, &setup(&plan, None));
    let measured = Measured { value: 94_500.5, ..Measured::default() };
    let reading =
        Reading { measurement: Measurement::Pressure(measured), ..Reading::zero(3, SensorKind::Baro) };
    let mut packets = Vec::new();
    encoder.encode(&Now { t: T, truth: &at_rest(T), readings: &[reading] }, &mut packets);
    let mut samples = Vec::new();
    let mut reader = Samples::new(Protocol::Sbg);
    packets.iter().for_each(|packet| reader.feed(packet.bytes(), |sample| samples.push(sample)));
    assert_eq!((samples[0].kind, samples[0].value), (SensorKind::Baro, Some(Sensed::Pressure(94_500.5))));
    assert_eq!((samples.len(), reader.counts().foreign["quat"]), (1, 1));
}

#[test]
fn the_stream_ends_with_a_vehicle_that_has_stopped() {
    let plan = plan(SCENE);
    let mut encoder = encoder(Protocol::Sbg, &setup(&plan, None));
    let (mut packets, end) = (Vec::new(), SimTime(NANOS));
    encoder.farewell(&at_rest(end), &mut packets);
    assert!(packets.is_empty(), "who has not been played to keeps what they have");
    let roll = Euler { roll: 0.5, pitch: 0.0, yaw: 0.0 }.to_quat();
    let truth = Truth { attitude: Attitude::from_quat(roll), ..at_rest(T) };
    encoder.encode(&Now { t: T, truth: &truth, readings: &readings(golden()) }, &mut packets);
    packets.clear();
    encoder.farewell(&Truth { t: end, ..truth }, &mut packets);
    let [sbg::Packet::Mag(field), sbg::Packet::ImuShort(last)] = said(&packets)[..] else { panic!("two") };
    assert!(packets.iter().all(|packet| packet.due == end && packet.carries.is_empty()));
    assert_eq!(last.gyro, [0; 3]);
    let up = [0.0, -9.80665 * 0.5_f64.sin(), -9.80665 * 0.5_f64.cos()];
    let near = |a: [f64; 3]| a.iter().zip(up).all(|(a, b)| (a - b).abs() < 1e-5);
    assert!(near(last.accel.map(|count| f64::from(count) / imu_short::ACCEL_SCALE)), "{last:?}");
    assert!(near(field.accel.map(f64::from)), "{field:?}");
}

/// Thirty minutes of it at the rate of a real unit, the end of its clock in their middle.
#[test]
fn thirty_minutes_over_the_end_of_the_clock_come_back_with_every_time_and_value() {
    let minutes = 30;
    let text = format!(
        "seed = 4\nduration = \"{} s\"\n[[motion]]\nkind = \"rock\"\namplitude = \"40 deg/s\"\nfrequency = \"0.3 Hz\"\naxis = \"pitch\"\nduration = \"{0} s\"\n[gyro]\nrate = \"200 Hz\"\nnoise_std = \"0.01 rad/s\"\n[accel]\nrate = \"200 Hz\"\nnoise_std = \"0.02 m/s^2\"\n[mag]\nrate = \"100 Hz\"\nnoise_std = \"0.2 uT\"\n",
        minutes * 60
    );
    let plan = plan(&text);
    let begin = SimTime(MICROS_32 / NANOS * NANOS - minutes / 2 * 60 * NANOS);
    let mut encoder = encoder(Protocol::Sbg, &setup(&plan, None));
    let mut reader = Samples::new(Protocol::Sbg);
    let (mut packets, mut came, mut sent) = (Vec::new(), [0_u64; 3], 0_u64);
    let played: Result<(), ()> = Player::new(&plan, plan.duration, 1000).play(|moment| {
        let t = begin + moment.t;
        packets.clear();
        let truth = Truth { t, ..*moment.truth };
        encoder.encode(&Now { t, truth: &truth, readings: moment.readings }, &mut packets);
        sent += packets.len() as u64;
        let mut read = |sample: Sample| {
            assert_eq!(sample.t, Some(t));
            let Some(count) = came.get_mut(sample.kind as usize) else { return };
            *count += 1;
            let reading = moment.readings.iter().find(|reading| reading.kind == sample.kind).unwrap();
            let reading = reading.body().unwrap().value.v;
            let off = sample.value.and_then(Sensed::body).unwrap().v - reading;
            let slack = match sample.kind {
                SensorKind::Gyro => 0.5 / imu_short::GYRO_SCALE,
                SensorKind::Accel => 0.5 / imu_short::ACCEL_SCALE,
                _ => reading.abs().max_element() * f64::from(f32::EPSILON),
            };
            assert!(off.abs().max_element() <= slack * (1.0 + 1e-6), "{}: {off} at {t}", sample.kind);
        };
        packets.iter().for_each(|packet| reader.feed(packet.bytes(), &mut read));
        Ok(())
    });
    assert!(played.is_ok());
    let seconds = minutes as u64 * 60;
    assert_eq!(came, [200 * seconds, 200 * seconds, 100 * seconds]);
    assert_eq!(sent, (200 + 100 + 10 + 50) * seconds);
    let Counts { damaged, packets, .. } = reader.counts();
    assert_eq!((*damaged, *packets), (0, sent));
}

#[test]
fn a_field_in_gauss_is_read_as_such_where_that_is_said() {
    let options = Options { mag: Some(MagUnit::Gauss), ..Options::default() };
    let packets = packets(options, &at_rest(T), golden());
    let read = |assumed: &Assumed| {
        let mut samples = Vec::new();
        Samples::assuming(Protocol::Sbg, assumed).feed(packets[1].bytes(), |sample| samples.push(sample));
        samples[0].value.and_then(Sensed::body).unwrap().v.x
    };
    let right = read(&Assumed { mag: MagUnit::Gauss, ..Assumed::default() });
    assert!((right - golden()[2][0]).abs() < 1e-5, "{right}");
    assert!((read(&Assumed::default()) * 1000.0 - right).abs() < 1e-3, "and else a thousandth");
}

/// CRC-16/KERMIT, bit by bit.
fn kermit(bytes: &[u8]) -> u16 {
    bytes.iter().fold(0, |crc, &byte| {
        (0..8).fold(crc ^ u16::from(byte), |crc, _| if crc & 1 == 0 { crc >> 1 } else { crc >> 1 ^ 0x8408 })
    })
}

proptest! {
    /// Packets with bytes changed and left out: nothing comes that was not sent.
    #[test]
    fn through_damage_only_samples_come_that_were_sent(
        flips in prop::collection::vec((any::<prop::sample::Index>(), 0..8u32), 0..12),
        holes in prop::collection::vec(any::<prop::sample::Index>(), 0..4),
        cut in 1..200usize,
    ) {
        let mut bytes = Vec::new();
        let mut buffer = [0; MAX_LEN];
        for time_us in 0..40 {
            let said = imu_short::Repr { time_us, gyro: [time_us as i32; 3], ..Default::default() };
            let len = sbg::encode(&sbg::Packet::ImuShort(said), &mut buffer).unwrap();
            bytes.extend_from_slice(&buffer[..len]);
        }
        for (at, bit) in flips {
            let at = at.index(bytes.len());
            bytes[at] ^= 1 << bit;
        }
        for at in holes {
            let at = at.index(bytes.len());
            bytes.remove(at);
        }
        let (mut reader, mut last) = (Samples::new(Protocol::Sbg), SimTime(-1));
        let mut each = |sample: Sample| {
            let t = sample.t.unwrap();
            if sample.kind == SensorKind::Gyro {
                assert!(last < t && t.0 < 40 * MICROSECOND, "{t} after {last}");
                let x = sample.value.and_then(Sensed::body).unwrap().v.x;
                assert!((x * imu_short::GYRO_SCALE - (t.0 / MICROSECOND) as f64).abs() < 1e-6, "{x} at {t}");
                last = t;
            }
        };
        bytes.chunks(cut).for_each(|piece| reader.feed(piece, &mut each));
        reader.finish(&mut each);
    }

    /// Any whole packets of any class are counted and panic nobody.
    #[test]
    fn packets_of_any_class_are_counted(
        id in any::<u8>(), class in prop::sample::select(vec![0_u8, 1, 16, 255]),
        payload in prop::collection::vec(any::<u8>(), 0..200),
    ) {
        let mut inside = vec![id, class];
        inside.extend((payload.len() as u16).to_le_bytes());
        inside.extend(&payload);
        let crc = kermit(&inside);
        let bytes = [&[0xff, 0x5a][..], &inside, &crc.to_le_bytes(), &[0x33]].concat();
        let mut found: Option<Received> = None;
        Decoder::new().feed(&bytes, |received| found = received.ok());
        let mut reader = Samples::new(Protocol::Sbg);
        reader.feed(&bytes, |_| {});
        prop_assert_eq!(reader.counts().packets, u64::from(found.is_some()));
        prop_assert!(reader.counts().damaged + reader.counts().joined_midway <= 1);
    }
}
