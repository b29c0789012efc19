//! The ROS 2 messages used, with their definitions, in CDR: little-endian, each number at a multiple of its length.
//!
//! Source: OMG DDSI-RTPS 2.2, 10.2 (encapsulation `CDR_LE`); definitions of `common_interfaces`, without comments.

use crate::geometry::Axes;
use crate::time::{NANOS, SimTime};

/// Which message a topic carries.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Attitude, angular rate, specific force.
    Imu,
    /// A magnetic field, tesla.
    MagneticField,
    /// A pressure, Pa.
    FluidPressure,
    /// A receiver's position.
    NavSatFix,
    /// An attitude.
    Quaternion,
    /// A vector.
    Vector,
    /// An attitude at a place.
    Pose,
    /// How one frame lies in another.
    Transform,
    /// How things are.
    Diagnostics,
}

/// What the messages call nav and body axes; without more said, ROS takes them as East-North-Up and Forward-Left-Up.
pub fn frames(axes: Axes) -> [&'static str; 2] {
    match axes {
        Axes::EnuFlu => ["map", "imu_link"],
        Axes::NedFrd => ["map_ned", "imu_link_frd"],
    }
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
    pub fn schema(self) -> (&'static str, &'static str) {
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
            Kind::Pose => (
                "geometry_msgs/msg/PoseStamped",
                with!(
                    "std_msgs/Header header\ngeometry_msgs/Pose pose\n",
                    "std_msgs/Header": header!(),
                    "builtin_interfaces/Time": time!(),
                    "geometry_msgs/Pose": "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n",
                    "geometry_msgs/Point": three!(),
                    "geometry_msgs/Quaternion": four!()
                ),
            ),
            Kind::Transform => (
                "tf2_msgs/msg/TFMessage",
                with!(
                    "geometry_msgs/TransformStamped[] transforms\n",
                    "geometry_msgs/TransformStamped":
                        "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform\n",
                    "std_msgs/Header": header!(),
                    "builtin_interfaces/Time": time!(),
                    "geometry_msgs/Transform": "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation\n",
                    "geometry_msgs/Vector3": three!(),
                    "geometry_msgs/Quaternion": four!()
                ),
            ),
            Kind::Diagnostics => (
                "diagnostic_msgs/msg/DiagnosticArray",
                with!(
                    "std_msgs/Header header\ndiagnostic_msgs/DiagnosticStatus[] status\n",
                    "std_msgs/Header": header!(),
                    "builtin_interfaces/Time": time!(),
                    "diagnostic_msgs/DiagnosticStatus":
                        "byte OK=0\nbyte WARN=1\nbyte ERROR=2\nbyte STALE=3\n\
                         byte level\nstring name\nstring message\nstring hardware_id\n\
                         diagnostic_msgs/KeyValue[] values\n",
                    "diagnostic_msgs/KeyValue": "string key\nstring value\n"
                ),
            ),
        }
    }
}

/// When, and in which frame's axes.
#[derive(Clone, Copy, Debug)]
pub struct Stamped {
    /// Since the scene began.
    pub t: SimTime,
    /// The frame's name.
    pub frame: &'static str,
}

/// What an `Imu` message holds: quaternion `[w, x, y, z]`, rad/s, m/s².
#[derive(Clone, Copy, Debug, Default)]
pub struct Imu {
    /// Body to the frame of the message, w first.
    pub attitude: Option<[f64; 4]>,
    /// Angular rate, rad/s.
    pub rate: Option<[f64; 3]>,
    /// Specific force, m/s².
    pub force: Option<[f64; 3]>,
}

