//! The encoders' output, read back by the decoders that a firmware uses.

use super::*;
use crate::earth::Place;
use crate::earth::STANDARD_GRAVITY;
use crate::player::Player;
use crate::scene::Plan;
use crate::schedule::{Schedule, Ticks};
use crate::sensor::Mount;
use crate::sensor::{Fix, Kinds, Measurement, SensorKind};
use crate::time::NANOS;
use crate::time::Rate;
use proptest::prelude::*;
use ratetable_protocols::mavlink::{self, Message, hil_sensor};
use ratetable_protocols::mpu::{self, config, registers};

const GYRO_ACCEL: Kinds = Kinds::of(&[SensorKind::Gyro, SensorKind::Accel]);

pub(super) fn plan(text: &str) -> Plan {
    Plan::parse(text, "s", "s", &[]).unwrap_or_else(|error| panic!("{error}"))
}

pub(super) fn setup(plan: &Plan, layout: Option<Layout>) -> Setup<'_> {
    Setup {
        sensors: &plan.sensors,
        axes: plan.axes,
        day: plan.day,
        options: Options { layout, ..Options::default() },
        peer: Peer::default(),
    }
}

/// Every packet of a plan, and every reading with its time.
pub(super) fn play(
    plan: &Plan,
    protocol: Protocol,
    layout: Option<Layout>,
) -> (Vec<Packet>, Vec<(SimTime, Reading)>) {
    let mut encoder = encoder(protocol, &setup(plan, layout));
    let (mut packets, mut readings) = (Vec::new(), Vec::new());
    let played: Result<(), ()> = Player::new(plan, plan.duration, 256).play(|moment| {
        encoder.encode(&Now { t: moment.t, truth: moment.truth, readings: moment.readings }, &mut packets);
        readings.extend(moment.readings.iter().map(|reading| (moment.t, *reading)));
        Ok(())
    });
    played.unwrap();
    assert!(packets.windows(2).all(|pair| pair[0].due <= pair[1].due), "due times never go back");
    (packets, readings)
}

/// The `mpu` packets as a driver sees them, each with the packet that was sent.
fn driven(packets: &[Packet]) -> Vec<(&Packet, mpu::Packet)> {
    let mut decoder = mpu::Decoder::new();
    let mut all = Vec::new();
    for (i, packet) in packets.iter().enumerate() {
        let mut found = Vec::new();
        decoder.feed(packet.bytes(), |received| found.push(received.unwrap()));
        let [received] = found[..] else { panic!("one packet a packet: {found:?}") };
        assert_eq!(received.seq, i as u8, "`seq` counts every packet");
        assert_eq!(i64::from(received.t_us), packet.due.0 / 1000);
        all.push((packet, received.packet));
    }
    all
}

fn of(readings: &[(SimTime, Reading)], kind: SensorKind) -> Vec<&(SimTime, Reading)> {
    readings.iter().filter(|(_, reading)| reading.kind == kind).collect()
}

/// Compares counts on the chip's axes, z up, with the reading: within half a count.
fn counts_match(counts: [i16; 3], reading: &Reading, count: f64) {
    let chip = Mount::flu().to_chip(reading.body().unwrap().value).v.to_array();
    for (raw, value) in counts.iter().zip(chip) {
        assert!(
            (f64::from(*raw) * count - value).abs() <= 0.5 * count * (1.0 + 1e-9),
            "{counts:?} of {chip:?}"
        );
    }
}

pub(super) const GYRO_COUNT: f64 = std::f64::consts::PI / 180.0 / 16.4;
pub(super) const ACCEL_COUNT: f64 = STANDARD_GRAVITY / 2048.0;

pub(super) const NOISY: &str = r#"
seed = 2
[[motion]]
kind = "rotate"
angular_rate = "[200, -300, 400] deg/s"
duration = "2.5 s"
[gyro]
rate = "200 Hz"
noise_std = "1 deg/s"
[accel]
rate = "200 Hz"
noise_std = "1 m/s^2"
[mag]
rate = "50 Hz"
noise_std = "1 uT"
"#;

