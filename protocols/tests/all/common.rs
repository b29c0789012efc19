//! The golden vectors as values: read from the data files, one line a packet.

use ratetable_protocols::mavlink::{self, Message, Version};
use ratetable_protocols::mpu::{self, Packet};
use ratetable_protocols::{betaflight, ilabs, mip, msp, sbg, vectornav};
use serde_json::Value;

/// One golden packet: its JSON and its bytes.
pub struct Vector {
    pub json: Value,
    pub bytes: Vec<u8>,
}

impl Vector {
    pub fn name(&self) -> &str {
        self.json["name"].as_str().unwrap()
    }

    pub fn hex(&self) -> &str {
        self.json["hex"].as_str().unwrap()
    }
}

/// The vectors of a format.
pub fn vectors(format: &str) -> Vec<Vector> {
    let path = format!("{}/vectors/{format}.json", env!("CARGO_MANIFEST_DIR"));
    let file: Value = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    let packets = file["packets"].as_array().unwrap().iter().cloned();
    packets.map(|json| Vector { bytes: unhex(json["hex"].as_str().unwrap()), json }).collect()
}

fn unhex(hex: &str) -> Vec<u8> {
    let digits = hex.as_bytes().chunks(2);
    digits.map(|pair| u8::from_str_radix(std::str::from_utf8(pair).unwrap(), 16).unwrap()).collect()
}

/// An integer of the JSON, whatever its type.
pub fn int<T: TryFrom<i64>>(value: &Value) -> T {
    let int = value.as_i64().unwrap_or_else(|| panic!("{value} is not an integer"));
    T::try_from(int).unwrap_or_else(|_| panic!("{value} does not fit"))
}

fn ints<T: TryFrom<i64>, const N: usize>(value: &Value) -> [T; N] {
    std::array::from_fn(|i| int(&value[i]))
}

fn float(value: &Value) -> f32 {
    value.as_f64().unwrap() as f32
}

fn floats<const N: usize>(value: &Value) -> [f32; N] {
    std::array::from_fn(|i| float(&value[i]))
}

/// The `mpu` packet that a vector describes.
pub fn mpu_packet(json: &Value) -> Packet {
    let f = &json["fields"];
    match json["type"].as_str().unwrap() {
        "imu" => Packet::Imu(mpu::imu::Repr {
            accel: ints(&f["accel"]),
            temperature: int(&f["temperature"]),
            gyro: ints(&f["gyro"]),
        }),
        "mag" => {
            Packet::Mag(mpu::mag::Repr { st1: int(&f["st1"]), field: ints(&f["field"]), st2: int(&f["st2"]) })
        }
        "gyro" => Packet::Gyro(mpu::gyro::Repr { gyro: ints(&f["gyro"]) }),
        "accel" => Packet::Accel(mpu::accel::Repr { accel: ints(&f["accel"]) }),
        "config" => Packet::Config(mpu::config::Repr {
            who_am_i: int(&f["who_am_i"]),
            smplrt_div: int(&f["smplrt_div"]),
            config: int(&f["config"]),
            gyro_config: int(&f["gyro_config"]),
            accel_config: int(&f["accel_config"]),
            mag_who: int(&f["mag_who"]),
            cntl1: int(&f["cntl1"]),
            asa: ints(&f["asa"]),
        }),
        "attitude" => {
            Packet::Attitude(mpu::attitude::Repr { clock_us: int(&f["clock_us"]), q: floats(&f["q"]) })
        }
        other => panic!("no packet type {other}"),
    }
}

/// The header that a `mavlink` vector describes.
pub fn mavlink_header(json: &Value) -> mavlink::Header {
    mavlink::Header {
        version: match int::<u8>(&json["version"]) {
            1 => Version::V1,
            _ => Version::V2,
        },
        seq: int(&json["seq"]),
        system: int(&json["system"]),
        component: int(&json["component"]),
    }
}

