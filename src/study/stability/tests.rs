use super::*;
use crate::motion::method::find;

/// As little as gives a verdict.
const BRIEF: Effort = Effort { drift_steps: 20_000, single_s: 20 };

fn row(method: &str, case: &str) -> Row {
    let case = CASES.iter().find(|known| known.name == case).unwrap_or_else(|| panic!("no case {case}"));
    case.row(find(method).unwrap(), BRIEF)
}

#[test]
fn every_method_has_a_verdict_in_every_case() {
    let rows = run(BRIEF, 2, &|_, _| ());
    assert_eq!(rows.len(), METHODS.len() * CASES.len());
    for row in &rows {
        assert!(!row.figure.is_nan() && row.figure >= 0.0, "{row:?}");
        assert_eq!(row.first_failing_step.is_some(), row.verdict == Verdict::Fails, "{row:?}");
    }
}

#[test]
fn nothing_that_cannot_be_stepped_through_is_accepted() {
    for method in METHODS {
        for case in ["step-zero", "step-negative", "not-finite"] {
            assert_eq!(row(method.name, case).verdict, Verdict::Stable, "{} {case}", method.name);
        }
    }
}

#[test]
fn the_sign_of_q_and_the_poles_of_pitch_are_nothing_to_a_quaternion() {
    for method in METHODS {
        for case in ["sign-flip", "pitch-90", "pitch-near-90"] {
            assert!(row(method.name, case).figure < 1e-9, "{} {case}", method.name);
        }
    }
}

#[test]
fn exponentials_turn_by_any_angle_and_linear_steps_do_not() {
    for case in ["angle-near-pi", "angle-beyond-pi", "angle-near-2pi", "angle-beyond-2pi"] {
        for method in METHODS {
            let row = row(method.name, case);
            match method.name {
                "euler" | "paper" | "paper-normalised" | "rk4" => {
                    assert_eq!((row.verdict, row.first_failing_step), (Verdict::Fails, Some(1)), "{row:?}")
                }
                _ => assert_eq!(row.verdict, Verdict::Stable, "{row:?}"),
            }
        }
    }
}

#[test]
fn the_papers_norm_grows_past_use_and_the_step_is_found() {
    // 200 deg/s at 1 kHz: (θ/2)⁴/6 = 1.55·10⁻¹² a step.
    let row = row("paper", "norm-1e9-steps");
    assert!((row.figure / 1.546e-3 - 1.0).abs() < 0.01 && row.verdict == Verdict::Degraded, "{row:?}");
    for method in ["paper-normalised", "euler", "rk4"] {
        assert!(self::row(method, "norm-1e9-steps").figure < 1e-6, "{method}");
    }
}

#[test]
fn coning_faster_than_half_the_rate_defeats_every_method() {
    for method in METHODS {
        let row = row(method.name, "coning-beyond-nyquist");
        assert_eq!(row.verdict, Verdict::Fails, "{row:?}");
        assert!(row.first_failing_step.is_some_and(|step| step > 100), "{row:?}");
    }
}

#[test]
fn a_figure_at_a_limit_is_on_its_better_side() {
    let limits = Limits::ANGLE;
    for (figure, verdict) in [
        (0.0, Verdict::Stable),
        (1e-3, Verdict::Stable),
        (1.1e-3, Verdict::Degraded),
        (1.0, Verdict::Degraded),
        (1.1, Verdict::Fails),
        (f64::INFINITY, Verdict::Fails),
    ] {
        assert_eq!(limits.verdict(figure), verdict, "{figure}");
    }
}

#[test]
fn a_row_has_the_columns_of_the_table() {
    let row = Row {
        method: "paper",
        case: "angle-near-pi",
        verdict: Verdict::Fails,
        figure: 90.0,
        first_failing_step: Some(1),
    };
    let mut table = csv::Writer::from_writer(vec![]);
    table.serialize(row).unwrap();
    let text = String::from_utf8(table.into_inner().unwrap()).unwrap();
    assert_eq!(text, "method,case,verdict,figure,first_failing_step\npaper,angle-near-pi,fails,90.0,1\n");
}
