//! What `msp`, `vectornav` and `mip` send, against golden packets of real firmwares and read back by the decoders.

use super::tests::{plan, play, setup};
use super::*;
use crate::geometry::Euler;
use crate::player::Player;
use crate::scene::Plan;
use crate::sensor::{Kinds, SensorKind};
use crate::time::NANOS;
use crate::time::Rate;
use ratetable_protocols::msp::{self, Message, simulator};
use ratetable_protocols::vectornav::{ahrs, imu as vn_imu};
use ratetable_protocols::{mip, vectornav as vn};

/// Three error-free sensors at 100 Hz.
const EXACT: &str = "[gyro]\nrate = \"100 Hz\"\n[accel]\nrate = \"100 Hz\"\n[mag]\nrate = \"100 Hz\"\n";
/// In which a packet has one new sample of each, and nothing repeats.
pub(super) const TOGETHER: &str = r#"
seed = 3
[[motion]]
kind = "rotate"
angular_rate = "[120, -310, 77] deg/s"
duration = "2.5 s"
[gyro]
rate = "100 Hz"
noise_std = "1 deg/s"
[accel]
rate = "100 Hz"
noise_std = "1 m/s^2"
[mag]
rate = "100 Hz"
noise_std = "1 uT"
"#;

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

fn simulated(packets: &[Packet]) -> Vec<simulator::Repr> {
    let mut all = Vec::new();
    let mut decoder = msp::Decoder::new();
    for packet in packets {
        decoder.feed(packet.bytes(), |received| match received.map(|received| received.message) {
            Ok(Some(Message::Simulator(seen))) => all.push(seen),
            other => panic!("{other:?}"),
        });
    }
    all
}

fn outputs(packets: &[Packet]) -> (Vec<vn_imu::Repr>, Vec<ahrs::Repr>) {
    let (mut imus, mut attitudes) = (Vec::new(), Vec::new());
    let mut decoder = vn::Decoder::new();
    for packet in packets {
        decoder.feed(packet.bytes(), |received| match received.unwrap() {
            vn::Packet::Imu(seen) => imus.push(seen),
            vn::Packet::Ahrs(seen) => attitudes.push(seen),
            vn::Packet::Line(line) => panic!("{line:?}"),
        });
    }
    (imus, attitudes)
}

fn inertial(packets: &[Packet]) -> Vec<mip::imu::Repr> {
    let mut all = Vec::new();
    let mut decoder = mip::Decoder::new();
    packets.iter().for_each(|packet| decoder.feed(packet.bytes(), |received| all.push(received.unwrap())));
    all
}

/// A golden message: level, heading north, in a field that dips 60 degrees.
const LEVEL: &str = "00000000e803000000000000cd8b010000280000b8ba2e";
/// At roll 30, pitch 10, yaw 90 degrees, turning at 1, 2, 3 deg/s.
const TURNING: &str = "ae00ec0155031000e0ffd0ffcd8b0100f8f38700e9b071";

/// What follows the header, version, flags and 30 bytes of zeros of a simulator message, which are checked.
fn readings_of(packet: &Packet) -> String {
    let hex = hex(packet.bytes());
    let start = format!("24583c001f203600020f{}", "00".repeat(30));
    hex.strip_prefix(&start).unwrap_or_else(|| panic!("{hex}")).to_string()
}

#[test]
fn msp_sends_the_golden_bytes_of_inav() {
    let turning = "[start]\nattitude = \"[30, 10, 90] deg\"\n[[motion]]\nkind = \"rotate\"\n\
                   angular_rate = \"[1, 2, 3] deg/s\"\nduration = \"1 s\"\n";
    for (motion, golden) in [("duration = \"1 s\"\n", LEVEL), (turning, TURNING)] {
        // Whatever the declination and the strength, and in either axes.
        for (declination, strength) in [(0.0, 50.0), (11.46, 50.0), (-170.0, 31.0)] {
            let field = strength * 60f64.to_radians().cos();
            let (north, east) = (f64::to_radians(declination).cos(), f64::to_radians(declination).sin());
            let down = strength * 60f64.to_radians().sin();
            let earth = format!("[earth]\nfield = \"[{}, {}, {down}] uT\"\n", field * north, field * east);
            let (packets, _) = play(&plan(&format!("{motion}{earth}{EXACT}")), Protocol::Msp, None);
            assert_eq!(readings_of(&packets[0]), golden, "declination {declination}, {strength} uT");
            assert_eq!(packets.len(), 100);
        }
    }
}

