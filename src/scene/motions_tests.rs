//! Motions as scenes write them: attitudes at times, mistakes in them, and the scene as resolved.

use super::Plan;
use crate::geometry::{Attitude, Axes, Euler};
use crate::time::{NANOS, SimTime};
use std::fs;
use std::path::Path;

const PROGRAMME: &str = include_str!("../../scenes/waypoints.toml");

fn plan(text: &str) -> Plan {
    Plan::parse(text, "s.toml", "s", &[]).unwrap_or_else(|error| panic!("{error}"))
}

/// A `waypoints` motion with these keys, after a quarter turn to the right.
fn waypoints(keys: &str) -> Result<Plan, String> {
    let turn = "[[motion]]\nkind = \"rotate\"\nyaw = \"90 deg/s\"\nduration = \"1 s\"\n";
    let motion = format!("[[motion]]\nkind = \"waypoints\"\nduration = \"3 s\"\nkeys = [{keys}]\n");
    let text = format!("{turn}{motion}[gyro]\nrate = \"1 Hz\"\n");
    Plan::parse(&text, "s.toml", "s", &[]).map_err(|error| error.to_string())
}

#[test]
fn the_vehicle_is_at_each_key_in_the_scenes_axes() {
    for axes in ["ned-frd", "enu-flu"] {
        let plan = plan(&format!("axes = \"{axes}\"\n{PROGRAMME}"));
        for (t, degrees) in [(2, [0.0, 30.0, 0.0]), (5, [90.0, 0.0, 45.0]), (6, [90.0, 0.0, 45.0])] {
            let [roll, pitch, yaw] = degrees.map(f64::to_radians);
            let key = plan.axes.attitude_in(Euler { roll, pitch, yaw }.to_quat());
            let truth = plan.trajectory.at(SimTime(t * NANOS - 1));
            assert!(truth.attitude.angle_to(key) < 1e-12, "{axes} at {t} s");
        }
    }
}

#[test]
fn the_scene_as_resolved_moves_alike() {
    let first = plan(PROGRAMME);
    let again = plan(&first.resolved);
    for ms in (0..20_000).step_by(37) {
        let at = |plan: &Plan| plan.trajectory.at(SimTime(ms * NANOS / 1000));
        assert_eq!((at(&first).attitude, at(&first).rate), (at(&again).attitude, at(&again).rate), "{ms} ms");
    }
}

#[test]
fn another_seed_moves_a_random_motion_and_nothing_before_it() {
    let (one, two) = (plan(PROGRAMME), plan(&PROGRAMME.replace("seed = 1", "seed = 2")));
    let at = |plan: &Plan, s: i64| plan.trajectory.at(SimTime(s * NANOS)).rate;
    assert_eq!(at(&one, 7), at(&two, 7));
    assert_ne!(at(&one, 12), at(&two, 12));
}

#[test]
fn a_key_at_zero_is_where_the_vehicle_is_or_refused() {
    assert!(
        waypoints(
            "{ t = \"0 s\", attitude = \"[0, 0, 90] deg\" }, { t = \"1 s\", attitude = \"[0, 9, 0] deg\" }"
        )
        .is_ok()
    );
    let error = waypoints("{ t = \"0 s\", attitude = \"[0, 0, 0] deg\" }").unwrap_err();
    assert!(error.starts_with("s.toml:8:8: `keys`: the one at 0 s is not"), "{error}");
}

#[test]
fn mistakes_in_keys_are_placed() {
    for (keys, says) in [
        ("", "`waypoints` needs `keys`"),
        ("3", "8:9: `keys` holds a bare number"),
        ("{ t = \"1 s\" }", "needs a time and an attitude"),
        ("{ t = \"1 s\", atitude = \"[0, 0, 0] deg\" }", "did you mean `attitude`?"),
        ("{ t = \"1 s\", attitude = \"[0, 0, 0] m\" }", "is a length"),
        ("{ t = \"4 s\", attitude = \"[0, 0, 0] deg\" }", "the last is at 4 s, but the motion ends at 3 s"),
        (
            "{ t = \"2 s\", attitude = \"0 deg\" }, { t = \"1 s\", attitude = \"0 deg\" }",
            "1 s comes after 2 s: write them in time order",
        ),
    ] {
        let error = waypoints(keys).unwrap_err();
        assert!(error.starts_with("s.toml:") && error.contains(says), "{keys}: {error}");
    }
}

