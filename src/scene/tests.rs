//! What scenes mean. What is said of wrong ones is in `mistakes.rs`.

use super::*;
use crate::double::Double;
use crate::earth;
use crate::geometry::{Body, Nav, Vector, exp};
use crate::sensor::{self, Mount, Sampling, SensorKind, white_noise};
use crate::time::{NANOS, Rate};
use crate::wire::{Claim, Extra, Layout, MagUnit, Protocol, Version};
use glam::DVec3;

/// The example of the documentation, every key of it.
const EXAMPLE: &str = r#"
name = "example"
seed = 1
duration = "60 s"              # default: the motions' sum; after the last motion the vehicle holds
axes = "enu-flu"               # or "ned-frd", the default
limits = []

[start]
attitude = "[0, 0, 0] deg"     # roll, pitch, yaw; or quaternion = [1, 0, 0, 0]

[earth]                        # explicit vectors, or a place and date (explicit wins, key by key)
gravity = "9.80665 m/s^2"
field = "[3.2, 15.0, -50.3] uT" # nav axes
# latitude = "59.93 deg"
# longitude = "30.31 deg"
# altitude = "10 m"
# date = "2026-11-22"

[[motion]]
kind = "rotate"                # the paper's cases 1 and 5: constant body rates
angular_rate = "[20, 0, 0] deg/s"
duration = "5 s"
[[motion]]
kind = "rotate"                # cases 2-4, short form: roll, pitch or yaw
roll = "30 deg/s"
duration = "3 s"
[[motion]]
kind = "cone"
half_angle = "5 deg"
frequency = "2 Hz"
duration = "10 s"
[[motion]]
kind = "circle"                # coordinated turn: the paper's introductory example
bank = "25 deg"
speed = "15 m/s"
duration = "20 s"

[[force]]                      # the paper's A_ex
start = "6 s"
duration = "2 s"
acceleration = "[0, 1.5, 0] m/s^2"
frame = "body"                 # or "nav"

[gyro]
rate = "1 kHz"
noise_variance = "3e-6 rad^2/s^2"
bias = "[-0.0005, 0.0005, -0.0006] rad/s"
bias_step_std = "0 rad/s"      # the paper's n_bg, per sample
[accel]
rate = "1 kHz"
bias = "[0.0007, 0.00033, -0.00404] m/s^2"
[mag]
rate = "100 Hz"
noise_variance = "0.04 uT^2"

[reference]                    # optional: reference.csv computed the paper's way, beside the exact truth
from = "gyro"                  # or "accel-mag" (external forces excluded)
method = "paper"               # any of `list methods`

[[output]]
to = "mpu@pty"
"#;

pub(super) fn plan(text: &str) -> Plan {
    Plan::parse(text, "s.toml", "s", &[]).unwrap_or_else(|error| panic!("{error}"))
}

fn set(text: &str, sets: &[&str]) -> Result<Plan, String> {
    let sets: Vec<_> = sets.iter().map(|set| set.to_string()).collect();
    Plan::parse(text, "s.toml", "s", &sets).map_err(|error| error.to_string())
}

const SHORT: &str = "duration = \"1 s\"\n[gyro]\nrate = \"1 kHz\"\n";

fn seconds(s: f64) -> SimTime {
    SimTime((s * NANOS as f64) as i64)
}

fn near<F>(a: Vector<F>, b: Vector<F>) {
    assert!((a - b).length() < 1e-12 * (1.0 + b.length()), "{a:?} against {b:?}");
}