/// `sensor_msgs/msg/Imu`.
pub fn imu(stamped: Stamped, imu: &Imu, bytes: &mut Vec<u8>) {
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
pub fn magnetic_field(stamped: Stamped, field: [f64; 3], bytes: &mut Vec<u8>) {
    let mut cdr = Cdr::begin(stamped, bytes);
    cdr.doubles(&field.map(|microtesla| microtesla * 1e-6));
    cdr.covariance(true);
}

/// `sensor_msgs/msg/FluidPressure` of a pressure in Pa; its variance is 0, unknown.
pub fn fluid_pressure(stamped: Stamped, pressure: f64, bytes: &mut Vec<u8>) {
    Cdr::begin(stamped, bytes).doubles(&[pressure, 0.0]);
}

/// `sensor_msgs/msg/NavSatFix` of latitude and longitude in degrees and altitude in m: a GPS fix, its covariance
/// unknown.
pub fn nav_sat_fix(stamped: Stamped, place: [f64; 3], bytes: &mut Vec<u8>) {
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
pub fn quaternion(stamped: Stamped, [w, x, y, z]: [f64; 4], bytes: &mut Vec<u8>) {
    Cdr::begin(stamped, bytes).doubles(&[x, y, z, w]);
}

/// `geometry_msgs/msg/Vector3Stamped`.
pub fn vector(stamped: Stamped, vector: [f64; 3], bytes: &mut Vec<u8>) {
    Cdr::begin(stamped, bytes).doubles(&vector);
}

/// `geometry_msgs/msg/PoseStamped` of an attitude `[w, x, y, z]`, at the origin.
pub fn pose(stamped: Stamped, [w, x, y, z]: [f64; 4], bytes: &mut Vec<u8>) {
    Cdr::begin(stamped, bytes).doubles(&[0.0, 0.0, 0.0, x, y, z, w]);
}

/// A frame `child` that lies at the origin of another one, turned in its axes by a quaternion `[w, x, y, z]`.
#[derive(Clone, Copy, Debug)]
pub struct Turned<'a> {
    /// When, and in which frame.
    pub stamped: Stamped,
    /// The frame's name.
    pub child: &'a str,
    /// Takes vectors of the frame to the other one's axes.
    pub attitude: [f64; 4],
}

/// `tf2_msgs/msg/TFMessage`.
pub fn transforms(all: &[Turned<'_>], bytes: &mut Vec<u8>) {
    let mut cdr = Cdr::empty(bytes);
    cdr.word(all.len() as u32);
    for Turned { stamped, child, attitude: [w, x, y, z] } in all {
        cdr.header(*stamped);
        cdr.text(child);
        cdr.doubles(&[0.0, 0.0, 0.0, *x, *y, *z, *w]);
    }
}

/// How something is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Status {
    /// What it is.
    pub name: String,
    /// How grave: 0 all is well, 1 a warning, 2 an error.
    pub level: u8,
    /// In words.
    pub message: String,
    /// Figures by name.
    pub values: Vec<(String, String)>,
}

/// `diagnostic_msgs/msg/DiagnosticArray`.
pub fn diagnostics(stamped: Stamped, status: &[Status], bytes: &mut Vec<u8>) {
    let mut cdr = Cdr::begin(stamped, bytes);
    cdr.word(status.len() as u32);
    for Status { name, level, message, values } in status {
        cdr.0.push(*level);
        cdr.text(name);
        cdr.text(message);
        cdr.text("");
        cdr.word(values.len() as u32);
        for (key, value) in values {
            cdr.text(key);
            cdr.text(value);
        }
    }
}

/// A message being written.
struct Cdr<'a>(&'a mut Vec<u8>);

/// Bytes that say how the rest is written, which alignment does not count.
const ENCAPSULATION: [u8; 4] = [0, 1, 0, 0];

