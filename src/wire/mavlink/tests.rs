//! Optional messages, and their sender.

use super::*;
use crate::earth::STANDARD_GRAVITY;
use crate::geometry::Attitude;
use crate::player::{Moment, Player};
use crate::scene::Plan;
use crate::wire::dialogue::Peer;
use crate::wire::tests::{ACCEL_COUNT, GYRO_COUNT, NOISY, flown, plan, setup};
use crate::wire::{Controller, Options, Protocol, check};

/// Every packet of a plan for `mavlink` with these options and a controller with that system id.
fn play(plan: &Plan, options: Options, system: Option<u8>) -> Vec<Packet> {
    let peer = Peer { system, ..Peer::default() };
    let mut encoder = Mavlink::new(&Setup { options, peer, ..setup(plan, None) });
    let mut packets = Vec::new();
    let played: Result<(), ()> =
        Player::new(plan, plan.duration, 256).play(|Moment { t, truth, readings }| {
            encoder.encode(&Now { t, truth, readings }, &mut packets);
            Ok(())
        });
    played.unwrap();
    packets
}

#[test]
fn mavlink_speaks_as_the_system_it_found_in_the_version_it_was_asked_for() {
    let plan = plan(NOISY);
    for (system, version) in [(None, Version::V2), (Some(7), Version::V1)] {
        let options = Options { version, ..Options::default() };
        let packets = play(&plan, options, system);
        let mut decoder = mavlink::Decoder::new();
        let mut sensors = 0;
        for packet in &packets {
            decoder.feed(packet.bytes(), |received| {
                let mavlink::Received { header, message, .. } = received.unwrap();
                assert_eq!(
                    (header.version, header.system, header.component),
                    (version, system.unwrap_or(1), 51)
                );
                sensors += usize::from(matches!(message, Some(Message::HilSensor(_))));
            });
            // HIL_SENSOR of MAVLink 1 is never truncated, and has no extension field.
            if version == Version::V1 && !packet.carries.is_empty() {
                assert_eq!(packet.bytes().len(), 6 + 64 + 2);
            }
        }
        assert_eq!(sensors, 500, "the same messages in both");
    }
}

#[test]
fn mavlink_sends_what_it_is_asked_for_fifty_times_a_second() {
    let plan = plan(NOISY);
    let extras = Extra::ALL.into_iter().fold(Extras::default(), Extras::with);
    let packets = play(&plan, Options { extras, ..Options::default() }, None);
    let plain = play(&plan, Options::default(), None);
    let mut count = std::collections::BTreeMap::new();
    let mut newest = None;
    for (packet, message) in flown(&packets) {
        *count.entry(message.name()).or_insert(0) += 1;
        let truth = plan.trajectory.at(packet.due);
        let (ms, us) = (packet.due.0 / 1_000_000, packet.due.0 / 1000);
        let attitude = |[w, x, y, z]: [f32; 4]| {
            let [w, x, y, z] = [w, x, y, z].map(f64::from);
            Attitude::from_quat(glam::DQuat::from_xyzw(x, y, z, w).normalize())
        };
        match message {
            Message::HilSensor(sensor) => newest = Some(sensor),
            Message::HilStateQuaternion(state) => {
                assert_eq!((state.time_usec as i64, packet.carries), (us, Kinds::NONE));
                assert!(attitude(state.q).angle_to(truth.attitude) < 1e-6);
                let mg = truth.force.v.to_array().map(|x| x / (1e-3 * STANDARD_GRAVITY));
                assert!(
                    state.accel.iter().zip(mg).all(|(seen, mg)| (f64::from(*seen) - mg).abs() <= 0.5 + 1e-9)
                );
            }
            Message::AttitudeQuaternion(told) => {
                assert_eq!(i64::from(told.time_boot_ms), ms);
                assert!(attitude(told.q).angle_to(truth.attitude) < 1e-6);
                let rate = truth.rate.v.to_array().map(|x| x as f32);
                assert_eq!(told.angular_rate, rate);
            }
            Message::HighresImu(told) => {
                let sensor = newest.unwrap();
                assert_eq!((told.gyro, told.accel, told.mag), (sensor.gyro, sensor.accel, sensor.mag));
                assert_eq!(told.fields_updated, 0x1FF, "all tick at 50 Hz and more");
            }
            Message::RawImu(told) => {
                let (sensor, counts) = (newest.unwrap(), [GYRO_COUNT, ACCEL_COUNT, 0.15 / 100.0]);
                for (raw, (value, count)) in [
                    (told.gyro, (sensor.gyro, counts[0])),
                    (told.accel, (sensor.accel, counts[1])),
                    (told.mag, (sensor.mag, counts[2])),
                ] {
                    for (raw, value) in raw.into_iter().zip(value) {
                        assert!((f64::from(raw) * count - f64::from(value)).abs() <= 0.5001 * count);
                    }
                }
            }
            Message::ScaledImu2(told) => {
                let sensor = newest.unwrap();
                for (milli, (value, unit)) in [
                    (told.gyro, (sensor.gyro, 1.0)),
                    (told.accel, (sensor.accel, STANDARD_GRAVITY)),
                    (told.mag, (sensor.mag, 1.0)),
                ] {
                    for (milli, value) in milli.into_iter().zip(value) {
                        assert!((f64::from(milli) * 1e-3 * unit - f64::from(value)).abs() <= 0.501e-3 * unit);
                    }
                }
            }
            _ => {}
        }
    }
    let samples = |packets: &[Packet]| packets.iter().filter(|packet| !packet.carries.is_empty()).count();
    assert_eq!(samples(&packets), samples(&plain), "what repeats a sample carries none");
    for extra in Extra::ALL {
        assert_eq!(count[extra.name().to_lowercase().as_str()], 125, "{}", extra.name());
        assert_eq!(Extra::from_name(extra.name()), Some(extra));
        let alone =
            play(&plan, Options { extras: Extras::default().with(extra), ..Options::default() }, None);
        assert_eq!(alone.len(), plain.len() + 125);
    }
}