#[test]
fn the_example_of_the_documentation_means_what_it_says() {
    let plan = plan(EXAMPLE);
    assert_eq!((plan.name.as_str(), plan.seed, plan.duration), ("example", 1, seconds(60.0)));
    assert_eq!((plan.axes, plan.day, plan.limits.len()), (Axes::EnuFlu, None, 0));
    let path = &plan.trajectory;
    assert_eq!(path.moving_until(), seconds(38.0));
    near(path.gravity(), Vector::new(0.0, 0.0, 9.80665));
    near(path.field(), Vector::new(15.0, 3.2, 50.3));
    // Level facing East in ENU-FLU; rolling is about the same axis in both.
    near(path.at(SimTime::ZERO).attitude.apply(Vector::new(1.0, 0.0, 0.0)), Vector::new(0.0, 1.0, 0.0));
    near(path.at(seconds(2.0)).rate, Vector::new(20f64.to_radians(), 0.0, 0.0));
    near(path.at(seconds(6.0)).rate, Vector::new(30f64.to_radians(), 0.0, 0.0));
    // At rest a z-up accelerometer reads +g; the push of 1.5 to the left acts from 6 s to 8 s.
    near(path.at(SimTime::ZERO).force, Vector::new(0.0, 0.0, -9.80665));
    let (pushed, free) = (path.at(seconds(7.0)), path.at(seconds(7.0)));
    let pull = free.attitude.inverse().apply(-path.gravity());
    near(pushed.force, pull + Vector::new(0.0, -1.5, 0.0));
    let after = path.at(seconds(50.0));
    near(after.rate, Vector::ZERO);
    near(after.force, after.attitude.inverse().apply(-path.gravity()));

    let [gyro, accel, mag] = &plan.sensors[..] else { panic!() };
    assert_eq!([gyro.kind, accel.kind, mag.kind], SensorKind::TRIADS);
    assert_eq!([gyro.rate, accel.rate, mag.rate], [Rate::hz(1000), Rate::hz(1000), Rate::hz(100)]);
    assert_eq!(gyro.values.get(sensor::BIAS).unwrap(), DVec3::new(-0.0005, -0.0005, 0.0006), "turned to FRD");
    assert_eq!(accel.values.get(sensor::BIAS).unwrap(), DVec3::new(0.0007, -0.00033, 0.00404));
    let sigma = |sensor: &SensorPlan| white_noise::sigma(&sensor.values, sensor.kind, sensor.rate).unwrap().x;
    assert_eq!((sigma(gyro), sigma(accel), sigma(mag)), (3e-6f64.sqrt(), 0.0, 0.2));
    assert_eq!(plan.outputs[0].to.to_string(), "mpu@pty");
    assert_eq!(plan.drawn, []);
}

#[test]
fn what_a_scene_leaves_out_has_its_default() {
    let plan = plan(SHORT);
    assert_eq!((plan.name.as_str(), plan.seed, plan.axes), ("s", 0, Axes::NedFrd));
    assert_eq!((plan.outputs.len(), plan.limits.len(), plan.day), (0, 0, None));
    near(plan.trajectory.gravity(), Vector::new(0.0, 0.0, 9.80665));
    let field = plan.trajectory.field();
    assert!((field.length() - 50.0).abs() < 1e-12 && field.v.y == 0.0 && field.v.x > 0.0);
    assert!((libm::atan2(field.v.z, field.v.x).to_degrees() - 60.0).abs() < 1e-12);
    assert!(
        plan.trajectory.at(seconds(0.5)).attitude.angle_to(exp_nb(DVec3::ZERO)) == 0.0,
        "level, facing north"
    );
    let gyro = &plan.sensors[0];
    assert_eq!(
        (gyro.phase, gyro.sampling, gyro.mount, gyro.part),
        (SimTime::ZERO, Sampling::Point, None, None)
    );
    assert!(plan.build(gyro).terms().is_empty());
}

fn exp_nb(v: DVec3) -> crate::geometry::Attitude {
    crate::geometry::Attitude::from_quat(exp(v))
}

#[test]
fn a_scene_lasts_as_long_as_its_motions_unless_it_says() {
    let motions = "[[motion]]\nkind = \"hold\"\nduration = \"1.5 s\"\n[[motion]]\nkind = \"rotate\"\nyaw = \"1 deg/s\"\nduration = \"250 ms\"\n[mag]\nrate = \"1 Hz\"\n";
    assert_eq!(plan(motions).duration, SimTime(1_750_000_000));
    assert_eq!(plan(&format!("duration = \"1 h\"\n{motions}")).duration, SimTime(3600 * NANOS));
}

