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
use ratetable_protocols::vectornav::{ahrs, imu as vn_imu, inertial as vn_inertial, navigation};
use ratetable_protocols::{mip, vectornav as vn};

/// Three error-free sensors at 100 Hz.
const EXACT: &str = "[gyro]\nrate = \"100 Hz\"\n[accel]\nrate = \"100 Hz\"\n[mag]\nrate = \"100 Hz\"\n";
/// A scene in which each packet has one new sample of each sensor, and nothing repeats.
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
            other => panic!("{other:?}"),
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

/// The fields after the header, version, flags and 30 bytes of zeros of a simulator message, which it checks.
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
        // For any declination and strength, and in either axes.
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

/// Negative control: a mistake in the axes, sign, unit or declination of a reading changes the bytes.
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

/// Simulator messages with a fix, each with the packet's samples of the receiver.
fn fixes(scene: &str) -> Vec<(simulator::Repr, bool, u64)> {
    let (packets, _) = play(&plan(scene), Protocol::Msp, None);
    let seen = simulated(&packets);
    let gps = SensorKind::Gps;
    let each = seen.into_iter().zip(&packets);
    each.map(|(seen, packet)| (seen, packet.carries.contains(gps), packet.samples(gps as usize))).collect()
}

/// At 59.93° N 30.31° W, 123.45 m up, going west at 15 m/s and a little down, with 9 satellites in view.
const FLYING: &str = "duration = \"1 s\"\n[start]\nattitude = \"[0, 0, -90] deg\"\nvelocity = \"[0, -15, 0.25] m/s\"\n\
    [earth]\nlatitude = \"59.93 deg\"\nlongitude = \"-30.31 deg\"\naltitude = \"123.45 m\"\ngravity = \"9.80665 m/s^2\"\nfield = \"[25, 0, 43.30127018922193] uT\"\n\
    [gyro]\nrate = \"100 Hz\"\n[accel]\nrate = \"100 Hz\"\n[mag]\nrate = \"100 Hz\"\n\
    [gps]\nrate = \"5 Hz\"\nsatellites = 9\n";

/// Its first message, made by Python's struct from the layout alone.
const FIXED: &str = "24583c001f203600021f0209a097b823a00fefed39300000dc058c0a000024fa190000000000000000000000e803000000000000cd8b0100000000d8b8ba03";

#[test]
fn msp_says_a_fix_as_inav_reads_it() {
    let (packets, _) = play(&plan(FLYING), Protocol::Msp, None);
    assert_eq!(hex(packets[0].bytes()), FIXED);
    // Negative control: each thing said otherwise makes other bytes.
    for (said, other) in [
        ("59.93 deg", "59.9300001 deg"),
        ("-30.31 deg", "30.31 deg"),
        ("123.45 m", "123.46 m"),
        ("[0, -15, 0.25]", "[0, 15, 0.25]"),
        ("[0, -15, 0.25]", "[0, -15, -0.25]"),
        ("[0, -15, 0.25]", "[-15, 0, 0.25]"),
        ("satellites = 9", "satellites = 10"),
    ] {
        let (packets, _) = play(&plan(&FLYING.replace(said, other)), Protocol::Msp, None);
        assert_ne!(hex(packets[0].bytes()), FIXED, "{other}");
    }
}

