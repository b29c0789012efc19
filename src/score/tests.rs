//! Known errors, delays, offsets and mistakes of estimates come back exactly.

use super::looks::MISTAKES;
use super::*;
use crate::geometry::{Attitude, Euler, exp};
use crate::random;
use crate::time::SimTime;
use glam::{DQuat, DVec3};
use rand::RngExt;

/// A flight that turns about every axis.
fn flight(t: SimTime) -> Attitude {
    let t = t.seconds();
    let roll = 0.45 * libm::sin(0.7 * t);
    let pitch = 0.25 * libm::sin(1.1 * t + 0.5);
    let yaw = 0.4 * t + 0.5 * libm::sin(0.3 * t);
    Attitude::from_quat(Euler { roll, pitch, yaw }.to_quat())
}

/// Half a minute at 50 Hz that arrives `late` ns after it held, each rotated in nav axes by `error`, rad.
fn late(late: i64, error: impl Fn(f64) -> DVec3) -> Vec<Timed> {
    let estimate = |k: i64| {
        let held = SimTime(3_000_000_000 + 20_000_000 * k);
        let attitude = Attitude::from_quat(exp(error(held.seconds())) * flight(held).q);
        Timed { arrival: held + SimTime(late), stamp: HeldAt::Arrival, attitude }
    };
    (0..1500).map(estimate).collect()
}

/// A truth that is known at every time.
fn known(truth: impl Fn(SimTime) -> Attitude) -> impl Fn(SimTime) -> Option<Attitude> {
    move |t| Some(truth(t))
}

fn rows(judged: &Judged, truth: impl Fn(SimTime) -> Attitude) -> Vec<Row> {
    let mut rows = Vec::new();
    judged.rows(&known(truth), |row| rows.push(row));
    rows
}

fn figures(estimates: &[Timed], options: Options) -> Figures {
    judge(&known(flight), estimates, &options).expect("something to judge").figures
}

fn near(a: f64, b: f64, tolerance: f64) -> bool {
    (a - b).abs() <= tolerance
}

#[test]
fn a_delay_and_a_constant_error_come_back_beside_each_other() {
    let tilt = DVec3::new(1f64.to_radians(), 0.0, 0.0);
    let heading = DVec3::new(0.0, 0.0, 3f64.to_radians());
    for delay in [-120_000_000, 0, 1_250_000, 37_312_500, 640_001_000, 1_900_000_000] {
        for (error, inclination, turn) in [(tilt, 1.0, 0.0), (heading, 0.0, 3.0), (DVec3::ZERO, 0.0, 0.0)] {
            let found = figures(&late(delay, |_| error), Options::default());
            assert_eq!(found.delay_known, DelayKnown::Estimated);
            // Within 2 µs, and the motion in 2 µs.
            assert!(near(found.delay_ms.unwrap(), delay as f64 * 1e-6, 2e-3), "{delay} {error:?}: {found:?}");
            assert!(
                near(found.errors.inclination_rms_deg, inclination, 1e-4),
                "{delay} {error:?}: {found:?}"
            );
            assert!(
                near(found.errors.heading_rms_deg, turn, 1e-4)
                    && near(found.errors.heading_max_deg, turn, 1e-4)
            );
            assert!(
                near(found.errors.rms_deg, inclination + turn, 1e-4)
                    && near(found.errors.max_deg, inclination + turn, 1e-4)
            );
            assert_eq!((found.samples, found.looks), (1500, None));
        }
    }
}

#[test]
fn noise_moves_the_delay_by_no_more_than_its_standard_error_allows() {
    let mut random = random::stream(5, "noise");
    let mut normal = || {
        // The sum of twelve uniform numbers.
        (0..12).map(|_| random.random::<f64>()).sum::<f64>() - 6.0
    };
    let noise: Vec<DVec3> = (0..1500).map(|_| DVec3::new(normal(), normal(), normal()) * 0.02).collect();
    let found =
        figures(&late(80_000_000, |t| noise[libm::round((t - 3.0) * 50.0) as usize]), Options::default());
    // 0.02 rad of noise over about 0.3 rad/s that vary and 1500 estimates is 1.7 ms; five times that.
    assert!(near(found.delay_ms.unwrap(), 80.0, 8.6), "{found:?}");
    // √3·0.02 rad, which 1500·3 numbers determine to 1 %; five times that.
    assert!(near(found.errors.rms_deg, (3f64.sqrt() * 0.02).to_degrees(), 0.1), "{found:?}");
}

