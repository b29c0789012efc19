//! Sizes against what is measured by playing a scene with an effect and without it.

use super::*;
use crate::geometry::{Attitude, Vector};
use crate::motion::{Kinematics, Motion, Trajectory};
use crate::player::{BLOCK, Player};
use crate::time::{NANOS, SimTime};
use std::convert::Infallible;

fn plan(text: &str, sets: &[&str]) -> Plan {
    let sets: Vec<String> = sets.iter().map(|set| set.to_string()).collect();
    Plan::parse(text, "test", "test", &sets).unwrap_or_else(|error| panic!("{error}"))
}

/// Every reading of the scene's only sensor.
fn readings(plan: &Plan) -> Vec<DVec3> {
    let mut readings = Vec::new();
    let Ok(()) = Player::new(plan, plan.duration, BLOCK).play(|moment| {
        readings.extend(moment.readings.iter().map(|reading| reading.body().unwrap().value.v));
        Ok::<(), Infallible>(())
    });
    readings
}

/// What one scene's readings differ by from the other's, sample by sample.
fn differences(with: &Plan, without: &Plan) -> Vec<DVec3> {
    let (with, without) = (readings(with), readings(without));
    assert_eq!(with.len(), without.len());
    with.iter().zip(&without).map(|(with, without)| with - without).collect()
}

fn largest(differences: &[DVec3]) -> f64 {
    differences.iter().fold(DVec3::ZERO, |most, v| most.max(v.abs())).max_element()
}

fn find(plan: &Plan, name: &str) -> Option<Effect> {
    effects(plan).into_iter().find(|effect| effect.effect == name)
}

fn found(plan: &Plan, name: &str) -> Effect {
    find(plan, name).unwrap_or_else(|| panic!("no {name} in {:?}", effects(plan)))
}

/// Whether values with a zero mean have this standard deviation: the estimate from N of them has a standard error of
/// σ/√(2N); within 4 of those.
fn has_deviation(values: &[f64], sigma: f64) -> Result<(), String> {
    let n = values.len() as f64;
    let measured = (values.iter().map(|x| x * x).sum::<f64>() / n).sqrt();
    match (measured / sigma - 1.0).abs() < 4.0 / (2.0 * n).sqrt() {
        true => Ok(()),
        false => Err(format!("{measured} is not {sigma} within 4 standard errors of {n} values")),
    }
}

const GYRO: &str = "duration = \"10 s\"\n[gyro]\nrate = \"100 Hz\"\n";

/// The last sample's difference in many runs, each with a seed of its own.
fn at_the_end(sets: &[&str]) -> Vec<f64> {
    let without = plan(GYRO, &[]);
    let runs = (0..200).flat_map(|seed| {
        let seed = format!("seed={seed}");
        let with = plan(GYRO, &[sets, &[&seed]].concat());
        differences(&with, &without).last().unwrap().to_array()
    });
    runs.collect()
}

#[test]
fn a_bias_walk_has_its_predicted_spread_at_the_end() {
    for sets in [
        &["gyro.bias_random_walk=0.01 deg/s/√s"][..],
        &["gyro.bias_step_std=0.001 deg/s"],
        &["gyro.bias_random_walk=0.01 deg/s/√s", "gyro.bias_step_std=0.001 deg/s"],
    ] {
        let size = found(&plan(GYRO, sets), "bias_walk").size;
        let ends = at_the_end(sets);
        has_deviation(&ends, size).unwrap_or_else(|why| panic!("{sets:?}: {why}"));
        assert!(has_deviation(&ends, 1.2 * size).is_err(), "a wrong prediction would be seen");
    }
    // K·√T: 0.01·√9.99 deg/s.
    let size = found(&plan(GYRO, &["gyro.bias_random_walk=0.01 deg/s/√s"]), "bias_walk").size;
    assert!((size.to_degrees() - 0.01 * 9.99f64.sqrt()).abs() < 1e-15);
}

