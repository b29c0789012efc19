//! What a unit sends, against golden frames of a real driver, over the end of a week, and through damage.

use super::*;
use crate::geometry::Attitude;
use crate::player::Player;
use crate::scene::Plan;
use crate::sensor::{Measured, Measurement, Reading};
use crate::time::Rate;
use crate::wire::samples::{Counts, Sample, Samples};
use crate::wire::tests::{plan, setup};
use crate::wire::{Options, Protocol, at_rest, encoder, load};
use proptest::prelude::{any, *};
use ratetable_protocols::ilabs::Decoder;

/// Error-free sensors, each with a tick in every millisecond.
const SCENE: &str = "duration = \"1 s\"\n[gyro]\nrate = \"1 kHz\"\n[accel]\nrate = \"1 kHz\"\n[mag]\nrate = \"1 kHz\"\n[baro]\nrate = \"1 kHz\"\n";

/// Gyro 30, −31, 2 rad/s; accel 156, −156, 20 m/s²; mag −3200, 3200, −7.8 mG; 94500 Pa; roll −11.70°, yaw 30°.
const TURNED: &str = "aa550195440009012321252407535a523a420000105e0dfff0a1f200ade4e0ffecc769f5ebca3e0aac2551ff92b800000000007d00834e00b80b00006efb00000000fa004d17";
/// Still at yaw 30°, in a field of 22 µT to the north and 43 µT down.
const STILL: &str = "aa550195440009012321252407535a52f40100000000000000000000ad400f00000000000000000000000000e6c500000000b4fb710734efb80b0000000000000000fa001a0b";

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// What is read, and what is true of the attitude.
struct Case {
    ms: i64,
    /// Gyro, accel, mag.
    triads: [[f64; 3]; 3],
    pressure: f64,
    /// Roll, pitch, yaw, degrees.
    attitude: [f64; 3],
}

fn turned() -> Case {
    Case {
        ms: 16_954,
        triads: [[30.0, -31.0, 2.0], [156.0, -156.0, 20.0], [-320.0, 320.0, -0.78]],
        pressure: 94_500.0,
        attitude: [-11.7, 0.0, 30.0],
    }
}

fn still() -> Case {
    Case {
        ms: 500,
        triads: [[0.0; 3], [0.0, 0.0, -9.80665], [19.05, -11.0, 43.0]],
        pressure: 101_325.0,
        attitude: [0.0, 0.0, 30.0],
    }
}

fn truth(t: SimTime, [roll, pitch, yaw]: [f64; 3]) -> Truth {
    let [roll, pitch, yaw] = [roll, pitch, yaw].map(f64::to_radians);
    Truth { attitude: Attitude::from_quat(Euler { roll, pitch, yaw }.to_quat()), ..at_rest(t) }
}

fn readings(case: &Case) -> Vec<Reading> {
    let triad = |(i, [x, y, z]): (usize, [f64; 3])| {
        Reading::zero(i, SensorKind::TRIADS[i]).with_body(Vector::new(x, y, z))
    };
    let measured = Measured { value: case.pressure, ..Measured::default() };
    let pressure =
        Reading { measurement: Measurement::Pressure(measured), ..Reading::zero(3, SensorKind::Baro) };
    case.triads.into_iter().enumerate().map(triad).chain([pressure]).collect()
}

/// The only frame of these readings.
fn frame(case: &Case, claim: Claim) -> String {
    let plan = plan(SCENE);
    let options = Options { claim, ..Options::default() };
    let mut encoder = encoder(Protocol::Ilabs, &Setup { options, ..setup(&plan, None) });
    let t = SimTime(case.ms * MILLISECOND);
    let mut packets = Vec::new();
    encoder.encode(&Now { t, truth: &truth(t, case.attitude), readings: &readings(case) }, &mut packets);
    let [packet] = &packets[..] else { panic!("one frame") };
    let carried = [SensorKind::Gyro, SensorKind::Accel, SensorKind::Mag, SensorKind::Baro];
    assert_eq!((packet.due, packet.carries), (t, Kinds::of(&carried)));
    hex(packet.bytes())
}

#[test]
fn the_golden_frames_of_a_real_driver_are_sent_byte_for_byte() {
    assert_eq!(frame(&turned(), Claim::Truth), TURNED);
    assert_eq!(frame(&still(), Claim::Truth), STILL);
}

/// Negative control: a mistake in axes, sign, unit or g makes other bytes.
#[test]
fn a_mistake_in_the_readings_is_not_golden() {
    let changes: [fn([f64; 3]) -> [f64; 3]; 4] = [
        |[x, y, z]| [y, x, z],
        |[x, y, z]| [x, -y, z],
        |[x, y, z]| [x, y, -z],
        |v| v.map(|x| x * 9.8106 / 9.80665),
    ];
    for kind in 0..3 {
        for (i, change) in changes.into_iter().enumerate() {
            let mut case = turned();
            case.triads[kind] = change(case.triads[kind]);
            assert_ne!(frame(&case, Claim::Truth), TURNED, "{kind} {i}");
        }
    }
    assert_ne!(frame(&Case { pressure: 94_502.0, ..turned() }, Claim::Truth), TURNED);
    assert_ne!(frame(&Case { attitude: [-11.7, 0.01, 30.0], ..turned() }, Claim::Truth), TURNED);
}

