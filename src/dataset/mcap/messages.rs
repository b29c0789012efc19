//! The ROS 2 messages used, with their definitions, in CDR: little-endian, each number at a multiple of its length.
//!
//! Source: OMG DDSI-RTPS 2.2, 10.2 (encapsulation `CDR_LE`); definitions of `common_interfaces`, without comments.

use super::super::format::plain;
use crate::time::{NANOS, SimTime};

/// Which message a topic carries.
#[derive(Clone, Copy)]
pub(super) enum Kind {
    Imu,
    MagneticField,
    FluidPressure,
    NavSatFix,
    Quaternion,
    Vector,
}

/// Before the definition of each message that another one holds.
macro_rules! with {
    ($own:expr $(, $name:literal: $text:expr)*) => {
        concat!($own, $(
            "================================================================================\nMSG: ", $name, "\n",
            $text,
        )*)
    };
}
macro_rules! header {
    () => {
        "builtin_interfaces/Time stamp\nstring frame_id\n"
    };
}
macro_rules! time {
    () => {
        "int32 sec\nuint32 nanosec\n"
    };
}
macro_rules! four {
    () => {
        "float64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1\n"
    };
}
macro_rules! three {
    () => {
        "float64 x\nfloat64 y\nfloat64 z\n"
    };
}

impl Kind {
    /// Its name and its definition, with those of the messages in it.
    pub(super) fn schema(self) -> (&'static str, &'static str) {
        match self {
            Kind::Imu => (
                "sensor_msgs/msg/Imu",
                with!(
                    "std_msgs/Header header\n\
                     geometry_msgs/Quaternion orientation\n\
                     float64[9] orientation_covariance\n\
                     geometry_msgs/Vector3 angular_velocity\n\
                     float64[9] angular_velocity_covariance\n\
                     geometry_msgs/Vector3 linear_acceleration\n\
                     float64[9] linear_acceleration_covariance\n",
                    "std_msgs/Header": header!(),
                    "builtin_interfaces/Time": time!(),
                    "geometry_msgs/Quaternion": four!(),
                    "geometry_msgs/Vector3": three!()
                ),
            ),
            Kind::MagneticField => (
                "sensor_msgs/msg/MagneticField",
                with!(
                    "std_msgs/Header header\n\
                     geometry_msgs/Vector3 magnetic_field\n\
                     float64[9] magnetic_field_covariance\n",
                    "std_msgs/Header": header!(),
                    "builtin_interfaces/Time": time!(),
                    "geometry_msgs/Vector3": three!()
                ),
            ),
            Kind::FluidPressure => (
                "sensor_msgs/msg/FluidPressure",
                with!(
                    "std_msgs/Header header\nfloat64 fluid_pressure\nfloat64 variance\n",
                    "std_msgs/Header": header!(),
                    "builtin_interfaces/Time": time!()
                ),
            ),
            Kind::NavSatFix => (
                "sensor_msgs/msg/NavSatFix",
                with!(
                    "uint8 COVARIANCE_TYPE_UNKNOWN=0\n\
                     uint8 COVARIANCE_TYPE_APPROXIMATED=1\n\
                     uint8 COVARIANCE_TYPE_DIAGONAL_KNOWN=2\n\
                     uint8 COVARIANCE_TYPE_KNOWN=3\n\
                     std_msgs/Header header\n\
                     sensor_msgs/NavSatStatus status\n\
                     float64 latitude\n\
                     float64 longitude\n\
                     float64 altitude\n\
                     float64[9] position_covariance\n\
                     uint8 position_covariance_type\n",
                    "std_msgs/Header": header!(),
                    "builtin_interfaces/Time": time!(),
                    "sensor_msgs/NavSatStatus":
                        "int8 STATUS_NO_FIX=-1\n\
                         int8 STATUS_FIX=0\n\
                         int8 STATUS_SBAS_FIX=1\n\
                         int8 STATUS_GBAS_FIX=2\n\
                         uint16 SERVICE_GPS=1\n\
                         uint16 SERVICE_GLONASS=2\n\
                         uint16 SERVICE_COMPASS=4\n\
                         uint16 SERVICE_GALILEO=8\n\
                         int8 status\n\
                         uint16 service\n"
                ),
            ),
            Kind::Vector => (
                "geometry_msgs/msg/Vector3Stamped",
                with!(
                    "std_msgs/Header header\ngeometry_msgs/Vector3 vector\n",
                    "std_msgs/Header": header!(),
                    "builtin_interfaces/Time": time!(),
                    "geometry_msgs/Vector3": three!()
                ),
            ),
            Kind::Quaternion => (
                "geometry_msgs/msg/QuaternionStamped",
                with!(
                    "std_msgs/Header header\ngeometry_msgs/Quaternion quaternion\n",
                    "std_msgs/Header": header!(),
                    "builtin_interfaces/Time": time!(),
                    "geometry_msgs/Quaternion": four!()
                ),
            ),
        }
    }
}