#[test]
fn mpu_packs_gyro_and_accel_together_when_they_tick_alike() {
    let (packets, readings) = play(&plan(NOISY), Protocol::Mpu, None);
    let (gyro, accel, mag) =
        (of(&readings, SensorKind::Gyro), of(&readings, SensorKind::Accel), of(&readings, SensorKind::Mag));
    let (mut imus, mut mags, mut configs) = (0, 0, Vec::new());
    for (packet, seen) in driven(&packets) {
        match seen {
            mpu::Packet::Imu(imu) => {
                assert_eq!((packet.due, packet.carries), (gyro[imus].0, GYRO_ACCEL));
                counts_match(imu.gyro, &gyro[imus].1, GYRO_COUNT);
                counts_match(imu.accel, &accel[imus].1, ACCEL_COUNT);
                assert_eq!(imu.temperature, 1335, "(25 °C − 21 °C)·333.87");
                imus += 1;
            }
            mpu::Packet::Mag(field) => {
                assert_eq!((packet.due, packet.carries), (mag[mags].0, SensorKind::Mag.into()));
                // The AK8963 inside sees y, x and −z of the MPU.
                let [x, y, z] = field.field;
                counts_match([y, x, -z], &mag[mags].1, 0.15);
                assert_eq!((field.st1, field.st2), (registers::ST1_DATA_READY, registers::ST2_16_BIT));
                mags += 1;
            }
            mpu::Packet::Config(config) => {
                configs.push(packet.due.0 / NANOS);
                assert_eq!(packet.carries, Kinds::NONE);
                let expected = config::Repr {
                    who_am_i: registers::WHO_MPU9250,
                    smplrt_div: 4,
                    config: 1,
                    gyro_config: 0x18,
                    accel_config: 0x18,
                    mag_who: registers::WHO_AK8963,
                    cntl1: 0x16,
                    asa: [128; 3],
                };
                assert_eq!(config, expected);
            }
            other => panic!("{other:?} has no place here"),
        }
    }
    assert_eq!((imus, mags, configs), (500, 125, vec![0, 1, 2]));
    let first = driven(&packets)[0].1;
    assert!(matches!(first, mpu::Packet::Config(_)), "the scales come before what they scale");
}

#[test]
fn the_registers_of_an_mpu_say_the_rate_and_the_filter_of_the_scene() {
    let config = |scene: &str| {
        let (packets, _) = play(&plan(scene), Protocol::Mpu, None);
        match driven(&packets)[0].1 {
            mpu::Packet::Config(config) => (config.config, config.smplrt_div, config.who_am_i),
            other => panic!("{other:?} comes first"),
        }
    };
    for (part, rate, filter, expected) in [
        ("MPU-9250", "1 kHz", "", (1, 0)),
        ("MPU-9250", "1 kHz", "DLPF 2", (2, 0)),
        ("MPU-9250", "200 Hz", "DLPF 6", (6, 4)),
        ("MPU-9250", "8 kHz", "DLPF 0", (0, 0)),
        ("MPU-9250", "100 Hz", "30 Hz", (3, 9)),
        ("MPU-6050", "1 kHz", "DLPF 0", (0, 7)),
        ("MPU-6050", "8 kHz", "DLPF 0", (0, 0)),
        ("MPU-6050", "2 kHz", "", (0, 3)),
        ("MPU-6050", "50 Hz", "DLPF 5", (5, 19)),
        ("MPU-6050", "4 Hz", "DLPF 0", (1, 249)),
    ] {
        let filter = if filter.is_empty() { String::new() } else { format!("filter = \"{filter}\"\n") };
        let scene = format!("duration = \"0.5 s\"\n[gyro]\npart = \"{part}\"\nrate = \"{rate}\"\n{filter}");
        let (low_pass, divider, who) = config(&scene);
        assert_eq!((low_pass, divider), expected, "{part} {rate} {filter}");
        let chip = registers::Chip::from_who_am_i(who).unwrap();
        let hz = plan(&scene).sensors[0].rate.as_hz();
        assert!((chip.sample_rate_hz(low_pass, divider) / hz - 1.0).abs() < 1e-12, "{part} {rate} {filter}");
        assert_eq!(config(&plan(&scene).resolved), (low_pass, divider, who), "as resolved");
    }
}

#[test]
fn mpu_sends_gyro_and_accel_apart_when_their_rates_differ_or_it_is_asked_to() {
    let scenes = [(NOISY.replacen("200 Hz", "250 Hz", 1), None), (NOISY.to_string(), Some(Layout::Separate))];
    for (scene, layout) in scenes {
        let (packets, readings) = play(&plan(&scene), Protocol::Mpu, layout);
        let (gyro, accel) = (of(&readings, SensorKind::Gyro), of(&readings, SensorKind::Accel));
        let (mut gyros, mut accels) = (0, 0);
        for (packet, seen) in driven(&packets) {
            match seen {
                mpu::Packet::Gyro(seen) => {
                    assert_eq!((packet.due, packet.carries), (gyro[gyros].0, SensorKind::Gyro.into()));
                    counts_match(seen.gyro, &gyro[gyros].1, GYRO_COUNT);
                    gyros += 1;
                }
                mpu::Packet::Accel(seen) => {
                    assert_eq!((packet.due, packet.carries), (accel[accels].0, SensorKind::Accel.into()));
                    counts_match(seen.accel, &accel[accels].1, ACCEL_COUNT);
                    accels += 1;
                }
                mpu::Packet::Mag(_) | mpu::Packet::Config(_) => {}
                other => panic!("{other:?} has no place here"),
            }
        }
        assert_eq!((gyros, accels), (gyro.len(), accel.len()));
    }
}

