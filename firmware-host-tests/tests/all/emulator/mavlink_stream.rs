//! The `mavlink` stream as it comes off the pty, read and written again by the `mavlink` crate.

use mavlink::dialects::common::{HIL_SENSOR_DATA, HilSensorUpdatedFlags, MavMessage, MavModeFlag, MavType};
use mavlink::{MAVLinkMessageRaw, MAVLinkV2MessageRaw, MavHeader, MavlinkReader, MavlinkVersion, Message};
use ratetable::scene::Plan;
use ratetable::sensor::{Reading, SensorKind};
use ratetable_firmware_host_tests::Protocol;

use crate::emulator::play::{readings, scene, stream};

/// Every message of a stream, after having made sure that the same messages written by the crate are the same bytes,
/// with none left over.
fn messages(bytes: &[u8]) -> Vec<(MavHeader, MavMessage)> {
    let mut reader = MavlinkReader::new(bytes);
    let (mut messages, mut again) = (Vec::new(), Vec::with_capacity(bytes.len()));
    while let Ok(MAVLinkMessageRaw::V2(raw)) = reader.read_raw_message::<MavMessage>(MavlinkVersion::V2) {
        let message =
            MavMessage::parse(MavlinkVersion::V2, raw.message_id(), raw.payload()).expect("a known message");
        let header = MavHeader {
            system_id: raw.system_id(),
            component_id: raw.component_id(),
            sequence: raw.sequence(),
        };
        let mut written = MAVLinkV2MessageRaw::new();
        written.serialize_message(header, &message);
        again.extend_from_slice(written.raw_bytes());
        messages.push((header, message));
    }
    assert!(again == bytes, "{} of {} bytes read are written again the same", again.len(), bytes.len());
    messages
}

/// Bits of a sensor's three axes.
fn bits(kind: SensorKind) -> HilSensorUpdatedFlags {
    HilSensorUpdatedFlags::from_bits(match kind {
        SensorKind::Gyro => 0x38,
        SensorKind::Accel => 0x7,
        SensorKind::Mag => 0x1c0,
        _ => panic!("no axes"),
    })
    .expect("bits of the dialect")
}

/// A sensor's fields, in the units of a reading (the field is in gauss on the wire).
fn fields(data: &HIL_SENSOR_DATA, kind: SensorKind) -> [f64; 3] {
    match kind {
        SensorKind::Gyro => [data.xgyro, data.ygyro, data.zgyro].map(f64::from),
        SensorKind::Accel => [data.xacc, data.yacc, data.zacc].map(f64::from),
        SensorKind::Mag => [data.xmag, data.ymag, data.zmag].map(|gauss| f64::from(gauss) * 100.0),
        _ => panic!("no axes"),
    }
}

/// Whether each component is the nearest that an `f32` can be: half a unit of its 24 bits and a rounding of ours, or
/// half of the smallest number it has.
fn same(field: [f64; 3], reading: &Reading) -> bool {
    let value = reading.body().unwrap().value.v.to_array();
    let near = |field: f64, value: f64| {
        (field - value).abs() <= value.abs() * 0.501 * f64::from(f32::EPSILON) + 1e-43
    };
    field.into_iter().zip(value).all(|(field, value)| near(field, value))
}

fn check_sensors(plan: &Plan, sent: &[HIL_SENSOR_DATA]) {
    let mut sent = sent.iter();
    let mut newest: [Option<Reading>; 3] = [None; 3];
    let mut updated = HilSensorUpdatedFlags::empty();
    for (t, readings) in readings(plan) {
        for reading in &readings {
            newest[reading.kind as usize] = Some(*reading);
            updated |= bits(reading.kind);
        }
        if readings.iter().all(|reading| reading.kind != SensorKind::Gyro) {
            continue;
        }
        let data = sent.next().expect("a message for each gyro tick");
        assert_eq!((data.time_usec, data.fields_updated, data.id), (t.0 as u64 / 1000, updated, 0));
        for reading in newest.iter().flatten() {
            let field = fields(data, reading.kind);
            assert!(
                same(field, reading),
                "{} at {t} is {field:?} for {:?}",
                reading.kind,
                reading.body().unwrap().value
            );
        }
        let unused = [data.abs_pressure, data.diff_pressure, data.pressure_alt, data.temperature];
        assert_eq!(unused, [0.0; 4], "nothing is said of what the scene has not");
        updated = HilSensorUpdatedFlags::empty();
    }
    assert!(sent.next().is_none(), "and no more");
}

#[test]
fn the_mavlink_crate_reads_every_byte_and_writes_the_same() {
    for (name, sets) in
        [("manoeuvre", &[][..]), ("still", &["mag.rate=75 Hz"]), ("coning", &["accel.rate=333 Hz"])]
    {
        let plan = scene(name, sets);
        let (outcome, bytes) = stream(&plan, Protocol::Mavlink);
        let messages = messages(&bytes);
        assert_eq!(
            (messages.len() as u64, bytes.len() as u64),
            (outcome.links[0].packets, outcome.links[0].bytes)
        );
        let (mut sensors, mut beats, mut clocks) = (Vec::new(), 0, Vec::new());
        for (number, (header, message)) in messages.into_iter().enumerate() {
            assert_eq!(
                (header.sequence, header.system_id, header.component_id),
                (number as u8, 1, 51),
                "{name}"
            );
            match message {
                MavMessage::HIL_SENSOR(data) => sensors.push(data),
                MavMessage::HEARTBEAT(beat) => {
                    assert_eq!((beat.mavtype, beat.mavlink_version), (MavType::MAV_TYPE_GENERIC, 3));
                    assert!(beat.base_mode.contains(MavModeFlag::MAV_MODE_FLAG_HIL_ENABLED));
                    beats += 1;
                }
                MavMessage::SYSTEM_TIME(clock) => clocks.push((clock.time_unix_usec, clock.time_boot_ms)),
                other => panic!("{name}: {other:?}"),
            }
        }
        let seconds = plan.duration.0 as u64 / 1_000_000_000;
        assert_eq!(beats, seconds, "{name}: a heartbeat a second");
        let start_us = plan.day.map_or(0, |day| day.unix_seconds() as u64 * 1_000_000);
        let clock = |second: u64| {
            (if start_us > 0 { start_us + second * 1_000_000 } else { 0 }, second as u32 * 1000)
        };
        assert_eq!(clocks, (0..seconds).map(clock).collect::<Vec<_>>(), "{name}: a time a second");
        check_sensors(&plan, &sensors);
    }
}