#[test]
fn what_cannot_be_solved_exactly_is_refused_at_its_key() {
    let error = Plan::parse(&PROGRAMME.replace("2 Hz", "1 GHz"), "s.toml", "s", &[]).unwrap_err().to_string();
    assert!(error.contains("`bandwidth`: with this duration"), "{error}");
}

/// The first second of a truth as a dataset writes it, in these axes.
fn truth_csv(axes: Axes, folder: &Path) -> Plan {
    let scene = format!(
        "axes = \"{axes}\"\n[start]\nattitude = \"[10, 20, 30] deg\"\n[[motion]]\nkind = \"cone\"\nhalf_angle = \"10 deg\"\nfrequency = \"1 Hz\"\nduration = \"2 s\"\n[gyro]\nrate = \"200 Hz\"\n"
    );
    let plan = plan(&scene);
    let mut text = String::from("t_ns,qw,qx,qy,qz,roll_rad,pitch_rad,yaw_rad,wx_rad_s,wy_rad_s,wz_rad_s\n");
    for k in 0..=200 {
        let truth = plan.trajectory.at(SimTime(k * NANOS / 200));
        let (q, w) = (axes.attitude_out(truth.attitude), axes.body_out(truth.rate));
        let Euler { roll, pitch, yaw } = Euler::from_quat(q);
        let values = [q.w, q.x, q.y, q.z, roll, pitch, yaw, w.x, w.y, w.z].map(|x| x.to_string());
        text += &format!("{},{}\n", truth.t.0, values.join(","));
    }
    fs::write(folder.join("truth.csv"), text).unwrap();
    plan
}

/// A `replay` motion of that truth with these keys, in a scene file beside it.
fn replay(axes: Axes, folder: &Path, before: &str, keys: &str) -> Result<Plan, String> {
    let text = format!(
        "axes = \"{axes}\"\n{before}[[motion]]\nkind = \"replay\"\nfile = \"truth.csv\"\n{keys}\n[gyro]\nrate = \"1 Hz\"\n"
    );
    Plan::parse(&text, &folder.join("s.toml").display().to_string(), "s", &[])
        .map_err(|error| error.to_string())
}

#[test]
fn a_log_plays_again_in_the_scenes_axes_whatever_column_it_is_read_from() {
    let folder = tempfile::tempdir().unwrap();
    for axes in [Axes::NedFrd, Axes::EnuFlu] {
        let first = truth_csv(axes, folder.path());
        let euler = "euler = { columns = [\"roll_rad\", \"pitch_rad\", \"yaw_rad\"], unit = \"rad\" }";
        let rate =
            "angular_rate = { columns = [\"wx_rad_s\", \"wy_rad_s\", \"wz_rad_s\"], unit = \"rad/s\" }";
        let start = "[start]\nattitude = \"[10, 20, 30] deg\"\n";
        for (before, keys) in [("", ""), ("", euler), (start, ""), (start, rate)] {
            let again = replay(axes, folder.path(), before, keys).unwrap_or_else(|error| panic!("{error}"));
            assert_eq!((again.duration, again.warnings.len()), (SimTime(NANOS), 0), "{:?}", again.warnings);
            for ms in 0..1000 {
                let t = SimTime(ms * NANOS / 1000 + 77_777);
                let (a, b) = (first.trajectory.at(t), again.trajectory.at(t));
                assert!(a.attitude.angle_to(b.attitude) < 2e-9, "{axes} {keys} at {ms} ms");
                assert!(
                    (a.rate - b.rate).length() < 2e-6,
                    "{axes} {keys} at {ms} ms: {:?} {:?}",
                    a.rate,
                    b.rate
                );
            }
        }
        // The same columns of the other axes are another motion.
        let other = if axes == Axes::NedFrd { Axes::EnuFlu } else { Axes::NedFrd };
        let wrong = replay(other, folder.path(), "", "").unwrap();
        let t = SimTime(NANOS / 2);
        assert!(first.trajectory.at(t).attitude.angle_to(wrong.trajectory.at(t).attitude) > 0.1);
    }
}