#[test]
fn a_fix_is_new_in_one_message_and_held_in_the_others() {
    let all = fixes(FLYING);
    assert_eq!(all.len(), 100);
    for (k, (seen, carries, samples)) in all.iter().enumerate() {
        let is_new = k % 20 == 0;
        assert_eq!(
            (seen.flags & simulator::NEW_POSITION != 0, *carries, *samples),
            (is_new, is_new, is_new.into())
        );
        assert_eq!((seen.fix, seen.satellites, seen.ground_speed, seen.course), (2, 9, 1500, 2700), "{k}");
    }
    // Slower and out of step with the messages: a fix waits for the next one and is never said before its time.
    let scene = FLYING.replace("rate = \"100 Hz\"", "rate = \"40 Hz\"").replace("5 Hz", "7 Hz");
    let plan_of = plan(&scene);
    let mut fix = None;
    let (packets, readings) = play(&plan_of, Protocol::Msp, None);
    for (packet, seen) in packets.iter().zip(simulated(&packets)) {
        let newest = readings.iter().rev().find(|(t, it)| *t <= packet.due && it.kind == SensorKind::Gps);
        let longitude = newest.unwrap().1.position().unwrap().fix.position.longitude.to_degrees();
        assert_eq!(seen.longitude, libm::round(longitude * 1e7) as i32, "{}", packet.due);
        let is_new = fix.replace(seen.longitude) != Some(seen.longitude);
        assert_eq!(seen.flags & simulator::NEW_POSITION != 0, is_new, "{}", packet.due);
    }
    // Without a receiver nothing is said of a position.
    let none = fixes(&FLYING[..FLYING.find("[gps]").unwrap()]);
    assert!(none.iter().all(|(seen, carries, _)| !carries
        && seen.flags & simulator::NEW_POSITION == 0
        && (seen.fix, seen.satellites, seen.latitude, seen.velocity) == (0, 0, 0, [0; 3])));
}

/// Level, facing north, in air that comes from ahead at an indicated 15 m/s: its first message, made by Python's struct.
const AIRED: &str = "24583c001f203a0002ef00000000000000000000000000000000000000000000000000000000000000000000e803000000000000cd8b010000280000b8ba7edc050099";

/// The airspeed (m/s) of each message, and whether the packet has a sample of the pitot tube.
fn airspeeds(scene: &str) -> Vec<(Option<f64>, bool)> {
    let (packets, _) = play(&plan(scene), Protocol::Msp, None);
    let mut all = Vec::new();
    let mut decoder = msp::Decoder::new();
    for packet in &packets {
        let carries = packet.carries.contains(SensorKind::Airspeed);
        decoder.feed(packet.bytes(), |received| match received.unwrap().message {
            Some(Message::SimulatorAir(seen)) => {
                assert_eq!(
                    (seen.readings.flags & 0xe0, seen.tail.voltage, seen.tail.more_flags),
                    (0xe0, 126, 0)
                );
                all.push((Some(f64::from(seen.tail.airspeed) / 100.0), carries));
            }
            Some(Message::Simulator(seen)) => {
                assert_eq!(seen.flags & 0xe0, 0);
                all.push((None, carries));
            }
            other => panic!("{other:?}"),
        });
    }
    all
}

#[test]
fn msp_says_an_airspeed_as_inavs_plugin_does() {
    let with = |speed: &str, rate: &str| {
        format!(
            "duration = \"1 s\"\n[start]\nvelocity = \"[{speed}, 0, 0] m/s\"\n{EXACT}[airspeed]\nrate = \"{rate}\"\n"
        )
    };
    let (packets, _) = play(&plan(&with("15", "20 Hz")), Protocol::Msp, None);
    assert_eq!(hex(packets[0].bytes()), AIRED);
    for (speed, expected) in [("15", 15.0), ("0", 0.0), ("31.07", 31.07), ("-15", 0.0), ("900", 655.35)] {
        let all = airspeeds(&with(speed, "20 Hz"));
        assert_eq!(all.len(), 100);
        for (k, (airspeed, carries)) in all.into_iter().enumerate() {
            assert_eq!((airspeed, carries), (Some(expected), k % 5 == 0), "{speed} {k}");
        }
    }
    assert_eq!(airspeeds(&format!("duration = \"1 s\"\n{EXACT}")), [(None, false); 100]);
}