#[test]
fn a_bias_instability_has_its_predicted_spread_from_either_start() {
    let wander = ["gyro.bias_instability=20 deg/h", "gyro.correlation_time=12 s"];
    let from_zero = [&wander[..], &["gyro.bias_instability_start=zero"]].concat();
    let sizes = [&wander[..], &from_zero].map(|sets| {
        let size = found(&plan(GYRO, sets), "bias_instability").size;
        has_deviation(&at_the_end(sets), size).unwrap_or_else(|why| panic!("{sets:?}: {why}"));
        size
    });
    assert!(sizes[1] < 0.95 * sizes[0], "the process from zero has not yet grown: {sizes:?}");
}

#[test]
fn white_noise_has_its_predicted_deviation_in_each_spelling() {
    for set in
        ["gyro.noise_density=0.01 deg/s/√Hz", "gyro.noise_std=0.1 deg/s", "gyro.angle_random_walk=0.3 deg/√h"]
    {
        let with = plan(GYRO, &[set]);
        let noise: Vec<f64> =
            differences(&with, &plan(GYRO, &[])).iter().flat_map(|v| v.to_array()).collect();
        has_deviation(&noise, found(&with, "white_noise").size).unwrap_or_else(|why| panic!("{set}: {why}"));
    }
}

const ROCK: &str = r#"
[[motion]]
kind = "rock"
axis = "pitch"
amplitude = "100 deg/s"
frequency = "0.7 Hz"
duration = "10 s"
[gyro]
rate = "500 Hz"
"#;

#[test]
fn rounding_moves_a_reading_by_half_a_count_at_most_and_nearly_does() {
    let with = plan(ROCK, &["gyro.resolution=0.1 deg/s"]);
    let (most, size) = (largest(&differences(&with, &plan(ROCK, &[]))), found(&with, "resolution").size);
    assert!(most <= size * (1.0 + 1e-9) && most > 0.98 * size, "{most} of {size}");
}

#[test]
fn a_range_cuts_off_what_goes_beyond_on_the_axis_it_is_on() {
    for mount in ["frd", "flu", "rdf"] {
        let mount = format!("gyro.mount={mount}");
        let with = plan(ROCK, &["gyro.range=60 deg/s", &mount]);
        let cut = found(&with, "range");
        let measured = largest(&differences(&with, &plan(ROCK, &[&mount])));
        assert!((cut.size - measured).abs() < 1e-12 && (0.69..0.7).contains(&cut.size), "{cut:?} {measured}");
        assert_eq!((cut.axis, cut.verdict), ("y", Verdict::Seen), "pitch is about y, whatever the mount");
        let wide = found(&plan(ROCK, &["gyro.range=200 deg/s", &mount]), "range");
        assert_eq!((wide.size, wide.verdict), (0.0, Verdict::Needless));
    }
}

const PUSHED: &str = r#"
[[motion]]
kind = "rotate"
yaw = "50 deg/s"
duration = "40 s"
[[force]]
start = "31.2345 s"
duration = "3 ms"
acceleration = "[0.5, -1.5, 0] m/s^2"
frame = "nav"
[accel]
rate = "1 kHz"
"#;

#[test]
fn a_force_is_as_large_as_what_it_adds_to_a_reading_however_short_it_is() {
    for sampling in ["point", "average"] {
        let sampling = format!("accel.sampling={sampling}");
        let with = plan(PUSHED, &[&sampling]);
        let quiet = plan(PUSHED, &[&sampling, "force.0.acceleration=0 m/s^2"]);
        let (size, measured) = (found(&with, "force").size, largest(&differences(&with, &quiet)));
        assert!(
            with.sensors[0].rate.ticks_before(SimTime::ZERO, with.duration) > TICKS,
            "not every tick is looked at"
        );
        // A mean over 1 ms of a force that stays in nav while the body turns by 0.05 degrees is a little less.
        assert!(
            size - measured > -1e-12 && size - measured < 1e-3 && size > 1.0,
            "{sampling}: {size} against {measured}"
        );
    }
    assert!(find(&plan(GYRO, &[]), "force").is_none());
}