#[test]
fn px4_is_not_told_the_truth() {
    let sensors = plan(NOISY).sensors;
    for controller in [None, Some(Controller::Px4), Some(Controller::Px4Sitl), Some(Controller::Ardupilot)] {
        for extra in Extra::ALL {
            let options = Options { controller, extras: Extras::default().with(extra), ..Options::default() };
            let px4 = matches!(controller, Some(Controller::Px4 | Controller::Px4Sitl));
            let refused = check(Protocol::Mavlink, &options, &sensors);
            assert_eq!(refused.is_err(), px4 && extra.is_truth(), "{controller:?} {extra:?}");
            assert!(refused.is_ok() || refused.unwrap_err().starts_with(extra.name()));
        }
    }
}

/// A vehicle flies north-east and climbs: HIL_GPS carries the receiver's reading, only at its ticks.
#[test]
fn a_receivers_fixes_go_out_at_its_ticks() {
    let scene = "duration = \"2 s\"\n\
        [start]\nvelocity = \"[3, 4, -1] m/s\"\n\
        [earth]\nlatitude = \"59.93 deg\"\nlongitude = \"30.31 deg\"\naltitude = \"10 m\"\ndate = \"2026-11-22\"\n\
        [gyro]\nrate = \"100 Hz\"\n\
        [gps]\nrate = \"5 Hz\"\neph = \"0.9 m\"\nepv = \"1.8 m\"\nsatellites = 11\n";
    let plan = plan(scene);
    let mut fixes = Vec::new();
    for (packet, message) in flown(&play(&plan, Options::default(), None)) {
        let Message::HilGps(fix) = message else { continue };
        assert_eq!(packet.carries, SensorKind::Gps.into());
        fixes.push((packet.due, fix));
    }
    assert_eq!(fixes.len(), 10);
    for (k, (due, fix)) in fixes.iter().enumerate() {
        assert_eq!((due.0, fix.time_usec), (k as i64 * 200_000_000, k as u64 * 200_000));
        assert_eq!((fix.velocity, fix.vel, fix.fix_type), ([300, 400, -100], 500, 3));
        assert_eq!((fix.eph, fix.epv, fix.satellites_visible), (90, 180, 11));
        assert_eq!(fix.cog, 5313, "atan2(4, 3)");
        // A metre a second up, and 3 m/s north over the meridian's radius of 6.38e6 m at 60 degrees.
        let t = k as f64 * 0.2;
        assert_eq!(fix.alt, 10_000 + (t * 1e3).round() as i32);
        let north = (f64::from(fix.lat) * 1e-7 - 59.93).to_radians() * 6_383_500.0;
        assert!((north - 3.0 * t).abs() < 0.02, "{north} m after {t} s");
    }
}
