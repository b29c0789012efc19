use super::*;
use crate::double::Double;
use crate::motion::method::find;
use crate::study::motions::{self, Cone, Sines, Turn};
use glam::DVec3;

fn error(method: &str, path: &dyn Path, hz: f64, duration: f64) -> End {
    let method = find(method).unwrap();
    integrate::<f64>(method, path, hz, (duration * hz) as u64 / method.input.samples() as u64).unwrap()
}

/// Final errors in degrees on A and B at 100 Hz and on A, B, C and D at 1 kHz, computed independently of this code,
/// twice; `-` for anything below 10⁻⁸.
#[rustfmt::skip]
const KNOWN: [(&str, [&str; 6]); 11] = [
    ("euler",             ["0.136",   "1.09",    "1.4e-2", "1.1e-2", "2.3e-3", "12.2"]),
    ("paper",             ["0.0216",  "4.13",    "2.2e-4", "4.3e-2", "8.9e-3", "6.1"]),
    ("exp-average",       ["0.0217",  "4.13",    "2.2e-4", "4.3e-2", "8.9e-3", "-"]),
    ("exp-midpoint",      ["5.43e-3", "1.09",    "5.4e-5", "1.1e-2", "2.3e-3", "-"]),
    ("rk4",               ["7.11e-8", "1.03e-2", "-",      "1.1e-6", "5.5e-6", "9.3e-5"]),
    ("crouch-grossman-3", ["7.52e-7", "3.91e-3", "-",      "3.9e-7", "2.0e-6", "-"]),
    ("magnus-4",          ["4.74e-8", "7.08e-3", "-",      "7.1e-7", "3.7e-6", "-"]),
    ("increment-1",       ["1.09e-2", "2.12",    "1.1e-4", "2.2e-2", "4.5e-3", "-"]),
    ("coning-2",          ["1.15e-6", "0.163",   "-",      "1.7e-5", "8.8e-5", "-"]),
    ("coning-3",          ["3.80e-8", "1.36e-2", "-",      "1.3e-8", "1.9e-6", "-"]),
    ("coning-4",          ["1.63e-6", "2.06e-3", "-",      "1.3e-8", "4e-8",   "-"]),
];

/// The largest and the smallest number written so.
fn rounds_to(text: &str) -> (f64, f64) {
    let (digits, power) = text.split_once('e').unwrap_or((text, "0"));
    let places = digits.split_once('.').map_or(0, |(_, fraction)| fraction.len() as i32);
    let half_unit = 0.5 * 10f64.powi(power.parse::<i32>().unwrap() - places);
    let value: f64 = text.parse().unwrap();
    (value - half_unit, value + half_unit)
}

#[test]
fn final_errors_are_those_computed_independently_within_two_percent() {
    let cases = motions::built_in();
    let columns = [("A", 100.0), ("B", 100.0), ("A", 1000.0), ("B", 1000.0), ("C", 1000.0), ("D", 1000.0)];
    for (method, known) in KNOWN {
        for ((name, hz), known) in columns.into_iter().zip(known) {
            let case = cases.iter().find(|case| case.name == name).unwrap();
            let found = error(method, &*case.path, hz, case.duration).error_deg;
            let (least, most) = if known == "-" { (0.0, 1e-8) } else { rounds_to(known) };
            assert!(
                0.98 * least <= found && found <= 1.02 * most,
                "{method} on {name} at {hz} Hz: {found} for {known}"
            );
        }
    }
}

/// log₂ of what halving the step gains, where neither rounding nor the next term counts.
#[test]
fn errors_fall_with_the_order_that_the_table_gives() {
    let sines = Sines::three_axes();
    for method in METHODS {
        let hz = if method.order > 4 { 20.0 } else { 160.0 };
        let (coarse, fine) =
            (error(method.name, &sines, hz, 48.0), error(method.name, &sines, 2.0 * hz, 48.0));
        let order = (coarse.error_deg / fine.error_deg).log2();
        let expected = f64::from(method.order);
        assert!((order - expected).abs() < 0.06 * expected + 0.05, "{}: {order} for {expected}", method.name);
    }
}

/// Under coning what does not come back with every turn is a drift about the cone's axis.
#[test]
fn the_drift_of_coning_algorithms_falls_with_twice_their_number_of_increments() {
    let cone = Cone::new(Double::from(0.01) * Double::PI_OVER_180, Double::from(1.0));
    for (increments, method) in (1..).zip(["increment-1", "coning-2", "coning-3", "coning-4"]) {
        let drift = |hz: f64| error(method, &cone, hz, 1000.0).error_deg;
        let order = (drift(12.0) / drift(24.0)).log2();
        assert!((order - 2.0 * f64::from(increments)).abs() < 0.1, "{method}: {order}");
    }
}

