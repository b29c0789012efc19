//! What is said of scenes that are wrong: where, why, and what would be right; each mistake once and no others.

use super::Plan;
use super::tests::plan;
use proptest::prelude::*;

/// A scene, and every mistake expected of it in order: its place and, separated by `|`, what it must say.
type Case<'a> = (&'a str, &'a [(&'a str, &'a str)]);

/// A gyro whose keys begin on line 4.
macro_rules! gyro {
    ($keys:literal) => {
        concat!("duration = \"1 s\"\n[gyro]\nrate = \"1 kHz\"\n", $keys)
    };
}

/// A motion whose keys begin on line 4, and a gyro.
macro_rules! motion {
    ($keys:literal) => {
        concat!("gyro = { rate = \"1 kHz\" }\n\n[[motion]]\n", $keys)
    };
}

/// `[earth]` whose keys begin on line 4, and a gyro.
macro_rules! earth {
    ($keys:literal) => {
        concat!("gyro = { rate = \"1 kHz\" }\nduration = \"1 s\"\n[earth]\n", $keys)
    };
}

const KEYS: &[Case] = &[
    (
        gyro!("nois_std = \"1 rad/s\""),
        &[("4:1", "`nois_std` is not a key of [gyro]: did you mean `noise_std`?")],
    ),
    (gyro!("Range = \"1 rad/s\""), &[("4:1", "`Range`|did you mean `range`?")]),
    (gyro!("wind = \"3 m/s\""), &[("4:1", "`wind` belongs to [earth]")]),
    (gyro!("xyzzy = 1"), &[("4:1", "`xyzzy` is not a key of [gyro], which has|rate, |noise_std")]),
    ("sed = 1\n[mag]\nrate = \"1 Hz\"\n", &[("1:1", "`sed` is not a key of a scene: did you mean `seed`?")]),
    (
        "duration = \"1 s\"\n[gyroscope]\nrate = \"1 Hz\"\n",
        &[("2:2", "`gyroscope` is not a key of a scene: did you mean `gyro`?")],
    ),
    ("[[motions]]\nkind = \"hold\"\n[mag]\nrate = \"1 Hz\"\n", &[("1:3", "did you mean `motion`?")]),
    (
        gyro!("[start]\natitude = \"0 deg\"\n"),
        &[("5:1", "`atitude` is not a key of [start]: did you mean `attitude`?")],
    ),
    (earth!("latitud = \"1 deg\""), &[("4:1", "not a key of [earth]: did you mean `latitude`?")]),
    (
        motion!("kind = \"hold\"\nduratoin = \"1 s\"\nduration = \"1 s\""),
        &[("5:1", "not a key of a `hold` motion: did you mean `duration`?")],
    ),
    (
        motion!("kind = \"rotate\"\nroll = \"1 deg/s\"\nduration = \"1 s\"\nhalf_angle = \"1 deg\""),
        &[(
            "7:1",
            "`half_angle` is not a key of a `rotate` motion, which has kind, duration, angular_rate, roll, pitch, yaw",
        )],
    ),
    (
        motion!(
            "kind = \"hold\"\nduration = \"1 s\"\n[[force]]\nduration = \"1 s\"\nacceleration = \"1 m/s^2\"\nframes = \"nav\""
        ),
        &[("9:1", "not a key of [[force]]: did you mean `frame`?")],
    ),
    (
        gyro!("[[output]]\nto = \"mpu@pty\"\nlayot = \"burst\""),
        &[("6:1", "not a key of [[output]]: did you mean `layout`?")],
    ),
    (gyro!("gyroscope_noise_density = 1e-4"), &[("4:1", "Kalibr|`angle_random_walk`")]),
    (gyro!("NoiseDensity = \"1 deg/s/√Hz\""), &[("4:1", "MATLAB|`noise_density`")]),
    (gyro!("AxesMisalignment = 1"), &[("4:1", "`misalignment`")]),
    (gyro!("odr = \"1 kHz\""), &[("4:1", "`odr` is spelled `rate` here")]),
    (gyro!("velocity_random_walk = \"1 m/s/√h\""), &[("4:1", "a gyro has `angle_random_walk`")]),
    (
        gyro!("[mag]\nrate = \"1 Hz\"\nangle_random_walk = \"1 deg/√h\""),
        &[("6:1", "does not apply to a magnetometer|`noise_density`")],
    ),
    (
        motion!("kind = \"rotate\"\nroll = \"1 deg/s\"\nduration = \"1 s\"\nfrequency = \"1 Hz\""),
        &[("7:1", "`frequency` is not a key of a `rotate` motion")],
    ),
];