#[test]
fn one_vehicle_written_in_either_axes_is_one_truth() {
    let ned = plan(
        r#"
        [start]
        attitude = "[10, -20, 130] deg"
        [earth]
        gravity = "[0.1, 0.2, 9.8] m/s^2"
        field = "[15, 3.2, 50.3] uT"
        [[motion]]
        kind = "rotate"
        angular_rate = "[20, -30, 40] deg/s"
        duration = "2 s"
        [[motion]]
        kind = "rotate"
        pitch = "15 deg/s"
        duration = "2 s"
        [[motion]]
        kind = "cone"
        half_angle = "5 deg"
        frequency = "2 Hz"
        duration = "2 s"
        [[force]]
        duration = "6 s"
        acceleration = "[0.5, -0.25, 1] m/s^2"
        [[force]]
        duration = "6 s"
        acceleration = "[1, 2, 3] m/s^2"
        frame = "nav"
        [gyro]
        rate = "10 Hz"
        bias = "[1, 2, 3] deg/s"
        "#,
    );
    // Roll and pitch about x and y, yaw from East to the left: 90° − 130°, pitch up is −pitch.
    let enu = plan(
        r#"
        axes = "enu-flu"
        [start]
        attitude = "[10, 20, -40] deg"
        [earth]
        gravity = "[0.2, 0.1, -9.8] m/s^2"
        field = "[3.2, 15, -50.3] uT"
        [[motion]]
        kind = "rotate"
        angular_rate = "[20, 30, -40] deg/s"
        duration = "2 s"
        [[motion]]
        kind = "rotate"
        pitch = "-15 deg/s"
        duration = "2 s"
        [[motion]]
        kind = "cone"
        half_angle = "-5 deg"
        frequency = "2 Hz"
        duration = "2 s"
        [[force]]
        duration = "6 s"
        acceleration = "[0.5, 0.25, -1] m/s^2"
        [[force]]
        duration = "6 s"
        acceleration = "[2, 1, -3] m/s^2"
        frame = "nav"
        [gyro]
        rate = "10 Hz"
        bias = "[1, -2, -3] deg/s"
        "#,
    );
    for ms in (0..7000).step_by(130) {
        let t = SimTime(ms * 1_000_000);
        let (a, b) = (ned.trajectory.at(t), enu.trajectory.at(t));
        assert!(a.attitude.angle_to(b.attitude) < 1e-13, "{ms} ms: {}", a.attitude.angle_to(b.attitude));
        near(a.rate, b.rate);
        near(a.force, b.force);
        near(a.field, b.field);
    }
    assert_eq!(ned.sensors[0].values.get(sensor::BIAS), enu.sensors[0].values.get(sensor::BIAS));
}

#[test]
fn the_start_may_be_three_angles_or_a_quaternion() {
    let start = |text: &str| plan(&format!("{SHORT}[start]\n{text}\n")).trajectory.at(SimTime::ZERO).attitude;
    let angles = start("attitude = \"[0, 0, 90] deg\"");
    assert!(angles.angle_to(exp_nb(DVec3::new(0.0, 0.0, 90f64.to_radians()))) < 1e-15);
    let given = start("quaternion = [0.7071067811865476, 0.0, 0, 0.7071067811865476]");
    assert!(angles.angle_to(given) < 1e-15);
    assert!(start("quaternion = [0.70711, 0, 0, 0.70711]").angle_to(angles) < 1e-15, "normalised");
    let all = start("attitude = \"[30, 45, 60] deg\"");
    let forward = all.apply(Vector::<Body>::new(1.0, 0.0, 0.0));
    near(forward, Vector::new(0.5f64.sqrt() * 0.5, 0.5f64.sqrt() * 0.75f64.sqrt(), -(0.5f64.sqrt())));
}

