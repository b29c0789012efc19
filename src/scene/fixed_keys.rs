//! The keys that a scene knows besides those which motions and error terms declare: name and meaning, for
//! `ratetable list keys`.

use crate::sensor::SensorKind;

/// Table, key, meaning; the scene itself is the table `""`.
pub const FIXED_KEYS: &[(&str, &str, &str)] = &[
    ("", "name", "what reports and datasets call it (default: the file's name)"),
    ("", "seed", "from which every random number comes, a whole number (default 0)"),
    (
        "",
        "duration",
        "how long it lasts (default: the sum of its motions); after the last motion the vehicle holds",
    ),
    ("", "axes", "\"ned-frd\" (default) or \"enu-flu\": how this file and its datasets are written"),
    ("", "limits", "of the report, such as [\"sensors.gyro.late_us.p99<200\"]"),
    (
        "sweep",
        "\"gyro.rate\"",
        "that key or any other, as --set names it: its values from run to run of `generate --runs`: [\"1 kHz\", \"2 kHz\"], every combination of the lists in turn, or { uniform = [low, high] }, drawn for each run",
    ),
    ("start", "attitude", "roll, pitch, yaw at t = 0: \"[0, 0, 0] deg\""),
    ("start", "quaternion", "instead: [w, x, y, z], body to nav"),
    (
        "start",
        "velocity",
        "over the ground at t = 0, a nav vector: \"[15, 0, 0] m/s\" (default: the first motion's own speed along the heading, 0 where it has none); for [baro] and [gps]",
    ),
    ("earth", "gravity", "its strength, or the acceleration of free fall as a nav vector: \"9.80665 m/s^2\""),
    ("earth", "field", "the magnetic field, a nav vector: \"[20, 0, 45] uT\""),
    ("earth", "latitude", "of a place: normal gravity (WGS 84) and the field (World Magnetic Model)"),
    ("earth", "longitude", "of the place, east positive"),
    ("earth", "altitude", "above the ellipsoid"),
    ("earth", "date", "on which the field is wanted: \"2026-11-22\""),
    ("motion", "kind", "one of `ratetable list motions`"),
    ("motion", "duration", "of the segment"),
    ("force", "start", "when it begins"),
    ("force", "duration", "how long it acts"),
    ("force", "acceleration", "a vector in `frame`"),
    ("force", "frame", "\"body\" (default) or \"nav\""),
    ("fault", "sensor", "a table of a sensor, such as \"gyro\" or \"baro\""),
    (
        "fault",
        "output",
        "of a fault of packets: the output's `to`, or its place in the scene from 0 on (default: every output)",
    ),
    (
        "fault",
        "kind",
        "of a sensor \"off\", \"stuck\", \"garbage\", \"wrong\", \"slow\", \"delayed\", \"intermittent\", \"spike\", \"step\" or \"ramp\"; of packets \"drop\", \"corrupt\", \"duplicate\", \"reorder\", \"stall\" or \"split\"",
    ),
    ("fault", "start", "when it begins"),
    ("fault", "duration", "how long it lasts (default: to the end)"),
    (
        "fault",
        "size",
        "of `spike`, `step`, `ramp`: what is added; of `garbage`: its bound (default the range)",
    ),
    (
        "fault",
        "share",
        "of `spike` and `intermittent`: how many of the samples; of faults of packets but `stall`: how many of these",
    ),
    ("fault", "bits", "of `corrupt`: how many are flipped in a packet (default 1)"),
    (
        "fault",
        "hurts",
        "of `corrupt`: \"packet\" (default), its inside, or \"framing\" too, which may cost a neighbour",
    ),
    ("fault", "pieces", "of `split`: in how many a packet goes out (default 2)"),
    ("fault", "gap", "of `split`: the time from piece to piece (default \"1 ms\")"),
    ("fault", "every", "of `slow`: one sample in so many (default 10)"),
    ("fault", "delay", "of `delayed`: how old a reading is"),
    (
        "reference",
        "from",
        "\"gyro\" (default) or \"accel-mag\": which error-free readings reference.csv is computed from",
    ),
    (
        "reference",
        "method",
        "how the gyro is stepped: one of `ratetable list methods` (default \"paper\"), or \"auto\": the cheapest that will do",
    ),
    ("reference", "rate", "samples that a method by name reads a second (default: the gyro's rate)"),
    (
        "reference",
        "tolerance",
        "of method = \"auto\": the largest angle from the truth (default \"0.001 deg\")",
    ),
    ("output", "to", "PROTOCOL@LINK, such as \"mpu@pty\""),
    (
        "output",
        "layout",
        "of `mpu`: \"separate\" or \"burst\" (default: burst where gyro and accel tick alike)",
    ),
    ("output", "version", "of `mavlink`: 1 or 2 (default)"),
    (
        "output",
        "messages",
        "of `mavlink`, beside HIL_SENSOR: any of [\"HIL_STATE_QUATERNION\", \"ATTITUDE_QUATERNION\", \"HIGHRES_IMU\", \"RAW_IMU\", \"SCALED_IMU2\"], 50 Hz each",
    ),
    (
        "output",
        "pace",
        "whether a pty with a baud rate, such as \"mpu@pty,115200\", takes the time of a UART (default true)",
    ),
    (
        "output",
        "overload",
        "what becomes of a packet that the link does not take in time: \"drop-newest\" (default), \"drop-oldest\", or \"stretch\", for which scene time stands still",
    ),
    ("output", "force", "true: start although the baud rate does not carry the packets (default false)"),
];

/// Whether a sensor has one of [`SENSOR_KEYS`]: only triads are parts on a chip's axes that may integrate.
pub fn takes(sensor: SensorKind, key: &str) -> bool {
    sensor.is_triad() || !["sampling", "mount", "part"].contains(&key)
}

/// Keys of every sensor besides its error terms'.
pub const SENSOR_KEYS: &[(&str, &str)] = &[
    ("rate", "output data rate, such as \"1 kHz\" or \"400/3 Hz\" (of [gps] \"5 Hz\" by default)"),
    ("phase", "when tick 0 is due (default \"0 s\")"),
    ("sampling", "\"point\" (default), or \"average\" over the interval that ends at the tick"),
    ("mount", "where the chip's x, y and z point, such as \"flu\", or a quaternion from body to chip"),
    ("part", "fill from a datasheet: one of `ratetable list parts`; keys beside it override"),
];