/// The message that a `mavlink` vector describes.
pub fn mavlink_message(json: &Value) -> Message {
    let f = &json["fields"];
    match json["message"].as_str().unwrap() {
        "heartbeat" => Message::Heartbeat(mavlink::heartbeat::Repr {
            custom_mode: int(&f["custom_mode"]),
            kind: int(&f["kind"]),
            autopilot: int(&f["autopilot"]),
            base_mode: int(&f["base_mode"]),
            system_status: int(&f["system_status"]),
            mavlink_version: int(&f["mavlink_version"]),
        }),
        "system_time" => Message::SystemTime(mavlink::system_time::Repr {
            time_unix_usec: int(&f["time_unix_usec"]),
            time_boot_ms: int(&f["time_boot_ms"]),
        }),
        "attitude" => Message::Attitude(mavlink::attitude::Repr {
            time_boot_ms: int(&f["time_boot_ms"]),
            roll: float(&f["roll"]),
            pitch: float(&f["pitch"]),
            yaw: float(&f["yaw"]),
            angular_rate: floats(&f["angular_rate"]),
        }),
        "attitude_quaternion" => Message::AttitudeQuaternion(mavlink::attitude_quaternion::Repr {
            time_boot_ms: int(&f["time_boot_ms"]),
            q: floats(&f["q"]),
            angular_rate: floats(&f["angular_rate"]),
            repr_offset_q: floats(&f["repr_offset_q"]),
        }),
        "hil_sensor" => Message::HilSensor(mavlink::hil_sensor::Repr {
            time_usec: int(&f["time_usec"]),
            accel: floats(&f["accel"]),
            gyro: floats(&f["gyro"]),
            mag: floats(&f["mag"]),
            abs_pressure: float(&f["abs_pressure"]),
            diff_pressure: float(&f["diff_pressure"]),
            pressure_alt: float(&f["pressure_alt"]),
            temperature: float(&f["temperature"]),
            fields_updated: int(&f["fields_updated"]),
            id: int(&f["id"]),
        }),
        "highres_imu" => Message::HighresImu(mavlink::highres_imu::Repr {
            time_usec: int(&f["time_usec"]),
            accel: floats(&f["accel"]),
            gyro: floats(&f["gyro"]),
            mag: floats(&f["mag"]),
            abs_pressure: float(&f["abs_pressure"]),
            diff_pressure: float(&f["diff_pressure"]),
            pressure_alt: float(&f["pressure_alt"]),
            temperature: float(&f["temperature"]),
            fields_updated: int(&f["fields_updated"]),
            id: int(&f["id"]),
        }),
        "raw_imu" => Message::RawImu(mavlink::raw_imu::Repr {
            time_usec: int(&f["time_usec"]),
            accel: ints(&f["accel"]),
            gyro: ints(&f["gyro"]),
            mag: ints(&f["mag"]),
            id: int(&f["id"]),
            temperature: int(&f["temperature"]),
        }),
        "scaled_imu" => Message::ScaledImu(mavlink::scaled_imu::Repr {
            time_boot_ms: int(&f["time_boot_ms"]),
            accel: ints(&f["accel"]),
            gyro: ints(&f["gyro"]),
            mag: ints(&f["mag"]),
            temperature: int(&f["temperature"]),
        }),
        "param_request_read" => Message::ParamRequestRead(mavlink::param_request_read::Repr {
            param_index: int(&f["param_index"]),
            target_system: int(&f["target_system"]),
            target_component: int(&f["target_component"]),
            param_id: mavlink::param_id(f["param_id"].as_str().unwrap()),
        }),
        "param_value" => Message::ParamValue(mavlink::param_value::Repr {
            param_value: f32::from_bits(int(&f["param_value_bits"])),
            param_count: int(&f["param_count"]),
            param_index: int(&f["param_index"]),
            param_id: mavlink::param_id(f["param_id"].as_str().unwrap()),
            param_type: int(&f["param_type"]),
        }),
        "command_long" => Message::CommandLong(mavlink::command_long::Repr {
            params: floats(&f["params"]),
            command: int(&f["command"]),
            target_system: int(&f["target_system"]),
            target_component: int(&f["target_component"]),
            confirmation: int(&f["confirmation"]),
        }),
        "command_ack" => Message::CommandAck(mavlink::command_ack::Repr {
            command: int(&f["command"]),
            result: int(&f["result"]),
            progress: int(&f["progress"]),
            result_param2: int(&f["result_param2"]),
            target_system: int(&f["target_system"]),
            target_component: int(&f["target_component"]),
        }),
        "hil_actuator_controls" => Message::HilActuatorControls(mavlink::hil_actuator_controls::Repr {
            time_usec: int(&f["time_usec"]),
            flags: int(&f["flags"]),
            controls: floats(&f["controls"]),
            mode: int(&f["mode"]),
        }),
        "timesync" => Message::Timesync(mavlink::timesync::Repr { tc1: int(&f["tc1"]), ts1: int(&f["ts1"]) }),
        "hil_gps" => Message::HilGps(mavlink::hil_gps::Repr {
            time_usec: int(&f["time_usec"]),
            lat: int(&f["lat"]),
            lon: int(&f["lon"]),
            alt: int(&f["alt"]),
            eph: int(&f["eph"]),
            epv: int(&f["epv"]),
            vel: int(&f["vel"]),
            velocity: ints(&f["velocity"]),
            cog: int(&f["cog"]),
            fix_type: int(&f["fix_type"]),
            satellites_visible: int(&f["satellites_visible"]),
            id: int(&f["id"]),
            yaw: int(&f["yaw"]),
        }),
        "hil_state_quaternion" => Message::HilStateQuaternion(mavlink::hil_state_quaternion::Repr {
            time_usec: int(&f["time_usec"]),
            q: floats(&f["q"]),
            angular_rate: floats(&f["angular_rate"]),
            lat: int(&f["lat"]),
            lon: int(&f["lon"]),
            alt: int(&f["alt"]),
            velocity: ints(&f["velocity"]),
            ind_airspeed: int(&f["ind_airspeed"]),
            true_airspeed: int(&f["true_airspeed"]),
            accel: ints(&f["accel"]),
        }),
        "scaled_imu2" => Message::ScaledImu2(mavlink::scaled_imu2::Repr {
            time_boot_ms: int(&f["time_boot_ms"]),
            accel: ints(&f["accel"]),
            gyro: ints(&f["gyro"]),
            mag: ints(&f["mag"]),
            temperature: int(&f["temperature"]),
        }),
        "scaled_imu3" => Message::ScaledImu3(mavlink::scaled_imu3::Repr {
            time_boot_ms: int(&f["time_boot_ms"]),
            accel: ints(&f["accel"]),
            gyro: ints(&f["gyro"]),
            mag: ints(&f["mag"]),
            temperature: int(&f["temperature"]),
        }),
        other => panic!("no message {other}"),
    }
}