/// Negative control: readings with a mistake in axes, sign, unit or declination make other bytes.
#[test]
fn a_mistake_in_the_readings_is_not_golden() {
    let scene = format!(
        "[start]\nattitude = \"[30, 10, 90] deg\"\n[[motion]]\nkind = \"rotate\"\n\
         angular_rate = \"[1, 2, 3] deg/s\"\nduration = \"1 s\"\n{EXACT}"
    );
    let plan = plan(&scene);
    let first = |change: &dyn Fn(&mut Reading)| {
        let mut encoder = encoder(Protocol::Msp, &setup(&plan, None));
        let mut packets = Vec::new();
        let _ = Player::new(&plan, plan.duration, 1).play(|moment| {
            let mut readings = moment.readings.to_vec();
            readings.iter_mut().for_each(change);
            encoder.encode(&Now { t: moment.t, truth: moment.truth, readings: &readings }, &mut packets);
            Err(())
        });
        readings_of(&packets[0])
    };
    assert_eq!(first(&|_| {}), TURNING);
    let changes: [fn([f64; 3]) -> [f64; 3]; 4] =
        [|[x, y, z]| [y, x, z], |[x, y, z]| [x, -y, z], |[x, y, z]| [x, y, -z], |v| v.map(|x| 1.05 * x)];
    for kind in SensorKind::ALL.into_iter().take(3) {
        for change in changes {
            let changed = first(&|reading: &mut Reading| {
                if reading.kind == kind {
                    let [x, y, z] = change(reading.body().unwrap().value.v.to_array());
                    *reading = reading.with_body(Vector::new(x, y, z));
                }
            });
            assert_ne!(changed, TURNING, "{kind}");
        }
    }
}

#[test]
fn msp_leaves_the_magnetometers_own_errors_on_its_own_axes() {
    let scene = |bias: &str| {
        let motion =
            "[[motion]]\nkind = \"rotate\"\nangular_rate = \"[90, 50, -70] deg/s\"\nduration = \"3 s\"\n";
        plan(&format!("{motion}[earth]\nfield = \"[15, 12, 40] uT\"\n{EXACT}{bias}"))
    };
    let strength = libm::sqrt(15f64.powi(2) + 12f64.powi(2) + 40f64.powi(2));
    let exact = simulated(&play(&scene(""), Protocol::Msp, None).0);
    let biased = simulated(&play(&scene("bias = \"[1, -2, 3] uT\"\n"), Protocol::Msp, None).0);
    for (exact, biased) in exact.iter().zip(&biased) {
        for (axis, expected) in [1.0, 2.0, -3.0].into_iter().enumerate() {
            let off = f64::from(biased.mag[axis]) - f64::from(exact.mag[axis]);
            assert!((off - expected * 20480.0 / strength).abs() <= 1.0, "axis {axis}: {off}");
        }
        let length = libm::sqrt(exact.mag.iter().map(|&x| f64::from(x).powi(2)).sum());
        assert!((length - 20480.0).abs() < 1.0, "{length}");
    }
}

/// Bytes of a golden packet whose pressure is that which a scene without a barometer has.
fn with_pressure(mut imu: vn_imu::Repr, pressure: f32) -> Vec<u8> {
    imu.pressure = pressure;
    let mut bytes = [0; vn::MAX_LEN];
    let len = vn::encode(&vn::Packet::Imu(imu), &mut bytes).unwrap();
    bytes[..len].to_vec()
}