#[test]
fn the_drift_of_one_increment_is_its_closed_form() {
    for (degrees, hertz, hz) in
        [(10.0, 0.37, 100.0), (1.0, 10.0, 100.0), (1.0, 10.0, 1000.0), (0.1, 50.0, 1000.0)]
    {
        let cone = Cone::new(Double::from(degrees) * Double::PI_OVER_180, Double::from(hertz));
        // After whole turns of the cone nothing is left but the drift.
        let duration = 1000.0 / hertz;
        let steps = (duration * hz).round();
        let found = error("increment-1", &cone, hz, steps / hz).error_deg.to_radians() / (steps / hz);
        let expected = cone.drift_of_one_increment(1.0 / hz);
        assert!(
            (found / expected - 1.0).abs() < 1e-3,
            "{degrees} deg at {hertz} Hz, {hz} Hz: {found} for {expected}"
        );
    }
}

/// rate (deg/s), step (s), |q| and error (deg) after 10 s, as printed in the paper's analysis.
#[test]
fn the_papers_step_grows_the_norm_and_loses_the_angle_as_known() {
    for (rate, hz, norm, angle) in [
        (20.0, 100.0, 1.000_000_001_5, 0.000_10),
        (200.0, 100.0, 1.000_015, 0.10),
        (2000.0, 100.0, 1.166, 99.8),
        (2000.0, 1000.0, 1.000_155, 1.02),
        (2000.0, 50.0, 3.37, f64::NAN),
    ] {
        let path = Turn::degrees(rate, DVec3::new(1.0, 2.0, 3.0));
        let end = error("paper", &path, hz, 10.0);
        let growth = end.norm_error / (norm - 1.0);
        assert!((growth - 1.0).abs() < 0.04, "{rate} deg/s at {hz} Hz: |q| = 1 + {}", end.norm_error);
        // The cause: a step's norm grows by (θ/2)⁴/6 and its angle errs by θ³/24.
        let theta = rate.to_radians() / hz;
        let grown = 10.0 * hz * libm::pow(0.5 * theta, 4.0) / 6.0;
        assert!(theta > 0.1 || (end.norm_error / grown - 1.0).abs() < 0.01, "{rate} {hz}: {grown}");
        if angle.is_finite() {
            assert!((end.error_deg / angle - 1.0).abs() < 0.05, "{rate} deg/s at {hz} Hz: {}", end.error_deg);
            let renormalised = error("paper-normalised", &path, hz, 10.0).error_deg;
            assert!(
                (renormalised / end.error_deg - 1.0).abs() < 1e-3,
                "renormalising does not help: {renormalised}"
            );
        }
    }
}

#[test]
fn a_single_precision_run_is_that_of_doubles_until_its_digits_end() {
    let path = Cone::new(Double::PI_OVER_180, Double::from(10.0));
    for method in ["euler", "paper", "exp-average"] {
        let method = find(method).unwrap();
        let double = integrate::<f64>(method, &path, 100.0, 6000).unwrap().error_deg;
        let single = integrate::<f32>(method, &path, 100.0, 6000).unwrap().error_deg;
        assert!((single / double - 1.0).abs() < 0.01, "{}: {single} for {double}", method.name);
    }
}

#[test]
fn every_method_has_a_row_in_every_precision_with_its_cost() {
    let mut cases = motions::quick();
    cases.truncate(2);
    for case in &mut cases {
        case.rates = vec![100];
        case.duration = 0.5;
    }
    let start = std::time::Instant::now();
    let rows = run(&cases, 2, &|| start.elapsed(), &|_, _| ());
    let per_case: usize = METHODS.iter().map(|method| method.precisions.len()).sum();
    assert_eq!(rows.len(), 2 * per_case);
    for row in &rows {
        let samples = find(row.method).unwrap().input.samples() as f64;
        assert!(row.error_deg.is_some_and(f64::is_finite) && row.norm_error.is_some_and(f64::is_finite));
        assert!(row.ns_per_step > 0.0 && row.ns_per_step.is_finite());
        assert!(
            (row.ns_per_simulated_s - row.ns_per_step * 100.0 / samples).abs()
                < 1e-9 * row.ns_per_simulated_s
        );
    }
    // A motion too short for a step of eight increments has no such row.
    cases[0].duration = 0.05;
    let rows = run(&cases[..1], 1, &|| start.elapsed(), &|_, _| ());
    assert!(rows.iter().all(|row| row.method != "polynomial-fit") && !rows.is_empty());
}

#[test]
fn a_row_has_the_columns_of_the_table() {
    let row = Row {
        method: "euler",
        motion: "A".to_string(),
        rate_hz: 100,
        precision: "f64",
        error_deg: Some(0.136),
        norm_error: None,
        ns_per_step: 12.5,
        ns_per_simulated_s: 1250.0,
    };
    let mut table = csv::Writer::from_writer(vec![]);
    table.serialize(row).unwrap();
    let text = String::from_utf8(table.into_inner().unwrap()).unwrap();
    let expected = "method,motion,rate_hz,precision,error_deg,norm_error,ns_per_step,ns_per_simulated_s\n\
                    euler,A,100,f64,0.136,,12.5,1250.0\n";
    assert_eq!(text, expected);
}
