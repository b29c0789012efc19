use super::super::subjects;
use super::*;
use crate::filters::FILTERS;

/// As little as gives a verdict.
const BRIEF: Effort = Effort { rounds: 1 };

fn row(case: &Case, estimator: Estimator) -> Row {
    case.row("control", true, estimator, BRIEF)
}

fn case(name: &str) -> &'static Case {
    CASES.iter().find(|case| case.name == name).unwrap_or_else(|| panic!("no case {name}"))
}

/// When the gyro is read: what each attitude is asked for.
fn times(trial: &Trial) -> impl Iterator<Item = SimTime> {
    trial.streams(None).gyro.map(|(t, _)| t)
}

#[test]
fn every_filter_has_a_verdict_in_every_case_that_concerns_it() {
    // The Kalman filter takes a minute in a debug build.
    let mut subjects = subjects();
    subjects.retain(|subject| subject.kind.name != "eskf");
    let rows = run(&subjects, BRIEF, 2, &|_, _| ());
    let of_mag = CASES.iter().filter(|case| case.needs_mag).count();
    assert_eq!(rows.len(), (2 * CASES.len() - of_mag) * (FILTERS.len() - 1));
    for row in &rows {
        assert!((0.0..=180.0).contains(&row.figure_deg), "{row:?}");
        assert_eq!(row.first_failing_step.is_some(), row.verdict == Verdict::Fails, "{row:?}");
        if row.case == "calm" {
            assert_eq!(row.verdict, Verdict::Stable, "{row:?}");
        }
    }
}

#[test]
fn who_knows_the_truth_is_stable_in_every_case() {
    let oracle = |trial: &Trial, each: &mut dyn FnMut(SimTime, Attitude)| {
        let mut latest = SimTime(i64::MIN);
        for t in times(trial) {
            latest = latest.max(t);
            each(t, (trial.truth)(latest.seconds()));
        }
    };
    for case in &CASES {
        let row = row(case, &oracle);
        assert!(row.verdict == Verdict::Stable && row.figure_deg < 1e-4, "{row:?}");
    }
}

#[test]
fn who_never_moves_fails_wherever_the_body_moves_and_never_comes_back_from_a_wrong_start() {
    let asleep = |trial: &Trial, each: &mut dyn FnMut(SimTime, Attitude)| {
        let start = trial.start.unwrap_or(Attitude::IDENTITY);
        times(trial).for_each(|t| each(t, start));
    };
    for (name, verdict) in [
        ("calm", Verdict::Fails),
        ("pitch-90", Verdict::Fails),
        ("day", Verdict::Fails),
        ("start-upside-down", Verdict::NeverComesBack),
        ("start-heading-180", Verdict::NeverComesBack),
        ("rate-2000", Verdict::NeverComesBack),
        ("gyro-clipped", Verdict::NeverComesBack),
    ] {
        assert_eq!(row(case(name), &asleep).verdict, verdict, "{name}");
    }
}

#[test]
fn who_is_off_for_a_while_is_degraded_if_it_is_back_in_time() {
    let until = |end: f64| {
        move |trial: &Trial, each: &mut dyn FnMut(SimTime, Attitude)| {
            for t in times(trial) {
                let truth = (trial.truth)(t.seconds());
                let off = if (12.0..end).contains(&t.seconds()) { 0.1 } else { 0.0 };
                each(t, Attitude::from_quat(truth.q * crate::geometry::exp(glam::DVec3::X * off)));
            }
        }
    };
    let free_fall = case("free-fall");
    for (end, verdict) in
        [(12.0, Verdict::Stable), (79.0, Verdict::Degraded), (82.0, Verdict::NeverComesBack)]
    {
        let row = row(free_fall, &until(end));
        assert_eq!(row.verdict, verdict, "until {end}");
        assert!(end == 12.0 || (row.figure_deg - 0.1_f64.to_degrees()).abs() < 1e-9, "{row:?}");
    }
}

#[test]
fn who_panics_or_loses_its_numbers_fails_at_that_step() {
    let panics = |trial: &Trial, each: &mut dyn FnMut(SimTime, Attitude)| {
        times(trial).take(6).for_each(|t| each(t, Attitude::IDENTITY));
        panic!("on purpose");
    };
    let lost = |trial: &Trial, each: &mut dyn FnMut(SimTime, Attitude)| {
        for (k, t) in times(trial).enumerate() {
            let w = if k < 6 { 1.0 } else { f64::NAN };
            each(t, Attitude::from_quat(glam::DQuat::from_xyzw(0.0, 0.0, 0.0, w)));
        }
    };
    let silent = |_: &Trial, _: &mut dyn FnMut(SimTime, Attitude)| ();
    let estimators: [(Estimator, u64); 3] = [(&panics, 7), (&lost, 7), (&silent, 1)];
    for (estimator, step) in estimators {
        let row = row(case("nan-gyro"), estimator);
        assert_eq!(
            (row.verdict, row.figure_deg, row.first_failing_step),
            (Verdict::Fails, 180.0, Some(step))
        );
    }
}

#[test]
fn a_filter_that_finds_its_start_is_shown_the_wrong_one() {
    let trial = (case("start-upside-down").trial)(BRIEF);
    let shown: Vec<_> = trial.streams(trial.start).accel.take_while(|(t, _)| t.0 < 0).collect();
    assert_eq!(shown.len(), 100);
    assert!(shown.iter().all(|(_, force)| force.v.z > 9.8), "upside down");
    let (first, force) = trial.streams(None).accel.next().unwrap();
    assert!(first == SimTime::ZERO && force.v.z < -9.8, "then upright");
}

#[test]
fn a_row_has_the_columns_of_the_table() {
    let row = Row {
        filter: "vqf-6d".into(),
        case: "calm",
        verdict: Verdict::NeverComesBack,
        figure_deg: 12.5,
        first_failing_step: None,
    };
    let mut table = csv::Writer::from_writer(vec![]);
    table.serialize(row).unwrap();
    assert_eq!(
        String::from_utf8(table.into_inner().unwrap()).unwrap(),
        "filter,case,verdict,figure_deg,first_failing_step\nvqf-6d,calm,never-comes-back,12.5,\n"
    );
}