#[test]
fn what_earth_says_itself_wins_over_its_place_key_by_key() {
    let place =
        "latitude = \"59.93 deg\"\nlongitude = \"30.31 deg\"\naltitude = \"10 m\"\ndate = \"2026-11-22\"\n";
    let earth = |more: &str| plan(&format!("{SHORT}[earth]\n{place}{more}")).trajectory;
    let (modelled, gravity, field) =
        (earth(""), earth("gravity = \"9.8 m/s^2\""), earth("field = \"[1, 2, 3] uT\""));
    let here =
        earth::Place { latitude: 59.93f64.to_radians(), longitude: 30.31f64.to_radians(), altitude: 10.0 };
    let day = Day { year: 2026, month: 11, day: 22 };
    near(modelled.field(), earth::magnetic_field(here, day).unwrap());
    // St Petersburg in these years: some 53 µT, pointing down steeply, 12° east of true north.
    assert!((modelled.field().length() - 53.0).abs() < 0.5, "{:?}", modelled.field());
    assert!((earth::declination(modelled.field()).to_degrees() - 12.0).abs() < 0.5);
    near(modelled.gravity(), Vector::new(0.0, 0.0, earth::normal_gravity(here)));
    assert!((modelled.gravity().v.z - 9.8191).abs() < 2e-4);
    near(gravity.gravity(), Vector::new(0.0, 0.0, 9.8));
    near(gravity.field(), modelled.field());
    near(field.field(), Vector::new(1.0, 2.0, 3.0));
    near(field.gravity(), modelled.gravity());
    assert_eq!(plan(&format!("{SHORT}[earth]\ndate = 2026-11-22\n")).day, Some(day), "a date needs no place");
    let west = plan(&format!("{SHORT}[earth]\n{}", place.replace("30.31", "-150")));
    let east = plan(&format!("{SHORT}[earth]\n{}", place.replace("30.31", "210")));
    near(west.trajectory.field(), east.trajectory.field());
}

#[test]
fn overlapping_forces_add_in_the_frames_they_name() {
    let pushed = plan(
        r#"
        [[motion]]
        kind = "rotate"
        yaw = "90 deg/s"
        duration = "1 s"
        [[motion]]
        kind = "hold"
        duration = "9 s"
        [[force]]
        start = "2 s"
        duration = "2 s"
        acceleration = "[1, 0, 0] m/s^2"
        [[force]]
        start = "3 s"
        duration = "2 s"
        acceleration = "[2, 0, 0] m/s^2"
        frame = "nav"
        [accel]
        rate = "100 Hz"
        "#,
    );
    // Facing East, a push to the North is one to the left.
    for (t, x, y) in [(1.9, 0.0, 0.0), (2.0, 1.0, 0.0), (3.0, 1.0, -2.0), (4.0, 0.0, -2.0), (5.0, 0.0, 0.0)] {
        near(pushed.trajectory.at(seconds(t)).force, Vector::new(x, y, -9.80665));
    }
}

const DRAWN: &str = r#"
seed = 3
duration = "1 s"
[gyro]
rate = "100 Hz"
noise_std = { uniform = ["0.001 rad/s", "0.003 rad/s"] }
bias = { normal = ["0 deg/s", "[1, 0, 2] deg/s"] }
[accel]
rate = "100 Hz"
range = { uniform = ["2 g", "4 g"] }
"#;

#[test]
fn drawn_values_repeat_by_seed_and_stand_in_the_resolved_scene() {
    let (one, same, other) = (plan(DRAWN), plan(DRAWN), plan(&DRAWN.replace("seed = 3", "seed = 4")));
    assert_eq!(
        one.drawn.iter().map(|drawn| drawn.key.as_str()).collect::<Vec<_>>(),
        ["gyro.bias", "gyro.noise_std", "accel.range"]
    );
    assert_eq!((&one.drawn, &one.resolved), (&same.drawn, &same.resolved));
    assert!(one.drawn.iter().zip(&other.drawn).all(|(a, b)| a.key == b.key && a.value != b.value));
    for drawn in &one.drawn {
        assert!(
            one.resolved.contains(&format!("\"{}\"", drawn.value)),
            "{} in {}",
            drawn.value,
            one.resolved
        );
    }
    let std = one.sensors[0].values.get(white_noise::NOISE_STD).unwrap();
    assert!(
        std.to_array().iter().all(|x| (0.001..0.003).contains(x)) && std.x != std.y,
        "each axis by itself: {std}"
    );
    let bias = one.sensors[0].values.get(sensor::BIAS).unwrap();
    assert!(bias.y == 0.0 && bias.x != 0.0 && bias.z != 0.0, "{bias}");
    assert!((2.0..4.0).contains(&(one.sensors[1].values.get(sensor::RANGE).unwrap() / 9.80665)));
}