impl Cdr<'_> {
    /// The encapsulation alone.
    fn empty(bytes: &mut Vec<u8>) -> Cdr<'_> {
        bytes.clear();
        bytes.extend_from_slice(&ENCAPSULATION);
        Cdr(bytes)
    }

    /// The encapsulation and the message's header.
    fn begin(stamped: Stamped, bytes: &mut Vec<u8>) -> Cdr<'_> {
        let mut cdr = Cdr::empty(bytes);
        cdr.header(stamped);
        cdr
    }

    fn header(&mut self, Stamped { t, frame }: Stamped) {
        let (seconds, nanos) = (t.0.div_euclid(NANOS), t.0.rem_euclid(NANOS));
        // Good for 68 years of scene.
        self.word(seconds as u32);
        self.word(nanos as u32);
        self.text(frame);
    }

    fn word(&mut self, word: u32) {
        self.align(4);
        self.0.extend_from_slice(&word.to_le_bytes());
    }

    /// A text: its length with the zero at its end, its bytes, the zero. One inside would end it for some readers.
    fn text(&mut self, text: &str) {
        let text = text.split('\0').next().unwrap_or_default();
        self.word(text.len() as u32 + 1);
        self.0.extend_from_slice(text.as_bytes());
        self.0.push(0);
    }

    /// Goes on at a multiple of so many bytes.
    fn align(&mut self, bytes: usize) {
        let length = (self.0.len() - ENCAPSULATION.len()).next_multiple_of(bytes);
        self.0.resize(ENCAPSULATION.len() + length, 0);
    }

    fn doubles(&mut self, values: &[f64]) {
        self.align(8);
        // A zero has no sign here, as in every file of a dataset.
        values.iter().for_each(|value| self.0.extend_from_slice(&(value + 0.0).to_le_bytes()));
    }

    /// Unknown; or, of something that the message does not hold, −1 to say so.
    fn covariance(&mut self, holds: bool) {
        let mut covariance = [0.0; 9];
        covariance[0] = if holds { 0.0 } else { -1.0 };
        self.doubles(&covariance);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bytes from words of hex digits; `"text"` stands for its own bytes.
    fn hex(words: &str) -> Vec<u8> {
        let word = |word: &str| match word.strip_prefix('"') {
            Some(text) => text.trim_end_matches('"').bytes().collect::<Vec<_>>(),
            None => {
                (0..word.len()).step_by(2).map(|i| u8::from_str_radix(&word[i..i + 2], 16).unwrap()).collect()
            }
        };
        words.split_whitespace().flat_map(word).collect()
    }

    const ZERO: &str = "0000000000000000";
    const ONE: &str = "000000000000f03f";

    #[test]
    fn each_frame_of_a_message_begins_where_its_numbers_may() {
        let at = |frame| Stamped { t: SimTime(3_000_000_258), frame };
        let frames = [
            Turned { stamped: at("map"), child: "b", attitude: [0.0, 1.0, -0.0, 0.0] },
            Turned { stamped: at("b"), child: "cd", attitude: [1.0, 0.0, 0.0, 0.0] },
        ];
        let mut bytes = vec![7];
        transforms(&frames, &mut bytes);
        // Two; the time, the frame, the child, which leave the first's numbers at 32 and the second's at 112.
        let first = format!(
            "03000000 02010000 04000000 \"map\" 00 02000000 \"b\" 00 000000000000 {ZERO} {ZERO} {ZERO} {ONE} {ZERO} {ZERO} {ZERO}"
        );
        let second = format!(
            "03000000 02010000 02000000 \"b\" 00 0000 03000000 \"cd\" 00 00 {ZERO} {ZERO} {ZERO} {ZERO} {ZERO} {ZERO} {ONE}"
        );
        assert_eq!(bytes, hex(&format!("00010000 02000000 {first} {second}")));
    }

    #[test]
    fn texts_have_their_bytes_counted_and_end_with_a_zero() {
        let status = Status {
            name: "µ".into(),
            level: 1,
            message: "a\0b".into(),
            values: vec![("k".into(), "vw".into())],
        };
        let mut bytes = Vec::new();
        diagnostics(Stamped { t: SimTime(0), frame: "m" }, &[status], &mut bytes);
        let header = "00010000 00000000 00000000 02000000 \"m\" 00 0000";
        let status = "01 000000 03000000 c2b5 00 00 02000000 \"a\" 00 0000 01000000 00 000000";
        let values = "01000000 02000000 \"k\" 00 0000 03000000 \"vw\" 00";
        assert_eq!(bytes, hex(&format!("{header} 01000000 {status} {values}")));
    }
}