const UNITS: &[Case] = &[
    (
        gyro!("noise_std = 0.01"),
        &[("4:13", "`noise_std`: `0.01` has no unit: write \"0.01 rad/s\" or \"0.01 deg/s\"")],
    ),
    (gyro!("noise_std = \"0.01\""), &[("4:14", "`0.01` has no unit")]),
    (gyro!("bias = [1, 2, 3]"), &[("4:8", "`bias`: `[1, 2, 3]` has no unit: write \"[1, 2, 3] rad/s\"")]),
    (
        gyro!("bias = [\"1 rad/s\", \"2 rad/s\", \"3 rad/s\"]"),
        &[("4:8", "`bias` is an array; write a string with a unit, such as \"[1, 2, 3] rad/s\"")],
    ),
    (
        "duration = 5\n[gyro]\nrate = 1000\n",
        &[
            ("1:12", "`duration`: `5` has no unit: write \"5 s\""),
            ("3:8", "`rate`: `1000` has no unit: write \"1000 Hz\""),
        ],
    ),
    (
        gyro!("bias = \"3 uT\""),
        &[(
            "4:11",
            "`bias`: `3 uT` is a magnetic field, but an angular rate is required, such as \"20 deg/s\"",
        )],
    ),
    (
        gyro!("noise_density = \"0.01 deg/s\""),
        &[("4:23", "is an angular rate, but a gyro noise density is required, such as \"0.01 deg/s/rtHz\"")],
    ),
    (gyro!("bias = \"3 degs/s\""), &[("4:11", "unknown unit `degs`: did you mean `deg")]),
    (
        "duration = \"1 s\"\n[gyro]\nrate = \"1 ms\"\n",
        &[("3:11", "`1 ms` is a time, but a rate is required: write \"1000 Hz\"")],
    ),
    (gyro!("noise_std = \"-1 deg/s\""), &[("4:14", "`noise_std`: `-1 deg/s` is negative|0 or above")]),
    (gyro!("bias_step_std = \"-1 deg/s\""), &[("4:18", "`bias_step_std`|is negative")]),
    (gyro!("bias_std = \"[1, -1, 0] deg/s\""), &[("4:13", "`bias_std`|is negative")]),
    (gyro!("noise_density = \"-0.01 deg/s/√Hz\""), &[("4:18", "is negative")]),
    (gyro!("bias = \"nan rad/s\""), &[("4:9", "`bias`: `nan` is not a finite number")]),
    (gyro!("bias = inf"), &[("4:8", "`inf` is not a finite number")]),
    (gyro!("bias = \"1e400 rad/s\""), &[("4:9", "too large")]),
    (gyro!("bias = \"[1, 2] rad/s\""), &[("4:9", "a vector has 3 values, not 2")]),
    (
        gyro!("bias = true"),
        &[("4:8", "`bias` is true or false; write a string with a unit, such as \"[1, 2, 3] rad/s\"")],
    ),
    (gyro!("bias = \"\""), &[("4:9", "`bias`: a value is missing: write, for example, \"20 deg/s\"")]),
    ("duration = \"1 s\"\n[gyro]\nrate = \"2 MHz\"\n", &[("3:9", "`2 MHz` is above 1 MHz")]),
    ("duration = \"1 s\"\n[gyro]\nrate = \"0 Hz\"\n", &[("3:9", "`0 Hz` is not above zero")]),
    (gyro!("phase = \"-1 ms\""), &[("4:10", "`phase`|is negative")]),
];

