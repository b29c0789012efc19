//! The `mavlink` crate as the other side: the same bytes, and it reads ours.

use ::mavlink::dialects::common::{
    ATTITUDE_DATA, ATTITUDE_QUATERNION_DATA, HEARTBEAT_DATA, HIGHRES_IMU_DATA, HIL_SENSOR_DATA,
    HighresImuUpdatedFlags, HilSensorUpdatedFlags, MavAutopilot, MavMessage, MavModeFlag, MavState, MavType,
    RAW_IMU_DATA, SCALED_IMU_DATA, SYSTEM_TIME_DATA,
};
use ::mavlink::{MAVLinkV1MessageRaw, MAVLinkV2MessageRaw, MavHeader, MavlinkVersion};
use proptest::prelude::*;
use ratetable_protocols::mavlink::{
    self, Header, Message, Version, attitude, attitude_quaternion, heartbeat, highres_imu, hil_sensor,
    raw_imu, scaled_imu, system_time,
};

type Pair = (Message, MavMessage);

fn heartbeats() -> impl Strategy<Value = Pair> {
    any::<u32>().prop_map(|custom_mode| {
        let ours = heartbeat::Repr {
            custom_mode,
            kind: 2,
            autopilot: 12,
            base_mode: 0x20,
            system_status: 4,
            mavlink_version: 3,
        };
        let theirs = HEARTBEAT_DATA {
            custom_mode,
            mavtype: MavType::MAV_TYPE_QUADROTOR,
            autopilot: MavAutopilot::MAV_AUTOPILOT_PX4,
            base_mode: MavModeFlag::MAV_MODE_FLAG_HIL_ENABLED,
            system_status: MavState::MAV_STATE_ACTIVE,
            mavlink_version: 3,
        };
        (Message::Heartbeat(ours), MavMessage::HEARTBEAT(theirs))
    })
}

fn system_times() -> impl Strategy<Value = Pair> {
    any::<(u64, u32)>().prop_map(|(time_unix_usec, time_boot_ms)| {
        let ours = system_time::Repr { time_unix_usec, time_boot_ms };
        let theirs = SYSTEM_TIME_DATA { time_unix_usec, time_boot_ms };
        (Message::SystemTime(ours), MavMessage::SYSTEM_TIME(theirs))
    })
}

fn attitudes() -> impl Strategy<Value = Pair> {
    any::<(u32, [f32; 6])>().prop_map(|(time_boot_ms, f)| {
        let [roll, pitch, yaw, rollspeed, pitchspeed, yawspeed] = f;
        let angular_rate = [rollspeed, pitchspeed, yawspeed];
        let ours = attitude::Repr { time_boot_ms, roll, pitch, yaw, angular_rate };
        let theirs = ATTITUDE_DATA { time_boot_ms, roll, pitch, yaw, rollspeed, pitchspeed, yawspeed };
        (Message::Attitude(ours), MavMessage::ATTITUDE(theirs))
    })
}

fn attitude_quaternions() -> impl Strategy<Value = Pair> {
    any::<(u32, [f32; 4], [f32; 3], [f32; 4])>().prop_map(|(time_boot_ms, q, rate, offset)| {
        let ours = attitude_quaternion::Repr { time_boot_ms, q, angular_rate: rate, repr_offset_q: offset };
        let theirs = ATTITUDE_QUATERNION_DATA {
            time_boot_ms,
            q1: q[0],
            q2: q[1],
            q3: q[2],
            q4: q[3],
            rollspeed: rate[0],
            pitchspeed: rate[1],
            yawspeed: rate[2],
            repr_offset_q: offset,
        };
        (Message::AttitudeQuaternion(ours), MavMessage::ATTITUDE_QUATERNION(theirs))
    })
}

fn hil_sensors() -> impl Strategy<Value = Pair> {
    let flags = any::<u32>().prop_map(HilSensorUpdatedFlags::from_bits_truncate);
    (any::<(u64, [f32; 13], u8)>(), flags).prop_map(|((time_usec, f, id), flags)| {
        let ours = hil_sensor::Repr {
            time_usec,
            accel: [f[0], f[1], f[2]],
            gyro: [f[3], f[4], f[5]],
            mag: [f[6], f[7], f[8]],
            abs_pressure: f[9],
            diff_pressure: f[10],
            pressure_alt: f[11],
            temperature: f[12],
            fields_updated: flags.bits(),
            id,
        };
        let theirs = HIL_SENSOR_DATA {
            time_usec,
            xacc: f[0],
            yacc: f[1],
            zacc: f[2],
            xgyro: f[3],
            ygyro: f[4],
            zgyro: f[5],
            xmag: f[6],
            ymag: f[7],
            zmag: f[8],
            abs_pressure: f[9],
            diff_pressure: f[10],
            pressure_alt: f[11],
            temperature: f[12],
            fields_updated: flags,
            id,
        };
        (Message::HilSensor(ours), MavMessage::HIL_SENSOR(theirs))
    })
}