#[test]
fn drawn_values_have_the_distribution_asked_for() {
    let runs = 300;
    let (mut uniform, mut normal) = (Vec::new(), Vec::new());
    for seed in 0..runs {
        let plan = plan(&DRAWN.replace("seed = 3", &format!("seed = {seed}")));
        uniform.extend(plan.sensors[0].values.get(white_noise::NOISE_STD).unwrap().to_array());
        normal.push(plan.sensors[0].values.get(sensor::BIAS).unwrap().z.to_degrees());
    }
    // N uniform numbers over a width w have a mean good to w/√(12N), N normal ones to σ/√N: five of each allowed.
    let mean = |xs: &[f64]| xs.iter().sum::<f64>() / xs.len() as f64;
    let n = uniform.len() as f64;
    assert!((mean(&uniform) - 0.002).abs() < 5.0 * 0.002 / (12.0 * n).sqrt());
    assert!((mean(&normal)).abs() < 5.0 * 2.0 / (normal.len() as f64).sqrt());
    let variance = normal.iter().map(|x| x * x).sum::<f64>() / normal.len() as f64;
    assert!((variance / 4.0 - 1.0).abs() < 5.0 * (2.0 / normal.len() as f64).sqrt(), "σ of 2: {variance}");
}

#[test]
fn keys_beside_a_part_override_it() {
    let with = |more: &str| {
        plan(&format!("duration = \"1 s\"\n[gyro]\npart = \"MPU-9250\"\nrate = \"1 kHz\"\n{more}\n"))
    };
    let alone = with("");
    assert_eq!(alone.sensors[0].part, Some("MPU-9250"));
    let bias = |plan: &Plan| plan.drawn.iter().any(|drawn| drawn.key == "gyro.bias");
    assert!(bias(&alone), "a part alone draws its turn-on bias");
    assert!(alone.sensors[0].values.has(white_noise::NOISE_DENSITY));
    let mine =
        with("noise_std = \"0.002 rad/s\"\nbias = \"0 rad/s\"\nmount = \"frd\"\nrange = \"500 deg/s\"");
    let values = &mine.sensors[0].values;
    assert!(
        !values.has(white_noise::NOISE_DENSITY),
        "one's own noise takes the place of the part's, however it is spelled"
    );
    assert_eq!((bias(&mine), mine.sensors[0].mount), (false, Some(Mount::default())));
    let lsb = sensor::lsb(values, SensorKind::Gyro).unwrap().to_degrees();
    assert!((lsb * 65.5 - 1.0).abs() < 1e-14, "the part's resolution at ±500 deg/s: {lsb}");
    let finer = with("range = \"300 deg/s\"\nresolution = \"100 LSB/(deg/s)\"");
    let lsb = sensor::lsb(&finer.sensors[0].values, SensorKind::Gyro).unwrap().to_degrees();
    assert!((lsb * 100.0 - 1.0).abs() < 1e-14, "one's own resolution goes with any range");
}

#[test]
fn mounts_have_names_or_are_quaternions_from_the_scenes_body_axes() {
    let mount = |axes: &str, mount: &str| {
        plan(&format!("axes = \"{axes}\"\n{SHORT}mount = {mount}\n")).sensors[0].mount.unwrap()
    };
    let v = Vector::new(1.0, 2.0, 3.0);
    assert_eq!(mount("ned-frd", "\"flu\""), Mount::flu());
    assert_eq!(
        mount("enu-flu", "\"flu\""),
        Mount::flu(),
        "a name says where the chip's axes point, in any axes"
    );
    near(mount("ned-frd", "[1, 0, 0, 0]").to_chip(v), Mount::default().to_chip(v));
    near(mount("enu-flu", "[1, 0, 0, 0]").to_chip(v), Mount::flu().to_chip(v));
    near(mount("ned-frd", "[0, 1, 0, 0]").to_chip(v), Mount::flu().to_chip(v));
}

