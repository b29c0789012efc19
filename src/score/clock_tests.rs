//! Clocks, delays and disturbances: an offset is right within 5 ms or declared unknown, and no figure is ever wrong
//! without a notice.

use super::*;
use crate::geometry::{Attitude, Euler, exp};
use crate::random;
use crate::time::SimTime;
use glam::DVec3;
use rand::{Rng, RngExt};
use std::f64::consts::TAU;

/// How long each motion lasts, s.
const LASTS: f64 = 40.0;

/// Attitudes as functions of time, s.
type Motion = fn(f64) -> Attitude;

fn euler(roll: f64, pitch: f64, yaw: f64) -> Attitude {
    Attitude::from_quat(Euler { roll, pitch, yaw }.to_quat())
}

/// From 0 to 1 around `at`, within `over` seconds, smoothly.
fn step(t: f64, at: f64, over: f64) -> f64 {
    let u = ((t - at) / over).clamp(0.0, 1.0);
    u * u * u * (10.0 - u * (15.0 - 6.0 * u))
}

/// Turns about every axis that never repeat.
fn flight(t: f64) -> Attitude {
    euler(0.45 * libm::sin(0.7 * t), 0.25 * libm::sin(1.1 * t + 0.5), 0.1 * t + 0.5 * libm::sin(0.3 * t))
}

/// Rest, then a sequence of turns.
fn turns(t: f64) -> Attitude {
    let roll = 0.5 * (step(t, 8.0, 2.0) - step(t, 12.0, 2.0));
    let pitch = 0.4 * (step(t, 16.0, 1.5) - step(t, 19.0, 3.0));
    euler(roll, pitch, 1.5 * step(t, 24.0, 4.0) - 0.8 * step(t, 33.0, 2.0))
}

/// Ten fast turns that end where they began.
fn pirouette(t: f64) -> Attitude {
    euler(0.1 * step(t, 3.0, 1.0), 0.0, 10.0 * TAU * step(t, 12.0, 5.0) - TAU * step(t, 25.0, 4.0))
}

/// A cone at 2 Hz that opens and closes.
fn cone(t: f64) -> Attitude {
    let size = 0.087 * (step(t, 5.0, 2.0) - step(t, 30.0, 6.0));
    let turn = TAU * 2.0 * t;
    Attitude::from_quat(
        exp(DVec3::new(libm::cos(turn), libm::sin(turn), 0.0) * size)
            * exp(DVec3::Z * 0.4 * step(t, 15.0, 8.0)),
    )
}

/// Vibration at 37 Hz under slow tilts.
fn vibration(t: f64) -> Attitude {
    let shake = 0.002 * libm::sin(TAU * 37.0 * t) * step(t, 2.0, 1.0);
    euler(0.3 * (step(t, 10.0, 2.0) - step(t, 26.0, 3.0)) + shake, 0.3 * step(t, 18.0, 2.0) - shake, 0.0)
}

/// A rocking that repeats without end.
fn rocking(t: f64) -> Attitude {
    euler(0.35 * libm::sin(TAU * 0.25 * t), 0.0, 0.0)
}

const MOTIONS: [(&str, Motion); 6] = [
    ("flight", flight),
    ("turns", turns),
    ("pirouette", pirouette),
    ("cone", cone),
    ("vibration", vibration),
    ("rocking", rocking),
];

/// The known properties of a generated estimate.
#[derive(Debug)]
struct Made {
    /// Its clock ahead of the truth's, delay included, s.
    ahead: f64,
    series: Series,
    /// The root mean square error at the times when the estimates held, deg.
    rms_deg: f64,
}

fn normal(random: &mut impl Rng) -> f64 {
    (0..12).map(|_| random.random::<f64>()).sum::<f64>() - 6.0
}