#[test]
fn a_burst_goes_out_at_the_faster_rate_and_holds_the_slower_sensor() {
    for (scene, faster) in [
        (NOISY.replacen("200 Hz", "1 kHz", 1), SensorKind::Gyro),
        (NOISY.replace("200 Hz\"\nnoise_std = \"1 m", "800 Hz\"\nnoise_std = \"1 m"), SensorKind::Accel),
    ] {
        let (packets, readings) = play(&plan(&scene), Protocol::Mpu, Some(Layout::Burst));
        let newest = |kind, t| {
            of(&readings, kind)
                .iter()
                .rfind(|(due, _)| *due <= t)
                .map(|(due, reading)| (*due, *reading))
                .unwrap()
        };
        let mut imus = 0;
        for (packet, seen) in driven(&packets) {
            let mpu::Packet::Imu(imu) = seen else { continue };
            let (gyro, accel) = (newest(SensorKind::Gyro, packet.due), newest(SensorKind::Accel, packet.due));
            counts_match(imu.gyro, &gyro.1, GYRO_COUNT);
            counts_match(imu.accel, &accel.1, ACCEL_COUNT);
            let fresh = [(SensorKind::Gyro, gyro.0), (SensorKind::Accel, accel.0)];
            let fresh: Kinds =
                fresh.into_iter().filter(|(_, t)| *t == packet.due).map(|(kind, _)| kind).collect();
            assert_eq!(packet.carries, fresh, "a held sample is not carried a second time");
            imus += 1;
        }
        assert_eq!(imus, of(&readings, faster).len());
    }
}

#[test]
fn mpu_counts_saturate_and_the_magnetometer_says_that_it_overflowed() {
    let scene = r#"
        axes = "enu-flu"
        [earth]
        field = "[0, 4000, -950] uT"
        [[motion]]
        kind = "rotate"
        angular_rate = "[2100, -2100, 100] deg/s"
        duration = "1 ms"
        [[force]]
        duration = "1 s"
        acceleration = "[0, 170, -190] m/s^2"
        [gyro]
        rate = "1 kHz"
        [accel]
        rate = "1 kHz"
        [mag]
        rate = "100 Hz"
    "#;
    let (packets, _) = play(&plan(scene), Protocol::Mpu, None);
    let seen = driven(&packets);
    let mpu::Packet::Imu(imu) = seen[1].1 else { panic!() };
    assert_eq!(imu.gyro, [32767, -32768, 1640]);
    assert_eq!((imu.accel[0], imu.accel[1]), (0, 32767));
    assert_eq!(imu.accel[2], -32768, "9.8 − 190 is beyond −16 g");
    let mpu::Packet::Mag(mag) = seen[2].1 else { panic!() };
    assert_eq!(mag.st2 & registers::ST2_OVERFLOW, registers::ST2_OVERFLOW, "4000 + 950 is above 4912");
    let (packets, _) = play(&plan(&scene.replace("950", "850")), Protocol::Mpu, None);
    let mpu::Packet::Mag(mag) = driven(&packets)[2].1 else { panic!() };
    assert_eq!(mag.st2 & registers::ST2_OVERFLOW, 0, "4000 + 850 is not");
}

