use super::*;
use crate::geometry::{Attitude, Nav, Vector, exp};
use crate::motion::rotate::constant;
use crate::motion::{Motion, Trajectory};
use crate::time::{NANOS, Rate, SimTime};
use glam::{DQuat, DVec3};
use proptest::prelude::*;

const GRAVITY: Vector<Nav> = Vector::new(0.0, 0.0, 9.80665);
const FIELD: Vector<Nav> = Vector::new(15.0, 3.2, 50.3);

/// As many copies of `w` as a step of `method` reads.
fn inputs<R: Real>(method: &MethodKind, w: DVec3) -> Vec<Triple<R>> {
    vec![Triple::from(w); method.input.count()]
}

fn turning() -> Trajectory {
    let motions: Vec<(SimTime, Box<dyn Motion>)> =
        vec![(SimTime(NANOS), constant([0.5, 0.0, 0.0])), (SimTime(2 * NANOS), constant([0.3, -4.0, 30.0]))];
    let start = Attitude::from_quat(exp(DVec3::new(0.3, -1.2, 0.5)));
    Trajectory::new(start, motions, vec![], GRAVITY, FIELD)
}

#[test]
fn names_are_found_and_no_two_are_the_same() {
    for (i, method) in METHODS.iter().enumerate() {
        assert_eq!(METHODS.iter().position(|other| other.name == method.name), Some(i));
        assert_eq!(find(method.name).map(|found| found.name), Some(method.name));
        assert!(method.precisions.contains(&Precision::Double));
    }
    assert!(find("runge").is_none());
}

#[test]
fn at_rest_nothing_turns() {
    let q = exp(DVec3::new(0.3, -1.2, 0.5));
    for method in METHODS {
        let still = method.run::<f64>(q.into(), 0.01, &inputs(method, DVec3::ZERO)).unwrap();
        assert!((DQuat::from(still) - q).length() < 3e-16, "{}", method.name);
    }
}

/// The common checks reject bad input: each reason, at the right step, in both precisions.
#[test]
fn what_cannot_be_stepped_through_is_refused_with_the_reason() {
    fn refusals<R: Real>(method: &MethodKind) {
        let (q, h) = (Quaternion::<R>::identity(), R::of(0.01));
        let good = inputs::<R>(method, DVec3::new(0.1, -0.2, 0.3));
        let why = |q, h, inputs: &[Triple<R>]| {
            method.run(q, h, inputs).map_err(|refused| (refused.step, refused.why))
        };
        assert!(why(q, h, &good).is_ok());
        assert_eq!(why(q, R::of(0.0), &good), Err((0, Why::StepNotPositive)));
        assert_eq!(why(q, R::of(-0.01), &good), Err((0, Why::StepNotPositive)));
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert_eq!(why(q, R::of(bad), &good), Err((0, Why::StepNotFinite)));
            let mut inputs = [&good[..], &good[..]].concat();
            inputs[good.len()].y = R::of(bad);
            assert_eq!(why(q, h, &inputs), Err((1, Why::InputNotFinite)));
            let lost = Quaternion { w: R::of(bad), ..q };
            assert_eq!(why(lost, h, &good), Err((0, Why::AttitudeNotFinite)));
        }
        assert_eq!(why(q * R::of(0.0), h, &good), Err((0, Why::AttitudeZero)));
        assert_eq!(why(q, h, &[]), Err((0, Why::InputMissing)));
        if good.len() > 1 {
            assert_eq!(why(q, h, &good[1..]), Err((0, Why::InputMissing)));
        }
    }
    for method in METHODS {
        refusals::<f64>(method);
        refusals::<f32>(method);
    }
    let refused = Refused { step: 3, why: Why::StepNotPositive };
    assert_eq!(refused.to_string(), "step 3 refused: the step's length is not above zero");
}