#[test]
fn averaging_is_as_large_as_what_it_changes() {
    let largest_change = |text, sensor: &str| {
        let average = plan(text, &[&format!("{sensor}.sampling=average")]);
        let point = plan(text, &[]);
        let of = |name| find(&point, name).map_or(0.0, |effect| effect.size);
        (largest(&differences(&average, &point)), of("averaging"), of("averaging_over_seams"), average)
    };
    // w(t) = A·sin(2π·f·t) lags by half an interval: A·2π·f·h/2, where it is steepest.
    let (measured, smooth, seams, average) = largest_change(ROCK, "gyro");
    let lag = 100f64.to_radians() * std::f64::consts::TAU * 0.7 * 0.002 / 2.0;
    assert!((smooth - measured).abs() < 1e-12 && (smooth / lag - 1.0).abs() < 1e-3 && seams == 0.0);
    assert_eq!(found(&average, "averaging").verdict, Verdict::Seen);
    assert_eq!(found(&plan(ROCK, &[]), "averaging").verdict, Verdict::Missing);

    let jump = "[[motion]]\nkind = \"rotate\"\nyaw = \"50 deg/s\"\nduration = \"1 s\"\n[[motion]]\nkind = \"hold\"\nduration = \"1 s\"\n[gyro]\nrate = \"100 Hz\"\n";
    let (measured, smooth, seams, _) = largest_change(jump, "gyro");
    assert!((seams - measured).abs() < 1e-12 && (seams - 50f64.to_radians()).abs() < 1e-12 && smooth == 0.0);
}

const TURN: &str = r#"
[[motion]]
kind = "circle"
bank = "25 deg"
speed = "300 m/s"
duration = "20 s"
[accel]
rate = "100 Hz"
"#;

#[test]
fn a_coordinated_turn_has_its_path_acceleration_and_what_the_earth_does_to_its_speed() {
    // g·tan φ inwards is g·sin φ along the banked y axis.
    let turn = plan(TURN, &[]);
    let (inwards, sine) = (found(&turn, "path_acceleration"), 25f64.to_radians().sin());
    assert!((inwards.size - 9.80665 * sine).abs() < 1e-9 && inwards.axis == "y", "{inwards:?}");
    assert!((found(&turn, "coriolis").size - 0.043_752_69).abs() < 1e-12);
    assert_eq!(found(&turn, "gravity_with_height").size, 0.0, "it is level");

    let gyro = plan(&TURN.replace("accel", "gyro"), &[]);
    // Rolling in ends with a jump of the roll rate, 25 deg in 2 s; apart from that nothing turns fast.
    let roll = found(&gyro, "averaging_over_seams").size.to_degrees();
    assert!((roll - 12.5).abs() < 0.01 && found(&gyro, "averaging").size.to_degrees() < 0.01, "{roll}");
    assert!((found(&gyro, "transport_rate").size - 300.0 / 6_335_439.0).abs() < 1e-15);
    // 6 km of a field of 50 µT that falls by 3/R a metre.
    let mag = plan(&TURN.replace("accel", "mag"), &[]);
    assert!((found(&mag, "field_along_path").size - 0.141_26).abs() < 1e-5);
    for name in ["path_acceleration", "coriolis", "transport_rate", "field_along_path"] {
        assert!(find(&plan(PUSHED, &[]), name).is_none(), "{name} of a vehicle that stands");
    }
}

#[test]
fn gravity_changes_with_the_height_that_a_climb_reaches() {
    #[derive(Debug)]
    struct Climb;
    impl Motion for Climb {
        fn at(&self, start: Attitude, _: crate::double::Double) -> Kinematics {
            Kinematics { attitude: start, rate: Vector::ZERO, acceleration: Vector::new(0.0, 0.0, -2.0) }
        }
        fn fastest(&self) -> f64 {
            0.0
        }
    }
    let mut plan = plan("duration = \"10 s\"\n[accel]\nrate = \"10 Hz\"\n", &[]);
    let motions: Vec<(SimTime, Box<dyn Motion>)> = vec![(SimTime(10 * NANOS), Box::new(Climb))];
    let (gravity, field) = (plan.trajectory.gravity(), plan.trajectory.field());
    plan.trajectory = Trajectory::new(Attitude::IDENTITY, motions, vec![], gravity, field);
    // ½·a·t² at the last tick, 9.9 s.
    let size = found(&plan, "gravity_with_height").size;
    assert!((size - 3.086e-6 * 9.9 * 9.9).abs() < 1e-12, "{size}");
}