#[test]
fn mpu_scales_and_chip_follow_the_scene() {
    let configured = |gyro: &str, accel: &str| {
        let scene = format!(
            "duration = \"1 ms\"\n[gyro]\nrate = \"1 kHz\"\n{gyro}\n[accel]\nrate = \"1 kHz\"\n{accel}\n"
        );
        let (packets, _) = play(&plan(&scene), Protocol::Mpu, None);
        let (mpu::Packet::Config(config), mpu::Packet::Imu(imu)) =
            (driven(&packets)[0].1, driven(&packets)[1].1)
        else {
            panic!()
        };
        (config, imu)
    };
    for (gyro, bits) in [
        ("", 3),
        ("range = \"250 deg/s\"", 0),
        ("range = \"500 deg/s\"", 1),
        ("range = \"1000 deg/s\"", 2),
        ("range = \"2000 deg/s\"", 3),
        ("range = \"300 deg/s\"", 1),
        ("range = \"9000 deg/s\"", 3),
        ("part = \"MPU-9250\"\nrange = \"500 deg/s\"", 1),
        ("resolution = \"131 LSB/(deg/s)\"", 0),
    ] {
        assert_eq!(configured(gyro, "").0.gyro_config, bits << 3, "{gyro}");
    }
    for (accel, bits) in
        [("range = \"2 g\"", 0), ("range = \"4 g\"", 1), ("part = \"MPU-6050\"", 3), ("range = \"3 g\"", 1)]
    {
        assert_eq!(configured("", accel).0.accel_config, bits << 3, "{accel}");
    }
    let (config, imu) = configured("part = \"MPU-6000\"", "part = \"MPU-6050\"");
    assert_eq!((config.who_am_i, config.mag_who, config.cntl1), (registers::WHO_MPU60X0, 0, 0));
    assert_eq!(imu.temperature, -3920, "(25 °C − 36.53 °C)·340");
    let two_g = configured("", "range = \"2 g\"\nmount = \"frd\"").1;
    assert_eq!(two_g.accel, [0, 0, -16384], "−1 g on a z that points down");
    assert_eq!(
        configured("", "range = \"2 g\"").1.accel,
        [0, 0, 16384],
        "+1 g on one that points up, by default"
    );
}

/// The messages of `mavlink` packets, each with the packet that was sent.
pub(super) fn flown(packets: &[Packet]) -> Vec<(&Packet, Message)> {
    let mut decoder = mavlink::Decoder::new();
    let mut all = Vec::new();
    for (i, packet) in packets.iter().enumerate() {
        let mut found = Vec::new();
        decoder.feed(packet.bytes(), |received| found.push(received.unwrap()));
        let [received] = found[..] else { panic!("one message a packet: {found:?}") };
        assert_eq!(received.header.seq, i as u8);
        all.push((packet, received.message.unwrap()));
    }
    all
}

#[test]
fn mavlink_carries_the_newest_of_each_sensor_with_a_bit_for_each_that_ticked() {
    let scene = NOISY.replacen("200 Hz", "100 Hz", 1).replace("50 Hz", "400/3 Hz");
    let (packets, readings) = play(&plan(&scene), Protocol::Mavlink, None);
    let newest = |kind, t| {
        of(&readings, kind).iter().rfind(|(due, _)| *due <= t).map(|(_, reading)| *reading).unwrap()
    };
    let (mut last, mut count, mut replaced) = (SimTime(-1), 0, [0; 3]);
    for (packet, message) in flown(&packets) {
        let Message::HilSensor(seen) = message else { continue };
        assert_eq!(seen.time_usec as i64, packet.due.0 / 1000);
        let mut mask = 0;
        for (kind, bits, values, unit) in [
            (SensorKind::Gyro, hil_sensor::GYRO, seen.gyro, 1.0),
            (SensorKind::Accel, hil_sensor::ACCEL, seen.accel, 1.0),
            (SensorKind::Mag, hil_sensor::MAG, seen.mag, 100.0),
        ] {
            let ticks = readings
                .iter()
                .filter(|(t, reading)| reading.kind == kind && *t > last && *t <= packet.due)
                .count();
            mask |= if ticks > 0 { bits } else { 0 };
            assert_eq!(packet.carries.contains(kind), ticks > 0);
            assert_eq!(packet.replaced[kind as usize] as usize, ticks.saturating_sub(1));
            replaced[kind as usize] += packet.replaced[kind as usize];
            let expected =
                newest(kind, packet.due).body().unwrap().value.v.to_array().map(|x| (x / unit) as f32);
            assert_eq!(values, expected, "{kind} in Forward-Right-Down, the field in gauss");
        }
        assert_eq!(seen.fields_updated, mask);
        (last, count) = (packet.due, count + 1);
    }
    assert_eq!(count, 250, "one at each tick of the gyro");
    assert!(
        replaced[1] > 200 && replaced[2] > 50 && replaced[0] == 0,
        "accel and mag are faster: {replaced:?}"
    );
    let warnings = warnings(Protocol::Mavlink, &Options::default(), &plan(&scene).sensors);
    assert!(warnings.len() == 2 && warnings[0].contains("accel (200 Hz)"), "{warnings:?}");
}