/// When, and in which frame's axes.
#[derive(Clone, Copy)]
pub(super) struct Stamped {
    pub t: SimTime,
    pub frame: &'static str,
}

/// What an `Imu` message holds: quaternion `[w, x, y, z]`, rad/s, m/s².
pub(super) struct Imu {
    pub attitude: Option<[f64; 4]>,
    pub rate: Option<[f64; 3]>,
    pub force: Option<[f64; 3]>,
}

/// `sensor_msgs/msg/Imu`.
pub(super) fn imu(stamped: Stamped, imu: &Imu, bytes: &mut Vec<u8>) {
    let mut cdr = Cdr::begin(stamped, bytes);
    let [w, x, y, z] = imu.attitude.unwrap_or([1.0, 0.0, 0.0, 0.0]);
    cdr.doubles(&[x, y, z, w]);
    cdr.covariance(imu.attitude.is_some());
    for vector in [imu.rate, imu.force] {
        cdr.doubles(&vector.unwrap_or_default());
        cdr.covariance(vector.is_some());
    }
}

/// `sensor_msgs/msg/MagneticField` of a field in µT, which the message holds in tesla.
pub(super) fn magnetic_field(stamped: Stamped, field: [f64; 3], bytes: &mut Vec<u8>) {
    let mut cdr = Cdr::begin(stamped, bytes);
    cdr.doubles(&field.map(|microtesla| microtesla * 1e-6));
    cdr.covariance(true);
}

/// `sensor_msgs/msg/FluidPressure` of a pressure in Pa; its variance is 0, unknown.
pub(super) fn fluid_pressure(stamped: Stamped, pressure: f64, bytes: &mut Vec<u8>) {
    Cdr::begin(stamped, bytes).doubles(&[pressure, 0.0]);
}

/// `sensor_msgs/msg/NavSatFix` of latitude and longitude in degrees and altitude in m: a GPS fix, its covariance
/// unknown.
pub(super) fn nav_sat_fix(stamped: Stamped, place: [f64; 3], bytes: &mut Vec<u8>) {
    const STATUS_FIX: u8 = 0;
    const SERVICE_GPS: u16 = 1;
    const COVARIANCE_TYPE_UNKNOWN: u8 = 0;
    let mut cdr = Cdr::begin(stamped, bytes);
    cdr.0.push(STATUS_FIX);
    cdr.align(2);
    cdr.0.extend_from_slice(&SERVICE_GPS.to_le_bytes());
    cdr.doubles(&place);
    cdr.doubles(&[0.0; 9]);
    cdr.0.push(COVARIANCE_TYPE_UNKNOWN);
}

/// `geometry_msgs/msg/QuaternionStamped` of `[w, x, y, z]`.
pub(super) fn quaternion(stamped: Stamped, [w, x, y, z]: [f64; 4], bytes: &mut Vec<u8>) {
    Cdr::begin(stamped, bytes).doubles(&[x, y, z, w]);
}

/// `geometry_msgs/msg/Vector3Stamped`.
pub(super) fn vector(stamped: Stamped, vector: [f64; 3], bytes: &mut Vec<u8>) {
    Cdr::begin(stamped, bytes).doubles(&vector);
}

/// A message being written.
struct Cdr<'a>(&'a mut Vec<u8>);

/// Bytes that say how the rest is written, which alignment does not count.
const ENCAPSULATION: [u8; 4] = [0, 1, 0, 0];

impl Cdr<'_> {
    /// The encapsulation and the message's header.
    fn begin(stamped: Stamped, bytes: &mut Vec<u8>) -> Cdr<'_> {
        bytes.clear();
        bytes.extend_from_slice(&ENCAPSULATION);
        let (seconds, nanos) = (stamped.t.0.div_euclid(NANOS), stamped.t.0.rem_euclid(NANOS));
        // Good for 68 years of scene.
        bytes.extend_from_slice(&(seconds as i32).to_le_bytes());
        bytes.extend_from_slice(&(nanos as u32).to_le_bytes());
        bytes.extend_from_slice(&(stamped.frame.len() as u32 + 1).to_le_bytes());
        bytes.extend_from_slice(stamped.frame.as_bytes());
        bytes.push(0);
        Cdr(bytes)
    }

    /// Goes on at a multiple of so many bytes.
    fn align(&mut self, bytes: usize) {
        let length = (self.0.len() - ENCAPSULATION.len()).next_multiple_of(bytes);
        self.0.resize(ENCAPSULATION.len() + length, 0);
    }

    fn doubles(&mut self, values: &[f64]) {
        self.align(8);
        values.iter().for_each(|value| self.0.extend_from_slice(&plain(*value).to_le_bytes()));
    }

    /// Unknown; or, of something that the message does not hold, −1 to say so.
    fn covariance(&mut self, holds: bool) {
        let mut covariance = [0.0; 9];
        covariance[0] = if holds { 0.0 } else { -1.0 };
        self.doubles(&covariance);
    }
}