#[test]
fn a_lever_arm_feels_centripetal_and_angular_acceleration() {
    let spin = ROCK.replace("gyro", "accel");
    let arm = found(&plan(&spin, &[]), "lever_arm");
    let angular = 100f64.to_radians() * std::f64::consts::TAU * 0.7;
    assert!((arm.size / (0.01 * angular) - 1.0).abs() < 1e-3, "{arm:?} at the swing's turn");
    assert_eq!((arm.modelled, arm.key.as_deref()), (false, Some("accel.lever_arm")));
    // Given, it is as large as what it changes.
    let with = plan(&spin, &["accel.lever_arm=[30, -20, 10] mm"]);
    let (size, measured) = (found(&with, "lever_arm"), largest(&differences(&with, &plan(&spin, &[]))));
    assert!((size.size - measured).abs() < 1e-12 && size.modelled && measured > 0.1, "{size:?} {measured}");
    // A steady turn: w²·r, and no angular acceleration from the jumps at its seams.
    let turn = found(&plan(PUSHED, &[]), "lever_arm");
    assert!((turn.size - 0.01 * 50f64.to_radians().powi(2)).abs() < 1e-12 && turn.axis != "z", "{turn:?}");
}

#[test]
fn the_earths_rotation_is_what_the_place_lets_each_axis_see() {
    const OMEGA: f64 = 7.292_115e-5;
    let anywhere = found(&plan(GYRO, &[]), "earth_rotation");
    assert_eq!((anywhere.size, anywhere.statistic), (OMEGA, "at most"));
    for (latitude, size, axis) in [(0.0, OMEGA, "x"), (90.0, OMEGA, "z"), (30.0, OMEGA * 0.75f64.sqrt(), "x")]
    {
        let place = format!("earth.latitude={latitude} deg");
        let there = plan(GYRO, &[&place, "earth.longitude=0 deg", "earth.date=2026-11-22"]);
        let effect = found(&there, "earth_rotation");
        assert!((effect.size - size).abs() < 1e-15 && effect.axis == axis, "{effect:?}");
    }
    // 15 deg/h against a tenth of the noise, on either side.
    for (noise, verdict) in [("0.041 deg/s", Verdict::Missing), ("0.042 deg/s", Verdict::Negligible)] {
        let noise = format!("gyro.noise_std={noise}");
        assert_eq!(found(&plan(GYRO, &[&noise]), "earth_rotation").verdict, verdict, "{noise}");
    }
}

#[test]
fn a_place_is_worth_what_it_changes_in_a_reading() {
    let place = ["earth.latitude=59.93 deg", "earth.longitude=30.31 deg", "earth.date=2026-11-22"];
    for (sensor, name, key, explicit) in [
        ("accel", "gravity_of_place", "earth.gravity", "earth.gravity=9.80665 m/s^2"),
        ("mag", "field_of_place", "earth.field", "earth.field=[25, 0, 43.30127018922193] uT"),
    ] {
        let text = GYRO.replace("gyro", sensor);
        let (here, nowhere) = (plan(&text, &place), plan(&text, &[]));
        let modelled = found(&here, name);
        let measured = largest(&differences(&here, &nowhere));
        assert!((modelled.size - measured).abs() < 1e-12 && modelled.size > 0.01, "{modelled:?} {measured}");
        assert_eq!((modelled.modelled, modelled.key.as_deref()), (true, Some("earth.latitude")));

        let overridden = found(&plan(&text, &[&place[..], &[explicit]].concat()), name);
        assert!((overridden.size - measured).abs() < 1e-9, "{overridden:?}");
        assert_eq!((overridden.modelled, overridden.key.as_deref()), (false, Some(key)));
        assert!(find(&nowhere, name).is_none(), "no place, no size");
    }
}

#[test]
fn a_declination_is_worth_the_field_turned_back_to_north() {
    let text = GYRO.replace("gyro", "mag");
    let turned = plan(&text, &["earth.field=[15, 20, 40] uT"]);
    let measured = largest(&differences(&turned, &plan(&text, &["earth.field=[25, 0, 40] uT"])));
    let effect = found(&turned, "declination");
    assert!((effect.size - measured).abs() < 1e-12 && effect.size == 20.0, "{effect:?}");
    assert!(find(&plan(&text, &[]), "declination").is_none());
}