const SENSORS: &[Case] = &[
    (
        "duration = \"1 s\"\n[gyro]\nbias = \"1 rad/s\"\n",
        &[("2:1", "[gyro] needs a rate, such as rate = \"100 Hz\"")],
    ),
    (
        gyro!("noise_std = \"1 rad/s\"\nnoise_density = \"1 rad/s/√Hz\""),
        &[("5:17", "`noise_density`: the gyro's white noise is already given by `noise_std`: keep only one")],
    ),
    (
        gyro!("bias_instability = \"1 deg/h\""),
        &[(
            "4:20",
            "`bias_instability` needs a `correlation_time` too, such as \"500 s\"|`bias_random_walk`",
        )],
    ),
    (
        gyro!("bias_instability = \"1 deg/h\"\ncorrelation_time = \"0 s\""),
        &[("5:20", "`correlation_time`: a correlation time must be above 0|`noise_std`")],
    ),
    (
        gyro!("bias_instability = \"1 deg/h\"\ncorrelation_time = \"inf s\""),
        &[("5:21", "`inf` is not a finite number: for a bias without bound use `bias_random_walk`")],
    ),
    (
        gyro!("bias_instability = \"1 deg/h\"\ncorrelation_time = inf"),
        &[("5:20", "not a finite number|`bias_random_walk`")],
    ),
    (gyro!("range = \"0 rad/s\""), &[("4:10", "`range`: `0 rad/s` is not above zero")]),
    (gyro!("resolution = \"16 bit\""), &[("4:14", "`resolution`: bits also need a `range`")]),
    (gyro!("resolution = \"1.5 bit\""), &[("4:15", "not a whole number of bits")]),
    (
        gyro!("range = \"1 rad/s\"\nresolution = \"2 rad/s\""),
        &[("5:14", "one count, 2 rad/s, is more than the whole range of ±1 rad/s")],
    ),
    (gyro!("mount = \"frx\""), &[("4:9", "`frx` is not a right-handed mount|\"flu\"")]),
    (gyro!("mount = \"fru\""), &[("4:9", "right-handed")]),
    (gyro!("mount = [1, 1, 0, 0]"), &[("4:9", "`mount`: [1, 1, 0, 0] has the length 1.4142")]),
    (
        gyro!("mount = 3"),
        &[("4:9", "`mount` is a bare number; write three letters, such as \"flu\", or a quaternion")],
    ),
    (
        gyro!("sampling = \"avarage\""),
        &[("4:12", "`sampling` takes point or average, not `avarage`; did you mean `average`?")],
    ),
    (gyro!("part = \"MPU9250\""), &[("4:8", "`MPU9250` is not a known part|did you mean `MPU-9250`?")]),
    (
        "duration = \"1 s\"\n[mag]\nrate = \"1 Hz\"\npart = \"MPU-6050\"\n",
        &[("4:8", "`MPU-6050` has no mag; parts that have one: MPU-9250")],
    ),
    (
        gyro!("part = \"MPU-9250\"\nrange = \"300 deg/s\""),
        &[(
            "5:9",
            "the part has no such range: choose one of 250 deg/s, 500 deg/s, 1000 deg/s, 2000 deg/s, or add a `resolution`",
        )],
    ),
    (gyro!("part = \"MPU-9250\"\nrange = 300"), &[("5:9", "`range`: `300` has no unit")]),
    (
        gyro!("noise_std = { unifrom = [\"1 rad/s\", \"2 rad/s\"] }"),
        &[("4:13", "a drawn value is { uniform = [low, high] } or { normal = [mean, std] }")],
    ),
    (
        gyro!("noise_std = { uniform = [\"1 rad/s\"] }"),
        &[("4:25", "`noise_std`: `uniform` takes two values, not 1")],
    ),
    (gyro!("noise_std = { uniform = [\"2 rad/s\", \"1 rad/s\"] }"), &[("4:25", "lower end first")]),
    (gyro!("noise_std = { normal = [\"1 rad/s\", \"-1 rad/s\"] }"), &[("4:37", "is negative")]),
    (gyro!("noise_std = { uniform = [1, 2] }"), &[("4:26", "`1` has no unit"), ("4:29", "`2` has no unit")]),
    ("duration = \"1 s\"\ngyro = 5\n", &[("2:8", "`gyro` is a bare number; write it as one table, [gyro]")]),
    (
        "duration = \"1 s\"\n[[gyro]]\nrate = \"1 Hz\"\n",
        &[("2:1", "`gyro` is an array; write it as one table, [gyro]")],
    ),
    ("duration = \"1 s\"\n", &[("1:1", "at least one sensor, [gyro], [accel], [mag], [baro] or [gps]")]),
];