/// An estimate of a motion. Its clock is `offset` s ahead; it has a delay, a heading error of 0 to 180 degrees, a
/// drift of up to 5 degrees, noise and lost stretches, and starts before or after the scene.
fn make(motion: Motion, seed: u64, offset: Option<f64>) -> Made {
    let mut random = random::stream(seed, "clocks");
    let rate = [20.0, 50.0, 100.0, 200.0][random.random_range(0..4)];
    let before = [0.0, 0.0, 5.0, 20.0][random.random_range(0..4)];
    let cut = [0.0, 0.0, 0.3][random.random_range(0..3)] * LASTS;
    let heading = random.random_range(0.0..180f64).to_radians();
    let wander = random.random_range(0.0..5f64).to_radians();
    let delay = if random.random() { random.random_range(0.0..0.2) } else { 0.0 };
    let noise = [0.0, 0.02f64, 0.2][random.random_range(0..3)].to_radians();
    let offset = offset.unwrap_or_else(|| random.random_range(-100.0..100.0));
    let waves: Vec<[f64; 5]> = (0..4)
        .map(|_| {
            let period = random.random_range(5.0..30.0);
            [
                period,
                random.random_range(0.0..TAU),
                normal(&mut random),
                normal(&mut random),
                normal(&mut random),
            ]
        })
        .collect();
    // A sum of four waves with normal coefficients has this root mean square.
    let size = wander
        / libm::sqrt(waves.iter().map(|w| (w[2] * w[2] + w[3] * w[3] + w[4] * w[4]) / 2.0).sum::<f64>());
    let drift = |t: f64| -> DVec3 {
        waves.iter().map(|w| DVec3::new(w[2], w[3], w[4]) * libm::sin(TAU * t / w[0] + w[1])).sum::<DVec3>()
            * size
    };
    let lost: Vec<(f64, f64)> = (0..random.random_range(0..4))
        .map(|_| {
            let from = random.random_range(0.0..LASTS);
            (from, from + random.random_range(0.0..3.0))
        })
        .collect();
    let (mut rows, mut square, mut count) = (Vec::new(), 0.0, 0.0);
    for k in 0..((LASTS + before - cut) * rate) as i64 {
        let held = k as f64 / rate - before + random.random_range(-0.2..0.2) / rate;
        if lost.iter().any(|(from, to)| (*from..*to).contains(&held)) {
            continue;
        }
        let shake = DVec3::new(normal(&mut random), normal(&mut random), normal(&mut random)) * noise;
        let truth = motion(held.clamp(0.0, LASTS));
        let q = exp(DVec3::Z * heading) * exp(drift(held)) * truth.q * exp(shake);
        if (0.0..=LASTS).contains(&held) {
            square += truth.angle_to(Attitude::from_quat(q)).to_degrees().powi(2);
            count += 1.0;
        }
        rows.push((((held + offset + delay) * 1e9) as i64, Attitude::from_quat(q)));
    }
    Made { ahead: offset + delay, series: Series::new(rows), rms_deg: libm::sqrt(square / count) }
}

/// The options for a clock that leaves no doubt.
fn options() -> Options {
    let until = SimTime((LASTS * 1e9) as i64);
    Options { clock: Clock::Auto, delay: Delay::Keep, until, ..Options::default() }
}

fn judged(motion: Motion, series: &Series, options: &Options) -> Result<Judged, Unjudged> {
    judge_series(&|t: SimTime| Some(motion(t.seconds())), series.clone(), &[], options)
}

/// The result for an estimate.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Outcome {
    /// Its clock is certain, with this error, s.
    Certain(f64),
    /// It has a figure, and its clock is marked as uncertain.
    Doubtful,
    /// The times when its attitudes held are unknown, and it has no figure.
    Unknown,
}

/// The result for an estimate, or what is wrong.
fn outcome(motion: Motion, seed: u64) -> Result<Outcome, String> {
    let made = make(motion, seed, None);
    let figures = match judged(motion, &made.series, &options()) {
        Ok(judged) => judged.figures,
        Err(Unjudged::When(why)) if why.len() > 20 => return Ok(Outcome::Unknown),
        Err(other) => return Err(other.to_string()),
    };
    let (off, sharp) = match (figures.clock_offset_s, figures.fitted) {
        (Some(ahead), _) => (ahead - made.ahead, 0.005),
        // A delay comes with its standard error.
        (None, Some(fitted)) => {
            (fitted.delay_ms * 1e-3 - made.ahead, 4e-3 * fitted.delay_std_ms.unwrap_or(0.0) + 0.005)
        }
        (None, None) => return Ok(Outcome::Doubtful),
    };
    let rms = figures.fitted.map_or(figures.errors.rms_deg, |fitted| fitted.errors.rms_deg);
    // Within 5 ms if marked as certain; the figure is right in any case.
    let is_right = (rms - made.rms_deg).abs() < (0.05 * made.rms_deg).max(0.03);
    match (!is_right || figures.clock_certain && off.abs() > sharp, figures.clock_certain) {
        (true, _) => Err(format!("{off} s off, {rms} deg RMS for {}, {figures:?}", made.rms_deg)),
        (_, true) => Ok(Outcome::Certain(off)),
        _ => Ok(Outcome::Doubtful),
    }
}

