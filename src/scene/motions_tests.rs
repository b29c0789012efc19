//! Motions as scenes write them: attitudes at times, mistakes in them, and the scene as resolved.

use super::Plan;
use crate::geometry::Euler;
use crate::time::{NANOS, SimTime};

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
            "1 s comes after 2 s: write them in order of time",
        ),
    ] {
        let error = waypoints(keys).unwrap_err();
        assert!(error.starts_with("s.toml:") && error.contains(says), "{keys}: {error}");
    }
}

#[test]
fn what_cannot_be_solved_exactly_is_refused_at_its_key() {
    let error = Plan::parse(&PROGRAMME.replace("2 Hz", "1 GHz"), "s.toml", "s", &[]).unwrap_err().to_string();
    assert!(error.contains("`bandwidth`: together with the duration"), "{error}");
}