const MOTIONS: &[Case] = &[
    (motion!("kind = \"replay\""), &[("4:8", "`replay` needs a `file`, such as file = \"log.csv\"")]),
    (motion!("kind = \"replay\"\nfile = 3"), &[("5:8", "`file` is a bare number; write it as a string")]),
    (
        motion!("kind = \"replay\"\nfile = \"none/there.csv\""),
        &[("5:8", "`file` cannot read none/there.csv: No such file")],
    ),
    (
        "[gyro]\nrate = \"1 Hz\"\n",
        &[("1:1", "a scene needs a motion or a duration, such as duration = \"10 s\"")],
    ),
    ("", &[("1:1", "at least one sensor"), ("1:1", "a motion or a duration")]),
    ("duration = \"0 s\"\n[gyro]\nrate = \"1 Hz\"\n", &[("1:13", "`0 s` is not above zero")]),
    ("duration = \"-1 s\"\n[gyro]\nrate = \"1 Hz\"\n", &[("1:13", "`-1 s` is not above zero")]),
    ("duration = \"300 y\"\n[gyro]\nrate = \"1 Hz\"\n", &[("1:17", "unknown unit `y`")]),
    (
        motion!("kind = \"spin\"\nduration = \"1 s\"\nspeed = 3"),
        &[("4:8", "`spin` is not a kind of motion; the kinds are hold, rotate, cone, circle")],
    ),
    (motion!("kind = \"rotat\"\nduration = \"1 s\""), &[("4:8", "did you mean `rotate`?")]),
    (
        motion!("duration = \"1 s\""),
        &[("3:1", "a motion needs a kind, such as kind = \"rotate\", one of hold, rotate, cone, circle")],
    ),
    (motion!("kind = \"hold\""), &[("3:1", "a motion needs a duration, such as duration = \"5 s\"")]),
    (motion!("kind = \"hold\"\nduration = \"0 s\""), &[("5:13", "not above zero")]),
    (
        motion!("kind = \"rotate\"\nduration = \"1 s\""),
        &[(
            "4:8",
            "`rotate` needs `angular_rate`, or one of `roll`, `pitch` and `yaw`, such as roll = \"30 deg/s\"",
        )],
    ),
    (
        motion!("kind = \"rotate\"\nroll = \"1 deg/s\"\nyaw = \"1 deg/s\"\nduration = \"1 s\""),
        &[("6:7", "`rotate` takes one of|`angular_rate`")],
    ),
    (
        motion!("kind = \"rotate\"\nroll = { uniform = [\"1 deg/s\", \"2 deg/s\"] }\nduration = \"1 s\""),
        &[("5:8", "`roll` is a table; write a string with a unit")],
    ),
    (
        motion!("kind = \"circle\"\nbank = \"25 deg\"\nduration = \"1 s\""),
        &[("4:8", "`circle` needs both `bank`, such as \"25 deg\", and `speed`")],
    ),
    (
        motion!("kind = \"circle\"\nbank = \"90 deg\"\nspeed = \"15 m/s\"\nduration = \"10 s\""),
        &[("5:8", "`bank`: a coordinated turn has a bank between -90 and 90 deg, not 90 deg")],
    ),
    (
        motion!("kind = \"circle\"\nbank = \"25 deg\"\nspeed = \"0 m/s\"\nduration = \"10 s\""),
        &[("6:10", "`speed`: `0 m/s` is not above zero")],
    ),
    (
        motion!("kind = \"circle\"\nbank = \"25 deg\"\nspeed = \"15 m/s\"\nduration = \"3 s\""),
        &[("3:1", "`entry`: rolling in and out takes 2 s each, which does not fit in the motion's 3 s")],
    ),
    (
        motion!("kind = \"circle\"\nbank = \"95 deg\"\nspeed = \"15 m/s\""),
        &[("3:1", "a motion needs a duration"), ("5:8", "between -90 and 90 deg, not 95 deg")],
    ),
    (
        motion!("kind = \"cone\"\nfrequency = \"-1 Hz\"\nhalf_angle = \"1 deg\"\nduration = \"1 s\""),
        &[("5:14", "`frequency`: `-1 Hz` is negative")],
    ),
    (
        "[motion]\nkind = \"hold\"\nduration = \"1 s\"\n[gyro]\nrate = \"1 Hz\"\n",
        &[("1:1", "`motion` is a table|[[motion]]")],
    ),
    (
        gyro!("[[force]]\nstart = \"1 s\"\n"),
        &[
            ("4:1", "a force needs its duration"),
            ("4:1", "a force needs its acceleration, such as acceleration = \"[0, 1.5, 0] m/s^2\""),
        ],
    ),
    (
        gyro!("[[force]]\nduration = \"1 s\"\nacceleration = \"1 m/s^2\"\nframe = \"world\"\n"),
        &[("7:9", "`frame` takes body or nav, not `world`")],
    ),
    (gyro!("[start]\nquaternion = [2, 0, 0, 0]\n"), &[("5:14", "has the length 2")]),
    (
        gyro!("[start]\nquaternion = [1, 0, 0]\n"),
        &[("5:14", "a quaternion is four numbers without a unit: [w, x, y, z]")],
    ),
    (
        gyro!("[start]\nquaternion = [1, 0, 0, 0]\nattitude = \"0 deg\"\n"),
        &[("5:14", "`attitude` is also given")],
    ),
];