#[test]
fn an_echo_makes_the_delay_exact_whatever_the_motion() {
    let still = |_: SimTime| Attitude::from_quat(exp(DVec3::new(0.1, 0.2, 0.3)));
    let estimate = |k: i64| {
        let held = SimTime(k * 10_000_000);
        let arrival = held + SimTime(1_000_000 + k % 3 * 500_000);
        Timed { arrival, stamp: HeldAt::Sample(held), attitude: still(held) }
    };
    let estimates: Vec<_> = (0..900).map(estimate).collect();
    let judged = judge(&known(still), &estimates, &Options::default()).unwrap();
    let rows = rows(&judged, still);
    assert_eq!((judged.figures.delay_ms, judged.figures.delay_known), (Some(1.5), DelayKnown::Echoed));
    assert_eq!((rows.len(), rows[7].t), (900, SimTime(70_000_000)));
    assert!(judged.figures.errors.max_deg < 1e-6);
}

#[test]
fn a_clock_of_its_own_takes_the_jitter_of_the_way_out() {
    let mut random = random::stream(9, "way");
    let mut estimates = late(0, |_| DVec3::ZERO);
    let mut way = 0.0;
    for estimate in &mut estimates {
        let held = estimate.arrival;
        // 25 ppm fast, 77 s ahead, in whole milliseconds; 5 to 25 ms of transmission.
        estimate.stamp = HeldAt::Own((77_000_000_000 + held.0 + held.0 / 40_000) / 1_000_000 * 1_000_000);
        let late = random.random_range(5_000_000..25_000_000);
        way += late as f64 * 1e-6 / 1500.0;
        estimate.arrival = held + SimTime(late);
    }
    let found = figures(&estimates, Options::default());
    assert!(near(found.delay_ms.unwrap(), way, 1.0), "{way}: {found:?}");
    // Half a millisecond of resolution is 0.01 deg here; the 20 ms of transmission would be 0.2.
    assert!(found.errors.rms_deg < 0.03, "{found:?}");
    // Without its clock the transmission jitter counts as error.
    estimates.iter_mut().for_each(|estimate| estimate.stamp = HeldAt::Arrival);
    assert!(figures(&estimates, Options::default()).errors.rms_deg > 0.1);
}

#[test]
fn a_log_of_another_clock_is_found_by_its_motion() {
    let options = Options { clock: Clock::Other, until: SimTime(60_000_000_000), ..Options::default() };
    for offset in [-2_000_000_000, 412_003_400_000, 1_763_800_000_123_456_000] {
        let found = figures(&late(offset, |_| DVec3::new(0.0, 0.01, 0.0)), options);
        assert!(near(found.clock_offset_s.unwrap(), offset as f64 * 1e-9, 3e-6), "{offset}: {found:?}");
        assert!(near(found.errors.rms_deg, 0.01f64.to_degrees(), 1e-4), "{found:?}");
        assert_eq!(found.delay_ms, None, "the two clocks' offset hides it");
    }
}

#[test]
fn of_a_log_of_another_clock_rest_alone_needs_no_motion() {
    let options = Options { clock: Clock::Other, until: SimTime(60_000_000_000), ..Options::default() };
    let log = |truth: &dyn Fn(SimTime) -> Attitude| -> Vec<Timed> {
        let held = |k: i64| SimTime(k * 20_000_000);
        let arrival = |k| held(k) + SimTime(900_000_000_000);
        (0..1500)
            .map(|k| Timed { arrival: arrival(k), stamp: HeldAt::Arrival, attitude: truth(held(k)) })
            .collect()
    };
    let still = |_: SimTime| Attitude::from_quat(exp(DVec3::X * 0.2));
    let found = judge(&known(still), &log(&still), &options).expect("rest is rest at any time").figures;
    assert!(found.errors.max_deg < 1e-6 && !found.clock_certain);
    let turn = |t: SimTime| Attitude::from_quat(exp(DVec3::Z * 0.3 * t.seconds()));
    let unjudged = judge(&known(turn), &log(&turn), &options).expect_err("an even turn may be anywhere");
    assert!(matches!(&unjudged, Unjudged::When(why) if why.contains("too even")), "{unjudged}");
}