#[test]
fn what_listens_to_msp_finds_fixes_and_the_pitot_tubes_pressure() {
    let scene = format!("{FLYING}[airspeed]\nrate = \"20 Hz\"\n").replace("[0, -15, 0.25]", "[0, -20, 0]");
    let (packets, readings) = play(&plan(&scene), Protocol::Msp, None);
    let mut samples = samples::Samples::new(Protocol::Msp);
    let (mut fixes, mut pressures) = (0, Vec::new());
    for packet in &packets {
        samples.feed(packet.bytes(), |sample| match sample.kind {
            SensorKind::Gps => fixes += u32::from(sample.value.is_none()),
            SensorKind::Airspeed => pressures.push(sample.value.unwrap().pressure().unwrap()),
            _ => {}
        });
    }
    assert_eq!((fixes, pressures.len(), samples.counts().damaged), (5, 100, 0));
    let sent = readings
        .iter()
        .find_map(|(_, it)| (it.kind == SensorKind::Airspeed).then(|| it.pressure().unwrap().value));
    // Half a centimetre a second of some twenty metres a second.
    assert!(
        pressures.iter().all(|seen| (seen / sent.unwrap() - 1.0).abs() < 2.0 * 0.005 / 19.0),
        "{pressures:?}"
    );
}

#[test]
fn the_last_message_stands_where_it_is() {
    let plan = plan(FLYING);
    let mut encoder = encoder(Protocol::Msp, &setup(&plan, None));
    let mut packets = Vec::new();
    let _: Result<(), ()> = Player::new(&plan, plan.duration, 64).play(|moment| {
        encoder.encode(&Now { t: moment.t, truth: moment.truth, readings: moment.readings }, &mut packets);
        Ok(())
    });
    let before = *simulated(&packets).last().unwrap();
    packets.clear();
    encoder.farewell(&at_rest(plan.duration), &mut packets);
    let last = simulated(&packets)[0];
    assert_eq!(
        (last.latitude, last.longitude, last.altitude),
        (before.latitude, before.longitude, before.altitude)
    );
    assert_eq!((last.velocity, last.ground_speed), ([0; 3], 0));
    assert!(last.flags & simulator::NEW_POSITION != 0);
}

/// Bytes of a golden packet with the pressure of a scene without a barometer.
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

/// Packets, with when they are due.
type Due<T> = Vec<(SimTime, T)>;

/// PX4's two outputs.
fn px4_outputs(packets: &[Packet]) -> (Due<vn_inertial::Repr>, Due<navigation::Repr>) {
    let (mut first, mut second) = (Vec::new(), Vec::new());
    let mut decoder = vn::Decoder::new();
    for packet in packets {
        decoder.feed(packet.bytes(), |received| match received.unwrap() {
            vn::Packet::Inertial(seen) => first.push((packet.due, seen)),
            vn::Packet::Navigation(seen) => second.push((packet.due, seen)),
            other => panic!("{other:?}"),
        });
    }
    (first, second)
}

/// PX4 that asked for its samples at this rate.
fn px4(rate: u32) -> Peer {
    let controller = Some(Controller::Px4Vectornav);
    Peer { rate: Some(Rate::hz(rate)), second: Some(Rate::hz(100)), controller, ..Peer::default() }
}

fn played_to(plan: &Plan, peer: Peer) -> Vec<Packet> {
    let mut encoder = encoder(Protocol::Vectornav, &Setup { peer, ..setup(plan, None) });
    let mut packets = Vec::new();
    let _: Result<(), ()> = Player::new(plan, plan.duration, 64).play(|moment| {
        encoder.encode(&Now { t: moment.t, truth: moment.truth, readings: moment.readings }, &mut packets);
        Ok(())
    });
    packets
}

/// The inertial packet that PX4's driver was given when it was measured.
const INERTIAL: &str = "fa060100000600f4f04606000000ef0e5eba4ea1b13c7dbc1cc1184260bebe1f3939f2e05cb8d5bc";