#[test]
fn set_overrides_are_read_like_the_file() {
    let scene = format!("{SHORT}[[motion]]\nkind = \"hold\"\nduration = \"1 s\"\n");
    let plan = set(
        &scene,
        &[
            "gyro.rate=8 kHz",
            "seed=7",
            "motion.0.duration='2 s'",
            "earth.gravity = 9.8 m/s^2",
            "axes=enu-flu",
        ],
    )
    .unwrap();
    assert_eq!((plan.sensors[0].rate, plan.seed, plan.axes), (Rate::hz(8000), 7, Axes::EnuFlu));
    assert_eq!(plan.trajectory.moving_until(), seconds(2.0));
    near(plan.trajectory.gravity(), Vector::new(0.0, 0.0, 9.8));
    let added =
        set(&scene, &["mag.rate=50 Hz", "mag.noise_std={ uniform = ['1 uT', '2 uT'] }", "limits=[\"a<1\"]"])
            .unwrap();
    assert_eq!((added.sensors.len(), added.drawn.len(), added.limits[0].0.as_str()), (2, 1, "a<1"));
    for (bad, says) in [
        ("gyro.rate=8", "--set gyro.rate=8: `rate`: `8` has no unit: write \"8 Hz\" or \"8 kHz\""),
        ("gyro.rat=8 Hz", "--set gyro.rat=8 Hz: `rat` is not a key of [gyro]: did you mean `rate`?"),
        ("gyro.rate", "--set gyro.rate: is not KEY=VALUE: write, for example, --set gyro.rate='8 kHz'"),
        ("gyro.rate.x=1", "--set gyro.rate.x=1: `rate` is a string, not a table"),
        ("motion.1.duration=1 s", "--set motion.1.duration=1 s: `motion` has 1 entry, motion.0"),
        ("motion.duration=1 s", "`motion` has 1 entry, motion.0"),
        ("motion.0=x", "--set motion.0=x: `motion` holds a string: write each as its own table, [[motion]]"),
    ] {
        let message = set(&scene, &[bad]).unwrap_err();
        assert!(message.contains(says) && message.lines().count() == 1, "{bad}: {message}");
    }
    let place_of_the_rest =
        set("duration = \"1 s\"\n[gyro]\nrate = 5\n", &["gyro.bias=1 rad/s"]).unwrap_err();
    assert!(place_of_the_rest.starts_with("s.toml:3:8: "), "{place_of_the_rest}");
}

#[test]
fn outputs_and_limits_are_handed_on() {
    let text = format!(
        "limits = [\"sensors.gyro.late_us.p99<200\"]\n{SHORT}[accel]\nrate = \"500 Hz\"\n[[output]]\nto = \"mpu@pty\"\nlayout = \"burst\"\n[[output]]\nto = \"mavlink@udpout:127.0.0.1:14550\"\n[[output]]\nto = \"csv@-\"\n"
    );
    let plan = plan(&text);
    let (limit, place) = &plan.limits[0];
    assert_eq!((limit.as_str(), place.to_string().as_str()), ("sensors.gyro.late_us.p99<200", "s.toml:1:11"));
    let protocols = [Protocol::Mpu, Protocol::Mavlink, Protocol::Csv];
    assert_eq!(plan.outputs.iter().map(|output| output.to.protocol).collect::<Vec<_>>(), protocols);
    assert_eq!(plan.outputs[0].wire.layout, Some(Layout::Burst));
    assert_eq!(plan.outputs[1].to.to_string(), "mavlink@udpout:127.0.0.1:14550");
}

#[test]
fn an_output_of_mavlink_has_a_version_and_messages_on_request() {
    let wire =
        |keys: &str| plan(&format!("{SHORT}[[output]]\nto = \"mavlink@pty\"\n{keys}")).outputs.remove(0).wire;
    let asked = wire("version = 1\nmessages = [\"SCALED_IMU2\", \"HIL_STATE_QUATERNION\"]\n");
    assert_eq!(asked.version, Version::V1);
    assert_eq!(
        asked.extras.iter().map(Extra::name).collect::<Vec<_>>(),
        ["HIL_STATE_QUATERNION", "SCALED_IMU2"]
    );
    assert_eq!(wire("version = 2\nmessages = []\n"), wire(""), "as by default");
}