#[test]
fn px4_in_lockstep_gets_no_more_packets_than_it_keeps_up_with_and_their_means() {
    for (hz, every) in [(100, 1), (250, 1), (333, 2), (500, 2), (1000, 4)] {
        let plan = plan(&format!("duration = \"2 s\"\n[gyro]\nrate = \"{hz} Hz\"\n"));
        for (controller, every) in [(Controller::Px4Sitl, every), (Controller::Px4, 1)] {
            let options = Options { controller: Some(controller), ..Options::default() };
            let mut encoder = encoder(Protocol::Mavlink, &Setup { options, ..setup(&plan, None) });
            let (mut packets, mut k) = (Vec::new(), 0.0);
            let played: Result<(), ()> = Player::new(&plan, plan.duration, 64).play(|moment| {
                let readings: Vec<_> =
                    moment.readings.iter().map(|it| it.with_body(Vector::new(k, 0.0, 0.0))).collect();
                encoder.encode(&Now { t: moment.t, truth: moment.truth, readings: &readings }, &mut packets);
                k += 1.0;
                Ok(())
            });
            played.unwrap();
            let sensed: Vec<_> = flown(&packets)
                .into_iter()
                .filter_map(|(_, message)| match message {
                    Message::HilSensor(seen) => Some(f64::from(seen.gyro[0])),
                    _ => None,
                })
                .collect();
            assert_eq!(sensed.len(), (2 * hz as usize).div_ceil(every), "{hz} Hz");
            // The first goes out at once; each after it is the mean of `every` samples.
            let mean = |i: usize| if i == 0 { 0.0 } else { (i * every) as f64 - (every - 1) as f64 / 2.0 };
            assert!(
                sensed.iter().enumerate().all(|(i, x)| (x - mean(i)).abs() < 1e-3),
                "{hz} Hz: {sensed:?}"
            );
        }
    }
}

#[test]
fn mavlink_sends_its_heartbeat_and_the_scenes_clock_once_a_second() {
    for (earth, start) in [("", None), ("[earth]\ndate = \"2026-11-22\"\n", Some(1_795_305_600_000_000))] {
        let scene = format!("duration = \"3.5 s\"\n{earth}[gyro]\nrate = \"10 Hz\"\n");
        let (packets, _) = play(&plan(&scene), Protocol::Mavlink, None);
        let (mut beats, mut clocks) = (Vec::new(), Vec::new());
        for (packet, message) in flown(&packets) {
            match message {
                Message::Heartbeat(_) => beats.push(packet.due.0 / NANOS),
                Message::SystemTime(clock) => {
                    let us = packet.due.0 as u64 / 1000;
                    assert_eq!(clock.time_unix_usec, start.map_or(0, |start| start + us));
                    assert_eq!(u64::from(clock.time_boot_ms), us / 1000);
                    clocks.push(packet.due.0 / NANOS);
                }
                _ => {}
            }
        }
        assert_eq!((beats, clocks), (vec![0, 1, 2, 3], vec![0, 1, 2, 3]));
    }
}

#[test]
fn mavlink_without_a_gyro_goes_by_the_sensor_it_has() {
    let (packets, _) = play(&plan("duration = \"1 s\"\n[mag]\nrate = \"10 Hz\"\n"), Protocol::Mavlink, None);
    let hil = flown(&packets).into_iter().filter_map(|(_, message)| match message {
        Message::HilSensor(hil) => Some(hil.fields_updated),
        _ => None,
    });
    assert_eq!(hil.collect::<Vec<_>>(), [hil_sensor::MAG; 10]);
}

#[test]
fn a_slow_scene_still_has_every_second() {
    let (packets, _) = play(&plan("duration = \"7 s\"\n[mag]\nrate = \"0.2 Hz\"\n"), Protocol::Mpu, None);
    let configs = driven(&packets).into_iter().filter(|(_, seen)| matches!(seen, mpu::Packet::Config(_)));
    assert_eq!(configs.map(|(packet, _)| packet.due.0 / NANOS).collect::<Vec<_>>(), [0, 1, 2, 3, 4, 5]);
}

#[test]
fn text_reads_back_to_the_same_bits_in_the_scenes_axes() {
    for axes in [Axes::NedFrd, Axes::EnuFlu] {
        let plan = plan(&format!("axes = \"{axes}\"\n{NOISY}"));
        let (csv, readings) = play(&plan, Protocol::Csv, None);
        let (jsonl, _) = play(&plan, Protocol::Jsonl, None);
        assert_eq!(csv[0].bytes(), b"t_ns,sensor,x,y,z\n");
        assert_eq!((csv.len() - 1, jsonl.len()), (readings.len(), readings.len()));
        for (((t, reading), csv), json) in readings.iter().zip(&csv[1..]).zip(&jsonl) {
            let bits = axes.body_out(reading.body().unwrap().value).to_array().map(f64::to_bits);
            let line = std::str::from_utf8(csv.bytes()).unwrap().strip_suffix('\n').unwrap();
            let cells: Vec<_> = line.split(',').collect();
            assert_eq!((cells[0], cells[1]), (t.0.to_string().as_str(), reading.kind.name()));
            assert_eq!([2, 3, 4].map(|i| cells[i].parse::<f64>().unwrap().to_bits()), bits);
            let object: serde_json::Value = serde_json::from_slice(json.bytes()).unwrap();
            assert_eq!(
                (object["t_ns"].as_i64(), object["sensor"].as_str()),
                (Some(t.0), Some(reading.kind.name()))
            );
            // Compare the text itself: the library that we also use could misread its own output.
            let text = std::str::from_utf8(json.bytes()).unwrap();
            let number = |key: &str| {
                text.split_once(key).unwrap().1.split([',', '}']).next().unwrap().parse::<f64>().unwrap()
            };
            assert!(["x", "y", "z"].iter().all(|key| object[*key].is_number()));
            assert_eq!(["\"x\":", "\"y\":", "\"z\":"].map(|key| number(key).to_bits()), bits);
            assert_eq!((csv.due, csv.carries, json.carries), (*t, reading.kind.into(), reading.kind.into()));
        }
    }
}

