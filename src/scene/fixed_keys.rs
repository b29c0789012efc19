//! The keys that a scene knows besides those which motions and error terms declare: name and meaning, for
//! `ratetable list keys`.

use crate::sensor::SensorKind;

/// Table, key, meaning; the scene itself is the table `""`.
pub const FIXED_KEYS: &[(&str, &str, &str)] = &[
    ("", "name", "name in reports and datasets (default: the file's name)"),
    ("", "seed", "seed of every random number, a whole number (default 0)"),
    (
        "",
        "duration",
        "how long the scene lasts (default: the sum of its motions); after the last motion the vehicle holds",
    ),
    ("", "axes", "\"ned-frd\" (default) or \"enu-flu\": the axes of this file and its datasets"),
    ("", "limits", "limits on the report, such as [\"sensors.gyro.late_us.p99<200\"]"),
    (
        "sweep",
        "\"gyro.rate\"",
        "values of any key, named as for --set, across the runs of `generate --runs`: [\"1 kHz\", \"2 kHz\"], every combination of the lists in turn, or { uniform = [low, high] }, drawn for each run",
    ),
    ("start", "attitude", "roll, pitch, yaw at t = 0: \"[0, 0, 0] deg\""),
    ("start", "quaternion", "or instead [w, x, y, z], body to nav"),
    (
        "start",
        "velocity",
        "ground velocity at t = 0, a nav vector: \"[15, 0, 0] m/s\" (default: the first motion's own speed along the heading, 0 where it has none); [baro], [gps] and [airspeed] use it",
    ),
    ("earth", "gravity", "its magnitude, or the free-fall acceleration as a nav vector: \"9.80665 m/s^2\""),
    ("earth", "field", "the magnetic field, a nav vector: \"[20, 0, 45] uT\""),
    (
        "earth",
        "wind",
        "the velocity of the air over the ground, a nav vector: \"[0, 5, 0] m/s\" blows to the east in ned",
    ),
    (
        "earth",
        "latitude",
        "of a place, which sets normal gravity (WGS 84) and the field (World Magnetic Model)",
    ),
    ("earth", "longitude", "of the place, east positive"),
    ("earth", "altitude", "above the ellipsoid"),
    ("earth", "date", "day of the magnetic field: \"2026-11-22\""),
    ("motion", "kind", "one of `ratetable list motions`"),
    ("motion", "duration", "how long the motion lasts"),
    ("force", "start", "when it begins"),
    ("force", "duration", "how long it acts"),
    ("force", "acceleration", "a vector in `frame`"),
    ("force", "frame", "\"body\" (default) or \"nav\""),
    ("setting", "sensor", "the sensor's table, such as \"gyro\""),
    (
        "setting",
        "start",
        "from when on: the sensor's first tick at or after it begins the new rate (default 0 s)",
    ),
    ("setting", "rate", "its rate from then on, or \"off\" while it takes no samples (default: as before)"),
    (
        "setting",
        "range",
        "and so `resolution`, `filter` (or \"none\") and `delay`: as in the sensor's table (default: as before; a part fills in the counts of a range)",
    ),
    ("fault", "sensor", "the sensor's table, such as \"gyro\" or \"baro\""),
    (
        "fault",
        "output",
        "for packet faults: the output's `to`, or its number in the scene, from 0 (default: every output)",
    ),
    (
        "fault",
        "kind",
        "for a sensor \"off\", \"stuck\", \"garbage\", \"wrong\", \"slow\", \"delayed\", \"intermittent\", \"spike\", \"step\" or \"ramp\"; for packets \"drop\", \"corrupt\", \"duplicate\", \"reorder\", \"stall\" or \"split\"",
    ),
    ("fault", "start", "when it begins"),
    ("fault", "duration", "how long it lasts (default: to the end)"),
    (
        "fault",
        "size",
        "for `spike`, `step`, `ramp`: the value added; for `garbage`: its bound (default: the range)",
    ),
    (
        "fault",
        "share",
        "for `spike` and `intermittent`: the share of samples affected; for packet faults except `stall`: the share of packets",
    ),
    ("fault", "bits", "for `corrupt`: bits flipped in a packet (default 1)"),
    (
        "fault",
        "hurts",
        "for `corrupt`: \"packet\" (default) flips bits inside it only; \"framing\" flips framing bits too and can damage the next packet",
    ),
    ("fault", "pieces", "for `split`: how many pieces a packet is sent in (default 2)"),
    ("fault", "gap", "for `split`: the time between pieces (default \"1 ms\")"),
    ("fault", "every", "for `slow`: one sample in this many (default 10)"),
    ("fault", "delay", "for `delayed`: the age of a reading"),
    (
        "reference",
        "from",
        "\"gyro\" (default) or \"accel-mag\": the error-free readings that reference.csv is computed from",
    ),
    (
        "reference",
        "method",
        "how the gyro is stepped: one of `ratetable list methods` (default \"paper\"), or \"auto\": the cheapest within `tolerance`",
    ),
    ("reference", "rate", "samples per second for a named method (default: the gyro's rate)"),
    (
        "reference",
        "tolerance",
        "for method = \"auto\": the largest angle from the truth (default \"0.001 deg\")",
    ),
    ("output", "to", "PROTOCOL@LINK, such as \"mpu@pty\""),
    (
        "output",
        "layout",
        "for `mpu`: \"separate\" or \"burst\" (default: burst where gyro and accel tick together)",
    ),
    (
        "output",
        "version",
        "for `mavlink`: 1 or 2 (default); for `betaflight` its release: \"2026.6\" (default; and later), \"2026.6-legacy\" (built with ENABLE_GAZEBO_BRIDGE=0), \"2025.12\" or \"4.5\"",
    ),
    (
        "output",
        "messages",
        "for `mavlink`, in addition to HIL_SENSOR: any of [\"HIL_STATE_QUATERNION\", \"ATTITUDE_QUATERNION\", \"HIGHRES_IMU\", \"RAW_IMU\", \"SCALED_IMU2\"], 50 Hz each",
    ),
    (
        "output",
        "attitude",
        "for `ilabs` and `sbg`, the attitude told beside the readings: \"level\" (default), which is false once the vehicle moves, or \"truth\"",
    ),
    (
        "output",
        "mag_unit",
        "for `sbg`, the unit of the magnetic field: \"milligauss\" (default), which ArduPilot takes it for, or \"gauss\", which PX4 does",
    ),
    (
        "output",
        "answers",
        "for `betaflight`: where it answers MSP (default: TCP port 5761 of the machine in `to`, such as \"tcpout:127.0.0.1:5761\"); for `px4-sitl`: where it tells its attitude (default: \"udpin:127.0.0.1:14550\")",
    ),
    (
        "output",
        "pace",
        "whether a pty with a baud rate, such as \"mpu@pty,115200\", has the timing of a UART (default true)",
    ),
    (
        "output",
        "overload",
        "what to do with a packet that the link does not accept in time: \"drop-newest\" (default), \"drop-oldest\", or \"stretch\", which stops scene time",
    ),
    (
        "output",
        "send",
        "false: no readings are sent, and the attitude that the other side tells there is scored (default true)",
    ),
    (
        "output",
        "chip",
        "for `bus`: the part whose registers sensors without a part of their own have, such as \"MPU-9250\"",
    ),
    ("output", "force", "true: start even if the baud rate is too low for the packets (default false)"),
];

/// Whether a sensor has one of [`SENSOR_KEYS`]: only triads are parts on a chip's axes that may integrate.
pub fn takes(sensor: SensorKind, key: &str) -> bool {
    sensor.is_triad() || !["sampling", "mount", "part", "address"].contains(&key)
}

/// Keys of every sensor besides its error terms'.
pub const SENSOR_KEYS: &[(&str, &str)] = &[
    ("rate", "output data rate, such as \"1 kHz\" or \"400/3 Hz\" ([gps] defaults to \"5 Hz\")"),
    ("phase", "when tick 0 is due (default \"0 s\")"),
    ("sampling", "\"point\" (default), or \"average\" over the interval that ends at the tick"),
    ("address", "where the sensor's chip answers on a bus, 7 bits, such as 0x69 (default: its usual one)"),
    ("mount", "where the chip's x, y and z point, such as \"flu\", or a quaternion from body to chip"),
    ("part", "take values from a datasheet: one of `ratetable list parts`; other keys override them"),
];