/// The readings of a simulator message.
fn msp_simulator(f: &Value) -> msp::simulator::Repr {
    msp::simulator::Repr {
        version: int(&f["version"]),
        flags: int(&f["flags"]),
        fix: int(&f["fix"]),
        satellites: int(&f["satellites"]),
        latitude: int(&f["latitude"]),
        longitude: int(&f["longitude"]),
        altitude: int(&f["altitude"]),
        ground_speed: int(&f["ground_speed"]),
        course: int(&f["course"]),
        velocity: ints(&f["velocity"]),
        attitude: ints(&f["attitude"]),
        accel: ints(&f["accel"]),
        gyro: ints(&f["gyro"]),
        pressure: int(&f["pressure"]),
        mag: ints(&f["mag"]),
    }
}

/// The `msp` message that a vector describes.
pub fn msp_message(json: &Value) -> msp::Message {
    let f = &json["fields"];
    match json["message"].as_str().unwrap() {
        "empty" => msp::Message::Empty { direction: msp_direction(json), command: int(&json["command"]) },
        "simulator" => msp::Message::Simulator(msp_simulator(f)),
        "simulator_air" => msp::Message::SimulatorAir(msp::simulator_air::Repr {
            readings: msp_simulator(f),
            tail: msp::simulator_air::tail::Repr {
                voltage: int(&f["voltage"]),
                airspeed: int(&f["airspeed"]),
                more_flags: int(&f["more_flags"]),
            },
        }),
        "simulator_reply" => msp::Message::SimulatorReply(msp::simulator_reply::Repr {
            outputs: ints(&f["outputs"]),
            state: int(&f["state"]),
            debug: int(&f["debug"]),
            attitude: ints(&f["attitude"]),
            display: ints(&f["display"]),
        }),
        "attitude" => msp::Message::Attitude(msp::attitude::Repr {
            roll: int(&f["roll"]),
            pitch: int(&f["pitch"]),
            yaw: int(&f["yaw"]),
        }),
        "api_version" => msp::Message::ApiVersion(msp::api_version::Repr {
            protocol: int(&f["protocol"]),
            major: int(&f["major"]),
            minor: int(&f["minor"]),
        }),
        "fc_variant" => msp::Message::FcVariant(msp::fc_variant::Repr { name: ints(&f["name"]) }),
        "fc_version" => msp::Message::FcVersion(msp::fc_version::Repr {
            major: int(&f["major"]),
            minor: int(&f["minor"]),
            patch: int(&f["patch"]),
        }),
        "status" => msp::Message::Status(msp::status::Repr {
            cycle_time: int(&f["cycle_time"]),
            bus_errors: int(&f["bus_errors"]),
            sensors: int(&f["sensors"]),
            modes: int(&f["modes"]),
            profile: int(&f["profile"]),
            load: int(&f["load"]),
        }),
        "raw_imu" => msp::Message::RawImu(msp::raw_imu::Repr {
            accel: ints(&f["accel"]),
            gyro: ints(&f["gyro"]),
            mag: ints(&f["mag"]),
        }),
        "attitude_quaternion" => {
            msp::Message::AttitudeQuaternion(msp::attitude_quaternion::Repr { q: ints(&f["q"]) })
        }
        other => panic!("no message {other}"),
    }
}