#[test]
fn vectornav_sends_px4_the_golden_bytes_of_its_first_output() {
    let plan = plan(&format!("duration = \"60 s\"\n{}", EXACT.replace("100 Hz", "1 Hz")));
    let mut encoder = encoder(Protocol::Vectornav, &Setup { peer: px4(200), ..setup(&plan, None) });
    let values =
        [[-0.219_002_13, 0.000_176_548, -5.266_158_4e-5], [-0.000_847_085_3, 0.021_683_361, -9.796_018], MAG];
    let readings = [0, 1, 2].map(|i| {
        let [x, y, z] = values[i];
        Reading::zero(i, SensorKind::ALL[i]).with_body(Vector::new(x, y, z))
    });
    let mut packets = Vec::new();
    for t in [0, 26_960_000_000].map(SimTime) {
        encoder.encode(&Now { t, truth: &at_rest(t), readings: &readings }, &mut packets);
    }
    let inertial: Vec<_> = packets.iter().filter(|packet| packet.bytes()[1] == 0x06).collect();
    let last = inertial.last().unwrap();
    assert_eq!((hex(last.bytes()).as_str(), last.due), (INERTIAL, SimTime(26_960_000_000)));
    let carries = Kinds::of(&[SensorKind::Gyro, SensorKind::Accel]);
    assert_eq!(last.carries, carries);
}

#[test]
fn px4s_outputs_come_evenly_at_their_own_rates_and_between_them_carry_every_sample() {
    for (rate, asked) in [("250 Hz", 200), ("250 Hz", 800), ("200 Hz", 200), ("1 kHz", 400)] {
        let scene = TOGETHER.replacen("100 Hz", rate, 2);
        let scene = format!("{scene}[baro]\nrate = \"25 Hz\"\n");
        let plan = plan(&scene);
        let packets = played_to(&plan, px4(asked));
        assert!(packets.windows(2).all(|pair| pair[0].due <= pair[1].due), "{rate}");
        let (first, second) = px4_outputs(&packets);
        let last = plan.sensors[0].rate.ticks_before(SimTime::ZERO, plan.duration) - 1;
        let last = plan.sensors[0].rate.tick(last);
        for (times, hz) in [
            (first.iter().map(|(due, seen)| (*due, seen.time_ns)).collect::<Vec<_>>(), asked),
            (second.iter().map(|(due, seen)| (*due, seen.time_ns)).collect(), 100),
        ] {
            let expected = Rate::hz(hz).ticks_before(SimTime::ZERO, SimTime(last.0 + 1));
            assert_eq!(times.len() as u64, expected, "{rate} {hz}");
            for (k, (due, time_ns)) in times.into_iter().enumerate() {
                assert_eq!((due, time_ns), (Rate::hz(hz).tick(k as u64), due.0 as u64), "{rate} {hz} {k}");
            }
        }
        for packet in &packets {
            let is_first = packet.bytes().len() == 40;
            let other = [SensorKind::Mag, SensorKind::Gyro][usize::from(!is_first)];
            assert!(!packet.carries.contains(other) && packet.replaced[other as usize] == 0);
        }
        let carried = |kind: SensorKind| -> u64 { packets.iter().map(|it| it.samples(kind as usize)).sum() };
        // A mag tick at 100 Hz has a navigation packet of its own; the gyro's own ticks end with an inertial packet or
        // wait for one.
        assert_eq!(carried(SensorKind::Mag), 250 - u64::from(last < SimTime(2_490_000_000)), "{rate}");
        assert!(
            carried(SensorKind::Gyro) + 5 >= plan.sensors[0].rate.ticks_before(SimTime::ZERO, plan.duration)
        );
    }
}