/// Packets of these readings of gyro, accel and mag, one second after the start.
fn after_a_second(protocol: Protocol, values: [[f64; 3]; 3]) -> Vec<Packet> {
    let plan = plan(&format!("duration = \"9 s\"\n{}", EXACT.replace("100 Hz", "1 Hz")));
    let mut encoder = encoder(protocol, &setup(&plan, None));
    let (mut packets, mut first) = (Vec::new(), 0);
    for seconds in [0, 1] {
        first = packets.len();
        let t = SimTime(seconds * NANOS);
        let reading = |(i, [x, y, z]): (usize, [f64; 3])| {
            Reading::zero(i, SensorKind::ALL[i]).with_body(Vector::new(x, y, z))
        };
        let readings: Vec<_> = values.into_iter().enumerate().map(reading).collect();
        encoder.encode(&Now { t, truth: &at_rest(t), readings: &readings }, &mut packets);
    }
    packets.split_off(first)
}

const GYRO: [f64; 3] = [0.125, -0.25, 0.5];
/// 0.25, 0.0625 and -0.5 gauss.
const MAG: [f64; 3] = [25.0, 6.25, -50.0];

#[test]
fn vectornav_sends_the_golden_bytes_of_a_vn_100() {
    let packets = after_a_second(Protocol::Vectornav, [GYRO, [0.5, -0.25, -9.75], MAG]);
    let golden = vn_imu::Repr {
        time_ns: 1_000_000_000,
        gyro: [0.125, -0.25, 0.5],
        accel: [0.5, -0.25, -9.75],
        raw_accel: [0.5, -0.25, -9.75],
        raw_gyro: [0.125, -0.25, 0.5],
        mag: [0.25, 0.0625, -0.5],
        temperature: 25.0,
        pressure: 94.5,
    };
    let whole = "fa01210700ca9a3b000000000000003e000080be0000003f0000003f000080be00001cc10000003f000080be00001cc1\
                 0000003e000080be0000003f0000803e0000803d000000bf0000c8410000bd425863";
    assert_eq!(hex(&with_pressure(golden, 94.5)), whole);
    assert_eq!(packets[0].bytes(), with_pressure(golden, 101.325));
    assert_eq!((packets[0].carries, packets[1].carries, packets.len()), (Kinds::TRIADS, Kinds::NONE, 2));
}

#[test]
fn mip_sends_the_golden_bytes_of_a_microstrain() {
    let packets = after_a_second(Protocol::Mip, [GYRO, [0.0, 0.0, -STANDARD_GRAVITY], MAG]);
    let seen = inertial(&packets);
    let golden = mip::imu::Repr { pressure: Some(945.0), ..seen[0] };
    let mut bytes = [0; mip::MAX_LEN];
    let len = mip::encode(&golden, &mut bytes).unwrap();
    assert_eq!(
        hex(&bytes[..len]),
        "756580300617446c40000e063e8000003d800000bf0000000e040000000000000000bf8000000e053e000000be8000003f0000000441"
    );
    assert_eq!((seen[0].pressure, seen.len()), (Some(1013.25), 1));
    let (packets, _) = play(&plan("duration = \"1 s\"\n[gyro]\nrate = \"50 Hz\"\n"), Protocol::Mip, None);
    assert!(inertial(&packets).iter().all(|seen| seen.accel.is_none() && seen.mag.is_none()));
}

#[test]
fn ahrs_packets_carry_the_truth_fifty_times_a_second() {
    for rate in ["1 kHz", "100 Hz", "30 Hz"] {
        let scene = TOGETHER.replace("100 Hz", rate);
        let plan = plan(&scene);
        let (packets, _) = play(&plan, Protocol::Vectornav, None);
        let (_, attitudes) = outputs(&packets);
        let expected = if rate == "30 Hz" { 75 } else { 125 };
        assert_eq!(attitudes.len(), expected, "{rate}");
        for seen in attitudes {
            let truth = plan.trajectory.at(SimTime(seen.time_ns as i64)).attitude;
            let [x, y, z, w] = seen.xyzw.map(f64::from);
            let q = glam::DQuat::from_xyzw(x, y, z, w);
            assert!(truth.angle_to(Attitude::from_quat(q.normalize())) < 1e-6);
            let [yaw, pitch, roll] = seen.yaw_pitch_roll.map(|angle| f64::from(angle).to_radians());
            let q = Euler { roll, pitch, yaw }.to_quat();
            assert!(truth.angle_to(Attitude::from_quat(q)) < 1e-6);
        }
    }
}