#[test]
fn the_load_is_what_is_sent() {
    let plan = plan(&NOISY.replace("2.5 s", "10 s"));
    for protocol in Protocol::STREAMS {
        let (packets, _) = play(&plan, protocol, None);
        let bytes = packets.iter().map(|packet| packet.bytes().len()).sum::<usize>() as f64;
        let (bytes_per_s, packets_per_s) = load(protocol, &setup(&plan, None));
        assert_eq!(packets_per_s, packets.len() as f64 / 10.0, "{protocol:?}");
        // Numbers in text differ in length; those of the others do not.
        let slack = if matches!(protocol, Protocol::Csv | Protocol::Jsonl) { 0.2 } else { 0.0 };
        let ratio = bytes_per_s / (bytes / 10.0);
        assert!((1.0..=1.0 + slack).contains(&ratio), "{protocol:?}: {ratio}");
    }
}

#[test]
fn protocols_have_names_and_a_burst_needs_both_sensors() {
    for protocol in Protocol::STREAMS {
        assert_eq!(Protocol::from_name(protocol.name()), Some(protocol));
        assert!(!protocol.about().is_empty());
    }
    let gyro = plan("duration = \"1 s\"\n[gyro]\nrate = \"1 Hz\"\n");
    let burst = Options { layout: Some(Layout::Burst), ..Options::default() };
    assert!(check(Protocol::Mpu, &burst, &gyro.sensors).unwrap_err().contains("[accel]"));
    assert!(check(Protocol::Mpu, &burst, &plan(NOISY).sensors).is_ok());
    assert!(check(Protocol::Mpu, &Options::default(), &gyro.sensors).is_ok());
}

/// A sensor's ticks, if it exists.
fn any_ticks() -> impl Strategy<Value = Option<(u64, u64, i64)>> {
    prop_oneof![1 => Just(None), 3 => (1..400u64, 1..7u64, 0..300_000_000i64).prop_map(Some)]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, ..ProptestConfig::default() })]

    #[test]
    fn every_sample_is_carried_once_or_counted_as_replaced(
        ticks in [any_ticks(), any_ticks(), any_ticks(), any_ticks(), any_ticks()],
        protocol in prop::sample::select(Protocol::STREAMS.to_vec()),
        layout in prop::sample::select(vec![None, Some(Layout::Separate), Some(Layout::Burst)]),
    ) {
        let sensor = |(kind, ticks): (SensorKind, Option<(u64, u64, i64)>)| ticks.map(|(top, bottom, phase)| SensorPlan {
            kind,
            rate: Rate::new(top, bottom).unwrap(),
            phase: SimTime(phase),
            sampling: Default::default(),
            mount: None,
            part: None,
            address: None,
            values: Default::default(),
            faults: Vec::new(),
            settings: Vec::new(),
            epoch: 0,
        });
        let sensors: Vec<_> = SensorKind::ALL.into_iter().zip(ticks).filter_map(sensor).collect();
        let options = Options { layout, ..Options::default() };
        prop_assume!(check(protocol, &options, &sensors).is_ok());
        let setup = Setup { sensors: &sensors, axes: Axes::NedFrd, day: None, options, peer: Peer::default() };
        let mut encoder = encoder(protocol, &setup);
        let (mut packets, mut made) = (Vec::new(), ByKind::<u64>::default());
        let end = SimTime(3 * NANOS);
        let due = Schedule::new(sensors.iter().map(|sensor| Ticks { rate: sensor.rate, phase: sensor.phase }), end);
        let (mut carried, mut replaced, mut seen) = (ByKind::<u64>::default(), ByKind::<u64>::default(), 0);
        for due in due {
            let ticked = sensors.iter().enumerate().filter(|(i, _)| due.sensors >> i & 1 == 1);
            let readings: Vec<_> = ticked.map(|(i, sensor)| Reading::zero(i, sensor.kind)).collect();
            let taken = readings.iter().filter(|reading| protocol.carries(reading.kind));
            taken.for_each(|reading| made[reading.kind as usize] += 1);
            encoder.encode(&Now { t: due.t, truth: &at_rest(due.t), readings: &readings }, &mut packets);
            for packet in &packets[seen..] {
                for (kind, (carried, replaced)) in carried.iter_mut().zip(&mut replaced).enumerate() {
                    *carried += u64::from(packet.carries.contains(SensorKind::ALL[kind]));
                    *replaced += u64::from(packet.replaced[kind]);
                }
            }
            seen = packets.len();
            let waiting = encoder.waiting();
            let accounted: ByKind<u64> = std::array::from_fn(|kind| carried[kind] + replaced[kind] + waiting[kind]);
            prop_assert_eq!(made, accounted, "{:?} at {}", protocol, due.t);
        }
        prop_assert!(packets.windows(2).all(|pair| pair[0].due <= pair[1].due));
        prop_assert!(packets.iter().all(|packet| !packet.bytes().is_empty() && packet.bytes().len() < MAX_PACKET));
    }
}