/// The number of seeds for each motion; `RATETABLE_SEEDS` raises it.
fn seeds() -> u64 {
    std::env::var("RATETABLE_SEEDS").ok().and_then(|seeds| seeds.parse().ok()).unwrap_or(34)
}

#[test]
#[expect(clippy::print_stderr, reason = "how many are certain is for whoever runs it with --nocapture")]
fn an_offset_is_right_within_5_ms_or_declared_unknown() {
    let seeds = seeds();
    let cases: Vec<(usize, u64)> =
        (0..MOTIONS.len()).flat_map(|m| (0..seeds).map(move |seed| (m, seed))).collect();
    let run = |cases: &[(usize, u64)]| -> Vec<(usize, u64, Result<Outcome, String>)> {
        cases.iter().map(|&(m, seed)| (m, seed, outcome(MOTIONS[m].1, seed))).collect()
    };
    let (first, second) = cases.split_at(cases.len() / 2);
    let found = std::thread::scope(|scope| {
        let other = scope.spawn(|| run(second));
        let mut found = run(first);
        found.extend(other.join().unwrap());
        found
    });
    let wrong =
        found.iter().filter_map(|(m, seed, found)| Some((MOTIONS[*m].0, seed, found.as_ref().err()?)));
    let wrong: Vec<String> = wrong.map(|(name, seed, why)| format!("{name} {seed}: {why}")).collect();
    assert!(wrong.is_empty(), "{} wrong:\n{}", wrong.len(), wrong.join("\n"));
    for (m, (name, _)) in MOTIONS.iter().enumerate() {
        let of: Vec<Outcome> =
            found.iter().filter(|(of, ..)| *of == m).filter_map(|(.., found)| found.clone().ok()).collect();
        let certain =
            |outcome: &Outcome| if let Outcome::Certain(off) = outcome { Some(off.abs()) } else { None };
        let worst = of.iter().filter_map(certain).fold(0.0, f64::max);
        let count = |wanted: fn(&Outcome) -> bool| of.iter().filter(|outcome| wanted(outcome)).count();
        let [certain, unknown] =
            [count(|it| matches!(it, Outcome::Certain(_))), count(|it| matches!(it, Outcome::Unknown))];
        eprintln!(
            "{name}: of {seeds} {certain} certain, {:.2} ms off at most; {unknown} unknown",
            worst * 1e3
        );
        // A motion that does not repeat almost always determines a figure; one that repeats does so only with a
        // rest beside it.
        let most = if *name == "rocking" { of.len() } else { of.len() / 10 };
        assert!(unknown <= most, "{name}: {unknown} unknown");
        assert!(*name != "rocking" || certain < of.len() / 3, "{name}: {certain} certain");
    }
}

#[test]
fn a_rest_that_is_known_tells_where_a_motion_that_repeats_begins() {
    let (mut alone, mut rested) = (0, 0);
    for seed in 0..60 {
        let made = make(rocking, seed, Some(17.0));
        let is_certain = |options: &Options| match judged(rocking, &made.series, options) {
            Ok(judged) if judged.figures.clock_certain => {
                let off = judged.figures.clock_offset_s.unwrap() - made.ahead;
                assert!(off.abs() < 0.005, "{seed}: {off}");
                true
            }
            Ok(_) => false,
            Err(why) => {
                let Unjudged::When(why) = why else { panic!("{seed}: {why}") };
                assert!(why.contains("repeats") || why.contains("give or take"), "{seed}: {why}");
                false
            }
        };
        alone += usize::from(is_certain(&options()));
        rested += usize::from(is_certain(&Options { rest: SimTime(25_000_000_000), ..options() }));
    }
    // Half of them started before the scene; if the rest before it is known, most of those are found.
    assert!(rested >= alone + 8, "{rested} beside {alone}");
}