/// Which way the frame of a vector goes.
pub fn msp_direction(json: &Value) -> msp::Direction {
    match json["direction"].as_str().unwrap() {
        "request" => msp::Direction::Request,
        "reply" => msp::Direction::Reply,
        "refusal" => msp::Direction::Refusal,
        other => panic!("no direction {other}"),
    }
}

/// The `vectornav` packet that a vector describes.
pub fn vectornav_packet(json: &Value) -> vectornav::Packet {
    let f = &json["fields"];
    match json["type"].as_str().unwrap() {
        "imu" => vectornav::Packet::Imu(vectornav::imu::Repr {
            time_ns: f["time_ns"].as_u64().unwrap(),
            gyro: floats(&f["gyro"]),
            accel: floats(&f["accel"]),
            raw_accel: floats(&f["raw_accel"]),
            raw_gyro: floats(&f["raw_gyro"]),
            mag: floats(&f["mag"]),
            temperature: float(&f["temperature"]),
            pressure: float(&f["pressure"]),
        }),
        "ahrs" => vectornav::Packet::Ahrs(vectornav::ahrs::Repr {
            time_ns: f["time_ns"].as_u64().unwrap(),
            yaw_pitch_roll: floats(&f["yaw_pitch_roll"]),
            xyzw: floats(&f["xyzw"]),
            uncertainty: floats(&f["uncertainty"]),
        }),
        "inertial" => vectornav::Packet::Inertial(vectornav::inertial::Repr {
            time_ns: f["time_ns"].as_u64().unwrap(),
            accel: floats(&f["accel"]),
            gyro: floats(&f["gyro"]),
        }),
        "navigation" => vectornav::Packet::Navigation(vectornav::navigation::Repr {
            time_ns: f["time_ns"].as_u64().unwrap(),
            temperature: float(&f["temperature"]),
            pressure: float(&f["pressure"]),
            mag: floats(&f["mag"]),
            xyzw: floats(&f["xyzw"]),
            acceleration: floats(&f["acceleration"]),
            status: f["status"].as_u64().unwrap() as u16,
            position: [0, 1, 2].map(|i| f["position"][i].as_f64().unwrap()),
            velocity: floats(&f["velocity"]),
            position_uncertainty: float(&f["position_uncertainty"]),
            velocity_uncertainty: float(&f["velocity_uncertainty"]),
        }),
        "line" => {
            let text = f["text"].as_str().unwrap();
            vectornav::Packet::Line(vectornav::line::Line::new(text).unwrap())
        }
        other => panic!("no packet type {other}"),
    }
}