/// T = 25 + 20·(1 − e^(−t/τ)), in counts of an MPU-9250 and in °C.
#[test]
fn packets_report_the_temperature_of_a_part_that_warms_up() {
    let warm = "temperature = { rise = \"20 K\", time_constant = \"1 s\" }";
    let scene =
        format!("duration = \"2 s\"\n[gyro]\nrate = \"100 Hz\"\n{warm}\n[accel]\nrate = \"100 Hz\"\n");
    let degrees = |packet: &Packet| 45.0 - 20.0 * (-packet.due.seconds()).exp();
    let mut told = 0;
    for (packet, seen) in driven(&play(&plan(&scene), Protocol::Mpu, None).0) {
        if let mpu::Packet::Imu(imu) = seen {
            assert_eq!(f64::from(imu.temperature), ((degrees(packet) - 21.0) * 333.87).round());
            told += 1;
        }
    }
    for (packet, seen) in flown(&play(&plan(&scene), Protocol::Mavlink, None).0) {
        if let Message::HilSensor(sensor) = seen {
            assert!((f64::from(sensor.temperature) - degrees(packet)).abs() < 1e-5);
            assert_eq!(sensor.fields_updated & hil_sensor::TEMPERATURE, hil_sensor::TEMPERATURE);
            told += 1;
        }
    }
    assert_eq!(told, 400);
}

/// A climbing vehicle with every sensor.
const AIDED: &str = "seed = 5\nduration = \"3 s\"\n[earth]\nlatitude = \"59.93 deg\"\nlongitude = \"30.31 deg\"\naltitude = \"120 m\"\ndate = \"2026-11-22\"\n[start]\nvelocity = \"[10, 0, -5] m/s\"\n[gyro]\nrate = \"100 Hz\"\nnoise_std = \"1 deg/s\"\n[accel]\nrate = \"100 Hz\"\n[baro]\nrate = \"25 Hz\"\nnoise_std = \"3 Pa\"\ntemperature = \"31 degC\"\n[gps]\nrate = \"5 Hz\"\nnoise_std = \"1 m\"\n";

#[test]
fn mavlink_has_the_pressure_with_its_bits_where_the_barometer_ticked() {
    let untold = AIDED.replace("temperature = \"31 degC\"\n", "");
    for (scene, degrees) in [(AIDED, 31.0), (&untold, 25.0)] {
        let (packets, readings) = play(&plan(scene), Protocol::Mavlink, None);
        let baro = of(&readings, SensorKind::Baro);
        let mut ticked = 0;
        for (packet, message) in flown(&packets) {
            let Message::HilSensor(seen) = message else { continue };
            let ticks = baro.iter().any(|(t, _)| *t == packet.due);
            let (_, newest) = baro.iter().rfind(|(t, _)| *t <= packet.due).unwrap();
            let pascals = newest.pressure().unwrap().value;
            assert_eq!(seen.abs_pressure, (pascals / 100.0) as f32);
            assert_eq!(seen.pressure_alt, crate::earth::pressure_altitude(pascals) as f32);
            assert_eq!(seen.temperature, degrees);
            let told = if degrees == 31.0 { hil_sensor::TEMPERATURE } else { 0 };
            let expected = if ticks { 0x1A00 } else { told };
            assert_eq!(seen.fields_updated & 0x1E00, expected, "{}", packet.due);
            assert_eq!(packet.carries.contains(SensorKind::Baro), ticks);
            ticked += u32::from(ticks);
        }
        assert_eq!(ticked, 75);
    }
}