/// Negative controls.
#[test]
fn of_another_flight_no_clock_is_told() {
    for (m, (name, motion)) in MOTIONS.iter().enumerate() {
        for (n, (other, _)) in MOTIONS.iter().enumerate().filter(|(n, _)| *n != m) {
            for seed in 0..2 {
                let made = make(MOTIONS[n].1, seed, Some(31.0));
                let found = judged(*motion, &made.series, &options());
                assert!(
                    matches!(found, Err(Unjudged::When(_))),
                    "{other} as {name}, {seed}: {:?}",
                    found.unwrap().figures
                );
            }
        }
    }
}

#[test]
fn on_the_truths_own_clock_nothing_is_taken_out_and_both_figures_are_told() {
    for (name, motion) in MOTIONS.iter().filter(|(name, _)| *name != "vibration") {
        // Exact but late by 120 ms, with the truth's own start and end.
        let rows =
            (0..=4000).map(|k| k as f64 * 0.01).map(|t| ((t * 1e9) as i64, motion((t - 0.12).max(0.0))));
        let series = Series::new(rows);
        let figures = judged(*motion, &series, &options()).unwrap().figures;
        let given = judged(*motion, &series, &Options { clock: Clock::Truth, ..options() }).unwrap().figures;
        assert_eq!(figures.errors, given.errors, "{name}");
        assert!(figures.clock_offset_s.is_none() && figures.errors.rms_deg > 0.1, "{name}: {figures:?}");
        assert_eq!(figures.looks, None, "{name}: late is not mistaken, {figures:?}");
        let fitted = figures.fitted.unwrap_or_else(|| panic!("{name}: {figures:?}"));
        assert!((fitted.delay_ms - 120.0).abs() < 1.0 && fitted.errors.rms_deg < 0.05, "{name}: {fitted:?}");
        let given = Options { delay: Delay::Given(120_000_000), ..options() };
        let figures = judged(*motion, &series, &Options { clock: Clock::Truth, ..given }).unwrap().figures;
        assert!((figures.fitted.unwrap().errors.rms_deg) < 0.05 && figures.errors.rms_deg > 0.1, "{name}");
    }
}

#[test]
fn what_an_estimate_covers_is_told() {
    let rows = |from: f64, to: f64, lost: std::ops::Range<f64>| {
        let times = (0..).map(move |k| from + f64::from(k) * 0.02).take_while(move |t| *t < to);
        let times = times.filter(move |t| !lost.contains(t));
        Series::new(times.map(|t| ((t * 1e9) as i64, flight(t))))
    };
    let options = Options { clock: Clock::Truth, ..options() };
    for (series, share) in [
        (rows(0.0, LASTS, 0.0..0.0), 1.0),
        (rows(25.0, LASTS, 0.0..0.0), 15.0 / LASTS),
        (rows(0.0, LASTS, 10.0..30.0), 0.5),
        (rows(-30.0, LASTS + 50.0, 10.0..30.0), 0.5),
    ] {
        let figures = judged(flight, &series, &options).unwrap().figures;
        assert!((figures.coverage - share).abs() < 0.002, "{share}: {}", figures.coverage);
    }
}

#[test]
fn a_turned_world_and_body_are_found_and_named() {
    let (world, body) = (exp(DVec3::new(0.1, 0.2, 0.6)), exp(DVec3::new(0.0, 0.17, 0.0)));
    let rows = (0..2000)
        .map(|k| k as f64 * 0.02)
        .map(|t| ((t * 1e9) as i64 + 300_000_000_000, Attitude::from_quat(world * flight(t).q * body)));
    let series = Series::new(rows);
    let given = judged(flight, &series, &options()).unwrap();
    assert!(given.figures.errors.rms_deg > 20.0 && given.figures.clock_certain, "{:?}", given.figures);
    let (turned, rms) = given.turned.unwrap();
    assert!(rms < 0.05 && (turned.body_deg - 0.17f64.to_degrees()).abs() < 0.1, "{turned:?} {rms}");
    let aligned = judged(flight, &series, &Options { align: Align::Frames, ..options() }).unwrap().figures;
    let angles = aligned.aligned.unwrap();
    let expected = DVec3::new(0.1, 0.2, 0.6).length().to_degrees();
    assert!((angles.world_deg - expected).abs() < 0.1 && aligned.errors.rms_deg < 0.05, "{angles:?}");
    assert!((aligned.clock_offset_s.unwrap() - 300.0).abs() < 0.001);
}