#[test]
fn aligned_the_constant_heading_is_taken_out_and_told() {
    let wander = |t: f64| DVec3::new(0.0, 0.0, 1.1 + 0.02 * libm::sin(9.0 * t));
    let options = Options { align: Align::Heading, ..Options::default() };
    let found = figures(&late(0, wander), options);
    assert!(near(found.heading_offset_deg.unwrap(), 1.1f64.to_degrees(), 0.01), "{found:?}");
    assert!(near(found.errors.rms_deg, (0.02 / 2f64.sqrt()).to_degrees(), 0.01), "{found:?}");
    let unaligned = figures(&late(0, wander), Options::default());
    assert!(unaligned.errors.rms_deg > 60.0 && unaligned.heading_offset_deg.is_none());
}

#[test]
fn what_comes_before_it_settles_does_not_count() {
    let error = |t: f64| DVec3::new(if t < 8.0 { 0.5 } else { 0.0 }, 0.0, 0.0);
    let options = Options { from: SimTime(7_990_000_000), ..Options::default() };
    let found = figures(&late(20_000_000, error), options);
    assert!(found.errors.max_deg < 1e-3, "{found:?}");
    assert_eq!(found.samples, 1250);
    assert!(figures(&late(20_000_000, error), Options::default()).errors.max_deg > 28.0);
    let late_start = Options { from: SimTime(80_000_000_000), ..Options::default() };
    assert_eq!(judge(&known(flight), &late(0, error), &late_start).unwrap_err(), Unjudged::NoTruth);
}

#[test]
fn of_an_even_motion_no_delay_is_told() {
    let still = |_: SimTime| Attitude::IDENTITY;
    let turn = |t: SimTime| Attitude::from_quat(exp(DVec3::Z * 0.3 * t.seconds()));
    let motions: [&dyn Fn(SimTime) -> Attitude; 2] = [&still, &turn];
    for truth in motions {
        let estimate = |k: i64| {
            let arrival = SimTime(k * 20_000_000);
            Timed { arrival, stamp: HeldAt::Arrival, attitude: truth(arrival - SimTime(50_000_000)) }
        };
        let estimates: Vec<_> = (200..1500).map(estimate).collect();
        let found = judge(&known(truth), &estimates, &Options::default()).unwrap().figures;
        assert_eq!((found.delay_ms, found.delay_known), (None, DelayKnown::Unknown));
        assert!(found.delay_doubt.unwrap().contains("too even"), "{found:?}");
        // It is compared with the truth at the given times.
        let expected = truth(SimTime::ZERO).angle_to(truth(SimTime(50_000_000))).to_degrees();
        assert!(near(found.errors.rms_deg, expected, 1e-9), "{found:?}");
    }
}

#[test]
fn of_a_motion_that_repeats_the_nearest_delay_is_taken() {
    let rock = |t: SimTime| Attitude::from_quat(exp(DVec3::X * 0.4 * libm::sin(10.0 * t.seconds())));
    let estimate = |k: i64| {
        let arrival = SimTime(k * 20_000_000);
        Timed { arrival, stamp: HeldAt::Arrival, attitude: rock(arrival - SimTime(50_000_000)) }
    };
    let estimates: Vec<_> = (200..1500).map(estimate).collect();
    let found = judge(&known(rock), &estimates, &Options::default()).unwrap().figures;
    assert!(near(found.delay_ms.unwrap(), 50.0, 0.01), "{found:?}");
}

/// Estimates of the flight with a mistake; `noise` rad of other errors.
fn mistaken(make: impl Fn(DQuat) -> DQuat, noise: f64) -> Vec<Timed> {
    let mut random = random::stream(3, "mistaken");
    let mut estimates = late(30_000_000, |_| DVec3::ZERO);
    for estimate in &mut estimates {
        let mut uniform = || random.random_range(-1.0..1.0) * noise;
        let off = exp(DVec3::new(uniform(), uniform(), uniform()));
        estimate.attitude = Attitude::from_quat(make(off * estimate.attitude.q));
    }
    estimates
}