proptest! {
    /// Any input gives an attitude or a reason; never a NaN, never a panic.
    #[test]
    fn no_nan_ever_comes_out(bits in prop::array::uniform8(any::<u64>()), h in any::<u64>()) {
        let [w, x, y, z, a, b, c, d] = bits.map(f64::from_bits);
        for method in METHODS {
            let mut inputs = inputs::<f64>(method, DVec3::new(a, b, c));
            if let Some(last) = inputs.last_mut() {
                last.x = d;
            }
            let start = DQuat::from_xyzw(x, y, z, w);
            if let Ok(q) = method.run(start.into(), f64::from_bits(h), &inputs) {
                let q = DQuat::from(q);
                prop_assert!(q.is_finite() && q != DQuat::from_array([0.0; 4]), "{}", method.name);
            }
        }
    }

    /// A step does not depend on its start: turning the start turns the end.
    #[test]
    fn a_step_turns_with_its_start(v in prop::array::uniform3(-3.0..3.0f64), w in prop::array::uniform3(-20.0..20.0f64)) {
        let start = exp(DVec3::from_array(v));
        for method in METHODS {
            let inputs = inputs::<f64>(method, DVec3::from_array(w) * 0.01);
            let from = |q: DQuat| DQuat::from(method.run::<f64>(q.into(), 0.01, &inputs).unwrap());
            prop_assert!((from(start) - start * from(DQuat::IDENTITY)).length() < 1e-14, "{}", method.name);
        }
    }
}

#[test]
fn the_reference_of_increments_is_the_truth_where_the_rate_is_constant_between_ticks() {
    let (path, end) = (turning(), SimTime(3 * NANOS));
    for (method, rate) in
        [("increment-1", Rate::hz(100)), ("coning-2", Rate::hz(100)), ("coning-4", Rate::hz(1000))]
    {
        let series = reference(&path, rate, end, method).unwrap();
        for (t, attitude) in &series {
            let off = attitude.angle_to(path.at(*t).attitude).to_degrees();
            assert!(off < 1e-9, "{method} at {t}: {off} deg");
        }
    }
}

#[test]
fn the_reference_has_an_attitude_at_the_end_of_each_whole_step() {
    let (path, end) = (turning(), SimTime(NANOS));
    for (method, rate, count) in [
        ("paper", Rate::hz(100), 100),
        ("magnus-4", Rate::new(400, 3).unwrap(), 134),
        ("coning-3", Rate::hz(100), 34),
        ("polynomial-fit", Rate::hz(100), 13),
    ] {
        let series = reference(&path, rate, end, method).unwrap();
        let samples = find(method).unwrap().input.samples() as u64;
        assert_eq!(series.len(), count, "{method}");
        for (i, (t, attitude)) in series.iter().enumerate() {
            assert_eq!(*t, rate.tick(i as u64 * samples));
            assert!((attitude.q.length() - 1.0).abs() < 1e-15);
            // Within about the turn of one sample, because of what a step reads at the seam.
            assert!(attitude.angle_to(path.at(*t).attitude) < 0.01, "{method} at {t}");
        }
        assert!(series.windows(2).all(|pair| pair[0].1.q.dot(pair[1].1.q) > 0.0), "{method}: the sign jumps");
    }
    assert_eq!(reference(&path, Rate::hz(100), SimTime::ZERO, "paper"), Ok(vec![]));
}

#[test]
fn an_unknown_method_is_answered_with_those_there_are() {
    let message = reference(&turning(), Rate::hz(100), SimTime(NANOS), "runge").unwrap_err().to_string();
    assert!(message.starts_with("no method `runge`; the methods are euler, paper, "), "{message}");
}

#[test]
fn the_reference_of_accelerometer_and_magnetometer_is_the_truth() {
    let path = turning();
    for step in from_accel_mag(&path, Rate::hz(100), SimTime(3 * NANOS)) {
        let Step { t, attitude, norm } = step.unwrap();
        assert!(attitude.angle_to(path.at(t).attitude) < 1e-14 && norm == 1.0, "{t}");
    }
}

#[test]
fn without_gravity_or_a_level_part_of_the_field_there_is_no_reference() {
    for (gravity, field, expected) in [
        (Vector::ZERO, FIELD, Degenerate::NoForce),
        (GRAVITY, Vector::ZERO, Degenerate::NoField),
        (GRAVITY, Vector::new(0.0, 0.0, 55.0), Degenerate::Parallel),
    ] {
        let path = Trajectory::new(Attitude::IDENTITY, vec![], vec![], gravity, field);
        let refused = from_accel_mag(&path, Rate::hz(100), SimTime(NANOS)).next().unwrap().unwrap_err();
        assert_eq!(refused, ReferenceError::Degenerate { t: SimTime::ZERO, why: expected });
    }
}