fn highres_imus() -> impl Strategy<Value = Pair> {
    let flags = any::<u16>().prop_map(HighresImuUpdatedFlags::from_bits_truncate);
    (any::<(u64, [f32; 13], u8)>(), flags).prop_map(|((time_usec, f, id), flags)| {
        let ours = highres_imu::Repr {
            time_usec,
            accel: [f[0], f[1], f[2]],
            gyro: [f[3], f[4], f[5]],
            mag: [f[6], f[7], f[8]],
            abs_pressure: f[9],
            diff_pressure: f[10],
            pressure_alt: f[11],
            temperature: f[12],
            fields_updated: flags.bits(),
            id,
        };
        let theirs = HIGHRES_IMU_DATA {
            time_usec,
            xacc: f[0],
            yacc: f[1],
            zacc: f[2],
            xgyro: f[3],
            ygyro: f[4],
            zgyro: f[5],
            xmag: f[6],
            ymag: f[7],
            zmag: f[8],
            abs_pressure: f[9],
            diff_pressure: f[10],
            pressure_alt: f[11],
            temperature: f[12],
            fields_updated: flags,
            id,
        };
        (Message::HighresImu(ours), MavMessage::HIGHRES_IMU(theirs))
    })
}

fn raw_imus() -> impl Strategy<Value = Pair> {
    any::<(u64, [i16; 9], u8, i16)>().prop_map(
        |(time_usec, [xacc, yacc, zacc, xgyro, ygyro, zgyro, xmag, ymag, zmag], id, temperature)| {
            let (accel, gyro, mag) = ([xacc, yacc, zacc], [xgyro, ygyro, zgyro], [xmag, ymag, zmag]);
            let ours = raw_imu::Repr { time_usec, accel, gyro, mag, id, temperature };
            let theirs = RAW_IMU_DATA {
                time_usec,
                xacc,
                yacc,
                zacc,
                xgyro,
                ygyro,
                zgyro,
                xmag,
                ymag,
                zmag,
                id,
                temperature,
            };
            (Message::RawImu(ours), MavMessage::RAW_IMU(theirs))
        },
    )
}

fn scaled_imus() -> impl Strategy<Value = Pair> {
    any::<(u32, [i16; 9], i16)>().prop_map(
        |(time_boot_ms, [xacc, yacc, zacc, xgyro, ygyro, zgyro, xmag, ymag, zmag], temperature)| {
            let (accel, gyro, mag) = ([xacc, yacc, zacc], [xgyro, ygyro, zgyro], [xmag, ymag, zmag]);
            let ours = scaled_imu::Repr { time_boot_ms, accel, gyro, mag, temperature };
            let theirs = SCALED_IMU_DATA {
                time_boot_ms,
                xacc,
                yacc,
                zacc,
                xgyro,
                ygyro,
                zgyro,
                xmag,
                ymag,
                zmag,
                temperature,
            };
            (Message::ScaledImu(ours), MavMessage::SCALED_IMU(theirs))
        },
    )
}

fn pairs() -> impl Strategy<Value = Pair> {
    prop_oneof![
        heartbeats(),
        system_times(),
        attitudes(),
        attitude_quaternions(),
        hil_sensors(),
        highres_imus(),
        raw_imus(),
        scaled_imus(),
    ]
}

/// What the crate writes.
fn their_bytes(version: Version, header: MavHeader, message: &MavMessage) -> Vec<u8> {
    match version {
        Version::V1 => {
            let mut raw = MAVLinkV1MessageRaw::new();
            raw.serialize_message(header, message);
            raw.raw_bytes().to_vec()
        }
        Version::V2 => {
            let mut raw = MAVLinkV2MessageRaw::new();
            raw.serialize_message(header, message);
            raw.raw_bytes().to_vec()
        }
    }
}

proptest! {
    #[test]
    fn our_bytes_are_theirs_and_each_reads_the_other(
        (ours, theirs) in pairs(),
        (v1, seq, system, component) in any::<(bool, u8, u8, u8)>(),
    ) {
        let version = if v1 { Version::V1 } else { Version::V2 };
        let header = Header { version, seq, system, component };
        let their_header = MavHeader { system_id: system.into(), component_id: component, sequence: seq };
        let mut out = [0; mavlink::MAX_LEN];
        let len = mavlink::encode(&header, &ours, &mut out).unwrap();
        let expected = their_bytes(version, their_header, &theirs);
        prop_assert_eq!(&out[..len], &expected[..]);

        let (their_version, skip) = match version {
            Version::V1 => (MavlinkVersion::V1, 6),
            Version::V2 => (MavlinkVersion::V2, 10),
        };
        use ::mavlink::Message as _;
        let read = MavMessage::parse(their_version, ours.id(), &out[skip..len - 2]).unwrap();
        prop_assert_eq!(their_bytes(version, their_header, &read), &out[..len]);

        let mut back = None;
        mavlink::Decoder::new().feed(&expected, |received| back = received.ok());
        let back = back.unwrap();
        prop_assert_eq!(back.header, header);
        let mut again = [0; mavlink::MAX_LEN];
        let again_len = mavlink::encode(&header, &back.message.unwrap(), &mut again).unwrap();
        prop_assert_eq!(&again[..again_len], &expected[..]);
    }
}

#[test]
fn our_checksum_seeds_are_theirs() {
    use ::mavlink::Message as _;
    for id in 0..=300 {
        if let Some(extra) = mavlink::crc_extra(id) {
            assert_eq!(extra, MavMessage::extra_crc(id), "id {id}");
        }
    }
}