#[test]
fn an_output_of_a_unit_says_what_it_claims_of_its_attitude_and_in_which_unit_its_field_is() {
    let whole = |keys: &str| plan(&format!("{SHORT}[[output]]\n{keys}"));
    let wire = |keys: &str| whole(keys).outputs.remove(0).wire;
    let plain = wire("to = \"sbg@pty\"\n");
    assert_eq!((plain.claim, plain.mag), (Claim::Level, None), "false, and what the controller takes it for");
    let keys = "to = \"sbg@pty\"\nattitude = \"truth\"\nmag_unit = \"gauss\"\n";
    let asked = wire(keys);
    assert_eq!((asked.claim, asked.mag), (Claim::Truth, Some(MagUnit::Gauss)));
    assert_eq!(wire("to = \"px4-ilabs@pty\"\nattitude = \"level\"\n").claim, Claim::Level);
    // As resolved it says the same, and a plain output nothing of it.
    assert_eq!(plan(&whole(keys).resolved).outputs[0].wire, asked);
    assert!(!whole("to = \"sbg@pty\"\n").resolved.contains("attitude = \"level\""));
}

#[test]
fn an_output_says_how_it_is_paced_and_what_it_does_when_it_is_too_slow() {
    let one = |keys: &str| plan(&format!("{SHORT}[[output]]\n{keys}")).outputs.remove(0);
    let plain = one("to = \"mpu@pty,115200\"\n");
    assert_eq!(
        (plain.to.address.baud(), plain.overload, plain.force),
        (Some(115_200), Overload::DropNewest, false)
    );
    assert_eq!(one("to = \"mpu@pty:/tmp/imu,115200\"\npace = true\n").to.address.baud(), Some(115_200));
    let unpaced = one("to = \"mpu@pty:/tmp/imu,115200\"\npace = false\n");
    assert_eq!(unpaced.to.to_string(), "mpu@pty:/tmp/imu");
    let serial = one("to = \"mpu@/dev/ttyUSB0,115200\"\npace = false\nforce = true\n");
    assert_eq!((serial.to.address.baud(), serial.force), (Some(115_200), true));
    for (name, policy) in [
        ("drop-newest", Overload::DropNewest),
        ("drop-oldest", Overload::DropOldest),
        ("stretch", Overload::Stretch),
    ] {
        let text = format!("{SHORT}[[output]]\nto = \"mpu@pty\"\noverload = \"{name}\"\n");
        let read = plan(&text);
        assert_eq!((read.outputs[0].overload, policy.name()), (policy, name));
        assert_eq!(plan(&read.resolved).outputs[0].overload, policy, "written down and read again");
    }
}

#[test]
fn every_built_in_scene_loads_and_says_what_it_is() {
    for (name, text) in builtin::SCENES {
        let plan = Plan::load(name, &[]).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(plan.name, name);
        assert!(builtin::about(text).len() > 20, "{name}");
        assert!(plan.outputs.is_empty());
    }
    let error = Plan::load("tabel-1", &[]).unwrap_err().to_string();
    assert!(error.contains("table-1, still") && error.ends_with("did you mean `table-1`?"), "{error}");
    let table_1 = Plan::load("table-1", &[]).unwrap();
    assert_eq!((table_1.axes, table_1.sensors.len()), (Axes::EnuFlu, 3));
}

#[test]
fn an_hour_of_turning_by_a_decimal_rate_loses_nothing_on_its_way_through_the_scene() {
    let plan = plan(
        "[[motion]]\nkind = \"rotate\"\npitch = \"2000 deg/s\"\nduration = \"1 h\"\n[gyro]\nrate = \"1 Hz\"\n",
    );
    let end = plan.trajectory.at(SimTime(3600 * NANOS)).attitude;
    assert!(end.angle_to(exp_nb(DVec3::ZERO)).to_degrees() < 1e-12);
    assert_eq!(seconds(3600.0).exact_seconds().to_f64(), Double::from(3600.0).to_f64());
    let nav: Vector<Nav> = end.apply(Vector::new(1.0, 0.0, 0.0));
    near(nav, Vector::new(1.0, 0.0, 0.0));
}

