//! What a stand-in makes of false words: an attitude of somebody else's changes nothing, wrong readings everything.

use ratetable_firmware_host_tests::quaternion::{from_euler, mul};
use ratetable_firmware_host_tests::standin::Make;
use ratetable_protocols::mavlink::{self, Header, Message, Version, hil_state_quaternion};
use ratetable_protocols::{ilabs, msp, sbg, vectornav};

use super::doctor::{Vectors, doctor, encoded, simulator};
use super::follow::BOUND_DEG;
use super::memory::{CASES, Case, converse, exact_deg, judge, own, settings};

type Stream = Vec<(u64, Vec<u8>)>;
type Lie = fn(Stream) -> Stream;
type Wrong = fn(&mut Vectors);

/// The AHRS packets of a stream with an attitude a quarter turn off.
fn lying_vectornav(stream: Stream) -> Stream {
    let lie = |packet: Vec<u8>| {
        let mut told = None;
        vectornav::Decoder::new().feed(&packet, |received| told = received.ok());
        let Some(vectornav::Packet::Ahrs(mut ahrs)) = told else { return packet };
        let [yaw, pitch, roll] = ahrs.yaw_pitch_roll;
        ahrs.yaw_pitch_roll = [yaw + 90.0, pitch, roll + 90.0];
        let [x, y, z, w] = ahrs.xyzw.map(f64::from);
        let [w, x, y, z] = mul(from_euler(1.6, 0.0, 1.6), [w, x, y, z]);
        ahrs.xyzw = [x, y, z, w].map(|c| c as f32);
        encoded(&vectornav::Packet::Ahrs(ahrs))
    };
    stream.into_iter().map(|(at, packet)| (at, lie(packet))).collect()
}

/// Navigation packets of a stream with an attitude and a position far off, tracked or not.
fn lying_navigation(stream: Stream) -> Stream {
    let lie = |packet: Vec<u8>| {
        let mut told = None;
        vectornav::Decoder::new().feed(&packet, |received| told = received.ok());
        let Some(vectornav::Packet::Navigation(mut it)) = told else { return packet };
        it.xyzw = [0.5; 4];
        it.acceleration = [9.0, -9.0, 9.0];
        (it.status, it.position, it.velocity) = (2, [10.0, 20.0, 3000.0], [50.0; 3]);
        encoded(&vectornav::Packet::Navigation(it))
    };
    stream.into_iter().map(|(at, packet)| (at, lie(packet))).collect()
}

/// The frames of a stream with an attitude far off.
fn lying_ilabs(stream: Stream) -> Stream {
    let lie = |packet: Vec<u8>| {
        let mut told = None;
        ilabs::Decoder::new().feed(&packet, |received| told = received.ok());
        let Some(mut frame) = told else { return packet };
        frame.attitude = Some(ilabs::data::Angles { yaw: 12_345, pitch: -6000, roll: 17_000 });
        let mut bytes = [0; ilabs::MAX_LEN];
        let len = ilabs::encode(&frame, &mut bytes).unwrap();
        bytes[..len].to_vec()
    };
    stream.into_iter().map(|(at, packet)| (at, lie(packet))).collect()
}

/// The QUAT packets of a stream with an attitude far off.
fn lying_sbg(stream: Stream) -> Stream {
    let lie = |packet: Vec<u8>| {
        let mut told = None;
        sbg::Decoder::new()
            .feed(&packet, |received| told = received.ok().and_then(|received| received.packet));
        let Some(sbg::Packet::Quat(quat)) = told else { return packet };
        let mut bytes = [0; sbg::MAX_LEN];
        let lie = sbg::quat::Repr { wxyz: [0.5; 4], status: 0x32, ..quat };
        let len = sbg::encode(&sbg::Packet::Quat(lie), &mut bytes).unwrap();
        bytes[..len].to_vec()
    };
    stream.into_iter().map(|(at, packet)| (at, lie(packet))).collect()
}

/// A stream with a false state told beside every fifth packet.
fn lying_mavlink(stream: Stream) -> Stream {
    let mut with = Vec::new();
    for (k, (at, packet)) in stream.into_iter().enumerate() {
        with.push((at, packet));
        if k % 5 == 0 {
            let state = hil_state_quaternion::Repr { q: [0.5; 4], ..Default::default() };
            let header = Header { version: Version::V2, seq: (k / 5) as u8, system: 1, component: 77 };
            let mut bytes = [0; mavlink::MAX_LEN];
            let len = mavlink::encode(&header, &Message::HilStateQuaternion(state), &mut bytes).unwrap();
            with.push((at, bytes[..len].to_vec()));
        }
    }
    with
}

/// Simulator messages with an attitude far off, with these flags.
fn lying_msp(stream: Stream, flags: u8) -> Stream {
    let lie = |packet: &[u8]| {
        simulator(packet, |message| {
            message.attitude = [900, 300, 1800];
            message.flags = flags;
        })
    };
    stream.into_iter().map(|(at, packet)| (at, lie(&packet).unwrap_or(packet))).collect()
}