const EARTH: &[Case] = &[
    (earth!("date = \"22.11.2026\""), &[("4:8", "`22.11.2026` is not a date: write it like \"2026-11-22\"")]),
    (earth!("date = \"2026-02-30\""), &[("4:8", "is not a date")]),
    (
        earth!("date = \"2050-01-01\"\nlatitude = \"1 deg\"\nlongitude = \"1 deg\""),
        &[("4:8", "World Magnetic Model has no field|give `field` itself")],
    ),
    (
        earth!("latitude = \"59.93 deg\"\nlongitude = \"30.31 deg\""),
        &[("4:12", "depends on the day: add a `date`, such as \"2026-11-22\", or give `field` itself")],
    ),
    (earth!("latitude = \"59.93 deg\""), &[("4:12", "a place needs a `longitude` too")]),
    (earth!("altitude = \"10 m\""), &[("4:12", "an altitude needs a `latitude` and a `longitude` too")]),
    (
        earth!("latitude = \"95 deg\"\nlongitude = \"0 deg\"\ndate = \"2026-11-22\""),
        &[("4:12", "`latitude`: 95 deg is beyond ±90 deg")],
    ),
    (
        earth!("altitude = \"900 km\"\nlatitude = \"5 deg\"\nlongitude = \"0 deg\"\ndate = \"2026-11-22\""),
        &[("4:12", "covers -1 km to 850 km")],
    ),
    (earth!("gravity = \"-9.8 m/s^2\""), &[("4:12", "`gravity`: `-9.8 m/s^2` is negative")]),
    (earth!("gravity = 9.8"), &[("4:11", "`gravity`: `9.8` has no unit: write \"9.8 m/s^2\" or \"9.8 g\"")]),
    (earth!("field = \"[1, 2, 3] T/s\""), &[("4:20", "magnetic field is required")]),
];