#[test]
fn every_key_that_is_listed_is_known() {
    for (table, key, _) in FIXED_KEYS {
        let table = match *table {
            "" => String::new(),
            "motion" | "force" | "fault" | "setting" | "output" => format!("[[{table}]]"),
            _ => format!("[{table}]"),
        };
        let kind = match (table.as_str(), *key) {
            ("[[motion]]", "kind") => "",
            ("[[motion]]", _) => "kind = \"hold\"\n",
            ("[[setting]]", "sensor") => "",
            ("[[setting]]", _) => "sensor = \"gyro\"\n",
            ("[[fault]]", "sensor") => "kind = \"off\"\n",
            ("[[fault]]", "kind") => "sensor = \"gyro\"\n",
            ("[[fault]]", "size" | "share") => "sensor = \"gyro\"\nkind = \"spike\"\n",
            ("[[fault]]", "output") => "kind = \"drop\"\n",
            ("[[fault]]", "bits" | "hurts") => "kind = \"corrupt\"\n",
            ("[[fault]]", "pieces" | "gap") => "kind = \"split\"\n",
            ("[[fault]]", "every") => "sensor = \"gyro\"\nkind = \"slow\"\n",
            ("[[fault]]", "delay") => "sensor = \"gyro\"\nkind = \"delayed\"\n",
            ("[[fault]]", _) => "sensor = \"gyro\"\nkind = \"off\"\n",
            _ => "",
        };
        let value = if ["pace", "force", "send"].contains(key) { "1" } else { "true" };
        let bad = format!("{table}\n{kind}{key} = {value}\n");
        let rest: String = SHORT
            .lines()
            .filter(|line| table == "[[setting]]" || !line.starts_with(key))
            .map(|line| format!("{line}\n"))
            .collect();
        let text = if table.is_empty() { bad + &rest } else { rest + &bad };
        let error = Plan::parse(&text, "s.toml", "s", &[]).unwrap_err().to_string();
        assert!(
            error.contains(&format!("`{}`", key.trim_matches('"'))) && !error.contains("is not a key"),
            "{table} {key}: {error}"
        );
    }
}

#[test]
fn a_reference_is_what_the_scene_asks_for_and_is_written_down() {
    let named = |plan: &Plan| plan.reference.map(|reference| (reference.from(), reference.method()));
    assert_eq!(named(&plan(EXAMPLE)), Some(("gyro", "paper")));
    assert_eq!(named(&plan(SHORT)), None);
    let short = format!("{SHORT}[reference]\n");
    assert_eq!(named(&plan(&short)), Some(("gyro", "paper")));
    assert!(plan(&short).resolved.contains("[reference]\nfrom = \"gyro\"\nmethod = \"paper\"\nrate = "));
    let auto = set(&short, &["reference.method=auto"]).unwrap();
    assert_eq!(named(&auto), Some(("gyro", "auto")));
    assert!(auto.resolved.contains("tolerance = \"0.001 deg\""), "{}", auto.resolved);
    let (settled, choice) = auto.reference.unwrap().settled(&auto.trajectory, auto.duration).unwrap();
    let written = plan(&auto.resolved_until(auto.duration, Some(&settled)));
    assert_eq!(
        (named(&written), choice.map(|it| it.method.name)),
        (Some(("gyro", settled.method())), Some(settled.method()))
    );
    assert_eq!(written.reference.map(|it| it.rate()), Some(settled.rate()));
    let method = set(&short, &["reference.method=magnus-4"]).unwrap();
    assert_eq!(named(&method), Some(("gyro", "magnus-4")));
    assert_eq!(named(&plan(&method.resolved)), Some(("gyro", "magnus-4")));
    let sets = ["reference.from=accel-mag", "accel.rate=200 Hz", "mag.rate=100 Hz"];
    let fixed = set(&short, &sets).unwrap();
    assert!(matches!(fixed.reference, Some(Reference::AccelMag { rate }) if rate == Rate::hz(200)));
    assert_eq!(named(&plan(&fixed.resolved)), Some(("accel-mag", "triad")));
}