/// 20 m/s at sea level is 2.45 hPa.
#[test]
fn mavlink_has_the_differential_pressure_with_its_bit_where_the_pitot_tube_ticked() {
    let scene = "duration = \"1 s\"\n[start]\nvelocity = \"[20, 0, 0] m/s\"\n[gyro]\nrate = \"100 Hz\"\n[airspeed]\nrate = \"20 Hz\"\n";
    let (packets, _) = play(&plan(scene), Protocol::Mavlink, None);
    let mut ticked = 0;
    for (packet, message) in flown(&packets) {
        let Message::HilSensor(seen) = message else { continue };
        assert!((seen.diff_pressure - 2.45).abs() < 1e-4, "{}", seen.diff_pressure);
        let ticks = packet.carries.contains(SensorKind::Airspeed);
        assert_eq!(seen.fields_updated & 0x400 != 0, ticks);
        ticked += u32::from(ticks);
    }
    assert_eq!(ticked, 20);
}

#[test]
fn what_a_protocol_has_no_place_for_is_said_and_not_sent() {
    let aided = plan(AIDED);
    let said = |protocol| warnings(protocol, &Options::default(), &aided.sensors);
    let mpu = said(Protocol::Mpu);
    assert!(mpu.len() == 2 && mpu[0].contains("no place for baro") && mpu[1].contains("gps"), "{mpu:?}");
    let vectornav = said(Protocol::Vectornav);
    assert!(vectornav.len() == 1 && vectornav[0].contains("no place for gps"), "{vectornav:?}");
    assert!(
        said(Protocol::Msp).is_empty()
            && said(Protocol::Mavlink).is_empty()
            && said(Protocol::Csv).is_empty()
            && said(Protocol::Jsonl).is_empty()
    );
    let bare = AIDED.split("[baro]").next().unwrap();
    let bytes = |scene: &str| -> Vec<u8> {
        let (packets, _) = play(&plan(scene), Protocol::Mpu, None);
        packets.iter().flat_map(|packet| packet.bytes().to_vec()).collect()
    };
    assert!(bytes(AIDED) == bytes(bare), "an added sensor leaves the stream as it was");
}

#[test]
fn a_line_of_text_has_what_the_aid_says() {
    let (packets, readings) = play(&plan(AIDED), Protocol::Csv, None);
    let text = |packet: &Packet| String::from_utf8(packet.bytes().to_vec()).unwrap();
    assert_eq!(text(&packets[0]), "t_ns,sensor,x,y,z,vn,ve,vd\n");
    let sent = packets[1..].iter().map(text).zip(&readings);
    let mut seen = 0;
    for (line, (t, reading)) in sent {
        let cells: Vec<&str> = line.trim_end_matches('\n').split(',').collect();
        assert_eq!((cells[0].parse(), cells[1]), (Ok(t.0), reading.kind.name()));
        match reading.kind {
            SensorKind::Baro => {
                assert_eq!(cells[2].parse(), Ok(reading.pressure().unwrap().value));
                assert_eq!(cells[3..], ["", ""]);
            }
            SensorKind::Gps => {
                let fix = reading.position().unwrap().fix;
                assert_eq!(cells[2].parse(), Ok(fix.position.latitude.to_degrees()));
                assert_eq!(cells[3].parse(), Ok(fix.position.longitude.to_degrees()));
                assert_eq!(cells[4].parse(), Ok(fix.position.altitude));
                assert_eq!(
                    [cells[5], cells[6], cells[7]].map(|cell| cell.parse::<f64>().unwrap()),
                    [10.0, 0.0, -5.0]
                );
            }
            _ => continue,
        }
        seen += 1;
    }
    assert_eq!(seen, 75 + 15);
    // The longest numbers still fit a packet.
    let longest = f64::from_bits(0x800f_ffff_ffff_fffe);
    let place = Place {
        latitude: -1.234_567_890_123_456_7e-100,
        longitude: -1.234_567_890_123_456_7e-100,
        altitude: longest,
    };
    let velocity = Vector::new(longest, longest, longest);
    let mut reading = Reading::zero(0, SensorKind::Gps);
    if let Measurement::Position(position) = &mut reading.measurement {
        position.fix = Fix { position: place, velocity };
    }
    let plan = plan("duration = \"1 s\"\n[gps]\n");
    let mut lines = Vec::new();
    encoder(Protocol::Jsonl, &setup(&plan, None)).encode(
        &Now { t: SimTime(i64::MAX), truth: &at_rest(SimTime::ZERO), readings: &[reading] },
        &mut lines,
    );
    assert!(lines[0].bytes().ends_with(b"}\n"), "{}", text(&lines[0]));
}