const FLAGS: u8 =
    msp::simulator::ENABLE | msp::simulator::BATTERY | msp::simulator::MUTE | msp::simulator::OWN_ESTIMATE;

#[test]
fn a_false_attitude_beside_the_samples_changes_no_estimate() {
    let lies: [(Make, Lie); 8] = [
        (Make::Px4Vectornav, lying_navigation),
        (Make::ArdupilotSbg, lying_sbg),
        (Make::Ardupilot, lying_vectornav),
        (Make::ArdupilotIlabs, lying_ilabs),
        (Make::Px4Ilabs, lying_ilabs),
        (Make::Px4, lying_mavlink),
        (Make::Px4Sitl, lying_mavlink),
        (Make::Inav, |stream| lying_msp(stream, FLAGS)),
    ];
    for (make, lie) in lies {
        let case = Case::of(make);
        let plan = ratetable::scene::Plan::load("level-then-turn", &set("duration=16 s", case)).unwrap();
        let settings = settings(case, &plan);
        let honest = converse(case, &plan, &settings, |stream, _| stream);
        let lied_to = converse(case, &plan, &settings, |stream, _| lie(stream));
        let foreign = lied_to.record.counts.foreign;
        assert!(
            foreign > 500 && foreign >= honest.record.counts.foreign,
            "{make}: it was lied to, {foreign} times"
        );
        assert!(honest.record.history.len() > 1000);
        assert_eq!(honest.record.history, lied_to.record.history, "{make}");
    }
}

/// The scene's settings of a case and one more.
fn set(more: &str, case: &Case) -> Vec<String> {
    case.sets.iter().copied().chain([more]).map(str::to_owned).collect()
}

#[test]
fn inav_believes_the_simulators_attitude_if_it_is_told_to() {
    let case = Case::of(Make::Inav);
    let plan = ratetable::scene::Plan::load("level-then-turn", &set("duration=2 s", case)).unwrap();
    let without = FLAGS & !msp::simulator::OWN_ESTIMATE;
    let told = converse(case, &plan, &settings(case, &plan), |stream, _| lying_msp(stream, without));
    let (rms, _) = exact_deg(&plan, &told.record, told.scene_us);
    assert!(rms > 90.0, "{rms}");
}

/// One thing wrong with the readings of every packet.
const WRONG: [(&str, Wrong); 7] = [
    ("x and y of all swapped", |vectors| vectors.iter_mut().for_each(|v| v.swap(0, 1))),
    ("x and z of the gyro swapped", |[gyro, ..]| gyro.swap(0, 2)),
    ("gyro z the other way round", |[gyro, ..]| gyro[2] = -gyro[2]),
    ("accel y the other way round", |[_, accel, _]| accel[1] = -accel[1]),
    ("mag x the other way round", |[.., mag]| mag[0] = -mag[0]),
    ("gyro in degrees", |[gyro, ..]| *gyro = gyro.map(f64::to_degrees)),
    ("gyro 5 % too great", |[gyro, ..]| *gyro = gyro.map(|w| w * 1.05)),
];

#[test]
fn wrong_readings_do_not_pass() {
    for case in &CASES {
        // As far as the end of the turn to the right.
        let plan = ratetable::scene::Plan::load("level-then-turn", &set("duration=30 s", case)).unwrap();
        for (what, wrong) in WRONG {
            let told = converse(case, &plan, &settings(case, &plan), |stream, _| {
                let all = stream.into_iter();
                all.map(|(at, packet)| (at, doctor(case.make, &packet, &mut |v| wrong(v)))).collect()
            });
            let figures = judge(&plan, &own(&told.record, told.scene_us));
            assert!(
                figures.errors.rms_deg > BOUND_DEG,
                "{}, {what}: {} deg",
                case.make,
                figures.errors.rms_deg
            );
        }
    }
}

/// A checksum begun from another seed differs by a constant in all packets of a length.
#[test]
fn packets_with_another_checksum_seed_are_all_refused() {
    for case in &CASES {
        let plan = ratetable::scene::Plan::load("level-then-turn", &set("duration=1 s", case)).unwrap();
        let told = converse(case, &plan, &settings(case, &plan), |stream, _| {
            let reseeded = stream.into_iter().map(|(at, mut packet)| {
                // Of sbgECom the last byte is no checksum.
                let last = packet.len() - if case.make == Make::ArdupilotSbg { 2 } else { 1 };
                packet[last] ^= 0x5a;
                (at, packet)
            });
            reseeded.collect()
        });
        let counts = told.record.counts;
        assert_eq!((counts.samples, told.record.history.len()), (0, 0), "{}: {counts}", case.make);
        assert!(counts.damaged > 0);
    }
}
