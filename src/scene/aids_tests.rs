//! What a scene says of barometer, GPS receiver and the velocity that it begins with.

use super::*;

fn plan(text: &str) -> Plan {
    Plan::parse(text, "s.toml", "s", &[]).unwrap_or_else(|error| panic!("{error}"))
}

fn mistake(text: &str) -> String {
    Plan::parse(text, "s.toml", "s", &[]).expect_err("a mistake").to_string()
}

const CIRCLE: &str =
    "[[motion]]\nkind = \"circle\"\nbank = \"25 deg\"\nspeed = \"15 m/s\"\nduration = \"20 s\"\n";

#[test]
fn the_scene_as_resolved_says_the_velocity_where_it_matters() {
    let scene = format!(
        "axes = \"enu-flu\"\n[start]\nattitude = \"[0, 0, 30] deg\"\n{CIRCLE}[gyro]\nrate = \"10 Hz\"\n"
    );
    assert!(!plan(&scene).resolved.contains("velocity"));
    for aid in ["[gps]\nbias_std = \"[1, 2, 3] m\"\n", "[baro]\nrate = \"10 Hz\"\nbias_std = \"1 hPa\"\n"] {
        let first = plan(&format!("seed = 3\n{scene}{aid}"));
        let again = plan(&first.resolved);
        assert_eq!(first.resolved, again.resolved);
        let velocity = first.trajectory.start_velocity();
        assert_eq!(velocity, again.trajectory.start_velocity());
        // 30° from east to north, in nav axes of ours.
        assert!(
            (velocity.v - glam::DVec3::new(7.5, 15.0 * libm::cos(30f64.to_radians()), 0.0)).length() < 1e-12
        );
        let sensor = |plan: &Plan| plan.sensors[1].values.get(crate::sensor::BIAS).unwrap();
        assert_eq!(sensor(&first), sensor(&again));
        assert!(sensor(&first).x != 0.0 && first.warnings.is_empty(), "{:?}", first.warnings);
    }
}

#[test]
fn a_turn_come_to_at_a_standstill_is_warned_of() {
    let scene = format!("[[motion]]\nkind = \"hold\"\nduration = \"5 s\"\n{CIRCLE}");
    let quiet = plan(&format!("{scene}[gyro]\nrate = \"10 Hz\"\n"));
    assert!(quiet.warnings.is_empty(), "without a position nobody minds");
    let warned = plan(&format!("{scene}[gps]\n"));
    let [warning] = &warned.warnings[..] else { panic!("one: {:?}", warned.warnings) };
    assert!(warning.contains("motion at 5 s") && warning.contains("[15, 0, 0] m/s"), "{warning}");
    let given = plan(&format!("[start]\nvelocity = \"[15, 0, 0] m/s\"\n{scene}[gps]\n"));
    assert!(given.warnings.is_empty());
}

#[test]
fn what_an_aid_cannot_be_is_refused_in_its_own_words() {
    let baro = |keys: &str| mistake(&format!("duration = \"1 s\"\n[baro]\nrate = \"10 Hz\"\n{keys}\n"));
    let gps = |keys: &str| mistake(&format!("duration = \"1 s\"\n[gps]\n{keys}\n"));
    for (message, expected) in [
        (baro("noise_std = \"[1, 2, 3] Pa\""), "is a vector, but a pressure with one value is required"),
        (baro("noise_std = \"1 m\""), "is a length, but a pressure is required"),
        (baro("part = \"MPU-9250\""), "`part` is not a key of [baro]"),
        (baro("mount = \"flu\""), "`mount` is not a key of [baro]"),
        (baro("sea_level_pressure = \"0 Pa\""), "is not above zero"),
        (baro("scale_error = \"1 %\""), "`scale_error` is not a key of [baro]"),
        (mistake("duration = \"1 s\"\n[baro]\n"), "[baro] needs a rate"),
        (gps("sampling = \"average\""), "`sampling` is not a key of [gps]"),
        (gps("satellites = 300"), "satellites"),
        (gps("range = \"1 km\""), "`range` is not a key of [gps]"),
        (gps("velocity_noise_std = \"1 m\""), "is a length, but a speed is required"),
        (mistake("duration = \"1 s\"\n[start]\nvelocity = \"3 m\"\n[gps]\n"), "is a length, but a speed"),
        (
            mistake("duration = \"1 s\"\n[gyro]\nrate = \"1 Hz\"\nvelocity_noise_std = \"1 m/s\"\n"),
            "is not a key of [gyro]",
        ),
    ] {
        assert!(message.contains(expected), "{message}");
        assert_eq!(message.lines().count(), 1, "one mistake, one message: {message}");
    }
}

#[test]
fn what_an_aid_claims_is_in_its_values() {
    let plan = plan("duration = \"1 s\"\n[gps]\neph = \"80 cm\"\nepv = \"2 m\"\nsatellites = 9\n");
    let claims = crate::sensor::Claims::of(&plan.sensors[0].values);
    assert_eq!((claims.eph, claims.epv, claims.satellites), (0.8, 2.0, 9));
}
