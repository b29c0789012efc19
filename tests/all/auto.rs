//! `method = "auto"` on motions that nothing was tuned on: what it chooses stays within the tolerance, and nothing that
//! is listed as cheaper would have. Both are found here from the methods' formulas alone, by another walk than the
//! program's.

use ratetable::motion::Trajectory;
use ratetable::motion::method::{Input, METHODS, MethodKind, Quaternion, ToleranceError, Triple, choose};
use ratetable::scene::Plan;
use ratetable::time::{NANOS, Rate, SimTime};

const HELD_OUT: [(&str, &str); 6] = [
    (
        "narrow cone",
        "kind = \"cone\"\nhalf_angle = \"2.5 deg\"\nfrequency = \"3.1 Hz\"\nduration = \"7 s\"\n",
    ),
    (
        "rocking",
        "kind = \"rock\"\naxis = \"pitch\"\namplitude = \"117 deg/s\"\nfrequency = \"1 Hz\"\nduration = \"8 s\"\n",
    ),
    ("fast turn", "kind = \"rotate\"\nangular_rate = \"[731, -400, 95] deg/s\"\nduration = \"6 s\"\n"),
    ("random", "kind = \"random\"\namplitude = \"60 deg/s\"\nbandwidth = \"2 Hz\"\nduration = \"9 s\"\n"),
    (
        "waypoints",
        "kind = \"waypoints\"\nkeys = [{ t = \"2 s\", attitude = \"[20, 30, -100] deg\" }, { t = \"5 s\", attitude = \"[-60, 10, 170] deg\" }]\nduration = \"6 s\"\n",
    ),
    ("coordinated turn", "kind = \"circle\"\nbank = \"32 deg\"\nspeed = \"21 m/s\"\nduration = \"9 s\"\n"),
];

fn trajectory(motion: &str) -> (Trajectory, SimTime) {
    let text = format!("seed = 7\n[[motion]]\n{motion}[gyro]\nrate = \"400 Hz\"\n");
    let plan = Plan::parse(&text, "held-out", "held-out", &[]).unwrap_or_else(|error| panic!("{error}"));
    (plan.trajectory, plan.duration)
}

fn cost(method: &MethodKind, hz: f64) -> f64 {
    f64::from(method.ns_per_step) * hz / method.input.samples() as f64
}

/// The largest angle (degrees) from the truth at the ends of steps from 0 to before `end`.
fn error(path: &Trajectory, method: &MethodKind, rate: Rate, end: SimTime) -> f64 {
    let samples = method.input.samples() as u64;
    let seconds = |t: SimTime| t.0 as f64 / NANOS as f64;
    let (mut q, mut largest) = (Quaternion::<f64>::from(path.at(SimTime::ZERO).attitude.q), 0f64);
    for k in 0.. {
        let (from, to) = (rate.tick(k * samples), rate.tick((k + 1) * samples));
        if to >= end {
            return largest;
        }
        let inputs: Vec<Triple<f64>> = match method.input {
            Input::Rate(fractions) => {
                let at = |c: &f64| SimTime(from.0 + (c * (to - from).0 as f64).round() as i64);
                fractions.iter().map(|c| Triple::from(path.at(at(c)).rate.v)).collect()
            }
            Input::Increments(_) => (k * samples..(k + 1) * samples)
                .map(|k| (rate.tick(k), rate.tick(k + 1)))
                .map(|(from, to)| Triple::from(path.mean(from, to).rate.v * seconds(to - from)))
                .collect(),
        };
        let Ok(next) = method.run(q, seconds(to - from), &inputs) else { return f64::INFINITY };
        q = next;
        let angle = glam::DQuat::from(q.normalised()).conjugate() * path.at(to).attitude.q;
        let angle = 2.0 * angle.xyz().length().atan2(angle.w.abs());
        largest = largest.max(angle.to_degrees());
    }
    unreachable!()
}

#[test]
fn it_stays_within_the_tolerance_and_nothing_cheaper_would() {
    let gyro = Rate::hz(400);
    for (name, motion) in HELD_OUT {
        let (path, end) = trajectory(motion);
        for tolerance in [0.3, 1e-3, 1e-6] {
            let choice = choose(&path, gyro, end, tolerance).unwrap_or_else(|why| panic!("{name}: {why}"));
            let found = error(&path, choice.method, choice.rate, end);
            assert!(found <= tolerance, "{name}, {tolerance} deg: {choice}, but it is {found} deg off");
            assert!(
                (found - choice.error_deg).abs() <= 1e-3 * found + 1e-11,
                "{name}: {choice}, found {found}"
            );
            assert_eq!(choice.ns_per_simulated_s, cost(choice.method, choice.rate.as_hz()));
            let rates = (0..=14).map(|k| gyro.times(16, 1 << k).expect("a rate"));
            let mut cheaper = 0;
            for (method, rate) in rates.flat_map(|rate| METHODS.map(|method| (method, rate))) {
                let steps = rate.ticks_before(SimTime::ZERO, end) / method.input.samples() as u64;
                if steps < 9 || cost(method, rate.as_hz()) >= choice.ns_per_simulated_s {
                    continue;
                }
                cheaper += 1;
                let half = rate.times(2, 1).expect("a rate");
                let worst = error(&path, method, rate, end).max(error(&path, method, half, end));
                assert!(
                    worst > tolerance,
                    "{name}, {tolerance} deg: {} at {rate} is cheaper than {choice}",
                    method.name
                );
            }
            assert!(cheaper <= choice.missed.map_or(0, |missed| missed.among), "{name}: {choice}");
        }
    }
}

#[test]
fn a_step_as_long_as_the_period_is_not_taken_for_exact() {
    // Rocking at 1 Hz is back where it was every second, and at rest for whom looks once a second.
    let (path, end) = trajectory(HELD_OUT[1].1);
    let by_chance = METHODS.into_iter().find(|method| method.name == "paper").expect("listed");
    assert!(error(&path, by_chance, Rate::hz(1), end) < 1e-9);
    let choice = choose(&path, Rate::hz(64), end, 1e-3).expect("something is good enough");
    assert!(cost(by_chance, 1.0) < choice.ns_per_simulated_s, "{choice}");
    assert!(matches!(choice.method.input, Input::Increments(_)), "{choice}");
}

#[test]
fn what_cannot_be_met_says_so() {
    let (path, end) = trajectory(HELD_OUT[3].1);
    let unmet = choose(&path, Rate::hz(400), end, 1e-17).unwrap_err();
    assert_eq!(unmet, ToleranceError::Unmet { tolerance_deg: 1e-17, fastest: Rate::hz(6400) });
    assert!(unmet.to_string().contains("no method at any rate up to 6400 Hz stays within"), "{unmet}");
    let short = choose(&path, Rate::hz(400), SimTime(1_000), 1.0).unwrap_err();
    let says = |part| short.to_string().contains(part);
    assert!(says("makes 8 steps in") && says("name a method, or lengthen the scene"), "{short}");
}