#[test]
fn the_attitude_beside_the_readings_is_level_unless_the_truth_is_asked_for() {
    let told = |claim, attitude| {
        let mut seen = None;
        let hex = frame(&Case { attitude, ..still() }, claim);
        let bytes: Vec<u8> =
            (0..hex.len()).step_by(2).map(|i| u8::from_str_radix(&hex[i..i + 2], 16).unwrap()).collect();
        Decoder::new().feed(&bytes, |received| seen = received.unwrap().attitude);
        let Angles { yaw, pitch, roll } = seen.unwrap();
        (yaw, pitch, roll)
    };
    for (attitude, expected) in [
        ([10.0, -20.0, 30.0], (3000, -2000, 1000)),
        ([-179.99, 89.9, -0.01], (35_999, 8990, -17_999)),
        // To the hundredth, a whole turn is none.
        ([0.0, 0.0, -0.004], (0, 0, 0)),
        ([180.0, 0.0, 180.0], (18_000, 0, 18_000)),
    ] {
        assert_eq!(told(Claim::Truth, attitude), expected, "{attitude:?}");
        assert_eq!(told(Claim::Level, attitude), (0, 0, 0), "{attitude:?}");
    }
}

/// What a frame of these readings tells.
fn told_of(case: &Case) -> Repr {
    let hex = frame(case, Claim::Level);
    let bytes: Vec<u8> =
        (0..hex.len()).step_by(2).map(|i| u8::from_str_radix(&hex[i..i + 2], 16).unwrap()).collect();
    let mut seen = None;
    Decoder::new().feed(&bytes, |received| seen = received.ok());
    seen.unwrap()
}

#[test]
fn what_does_not_fit_is_clipped_at_the_ends_of_its_range() {
    let triads = [[1e6, -1e6, 0.0], [1e9, 0.0, -1e9], [-400.0, 400.0, 327.68]];
    let far = told_of(&Case { triads, pressure: 200_000.0, ..still() });
    assert_eq!(far.gyro, Some([i32::MIN, i32::MAX, 0]));
    assert_eq!(far.accel, Some([0, i32::MAX, i32::MAX]));
    assert_eq!(far.mag, Some([i16::MAX, -i16::MAX, -i16::MAX]), "3276.7 mG both ways");
    assert_eq!(far.pressure, Some(Pressure { half_pascals: u16::MAX, altitude: 0 }));
    let none = told_of(&Case { triads: [[f64::NAN; 3]; 3], pressure: -1.0, ..still() });
    assert_eq!((none.gyro, none.mag), (Some([0; 3]), Some([0; 3])));
    assert_eq!(none.pressure, Some(Pressure { half_pascals: 0, altitude: 0 }));
}

#[test]
fn a_frame_tells_what_the_scene_has_and_that_the_unit_is_well() {
    for (sensors, len) in [
        ("[gyro]\nrate = \"200 Hz\"\n", 37),
        ("[gyro]\nrate = \"200 Hz\"\n[accel]\nrate = \"200 Hz\"\n", 50),
        ("[gyro]\nrate = \"200 Hz\"\n[accel]\nrate = \"200 Hz\"\n[mag]\nrate = \"50 Hz\"\n", 57),
    ] {
        let plan = plan(&format!("duration = \"1 s\"\n{sensors}"));
        // Beside the vectors 13 bytes for each id of the others: time, pressure, attitude, two words, temperature.
        let (bytes, frames) = load(Protocol::Ilabs, &setup(&plan, None));
        assert_eq!((bytes, frames), (f64::from(len + 13) * 200.0, 200.0), "{sensors}");
    }
    let told = told_of(&still());
    assert_eq!((told.status, told.status_2, told.temperature), (Some(0), Some(0), Some(250)));
}