const REST: &[Case] = &[
    (
        gyro!("[[output]]\nto = \"mpu\"\n"),
        &[("5:6", "`mpu` is not PROTOCOL@LINK: write, for example, mpu@/dev/ttyACM0")],
    ),
    (
        gyro!("[[output]]\nto = \"mpuu@pty\"\n"),
        &[("5:6", "`mpuu` is not a protocol of this version (mpu, mavlink, |did you mean `mpu`?")],
    ),
    (
        gyro!("[reference]\nmethod = \"magnus\"\n"),
        &[("5:10", "`magnus` is not a method (euler, paper, |did you mean `magnus-4`?")],
    ),
    (
        gyro!("[reference]\nmethod = \"auto\"\nrate = \"1 Hz\"\ntolerance = \"0 deg\"\n"),
        &[("6:8", "`auto` chooses the rate itself"), ("7:14", "`0 deg` is not above zero")],
    ),
    (
        gyro!("[reference]\nmethod = \"rk4\"\ntolerance = \"1 deg\"\n"),
        &[("6:13", "`tolerance` needs method = \"auto\": `rk4` does not adapt to a tolerance")],
    ),
    (
        "duration = \"1 s\"\n[accel]\nrate = \"1 Hz\"\n[mag]\nrate = \"1 Hz\"\n[reference]\nfrom = \"accel-mag\"\nrate = \"2 Hz\"\n",
        &[("8:8", "needs from = \"gyro\": accel-mag has no steps")],
    ),
    (gyro!("[reference]\nfrom = \"gyros\"\n"), &[("5:8", "`from` takes gyro or accel-mag, not `gyros`")]),
    (gyro!("[reference]\nfrom = \"accel-mag\"\n"), &[("5:8", "needs both an [accel] and a [mag]")]),
    (
        "duration = \"1 s\"\n[mag]\nrate = \"1 Hz\"\n[reference]\n",
        &[("4:1", "a reference from the gyro needs a [gyro] with its rate")],
    ),
    (
        "duration = \"1 s\"\naccel = { rate = \"1 Hz\" }\nmag = { rate = \"1 Hz\" }\nreference = { from = \"accel-mag\" }\n[earth]\nfield = \"[0, 0, 50] uT\"\n",
        &[("4:22", "accel-mag gives no attitude here: the magnetic field is along the specific force")],
    ),
    (
        gyro!("[reference]\nmetod = \"paper\"\n"),
        &[("5:1", "not a key of [reference]: did you mean `method`?")],
    ),
    (gyro!("[[output]]\nlayout = \"burst\"\n"), &[("4:1", "an output needs a destination")]),
    (
        gyro!("[[output]]\nto = \"mpu\"\nlayout = \"brst\"\n"),
        &[("5:6", "is not PROTOCOL@LINK"), ("6:10", "did you mean `burst`?")],
    ),
    (gyro!("[[output]]\n"), &[("4:1", "an output needs a destination, such as to = \"mpu@pty\"")]),
    (
        gyro!("[[output]]\nto = \"mpu@pty\"\nlayout = \"burst\"\n"),
        &[("6:10", "`layout = \"burst\"` needs both [gyro] and [accel]")],
    ),
    (
        gyro!("[accel]\n[[output]]\nto = \"mpu@pty\"\nlayout = \"burst\"\n"),
        &[("4:1", "[accel] needs a rate")],
    ),
    (
        gyro!("[[output]]\nto = \"mpu@pty\"\nattitude = \"truth\"\n"),
        &[("6:12", "`attitude` is for `ilabs` and `sbg`, not for `mpu`")],
    ),
    (
        gyro!("[[output]]\nto = \"sbg@pty\"\nattitude = \"true\"\nmag_unit = \"uT\"\n"),
        &[("6:12", "takes level or truth, not `true`"), ("7:12", "takes milligauss or gauss, not `uT`")],
    ),
    (
        gyro!("[[output]]\nto = \"ilabs@pty\"\nmag_unit = \"gauss\"\n"),
        &[("6:12", "`mag_unit` is for `sbg`, not for `ilabs`")],
    ),
    (gyro!("[[output]]\nto = \"csv@-\"\nlayout = \"burst\"\n"), &[("6:10", "is for `mpu`, not for `csv`")]),
    (
        gyro!("[[output]]\nto = \"mpu@pty\"\nversion = 1\nmessages = []\n"),
        &[
            ("6:11", "is for `mavlink` and `betaflight`, not for `mpu`"),
            ("7:12", "is for `mavlink`, not for `mpu`"),
        ],
    ),
    (
        gyro!("[[output]]\nto = \"betaflight\"\nversion = \"2025.6\"\nmessages = []\n"),
        &[("6:11", "|2025.12"), ("7:12", "is for `mavlink`, not for `betaflight`")],
    ),
    (
        gyro!(
            "[[output]]\nto = \"betaflight\"\nanswers = \"udpout:127.0.0.1:1\"\n[[output]]\nto = \"inav@pty\"\nanswers = \"tcpout:127.0.0.1:1\"\n"
        ),
        &[("6:11", "takes tcpout:ADDR:PORT"), ("9:11", "is for `betaflight` and `px4-sitl`, not for `inav`")],
    ),
    (
        gyro!("[[output]]\nto = \"mavlink@pty\"\nversion = 3\nmessages = [\"RAW_IMU\", \"RAW_IMUS\"]\n"),
        &[("6:11", "is 3; MAVLink has 1 and 2"), ("7:24", "did you mean `RAW_IMU`?")],
    ),
    (
        gyro!("[[output]]\nto = \"mpu@pty\"\npace = true\n"),
        &[("6:8", "`pace` needs a baud rate: write to = \"mpu@pty,115200\"")],
    ),
    (
        gyro!("[[output]]\nto = \"mpu@/dev/ttyUSB0,115200\"\npace = true\n"),
        &[("6:8", "`pace` is only for a pty: a serial port has its own timing")],
    ),
    (
        gyro!("[[output]]\nto = \"mpu@tcpin:4560\"\npace = true\n"),
        &[("6:8", "`pace` is for a pty with a baud rate, not for `tcpin:127.0.0.1:4560`")],
    ),
    (
        gyro!("[[output]]\nto = \"mpu@pty,115200\"\npace = \"yes\"\nforce = 1\n"),
        &[("6:8", "`pace` is a string; write true or false"), ("7:9", "`force` is a|write true or false")],
    ),
    (
        gyro!("[[output]]\nto = \"mpu@pty\"\noverload = \"drop-old\"\n"),
        &[(
            "6:12",
            "takes drop-newest or drop-oldest or stretch, not `drop-old`; did you mean `drop-oldest`?",
        )],
    ),
    (
        gyro!("[[output]]\nto = \"mpu@pty,fast\"\n"),
        &[("5:6", "`fast` is not a baud rate (50 to 20000000); say pty,921600")],
    ),
    (
        "seed = -1\nduration = \"1 s\"\n[gyro]\nrate = \"1 Hz\"\n",
        &[("1:8", "`seed` is -1; write a whole number from 0")],
    ),
    (
        "seed = \"x\"\nduration = \"1 s\"\n[gyro]\nrate = \"1 Hz\"\n",
        &[("1:8", "`seed` is a string; write a whole number")],
    ),
    (
        "name = 5\nduration = \"1 s\"\n[gyro]\nrat = \"1 Hz\"\n",
        &[
            ("1:8", "`name` is a bare number; write it as a string"),
            ("3:1", "needs a rate"),
            ("4:1", "did you mean `rate`?"),
        ],
    ),
    (
        "axes = \"ned\"\nduration = \"1 s\"\n[gyro]\nrate = \"1 Hz\"\n",
        &[("1:8", "`axes` takes ned-frd or enu-flu, not `ned`; did you mean `ned-frd`?")],
    ),
    (
        "limits = \"a<1\"\nduration = \"1 s\"\n[gyro]\nrate = \"1 Hz\"\n",
        &[("1:10", "`limits` is a string; write an array of strings")],
    ),
    (
        "limits = [1]\nduration = \"1 s\"\n[gyro]\nrate = \"1 Hz\"\n",
        &[("1:11", "`limits` holds strings, not a bare number")],
    ),
    (
        "start = \"level\"\nduration = \"1 s\"\n[gyro]\nrate = \"1 Hz\"\n",
        &[("1:9", "`start` is a string; write it as one table, [start]")],
    ),
    ("this is a sentence\n", &[("1:6", "this is not TOML")]),
    (
        gyro!("bias = 3 deg/s\n"),
        &[("4:8", "this is not TOML: a value with a unit stands in quotation marks, bias = \"3 deg/s\"")],
    ),
    (gyro!("rate = \"2 kHz\"\n"), &[("4:1", "`rate` is given twice")]),
    (
        "seed = 1.5\n[earth]\nlatitude = \"1 deg\"\n[[motion]]\nkind = \"rotate\"\nroll = \"1 deg\"\nduration = 5\n[gyro]\nnoise_std = 1\nbias_instability = \"1 deg/h\"\nbaud = 3\n[[output]]\nto = \"mpu@\"\n",
        &[
            ("1:8", "`seed` is a bare number; write a whole number"),
            ("3:12", "a place needs a `longitude` too"),
            ("6:11", "`roll`: `1 deg` is an angle, but an angular rate is required"),
            ("7:12", "`5` has no unit"),
            ("8:1", "[gyro] needs a rate"),
            ("9:13", "`1` has no unit"),
            ("11:1", "`baud` is not a key of [gyro]"),
            ("13:6", "`to`"),
        ],
    ),
];

