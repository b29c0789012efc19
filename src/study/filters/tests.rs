use super::cost::Clip;
use super::play::{Played, play};
use super::*;
use crate::geometry::{Attitude, Euler, exp};
use crate::scene::Plan;
use glam::DVec3;
use std::cell::Cell;

/// A scene without errors.
fn played(motion: &str) -> Played {
    let rate = "rate = \"50 Hz\"";
    let text = format!("{motion}\n[gyro]\n{rate}\nsampling = \"average\"\n[accel]\n{rate}\n[mag]\n{rate}\n");
    play(&Plan::parse(&text, "test", "test", &[]).unwrap())
}

fn error(played: &Played, subject: &Subject, start: Option<Attitude>, from: i64) -> Errors {
    let options = Options { with_mag: subject.with_mag, declination: played.declination, start };
    let estimates = filters::run(subject.kind, &played.readings, &options);
    judge(&played.truth, &estimates, SimTime(from * 1_000_000_000), !subject.with_mag).unwrap()
}

#[test]
fn at_rest_without_noise_every_filter_converges_to_the_truth() {
    let played = played("duration = \"90 s\"\n[start]\nattitude = \"[20, 0, 50] deg\"");
    assert_eq!((played.truth.len(), played.readings.mag.len()), (4500, 4500));
    let tilted = Euler { roll: 0.2, pitch: 0.1, yaw: 1.1 }.to_quat();
    for subject in subjects() {
        // From ten degrees off.
        let errors = error(&played, &subject, Some(Attitude::from_quat(tilted)), 80);
        // Madgwick's steps are 2 · 0.1 rad/s · 20 ms = 0.23 deg long.
        assert!(errors.total < 0.23, "{}: {errors:?}", subject.name());
    }
}

#[test]
fn a_swapped_axis_is_seen() {
    let turns = ["roll", "pitch", "yaw"].map(|axis| {
        format!("[[motion]]\nkind = \"rock\"\naxis = \"{axis}\"\namplitude = \"40 deg/s\"\nfrequency = \"0.3 Hz\"\nduration = \"10 s\"\n")
    });
    let good = played(&turns.concat());
    let mut bad = good.clone();
    for (_, rate) in &mut bad.readings.gyro {
        rate.v = DVec3::new(rate.v.y, rate.v.x, rate.v.z);
    }
    for subject in subjects() {
        let [good, bad] = [&good, &bad].map(|played| error(played, &subject, None, 5));
        assert!(bad.total > 5.0 * good.total, "{}: {good:?}, swapped {bad:?}", subject.name());
    }
}

#[test]
fn heading_without_a_magnetometer_is_its_drift() {
    let at = |k: i64, yaw: f64| (SimTime(k), Attitude::from_quat(exp(DVec3::Z * yaw)));
    let truth: Vec<_> = (0..3).map(|k| at(k, 0.0)).collect();
    let turned: Vec<_> = (0..3).map(|k| at(k, 1.0 + 0.1 * k as f64)).collect();
    let drift = judge(&truth, &turned, SimTime(1), true).unwrap();
    // 0 and 0.1 rad; the one before counts for nothing.
    let rms = (0.1_f64 * 0.1 / 2.0).sqrt().to_degrees();
    assert!((drift.heading - rms).abs() < 1e-9 && (drift.total - rms).abs() < 1e-9, "{drift:?}");
    assert!(drift.inclination < 1e-6);
    let whole = judge(&truth, &turned, SimTime(1), false).unwrap();
    assert!(whole.heading > 60.0, "{whole:?}");
    let lost = [
        truth[0],
        truth[1],
        (SimTime(2), Attitude::from_quat(glam::DQuat::from_xyzw(0.0, 0.0, 0.0, f64::NAN))),
    ];
    assert_eq!(judge(&truth, &lost, SimTime(1), false), None);
    assert_eq!(judge(&truth, &turned, SimTime(9), false), None);
}

/// A clock by which a millisecond passes between two looks.
fn ticking() -> impl Fn() -> Duration {
    let looks = Cell::new(0);
    move || {
        looks.set(looks.get() + 1);
        Duration::from_millis(looks.get())
    }
}

#[test]
fn a_clock_of_its_own_gives_the_cost_of_an_update() {
    let played = played("duration = \"10 s\"");
    let now = ticking();
    for kind in FILTERS {
        let ns = Clip::new(&played.readings, true, 50).ns_per_update(kind, &now);
        assert_eq!(ns, 1e6 / 500.0, "{}", kind.name);
    }
}

#[test]
fn a_scene_is_played_at_each_rate_with_each_seed() {
    let plan = Plan::load("coning", &[]).unwrap();
    let mut scene = Scene::given("coning", &plan, &[50, 100]).unwrap();
    let hz = |rate| {
        let sensors = scene.plan(rate, 0).unwrap().sensors;
        sensors.iter().map(|sensor| sensor.rate.as_hz()).collect::<Vec<_>>()
    };
    let own: Vec<f64> = plan.sensors.iter().map(|sensor| sensor.rate.as_hz()).collect();
    assert_eq!(hz(50)[..2], [50.0, 50.0]);
    assert_eq!(hz(8000), [8000.0, own[1], own[2]], "the others keep their own rate");
    assert_ne!(scene.plan(50, 0).unwrap().seed, scene.plan(50, 1).unwrap().seed);

    scene.rates = vec![50];
    let now = ticking();
    let rows = run(&[scene.clone()], &subjects(), Effort { seeds: 2, threads: 2 }, &now, &|_, _| ()).unwrap();
    let names: Vec<_> = rows.iter().map(|row| row.filter.clone()).collect();
    assert_eq!(names, subjects().iter().map(Subject::name).collect::<Vec<_>>());
    for row in &rows {
        let (error, spread) = (row.error_deg.unwrap(), row.spread_deg.unwrap());
        assert!(error > 0.0 && spread >= 0.0 && spread < error, "{row:?}");
        assert_eq!((row.scene.as_str(), row.rate_hz), ("coning", 50));
    }
}

#[test]
fn a_scene_without_a_magnetometer_has_the_filters_that_need_none() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("bare.toml");
    let rest = "duration = \"8 s\"\n[gyro]\nrate = \"50 Hz\"\nnoise_std = \"1 deg/s\"\n";
    std::fs::write(&file, format!("{rest}[accel]\nrate = \"50 Hz\"\n")).unwrap();
    let source = file.to_str().unwrap();
    let plan = Plan::load(source, &[]).unwrap();
    let scene = Scene::given(source, &plan, &[50]).unwrap();
    let rows = run(&[scene], &subjects(), Effort { seeds: 1, threads: 1 }, &ticking(), &|_, _| ()).unwrap();
    assert_eq!(rows.len(), FILTERS.len());
    assert!(rows.iter().all(|row| row.filter.ends_with(SIX) && row.spread_deg.is_none()), "{rows:?}");

    std::fs::write(&file, rest).unwrap();
    let plan = Plan::load(source, &[]).unwrap();
    let why = Scene::given(source, &plan, &[50]).unwrap_err();
    assert!(why.contains("`bare` has no [accel]"), "{why}");
}

#[test]
fn every_built_in_scene_holds_still_for_the_start_up() {
    for scene in scenes::built_in(false).unwrap() {
        let plan = scene.plan(25, 0).unwrap();
        let moved =
            |t: SimTime| plan.trajectory.at(t).attitude.angle_to(plan.trajectory.at(SimTime::ZERO).attitude);
        assert!(moved(START_UP - SimTime(1)) < 1e-9, "{}", scene.name);
        assert!(plan.duration > START_UP + START_UP, "{}", scene.name);
    }
}