/// The mistake whose correction is under test.
fn make(name: &str) -> fn(DQuat) -> DQuat {
    let undo_of = |name: &str| MISTAKES.iter().find(|mistake| mistake.name == name).unwrap().undo;
    match name {
        "w last, read as w first" => undo_of("w first, read as w last"),
        "w first, read as w last" => undo_of("w last, read as w first"),
        "turned by 90 deg about the vertical" => undo_of("turned by -90 deg about the vertical"),
        "turned by -90 deg about the vertical" => undo_of("turned by 90 deg about the vertical"),
        "NED/ENU swapped (nav axes alone)" => |q| {
            let half = exp(DVec3::X * std::f64::consts::PI);
            crate::geometry::Axes::EnuFlu.attitude_out(Attitude::from_quat(q)) * half.conjugate()
        },
        "in radians read as degrees" => |q| {
            let Euler { roll, pitch, yaw } = Euler::from_quat(q);
            Euler { roll: roll.to_radians(), pitch: pitch.to_radians(), yaw: yaw.to_radians() }.to_quat()
        },
        other => undo_of(other),
    }
}

#[test]
fn every_mistake_is_recognised_and_named() {
    for mistake in &MISTAKES {
        let found = figures(&mistaken(make(mistake.name), 0.05), Options::default());
        assert_eq!(found.looks.as_deref(), Some(mistake.name), "{found:?}");
        // 0.05 rad uniform about each axis is 2.9 deg RMS.
        assert!(found.errors.rms_deg > 10.0 && found.looks_rms_deg.unwrap() < 3.2, "{found:?}");
    }
}

#[test]
fn another_reading_is_recognised() {
    let estimates = mistaken(|_| DQuat::IDENTITY, 0.0);
    let series = |all: &[Timed]| Series::new(all.iter().map(|it| (it.arrival.0, it.attitude)));
    let right = series(&late(0, |_| DVec3::ZERO));
    let found = judge_series(&known(flight), series(&estimates), &[("sideways", right)], &Options::default())
        .unwrap();
    assert_eq!(found.figures.looks.as_deref(), Some("sideways"));
}

#[test]
fn where_the_motion_does_not_tell_mistakes_apart_each_is_named() {
    let turn = |t: SimTime| Attitude::from_quat(exp(DVec3::Z * libm::sin(0.5 * t.seconds())));
    let estimate = |k: i64| {
        let arrival = SimTime(k * 20_000_000);
        Timed { arrival, stamp: HeldAt::Arrival, attitude: Attitude::from_quat(turn(arrival).q.conjugate()) }
    };
    let estimates: Vec<_> = (0..1500).map(estimate).collect();
    let looks = judge(&known(turn), &estimates, &Options::default()).unwrap().figures.looks.unwrap();
    assert!(looks.contains("conjugated") && looks.contains(" or ") && looks.contains("yaw sign"), "{looks}");
}

/// Negative controls: a merely poor estimate is not called a mistake.
#[test]
fn a_poor_estimate_is_not_called_a_mistake() {
    let mut random = random::stream(4, "poor");
    let mut drift = 0.0;
    let drifting: Vec<f64> = (0..1500)
        .map(|_| {
            drift += random.random_range(-1.0..1.0) * 0.05;
            drift
        })
        .collect();
    let number = |t: f64| libm::round((t - 3.0) * 50.0) as usize;
    let frozen = mistaken(|_| DQuat::IDENTITY, 0.0);
    let anywhere = mistaken(|_| DQuat::IDENTITY, 3.0);
    for (what, estimates) in [
        ("a heading that drifts", late(0, |t| DVec3::Z * drifting[number(t)])),
        ("a heading that drifts evenly", late(0, |t| DVec3::Z * 0.1 * (t - 3.0))),
        ("a tilt", late(0, |_| DVec3::X * 0.3)),
        ("a tilt that swings", late(0, |t| DVec3::Y * 0.6 * libm::sin(t))),
        ("a heading that is off", late(0, |_| DVec3::Z * 0.5)),
        ("frozen", frozen),
        ("nonsense", anywhere),
    ] {
        let found = figures(&estimates, Options::default());
        assert!(found.errors.rms_deg > 10.0, "{what}: {found:?}");
        assert_eq!(found.looks, None, "{what}: {found:?}");
    }
}