fn check(cases: &[Case]) {
    let mut wrong = Vec::new();
    for (scene, expected) in cases {
        let mistakes = match Plan::parse(scene, "s.toml", "s", &[]) {
            Ok(_) => Vec::new(),
            Err(error) => error.mistakes.iter().map(|mistake| mistake.to_string()).collect(),
        };
        let as_expected = |(mistake, (place, says)): (&String, &(&str, &str))| {
            let message = mistake.strip_prefix(&format!("s.toml:{place}: "));
            message.is_some_and(|message| says.split('|').all(|part| message.contains(part)))
        };
        if mistakes.len() != expected.len() || !mistakes.iter().zip(*expected).all(as_expected) {
            wrong.push(format!("{scene}\ngave\n    {}\nnot\n    {expected:?}\n", mistakes.join("\n    ")));
        }
    }
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}

#[test]
fn an_unknown_key_gets_the_nearest_known_one() {
    check(KEYS);
}

#[test]
fn a_wrong_quantity_is_told_what_is_needed() {
    check(UNITS);
}

#[test]
fn a_sensor_that_cannot_be_says_why() {
    check(SENSORS);
}

#[test]
fn a_motion_start_or_force_that_cannot_be_says_why() {
    check(MOTIONS);
}

#[test]
fn an_earth_that_cannot_be_says_why() {
    check(EARTH);
}