#[test]
fn a_first_log_settles_the_start_and_a_later_one_must_fit_or_be_turned() {
    let folder = tempfile::tempdir().unwrap();
    let first = truth_csv(Axes::NedFrd, folder.path());
    let settled = replay(Axes::NedFrd, folder.path(), "", "").unwrap();
    let table: toml::Table = settled.resolved.parse().unwrap();
    assert!(table["start"].get("quaternion").is_some() && table["start"].get("attitude").is_none());
    let elsewhere = "[start]\nattitude = \"[0, 0, 0] deg\"\n";
    let error = replay(Axes::NedFrd, folder.path(), elsewhere, "").unwrap_err();
    for says in
        ["s.toml:6:8: `file`: ", "truth.csv:2 starts 3", "[start] quaternion = [0.9", "align = \"start\""]
    {
        assert!(error.contains(says), "{error}");
    }
    let turned = replay(Axes::NedFrd, folder.path(), elsewhere, "align = \"start\"").unwrap();
    let t = SimTime(NANOS / 3);
    assert!((turned.trajectory.at(t).rate - first.trajectory.at(t).rate).length() < 1e-6);
    assert!(turned.trajectory.at(SimTime::ZERO).attitude.angle_to(Attitude::IDENTITY) < 1e-15);
}

#[test]
fn a_shorter_duration_cuts_a_log_and_a_longer_one_holds() {
    let folder = tempfile::tempdir().unwrap();
    truth_csv(Axes::NedFrd, folder.path());
    for (ms, end) in [(400, 400), (3000, 1000)] {
        let plan = replay(Axes::NedFrd, folder.path(), "", &format!("duration = \"{ms} ms\"")).unwrap();
        assert_eq!(plan.duration, SimTime(ms * NANOS / 1000));
        let (a, b) =
            (plan.trajectory.at(SimTime(end * NANOS / 1000)), plan.trajectory.at(SimTime(9 * NANOS)));
        assert_eq!((a.attitude, a.rate), (b.attitude, b.rate));
    }
}

#[test]
fn mistakes_in_a_replay_are_placed() {
    let folder = tempfile::tempdir().unwrap();
    truth_csv(Axes::NedFrd, folder.path());
    for (keys, says) in [
        (
            "time = \"t_ns\"",
            "5:8: `time` is a string, but columns need their unit: { column = \"t\", unit = \"s\" }",
        ),
        ("time = { column = \"t_ns\" }", "`time` needs a `unit`"),
        ("time = { unit = \"s\" }", "`time` needs a `column`"),
        ("time = { column = \"t_ns\", unit = \"deg\" }", "5:34: `deg` is an angle, but a time is required"),
        ("time = { column = \"t_ns\", unit = \"ns\", scale = 3 }", "`scale` is not a key of `time`"),
        (
            "time = { column = \"t_n\", unit = \"ns\" }",
            "5:8: `time`: |truth.csv has no column `t_n`; did you mean `t_ns`?; its columns are t_ns, qw",
        ),
        ("quaternion = [\"qw\", \"qx\"]", "5:14: `quaternion` takes 4 names of columns, such as [\"w\""),
        ("quaternion = [\"qw\", \"qx\", \"q3\", \"q4\"]", "has no column `q3`, `q4`"),
        (
            "quaternion = [\"qw\", \"qx\", \"qy\", \"qz\"]\neuler = { columns = [\"qx\", \"qy\", \"qz\"], unit = \"rad\" }",
            "6:9: `euler` is given with `quaternion`: keep only one",
        ),
        ("align = \"end\"", "5:9: `align` takes none or start, not `end`"),
        ("fle = \"x\"", "5:1: `fle` is not a key of a `replay` motion: did you mean `file`?"),
    ] {
        let error = replay(Axes::NedFrd, folder.path(), "", keys).unwrap_err();
        assert!(says.split('|').all(|part| error.contains(part)), "{keys}: {error}");
        assert_eq!(error.lines().count(), 1, "{keys}: {error}");
    }
    let missing = Plan::parse(
        "[[motion]]\nkind = \"replay\"\nfile = \"no.csv\"\n[gyro]\nrate = \"1 Hz\"\n",
        "s.toml",
        "s",
        &[],
    );
    let error = missing.unwrap_err().to_string();
    assert!(error.starts_with("s.toml:3:8: `file` cannot read no.csv: No such file"), "{error}");
}