/// A ramp of the gyro's x that says in which millisecond a sample was taken.
fn ramp(protocol: Protocol, gyro: Rate, peer: Peer) -> Vec<Packet> {
    let plan = plan(&format!("duration = \"9 s\"\n{}", EXACT.replacen("100 Hz", &format!("{gyro}"), 1)));
    let mut encoder = encoder(protocol, &Setup { peer, ..setup(&plan, None) });
    let mut packets = Vec::new();
    for t in (0..).map(|k| gyro.tick(k)).take_while(|t| t.0 < 2 * NANOS) {
        let value = Vector::new((t.0 / 1_000_000) as f64 * 1e-3, 0.0, 0.0);
        let reading = Reading::zero(0, SensorKind::Gyro).with_body(value);
        encoder.encode(&Now { t, truth: &at_rest(t), readings: &[reading] }, &mut packets);
    }
    packets.retain(|packet| packet.bytes().len() != 56);
    packets
}

#[test]
fn imu_packets_come_evenly_at_the_rate_asked_for_with_the_newest_sample_then() {
    for (gyro, asked) in [(1000, 100), (1000, 400), (1000, 1000), (50, 200), (333, 100)] {
        let (gyro, asked) = (Rate::hz(gyro), Rate::hz(asked));
        let packets = ramp(Protocol::Vectornav, gyro, Peer { rate: Some(asked), ..Peer::default() });
        let (imus, _) = outputs(&packets);
        for (k, (packet, imu)) in packets.iter().zip(&imus).enumerate() {
            assert_eq!(packet.due, asked.tick(k as u64), "{gyro} {asked}");
            assert_eq!(imu.time_ns as i64, packet.due.0);
            let newest = gyro.ticks_before(SimTime::ZERO, SimTime(packet.due.0 + 1)) - 1;
            let expected = (gyro.tick(newest).0 / 1_000_000) as f64 * 1e-3;
            assert!((f64::from(imu.gyro[0]) - expected).abs() < 1e-6, "{gyro} {asked} packet {k}");
        }
        let last = gyro.tick(gyro.ticks_before(SimTime::ZERO, SimTime(2 * NANOS)) - 1);
        assert_eq!(packets.len() as u64, asked.ticks_before(SimTime::ZERO, SimTime(last.0 + 1)));
    }
}

#[test]
fn msp_sends_a_hundred_packets_a_second_at_most_and_says_what_is_left_out() {
    for (gyro, rate) in [(1000, 100), (333, 100), (100, 100), (50, 50)] {
        let packets = ramp(Protocol::Msp, Rate::hz(gyro), Peer::default());
        let seen = simulated(&packets);
        assert!(packets.iter().enumerate().all(|(k, packet)| packet.due == Rate::hz(rate).tick(k as u64)));
        let replaced: u32 = packets.iter().map(|packet| packet.replaced[0]).sum();
        let carried: u32 =
            packets.iter().map(|packet| u32::from(packet.carries.contains(SensorKind::Gyro))).sum();
        assert!(carried + replaced <= 2 * gyro && carried == 2 * gyro.min(rate), "{carried} {replaced}");
        let scale = 1f64.to_degrees() * 16.0;
        for (packet, seen) in packets.iter().zip(&seen) {
            let newest = Rate::hz(gyro).ticks_before(SimTime::ZERO, SimTime(packet.due.0 + 1)) - 1;
            let expected = (Rate::hz(gyro).tick(newest).0 / 1_000_000) as f64 * 1e-3 * scale;
            assert!((f64::from(seen.gyro[0]) - expected).abs() <= 0.5);
        }
        let plan = plan(&format!("duration = \"1 s\"\n[gyro]\nrate = \"{gyro} Hz\"\n"));
        let warnings = warnings(Protocol::Msp, &plan.sensors);
        assert_eq!(warnings.len(), usize::from(gyro > 100), "{warnings:?}");
        assert!(warnings.iter().all(|warning| warning.contains("a rate of 100 Hz fits")), "{warnings:?}");
        let (_, packets_per_s) = load(Protocol::Msp, &setup(&plan, None));
        assert!((packets_per_s - f64::from(rate)).abs() <= 0.1, "{packets_per_s}");
    }
}