#[test]
fn what_a_datasheet_gives_and_the_scene_leaves_out_is_named() {
    let part = [r#"gyro.part="MPU-9250""#, "gyro.bias=0 deg/s"];
    let bias = found(&plan(GYRO, &part), "bias");
    assert!((bias.size.to_degrees() - 5.0).abs() < 1e-12, "the end of the tolerance of ±5 deg/s: {bias:?}");
    assert_eq!((bias.verdict, bias.key.as_deref()), (Verdict::Missing, Some("gyro.bias")));
    assert_eq!(bias.statistic, "at most");
    assert!(bias.note.is_some_and(|note| note.contains("MPU-9250")));

    let quiet = found(&plan(GYRO, &[part[0], "gyro.noise_std=0 deg/s"]), "white_noise");
    assert!(
        (quiet.size.to_degrees() - 0.01 * 50f64.sqrt()).abs() < 1e-12,
        "0.01 deg/s/√Hz at 100 Hz: {quiet:?}"
    );
    assert_eq!((quiet.modelled, quiet.key.as_deref()), (false, Some("gyro.noise_density")));

    assert!(found(&plan(GYRO, &part[..1]), "bias").modelled, "as drawn from the tolerance");
    assert!(find(&plan(GYRO, &[]), "bias").is_none(), "nothing says how large it would be");
}

#[test]
fn half_a_count_and_a_tenth_of_the_noise_divide_seen_from_below() {
    let against = |resolution, noise| Against { resolution, noise };
    for (against, threshold) in [
        (against(Some(2.0), None), 1.0),
        (against(None, Some(3.0)), 0.3),
        (against(Some(2.0), Some(3.0)), 1.0),
        (against(Some(2.0), Some(30.0)), 3.0),
    ] {
        assert!((against.threshold() - threshold).abs() < 1e-15);
        assert!(against.shows(threshold * (1.0 + 1e-9)) && !against.shows(threshold * (1.0 - 1e-9)));
    }
    assert!(against(None, None).shows(f64::MIN_POSITIVE) && !against(None, None).shows(0.0));

    // As a scene: a bias just below half a count never moves a level gyro's count, one just above always does.
    for (bias, verdict, moved) in
        [("0.499 deg/s", Verdict::Needless, 0.0), ("0.501 deg/s", Verdict::Seen, 1.0)]
    {
        let with = plan(GYRO, &["gyro.resolution=1 deg/s", &format!("gyro.bias={bias}")]);
        assert_eq!(found(&with, "bias").verdict, verdict);
        let measured = largest(&differences(&with, &plan(GYRO, &["gyro.resolution=1 deg/s"])));
        assert!((measured.to_degrees() - moved).abs() < 1e-12, "{bias}: {measured}");
    }
}

#[test]
fn an_effect_is_judged_on_the_axis_that_shows_it_most() {
    let uneven = ["gyro.noise_std=[1, 0.01, 1] deg/s", "gyro.bias=[0.09, 0.002, 0.01] deg/s"];
    let bias = found(&plan(GYRO, &uneven), "bias");
    assert_eq!((bias.axis, bias.verdict), ("y", Verdict::Seen), "smaller, but on a quiet axis: {bias:?}");
    // Noise does not hide itself, nor rounding.
    let alone = plan(GYRO, &["gyro.noise_std=1 deg/s"]);
    assert_eq!(found(&alone, "white_noise").verdict, Verdict::Seen);
    for (count, noise, rounding) in [
        ("1 deg/s", Verdict::Seen, Verdict::Seen),
        ("2.1 deg/s", Verdict::Needless, Verdict::Seen),
        ("0.19 deg/s", Verdict::Seen, Verdict::Needless),
    ] {
        let plan = plan(GYRO, &["gyro.noise_std=1 deg/s", &format!("gyro.resolution={count}")]);
        assert_eq!(found(&plan, "white_noise").verdict, noise, "{count}");
        assert_eq!(found(&plan, "resolution").verdict, rounding, "{count}");
    }
}

/// Every error term, named or measured, shows up; and measuring agrees with the closed forms where both are sure.
#[test]
fn a_term_without_an_entry_is_measured_by_leaving_it_out() {
    let all = plan(
        ROCK,
        &[
            "gyro.bias=[0.1, -0.2, 0.3] deg/s",
            "gyro.bias_instability=20 deg/h",
            "gyro.correlation_time=12 s",
            "gyro.bias_random_walk=0.01 deg/s/√s",
            "gyro.noise_std=0.1 deg/s",
            "gyro.range=2000 deg/s",
            "gyro.resolution=0.1 deg/s",
        ],
    );
    let sensor = &all.sensors[0];
    let listed: Vec<_> = effects(&all).iter().map(|effect| effect.effect).collect();
    for term in all.build(sensor).terms() {
        assert!(listed.contains(term), "{term} in {listed:?}");
    }
    let survey = Survey::new(&all, sensor);
    let measured = |term| measured::measure(&survey, term).unwrap();
    let bias = measured("bias");
    assert!((bias.size - DVec3::new(0.1, 0.2, 0.3).map(f64::to_radians)).length() < 1e-12, "{bias:?}");
    assert_eq!(bias.key.as_deref(), Some("gyro.bias"));
    // Among 5000 normal numbers an axis the largest is between 3 and 5.5 σ (outside: less than once in 10⁻³).
    let noise = measured("white_noise").size / 0.1f64.to_radians();
    assert!(noise.min_element() > 3.0 && noise.max_element() < 5.5, "{noise:?}");
    assert_eq!(measured("resolution").size, DVec3::ZERO, "rounding is left out of both");
    assert!(measured::others(&survey).is_empty(), "each term of today has an entry");
}

/// Each as large as what it changes, and as the datasheet has it where the scene calibrates it away.
#[test]
fn scale_iron_bends_and_g_are_as_large_as_what_they_change() {
    for (sensor, set, name) in [
        ("gyro", "gyro.scale_error=[1, -2, 0.5] %", "matrix"),
        ("gyro", "gyro.misalignment=[1, -2, 3] deg", "matrix"),
        ("accel", "accel.matrix=[1.01, 0.98, 1]", "matrix"),
        ("mag", "mag.hard_iron=[3, -5, 1] uT", "hard_iron"),
        ("gyro", "gyro.g_sensitivity=[0.1, 0.2, 0.05] deg/s/g", "g_sensitivity"),
    ] {
        let text = ROCK.replace("gyro", sensor).replace("\"roll\"", "\"pitch\"");
        let with = plan(&text, &[set]);
        let effect = found(&with, name);
        let differences = differences(&with, &plan(&text, &[]));
        let axis = ["x", "y", "z"].iter().position(|axis| *axis == effect.axis).unwrap();
        let measured = differences.iter().fold(0f64, |most, v| most.max(v[axis].abs()));
        assert!(
            (effect.size / measured - 1.0).abs() < 1e-9 && effect.modelled,
            "{set}: {effect:?} {measured}"
        );
        assert_eq!(effect.key.as_deref(), set.split_once('=').map(|(key, _)| key), "{set}");
    }
    // 200 deg/s of full scale, of which the swing of 100 deg/s is half.
    let text = ["gyro.nonlinearity=0.5 %", "gyro.range=200 deg/s"];
    let with = plan(ROCK, &text);
    let (bent, measured) =
        (found(&with, "nonlinearity"), largest(&differences(&with, &plan(ROCK, &text[1..]))));
    assert!(
        (bent.size.to_degrees() - 1.0).abs() < 1e-5 && (measured / bent.size - 1.0).abs() < 1e-6,
        "{bent:?}"
    );

    let calibrated = plan(
        GYRO,
        &[
            r#"gyro.part="MPU-6050""#,
            "gyro.scale_error=0 %",
            "gyro.misalignment=0 deg",
            "gyro.g_sensitivity=0 deg/s/g",
        ],
    );
    let missing = found(&calibrated, "g_sensitivity");
    assert!((missing.size.to_degrees() - 0.1).abs() < 1e-3, "the sheet's 0.1 deg/s of 1 g: {missing:?}");
    assert_eq!((missing.verdict, missing.key.as_deref()), (Verdict::Missing, Some("gyro.g_sensitivity")));
}