/// The `ilabs` frame that a vector describes: what it lacks is not told.
pub fn ilabs_frame(json: &Value) -> ilabs::data::Repr {
    use ilabs::data::{Angles, Pressure};
    let f = |name: &str| json["fields"].get(name);
    ilabs::data::Repr {
        time_ms: f("time_ms").map(int),
        accel: f("accel").map(ints),
        gyro: f("gyro").map(ints),
        pressure: f("pressure").map(|it| Pressure { half_pascals: int(&it[0]), altitude: int(&it[1]) }),
        mag: f("mag").map(ints),
        attitude: f("attitude").map(|it| Angles { yaw: int(&it[0]), pitch: int(&it[1]), roll: int(&it[2]) }),
        status: f("status").map(int),
        status_2: f("status_2").map(int),
        temperature: f("temperature").map(int),
    }
}

/// The `sbg` packet that a vector describes.
pub fn sbg_packet(json: &Value) -> sbg::Packet {
    let f = &json["fields"];
    match json["type"].as_str().unwrap() {
        "imu_short" => sbg::Packet::ImuShort(sbg::imu_short::Repr {
            time_us: int(&f["time_us"]),
            status: int(&f["status"]),
            accel: ints(&f["accel"]),
            gyro: ints(&f["gyro"]),
            temperature: int(&f["temperature"]),
        }),
        "mag" => sbg::Packet::Mag(sbg::mag::Repr {
            time_us: int(&f["time_us"]),
            status: int(&f["status"]),
            field: floats(&f["field"]),
            accel: floats(&f["accel"]),
        }),
        "air_data" => sbg::Packet::AirData(sbg::air_data::Repr {
            time_us: int(&f["time_us"]),
            status: int(&f["status"]),
            pressure: float(&f["pressure"]),
            altitude: float(&f["altitude"]),
            differential_pressure: float(&f["differential_pressure"]),
            airspeed: float(&f["airspeed"]),
            temperature: float(&f["temperature"]),
        }),
        "quat" => sbg::Packet::Quat(sbg::quat::Repr {
            time_us: int(&f["time_us"]),
            wxyz: floats(&f["wxyz"]),
            uncertainty: floats(&f["uncertainty"]),
            status: int(&f["status"]),
        }),
        "info_request" => sbg::Packet::InfoRequest,
        "info" => {
            let mut product = [0; 32];
            let name = f["product"].as_str().unwrap().as_bytes();
            product[..name.len()].copy_from_slice(name);
            sbg::Packet::Info(sbg::info::Repr {
                product,
                serial: int(&f["serial"]),
                calibration: int(&f["calibration"]),
                year: int(&f["year"]),
                month: int(&f["month"]),
                day: int(&f["day"]),
                hardware: int(&f["hardware"]),
                firmware: int(&f["firmware"]),
            })
        }
        other => panic!("no packet type {other}"),
    }
}

/// The `mip` packet that a vector describes: fields that it lacks are not sent.
pub fn mip_packet(json: &Value) -> mip::imu::Repr {
    let vector = |name: &str| json["fields"].get(name).map(floats);
    mip::imu::Repr {
        pressure: json["fields"].get("pressure").map(float),
        mag: vector("mag"),
        accel: vector("accel"),
        gyro: vector("gyro"),
        time: None,
    }
}

fn doubles<const N: usize>(value: &Value) -> [f64; N] {
    std::array::from_fn(|i| value[i].as_f64().unwrap())
}

/// The `betaflight` packet that a vector describes.
pub fn betaflight_packet(json: &Value) -> betaflight::state::Repr {
    let f = &json["fields"];
    betaflight::state::Repr {
        timestamp: f["timestamp"].as_f64().unwrap(),
        gyro: doubles(&f["gyro"]),
        accel: doubles(&f["accel"]),
        orientation: doubles(&f["orientation"]),
        velocity: doubles(&f["velocity"]),
        position: doubles(&f["position"]),
        pressure: f["pressure"].as_f64().unwrap(),
    }
}
