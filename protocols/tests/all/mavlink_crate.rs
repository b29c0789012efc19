//! The `mavlink` crate as the other side: the same bytes, and it reads ours.

use ::mavlink::dialects::common::{
    ATTITUDE_DATA, ATTITUDE_QUATERNION_DATA, COMMAND_ACK_DATA, COMMAND_LONG_DATA, HEARTBEAT_DATA,
    HIGHRES_IMU_DATA, HIL_ACTUATOR_CONTROLS_DATA, HIL_GPS_DATA, HIL_SENSOR_DATA, HIL_STATE_QUATERNION_DATA,
    HighresImuUpdatedFlags, HilActuatorControlsFlags, HilSensorUpdatedFlags, MavAutopilot, MavCmd,
    MavMessage, MavModeFlag, MavParamType, MavResult, MavState, MavType, PARAM_REQUEST_READ_DATA,
    PARAM_VALUE_DATA, RAW_IMU_DATA, SCALED_IMU_DATA, SCALED_IMU2_DATA, SCALED_IMU3_DATA, SYSTEM_TIME_DATA,
    TIMESYNC_DATA,
};
use ::mavlink::types::CharArray;
use ::mavlink::{MAVLinkV1MessageRaw, MAVLinkV2MessageRaw, MavHeader, MavlinkVersion};
use proptest::prelude::*;
use ratetable_protocols::mavlink::{
    self, Header, Message, Version, attitude, attitude_quaternion, command_ack, command_long, heartbeat,
    highres_imu, hil_actuator_controls, hil_gps, hil_sensor, hil_state_quaternion, param_request_read,
    param_value, raw_imu, scaled_imu, scaled_imu2, scaled_imu3, system_time, timesync,
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

fn scaled_imus_2_and_3() -> impl Strategy<Value = Pair> {
    any::<(bool, u32, [i16; 9], i16)>().prop_map(
        |(third, time_boot_ms, [xacc, yacc, zacc, xgyro, ygyro, zgyro, xmag, ymag, zmag], temperature)| {
            let (accel, gyro, mag) = ([xacc, yacc, zacc], [xgyro, ygyro, zgyro], [xmag, ymag, zmag]);
            if third {
                let ours = scaled_imu3::Repr { time_boot_ms, accel, gyro, mag, temperature };
                let theirs = SCALED_IMU3_DATA {
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
                (Message::ScaledImu3(ours), MavMessage::SCALED_IMU3(theirs))
            } else {
                let ours = scaled_imu2::Repr { time_boot_ms, accel, gyro, mag, temperature };
                let theirs = SCALED_IMU2_DATA {
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
                (Message::ScaledImu2(ours), MavMessage::SCALED_IMU2(theirs))
            }
        },
    )
}

fn param_requests() -> impl Strategy<Value = Pair> {
    any::<(i16, u8, u8, [u8; 16])>().prop_map(|(param_index, target_system, target_component, id)| {
        let ours = param_request_read::Repr { param_index, target_system, target_component, param_id: id };
        let param_id = CharArray::new(id);
        let theirs = PARAM_REQUEST_READ_DATA { param_index, target_system, target_component, param_id };
        (Message::ParamRequestRead(ours), MavMessage::PARAM_REQUEST_READ(theirs))
    })
}

fn param_values() -> impl Strategy<Value = Pair> {
    any::<(i32, u16, u16, [u8; 16])>().prop_map(|(bits, param_count, param_index, id)| {
        let param_value = f32::from_bits(bits.cast_unsigned());
        let param_type = param_value::INT32;
        let ours = param_value::Repr { param_value, param_count, param_index, param_id: id, param_type };
        let (param_id, param_type) = (CharArray::new(id), MavParamType::MAV_PARAM_TYPE_INT32);
        let theirs = PARAM_VALUE_DATA { param_value, param_count, param_index, param_id, param_type };
        (Message::ParamValue(ours), MavMessage::PARAM_VALUE(theirs))
    })
}

fn commands() -> impl Strategy<Value = Pair> {
    any::<([f32; 7], u8, u8, u8)>().prop_map(|(params, target_system, target_component, confirmation)| {
        let command = command_long::SET_MESSAGE_INTERVAL;
        let ours = command_long::Repr { params, command, target_system, target_component, confirmation };
        let [param1, param2, param3, param4, param5, param6, param7] = params;
        let command = MavCmd::MAV_CMD_SET_MESSAGE_INTERVAL;
        let theirs = COMMAND_LONG_DATA {
            param1,
            param2,
            param3,
            param4,
            param5,
            param6,
            param7,
            command,
            target_system,
            target_component,
            confirmation,
        };
        (Message::CommandLong(ours), MavMessage::COMMAND_LONG(theirs))
    })
}

fn command_acks() -> impl Strategy<Value = Pair> {
    any::<(u8, i32, u8, u8)>().prop_map(|(progress, result_param2, target_system, target_component)| {
        let (command, result) = (command_long::SET_MESSAGE_INTERVAL, command_ack::IN_PROGRESS);
        let ours =
            command_ack::Repr { command, result, progress, result_param2, target_system, target_component };
        let command = MavCmd::MAV_CMD_SET_MESSAGE_INTERVAL;
        let result = MavResult::MAV_RESULT_IN_PROGRESS;
        let theirs =
            COMMAND_ACK_DATA { command, result, progress, result_param2, target_system, target_component };
        (Message::CommandAck(ours), MavMessage::COMMAND_ACK(theirs))
    })
}

fn actuator_controls() -> impl Strategy<Value = Pair> {
    any::<(u64, bool, [f32; 16], u8)>().prop_map(|(time_usec, lockstep, controls, mode)| {
        let flags = if lockstep { hil_actuator_controls::LOCKSTEP } else { 0 };
        let mode = MavModeFlag::from_bits_truncate(mode);
        let ours = hil_actuator_controls::Repr { time_usec, flags, controls, mode: mode.bits() };
        let flags = HilActuatorControlsFlags::from_bits_truncate(flags);
        let theirs = HIL_ACTUATOR_CONTROLS_DATA { time_usec, flags, controls, mode };
        (Message::HilActuatorControls(ours), MavMessage::HIL_ACTUATOR_CONTROLS(theirs))
    })
}

/// Without the addressees that an extension gives them, which are not read here.
fn timesyncs() -> impl Strategy<Value = Pair> {
    any::<(i64, i64)>().prop_map(|(tc1, ts1)| {
        let theirs = TIMESYNC_DATA { tc1, ts1, target_system: 0, target_component: 0 };
        (Message::Timesync(timesync::Repr { tc1, ts1 }), MavMessage::TIMESYNC(theirs))
    })
}

fn fixes() -> impl Strategy<Value = Pair> {
    any::<(u64, [i32; 3], [u16; 5], [i16; 3], [u8; 3])>().prop_map(|(time_usec, place, u, velocity, b)| {
        let ([lat, lon, alt], [eph, epv, vel, cog, yaw]) = (place, u);
        let ([vn, ve, vd], [fix_type, satellites_visible, id]) = (velocity, b);
        let ours = hil_gps::Repr {
            time_usec,
            lat,
            lon,
            alt,
            eph,
            epv,
            vel,
            velocity,
            cog,
            fix_type,
            satellites_visible,
            id,
            yaw,
        };
        let theirs = HIL_GPS_DATA {
            time_usec,
            lat,
            lon,
            alt,
            eph,
            epv,
            vel,
            vn,
            ve,
            vd,
            cog,
            fix_type,
            satellites_visible,
            id,
            yaw,
        };
        (Message::HilGps(ours), MavMessage::HIL_GPS(theirs))
    })
}

fn states() -> impl Strategy<Value = Pair> {
    any::<(u64, [f32; 4], [f32; 3], [i32; 3], [i16; 6], [u16; 2])>().prop_map(
        |(time_usec, q, angular_rate, [lat, lon, alt], [vx, vy, vz, xacc, yacc, zacc], airspeeds)| {
            let [ind_airspeed, true_airspeed] = airspeeds;
            let (velocity, accel) = ([vx, vy, vz], [xacc, yacc, zacc]);
            let ours = hil_state_quaternion::Repr {
                time_usec,
                q,
                angular_rate,
                lat,
                lon,
                alt,
                velocity,
                ind_airspeed,
                true_airspeed,
                accel,
            };
            let [rollspeed, pitchspeed, yawspeed] = angular_rate;
            let theirs = HIL_STATE_QUATERNION_DATA {
                time_usec,
                attitude_quaternion: q,
                rollspeed,
                pitchspeed,
                yawspeed,
                lat,
                lon,
                alt,
                vx,
                vy,
                vz,
                ind_airspeed,
                true_airspeed,
                xacc,
                yacc,
                zacc,
            };
            (Message::HilStateQuaternion(ours), MavMessage::HIL_STATE_QUATERNION(theirs))
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
        scaled_imus_2_and_3(),
        param_requests(),
        param_values(),
        commands(),
        command_acks(),
        actuator_controls(),
        timesyncs(),
        fixes(),
        states(),
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
fn our_checksum_seeds_and_names_are_theirs() {
    use ::mavlink::Message as _;
    let mut common = 0;
    for known in &mavlink::KNOWN {
        let theirs = MavMessage::message_id_from_name(&known.name.to_uppercase());
        assert!(theirs.is_none_or(|id| id == known.id), "{known:?} is {theirs:?}");
        if theirs.is_some() {
            common += 1;
            assert_eq!(known.crc_extra, MavMessage::extra_crc(known.id), "{known:?}");
        }
        assert!(theirs.is_some() || !Message::IDS.contains(&known.id), "{known:?}");
    }
    assert!(common > 200, "theirs is the dialect `common` alone, with {common} messages");
}