/// Thirty minutes of it at the rate of a real unit, the end of a week in their middle.
#[test]
fn thirty_minutes_over_the_end_of_a_week_come_back_with_every_time_and_value() {
    let minutes = 30;
    let plan: Plan = plan(&format!(
        "seed = 4\nduration = \"{} s\"\n[[motion]]\nkind = \"rock\"\namplitude = \"40 deg/s\"\nfrequency = \"0.3 Hz\"\naxis = \"pitch\"\nduration = \"{0} s\"\n[gyro]\nrate = \"200 Hz\"\nnoise_std = \"0.01 rad/s\"\n[accel]\nrate = \"200 Hz\"\nnoise_std = \"0.02 m/s^2\"\n[mag]\nrate = \"100 Hz\"\nnoise_std = \"0.2 uT\"\n",
        minutes * 60
    ));
    let begin = SimTime(WEEK - minutes / 2 * 60 * NANOS);
    let mut encoder = encoder(Protocol::Ilabs, &setup(&plan, None));
    let mut reader = Samples::new(Protocol::Ilabs);
    let (mut packets, mut came, mut sent) = (Vec::new(), 0_u64, 0_u64);
    let step = Rate::hz(200).tick(1);
    let played: Result<(), ()> = Player::new(&plan, plan.duration, 1000).play(|moment| {
        let t = begin + moment.t;
        packets.clear();
        encoder.encode(
            &Now { t, truth: &Truth { t, ..*moment.truth }, readings: moment.readings },
            &mut packets,
        );
        sent += packets.len() as u64;
        let mut read = |sample: Sample| {
            came += u64::from(sample.kind == SensorKind::Gyro);
            assert_eq!(sample.t, Some(t));
            let reading = moment.readings.iter().find(|reading| reading.kind == sample.kind);
            let Some(reading) = reading.and_then(|reading| reading.body()) else { return };
            let off = sample.value.unwrap().body().unwrap().v - reading.value.v;
            let count = [GYRO, ACCEL, MAG][sample.kind as usize];
            assert!(off.abs().max_element() <= 0.5 * count * (1.0 + 1e-6), "{}: {off} at {t}", sample.kind);
        };
        packets.iter().for_each(|packet| reader.feed(packet.bytes(), &mut read));
        Ok(())
    });
    assert!(played.is_ok());
    let frames = (minutes * 60 * NANOS / step.0) as u64;
    assert_eq!((sent, came), (frames, frames));
    let Counts { damaged, packets, .. } = reader.counts();
    assert_eq!((*damaged, *packets), (0, frames));
}

#[test]
fn the_last_frames_time_is_not_that_of_the_one_before_however_close_it_is() {
    let plan = plan(SCENE);
    let mut encoder = encoder(Protocol::Ilabs, &setup(&plan, None));
    let (t, mut packets) = (SimTime(500 * MILLISECOND), Vec::new());
    encoder.encode(&Now { t, truth: &at_rest(t), readings: &readings(&still()) }, &mut packets);
    encoder.farewell(&at_rest(SimTime(t.0 + 1)), &mut packets);
    let mut times = Vec::new();
    let mut reader = Samples::new(Protocol::Ilabs);
    for packet in &packets {
        reader.feed(packet.bytes(), |sample| {
            times.extend(sample.t.filter(|_| sample.kind == SensorKind::Gyro))
        });
    }
    assert_eq!(times, [500, 501].map(|ms| SimTime(ms * MILLISECOND)));
}

/// What the sum cannot do, and no receiver: two flipped bits that cancel are not seen.
#[test]
fn damage_that_cancels_in_the_sum_is_not_seen() {
    let frame = |gyro| {
        let mut buffer = [0; ilabs::MAX_LEN];
        let len = ilabs::encode(&Repr { gyro: Some(gyro), ..Repr::default() }, &mut buffer).unwrap();
        buffer[..len].to_vec()
    };
    let mut hurt = frame([8, 0, 0]);
    let (x, y) = (HEADER_LEN + 2, HEADER_LEN + 6);
    assert_eq!((hurt[x], hurt[y]), (8, 0));
    hurt[x] ^= 8;
    let seen = |bytes: &[u8]| {
        let mut seen = None;
        Decoder::new().feed(bytes, |received| seen = Some(received));
        seen
    };
    assert!(matches!(seen(&hurt), Some(Err(_))), "one is");
    hurt[y] ^= 8;
    assert_eq!(hurt, frame([0, 8, 0]));
}

proptest! {
    /// Frames with a bit flipped or a byte left out: nothing comes that was not sent.
    #[test]
    fn through_damage_only_samples_come_that_were_sent(
        flips in prop::collection::btree_map(0..40_usize, any::<prop::sample::Index>(), 0..12),
        holes in prop::collection::btree_map(0..40_usize, any::<prop::sample::Index>(), 0..4),
        cut in 1..200usize,
    ) {
        let mut buffer = [0; ilabs::MAX_LEN];
        let mut frames: Vec<Vec<u8>> = Vec::new();
        for ms in 0..40 {
            let told = Repr { time_ms: Some(ms), gyro: Some([ms as i32; 3]), ..Repr::default() };
            let len = ilabs::encode(&told, &mut buffer).unwrap();
            frames.push(buffer[..len].to_vec());
        }
        // One change a frame: of two the plain sum may see none.
        for (k, at) in &flips {
            let bit = at.index(8 * frames[*k].len());
            frames[*k][bit / 8] ^= 1 << (bit % 8);
        }
        for (k, at) in holes.iter().filter(|(k, _)| !flips.contains_key(k)) {
            let at = at.index(frames[*k].len());
            frames[*k].remove(at);
        }
        let bytes = frames.concat();
        let (mut reader, mut last) = (Samples::new(Protocol::Ilabs), SimTime(-1));
        let mut each = |sample: Sample| {
            let t = sample.t.unwrap();
            assert!(last < t && t.0 < 40 * MILLISECOND, "{t} after {last}");
            let [x, ..] = sample.value.unwrap().body().unwrap().v.to_array();
            assert!((x / GYRO - (t.0 / MILLISECOND) as f64).abs() < 1e-6, "{x} at {t}");
            last = t;
        };
        bytes.chunks(cut).for_each(|piece| reader.feed(piece, &mut each));
        reader.finish(&mut each);
    }
}