#[test]
fn everything_else_is_checked_too_and_all_at_once() {
    check(REST);
}

/// The table of cases is only worth something if a scene without a mistake gives none.
#[test]
fn the_frames_of_the_cases_are_right_themselves() {
    plan(gyro!(""));
    plan(motion!("kind = \"hold\"\nduration = \"1 s\""));
    plan(earth!(""));
}

fn built_in() -> impl Strategy<Value = String> {
    (0..super::builtin::SCENES.len()).prop_map(|i| super::builtin::SCENES[i].1.to_string())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, ..ProptestConfig::default() })]

    #[test]
    fn no_text_panics(text in "\\PC{0,200}", set in "\\PC{0,40}") {
        let _ = Plan::parse(&text, "s.toml", "s", &[]);
        let _ = Plan::parse("duration = \"1 s\"\n[gyro]\nrate = \"1 Hz\"\n", "s.toml", "s", &[set]);
    }

    #[test]
    fn no_damaged_scene_panics(
        scene in built_in(),
        damage in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>(), 0..4u8), 1..4),
    ) {
        let mut bytes = scene.into_bytes();
        for (at, byte, how) in damage {
            let i = at.index(bytes.len());
            match how {
                0 => bytes[i] = byte,
                1 => bytes[i] ^= 1 << (byte % 8),
                2 => { bytes.remove(i); }
                _ => bytes.insert(i, b"0.-e[]\"= \n"[usize::from(byte) % 10]),
            }
        }
        let _ = Plan::parse(&String::from_utf8_lossy(&bytes), "s.toml", "s", &[]);
    }

    #[test]
    fn no_value_of_any_key_panics(
        key in prop::sample::select(vec![
            "rate", "phase", "range", "resolution", "noise_std", "noise_density", "bias", "bias_std", "bias_step_std",
            "bias_random_walk", "bias_instability", "correlation_time", "mount", "part", "sampling",
        ]),
        value in prop_oneof![
            Just("\"1e308 rad/s\"".to_string()), Just("\"5e-324 rad/s\"".to_string()), Just("\"1e-300 s\"".to_string()),
            Just("\"64 bit\"".to_string()), Just("[0, 0, 0, 0]".to_string()), Just("{ uniform = [\"-1e308 rad/s\", \"1e308 rad/s\"] }".to_string()),
            "\"-?[0-9]{1,3}(e-?[0-9]{1,3})? (rad/s|deg/s|s|Hz|LSB/\\(deg/s\\)|rad/s/rtHz|rad/s/rts|bit)\"",
            "[0-9.e\\[\\]{}\", a-z-]{0,20}",
        ],
    ) {
        let rate = if key == "rate" { "" } else { "rate = \"1 kHz\"\n" };
        let text = format!("duration = \"10 ms\"\n[gyro]\n{rate}range = \"1 rad/s\"\ncorrelation_time = \"1 s\"\n{key} = {value}\n");
        let text = if key == "range" || key == "correlation_time" { text.replacen("range = \"1 rad/s\"\ncorrelation_time = \"1 s\"\n", "", 1) } else { text };
        if let Ok(plan) = Plan::parse(&text, "s.toml", "s", &[]) {
            let mut player = crate::player::Player::new(&plan, plan.duration, 16);
            let played: Result<(), ()> = player.play(|_| Ok(()));
            prop_assert!(played.is_ok());
        }
    }
}