#[test]
fn px4s_second_output_holds_readings_truth_and_nothing_of_a_position() {
    let scene = TOGETHER.replace("100 Hz", "200 Hz");
    let force = "[[force]]\nstart = \"0 s\"\nduration = \"2 s\"\nacceleration = \"[2, -3, 4] m/s^2\"\nframe = \"nav\"\n";
    let plan = plan(&format!("{scene}{force}[baro]\nrate = \"200 Hz\"\n"));
    let (packets, readings) = play(&plan, Protocol::Vectornav, None);
    drop(packets);
    let (_, second) = px4_outputs(&played_to(&plan, px4(200)));
    assert!(second.len() > 240);
    for (due, seen) in second {
        let truth = plan.trajectory.at(due);
        let [x, y, z, w] = seen.xyzw.map(f64::from);
        let q = glam::DQuat::from_xyzw(x, y, z, w).normalize();
        assert!(truth.attitude.angle_to(Attitude::from_quat(q)) < 1e-6, "{due}");
        let pushed = due < SimTime(2 * NANOS);
        let expected = if pushed { [2.0, -3.0, 4.0] } else { [0.0; 3] };
        for (seen, expected) in seen.acceleration.into_iter().zip(expected) {
            assert!((f64::from(seen) - expected).abs() < 1e-5, "{due}");
        }
        let read = |kind| readings.iter().find(|(t, reading)| *t == due && reading.kind == kind).unwrap().1;
        let mag = read(SensorKind::Mag).body().unwrap().value.v.to_array();
        assert_eq!(seen.mag, mag.map(|x| (x / 100.0) as f32));
        let pressure = read(SensorKind::Baro).pressure().unwrap().value;
        assert_eq!(seen.pressure, (pressure / 1000.0) as f32);
        assert_eq!(
            (seen.status, seen.position, seen.velocity, seen.position_uncertainty, seen.velocity_uncertainty),
            (0, [0.0; 3], [0.0; 3], 0.0, 0.0)
        );
    }
}

#[test]
fn a_controller_that_asks_for_another_rate_gets_it_from_the_next_packet_on() {
    let plan = plan(&TOGETHER.replace("100 Hz", "1 kHz"));
    let ardupilot = |rate| Peer {
        rate: Some(Rate::hz(rate)),
        second: Some(Rate::hz(50)),
        controller: Some(Controller::Ardupilot),
        ..Peer::default()
    };
    for (before, after) in [(ardupilot(100), ardupilot(200)), (px4(200), px4(50)), (ardupilot(100), px4(400))]
    {
        let mut encoder = encoder(Protocol::Vectornav, &Setup { peer: before, ..setup(&plan, None) });
        let (mut packets, mut seam) = (Vec::new(), 0);
        let asked = SimTime(1_003_000_000);
        let _: Result<(), ()> = Player::new(&plan, plan.duration, 64).play(|moment| {
            if moment.t == asked {
                encoder.follow(&after, asked);
                seam = packets.len();
            }
            encoder
                .encode(&Now { t: moment.t, truth: moment.truth, readings: moment.readings }, &mut packets);
            Ok(())
        });
        let times = |packets: &[Packet], len: usize| -> Vec<i64> {
            packets.iter().filter(|packet| packet.bytes().len() == len).map(|packet| packet.due.0).collect()
        };
        let first = |peer: &Peer| if peer.controller == Some(Controller::Ardupilot) { 82 } else { 40 };
        let old = times(&packets[..seam], first(&before));
        let new = times(&packets[seam..], first(&after));
        let periods = [before, after].map(|peer| peer.rate.unwrap().tick(1).0);
        assert!(old.windows(2).all(|pair| pair[1] - pair[0] == periods[0]));
        assert!(new.windows(2).all(|pair| pair[1] - pair[0] == periods[1]));
        let gap = new[0] - old[old.len() - 1];
        assert!(new[0] >= asked.0 && gap % periods[1] == 0 && gap < periods[0] + periods[1], "{gap}");
        assert_eq!(
            times(&packets[seam..], if first(&after) == 82 { 40 } else { 82 }),
            [0; 0],
            "nobody else's"
        );
        // Asked for again, it changes nothing.
        let mut again = Vec::new();
        encoder.follow(&after, plan.duration);
        encoder.farewell(&at_rest(plan.duration), &mut again);
        assert_eq!(again[0].bytes().len(), first(&after));
    }
}

/// A ramp of the gyro's x whose value tells the millisecond of a sample.
fn ramp(protocol: Protocol, gyro: Rate, peer: Peer) -> Vec<Packet> {
    ramp_with(Options::default(), protocol, gyro, peer)
}