/// Gyro, accel and mag of a frame of an Inertial Labs unit, read by the unit's own description of it.
fn unit(packet: &Packet) -> [[f64; 3]; 3] {
    let mut seen = ratetable_protocols::ilabs::data::Repr::default();
    ratetable_protocols::ilabs::Decoder::new().feed(packet.bytes(), |received| seen = received.unwrap());
    let frd = |[right, forward, up]: [f64; 3], count: f64| [forward, right, -up].map(|x| x * count);
    [
        frd(seen.gyro.unwrap().map(f64::from), 1e-5_f64.to_radians()),
        frd(seen.accel.unwrap().map(f64::from), 9.8106e-6),
        frd(seen.mag.unwrap().map(f64::from), 0.01),
    ]
}

#[test]
fn the_last_packet_is_that_of_a_vehicle_that_has_stopped() {
    let text = "[start]\nattitude = \"[30, 10, 90] deg\"\n[[motion]]\nkind = \"rotate\"\n\
                angular_rate = \"[400, 0, 0] deg/s\"\nduration = \"1 s\"\n[[force]]\nstart = \"0 s\"\n\
                duration = \"1 s\"\nacceleration = \"[20, 0, 0] m/s^2\"\n";
    let plan: Plan = plan(&format!("{text}{EXACT}"));
    let end = SimTime(NANOS);
    for protocol in [Protocol::Msp, Protocol::Vectornav, Protocol::Mip, Protocol::Ilabs] {
        let mut encoder = encoder(protocol, &setup(&plan, None));
        let mut packets = Vec::new();
        encoder.farewell(end, &mut packets);
        assert!(packets.is_empty(), "who has not been played to keeps what they have");
        let mut last = at_rest(SimTime::ZERO);
        let _: Result<(), ()> = Player::new(&plan, plan.duration, 64).play(|moment| {
            last = *moment.truth;
            encoder
                .encode(&Now { t: moment.t, truth: moment.truth, readings: moment.readings }, &mut packets);
            Ok(())
        });
        packets.clear();
        encoder.farewell(end, &mut packets);
        let [packet] = &packets[..] else { panic!("one packet") };
        assert_eq!((packet.due, packet.carries), (end, Kinds::NONE));
        let up = last.attitude.inverse().apply(Vector::new(0.0, 0.0, -STANDARD_GRAVITY)).v.to_array();
        let field = last.field.v.to_array();
        let ([gyro, accel, mag], tolerance) = match protocol {
            Protocol::Msp => {
                let seen = simulated(&packets)[0];
                let frd = |[x, y, z]: [i16; 3], unit: f64| [x, -y, -z].map(|count| f64::from(count) * unit);
                let values = [
                    frd(seen.gyro, 1.0),
                    frd(seen.accel, 1e-3 * STANDARD_GRAVITY),
                    frd(seen.mag, last.field.length() / 20480.0),
                ];
                (values, 5e-3)
            }
            Protocol::Vectornav => {
                let seen = outputs(&packets).0[0];
                ([seen.gyro, seen.accel, seen.mag.map(|x| 100.0 * x)].map(|v| v.map(f64::from)), 1e-4)
            }
            Protocol::Ilabs => (unit(&packets[0]), 1e-2),
            _ => {
                let seen = inertial(&packets)[0];
                let accel = seen.accel.unwrap().map(|x| x * STANDARD_GRAVITY as f32);
                let mag = seen.mag.unwrap().map(|x| 100.0 * x);
                ([seen.gyro.unwrap(), accel, mag].map(|v| v.map(f64::from)), 1e-4)
            }
        };
        assert_eq!(gyro, [0.0; 3]);
        let close = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < tolerance);
        assert!(close(accel, up), "{protocol:?} {accel:?} {up:?}");
        assert!(close(mag, field), "{protocol:?} {mag:?} {field:?}");
    }
}