fn ramp_with(options: Options, protocol: Protocol, gyro: Rate, peer: Peer) -> Vec<Packet> {
    let plan = plan(&format!("duration = \"9 s\"\n{}", EXACT.replacen("100 Hz", &format!("{gyro}"), 1)));
    let mut encoder = encoder(protocol, &Setup { peer, options, ..setup(&plan, None) });
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

/// The integral of what is sent is that of what was sampled: nothing of a turn is lost between packets.
#[test]
fn packets_for_a_controller_carry_the_mean_of_the_samples_since_the_one_before() {
    let target = Options { controller: Some(Controller::Ardupilot), ..Options::default() };
    let asked = Options { thin: Some(Thin::Mean), ..Options::default() };
    let last = Options { thin: Some(Thin::Last), ..target };
    for (options, gyro, asked, means) in [
        (target, 1000, 100, true),
        (asked, 333, 100, true),
        (target, 50, 200, true),
        (last, 1000, 100, false),
    ] {
        let (gyro, asked) = (Rate::hz(gyro), Rate::hz(asked));
        let peer = Peer { rate: Some(asked), ..Peer::default() };
        let packets = ramp_with(options, Protocol::Vectornav, gyro, peer);
        let (imus, _) = outputs(&packets);
        let (mut next, mut sent, mut sampled) = (0, 0.0, 0.0);
        for (packet, imu) in packets.iter().zip(&imus) {
            let until = gyro.ticks_before(SimTime::ZERO, SimTime(packet.due.0 + 1));
            let samples = (next..until).map(|k| (gyro.tick(k).0 / 1_000_000) as f64 * 1e-3);
            let (count, sum) = ((until - next) as f64, samples.sum::<f64>());
            assert_eq!(u64::from(packet.replaced[0]), (until - next).saturating_sub(1));
            assert_eq!(packet.merges, means && packet.replaced[0] > 0);
            sent += f64::from(imu.gyro[0]) * count;
            sampled += sum;
            next = until;
        }
        let off = (sent - sampled).abs() / sampled;
        assert_eq!(off < 1e-6, means || asked.as_hz() > gyro.as_hz(), "{gyro} {asked}: {off}");
    }
    // A barometer's too, and 2.5 samples a packet are 2 and 3 in turn.
    let mut newest = Newest::new(&target);
    let mut press = |pascals: f64| {
        let mut reading = Reading::zero(0, SensorKind::Baro);
        reading.measurement = crate::sensor::Measurement::Pressure(crate::sensor::Measured {
            value: pascals,
            truth: 0.0,
            bias: 0.0,
        });
        newest.take_in(&[reading]);
        newest.told.pressure(SensorKind::Baro).unwrap()
    };
    assert_eq!([press(100.0), press(200.0), press(600.0)], [100.0, 150.0, 300.0]);
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
        let warnings = warnings(Protocol::Msp, &Options::default(), &plan.sensors);
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
        encoder.farewell(&at_rest(end), &mut packets);
        assert!(packets.is_empty(), "who has not been played to keeps what they have");
        let mut last = at_rest(SimTime::ZERO);
        let _: Result<(), ()> = Player::new(&plan, plan.duration, 64).play(|moment| {
            last = *moment.truth;
            encoder
                .encode(&Now { t: moment.t, truth: moment.truth, readings: moment.readings }, &mut packets);
            Ok(())
        });
        packets.clear();
        // Half-way: what was made is ahead of what was sent.
        let sent = Truth { t: end, ..plan.trajectory.at(SimTime(NANOS / 2)) };
        assert!(last.attitude.angle_to(sent.attitude) > 1.0, "the scene's end is another attitude");
        last = sent;
        encoder.farewell(&sent, &mut packets);
        let (packet, leaves) = packets.split_first().expect("a packet");
        assert_eq!(leaves.len(), usize::from(protocol == Protocol::Msp), "and INAV is told to leave");
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
