//! The built-in scenes through driver and estimator: the attitude follows the truth.

use std::sync::Arc;

use ratetable::earth::declination;
use ratetable::scene::Plan;
use ratetable_firmware_host_tests::ahrs::Kind;
use ratetable_firmware_host_tests::{Options, Protocol};

use crate::emulator::accuracy::{Deg, Errors};
use crate::emulator::play::{play_to_board, scene};

/// A scene, an estimator, and what the sensor errors of the one leave the other.
pub struct Case {
    pub scene: &'static str,
    pub ahrs: Kind,
    pub settled_s: f64,
    pub bound: Errors,
}

const fn errors(inclination: [f64; 2], heading: [f64; 2]) -> Errors {
    let [max, rms] = inclination;
    let inclination = Deg { max, rms };
    let [max, rms] = heading;
    Errors { inclination, heading: Deg { max, rms } }
}

/// Bounds are `[max, rms]` in degrees, from the scene's sensor errors and from how the estimators work:
///
/// - Both take the accelerometer for vertical. A bias `a` of it tilts by a/g, and the tilt's part about north turns
///   the heading by itself times the tangent of the field's dip: 1.73 of the default field (60°), 3.4 of the two
///   fields in St Petersburg (73.5°).
/// - Fusion corrects with K = 0.5 /s and knows no gyro bias: a bias `b` leaves b/K. It holds a reading of the
///   magnetometer until the next, which at 100 Hz is on average 5.5 ms old.
/// - VQF low-passes acceleration (τ = 3 s, so a rate `b` leaves b · 3 s), learns the gyro's bias, above all at rest
///   (detected after 1.5 s), and takes its heading from the mean of the first 9 s of the magnetometer, later only
///   once it has seen 5 s of turning; in between it holds it by the gyro alone.
/// - A rate read at the end of a step and held over it leads by half a step: 0.5 ms times the rate, and the same
///   once more from where it began.
pub const CASES: [Case; 8] = [
    // 5 and -5 mg tilt by 0.405 and turn by 1.73 · 0.289 = 0.50. Until rest is seen at 1.5 s, the gyro's bias of
    // 0.36 deg/s adds up to 0.5 of tilt, of which after 5 s less than 0.1 is left; and up to 0.2 about the vertical
    // and 1.73 · 0.1 from the tilt of then stay in the mean heading, less and less.
    Case { scene: "still", ahrs: Kind::Vqf, settled_s: 5.0, bound: errors([0.50, 0.43], [0.88, 0.75]) },
    // Roll 0.3/K + 0.289 and pitch -0.2/K + 0.289 make 0.896; heading 0.1/K + 1.73 · 0.889 = 1.74. Noise through K:
    // 0.01 of tilt and 0.03 of heading (1 σ).
    Case { scene: "still", ahrs: Kind::Fusion, settled_s: 15.0, bound: errors([0.93, 0.91], [1.86, 1.77]) },
    // Half a second of rest leaves 6 % of the gyro's bias (0.053 deg/s) and 0.009 deg/s of its noise: 0.012 · 3 s of
    // tilt. A count of the accelerometer is 0.028, and a seam of 45 deg/s one step late 0.045. Heading: 0.012 deg/s
    // for 23 s, and 3.4 · 0.05 at first.
    Case { scene: "table-1", ahrs: Kind::Vqf, settled_s: 5.0, bound: errors([0.10, 0.05], [0.45, 0.25]) },
    // 0.053/K = 0.106 whichever way the vehicle lies, and a count; heading √(1 + 3.4²) as much, and the
    // magnetometer's age: 5.5 ms of 20 deg/s roll, 3.4 times, nine tenths of it let through in 4 s.
    Case { scene: "table-1", ahrs: Kind::Fusion, settled_s: 5.0, bound: errors([0.15, 0.11], [0.75, 0.40]) },
    // No sensor errors: 2 · 0.5 ms of 62.7 deg/s is 0.063, half of that on average, and K or τ take most of what is
    // constant out of the tilt. Over `mpu` the steady 2.740 deg/s about the vertical is 0.004 off in counts: 0.08
    // in 20 s for the estimator that holds its heading.
    Case { scene: "coning", ahrs: Kind::Vqf, settled_s: 5.0, bound: errors([0.065, 0.035], [0.145, 0.08]) },
    Case { scene: "coning", ahrs: Kind::Fusion, settled_s: 5.0, bound: errors([0.065, 0.035], [0.08, 0.05]) },
    // Into the turn and out of it 1 m/s changes direction, which VQF sees as up to 0.215 /s · 1 m/s ÷ g = 1.26 of
    // tilt; the pushes of 0.85 m/s just after it as up to 1.1, against it; 0.28 of the bank goes round; the
    // accelerometer's bias is 0.21. Heading: 3.4 · 0.17 of that bias, 0.2 from before the gyro's bias is known, and
    // of 3.4 · 1.26 what 2 s of its 9 s let through.
    Case { scene: "manoeuvre", ahrs: Kind::Vqf, settled_s: 5.0, bound: errors([1.80, 1.00], [1.70, 0.80]) },
    // The same through K: K · 1 m/s ÷ g = 2.94, times 1 + exp(-2 s · K) + K/(4.57 rad/s) while it begins and 1.1 in
    // the turn, which is half of the time; 0.15/K from the gyro's and 0.21 from the accelerometer's bias. Heading:
    // the magnetometer's age at 262 deg/s, 1.44; 3.4 · 2.94 once more through K, 0.37 of a step and 0.11 of what
    // goes round.
    Case {
        scene: "manoeuvre",
        ahrs: Kind::Fusion,
        settled_s: 5.0,
        bound: errors([4.90, 2.40], [6.20, 2.50]),
    },
];

/// What a firmware is told before it starts: its estimator, and the declination at its place.
pub fn options(plan: &Plan, ahrs: Kind) -> Options {
    Options { ahrs, declination_rad: declination(plan.trajectory.field()), ..Options::default() }
}

fn follow(plan: &Arc<Plan>, case: &Case, protocol: Protocol) -> Result<Errors, String> {
    let (outcome, board) = play_to_board(plan, protocol, options(plan, case.ahrs));
    let counts = board.report().counts;
    assert_eq!((counts.damaged, counts.lost, counts.skipped), (0, 0, 0));
    for (sensor, arrived) in outcome.sensors.iter().zip([counts.gyro, counts.accel, counts.mag]) {
        assert_eq!((sensor.made, sensor.sent), (arrived, arrived), "{}", sensor.name);
    }
    Errors::of(board.history(), plan, case.settled_s)
}

#[test]
fn the_attitude_follows_the_truth_within_what_the_sensor_errors_leave() {
    let mut failures = Vec::new();
    for case in &CASES {
        let plan = scene(case.scene, &[]);
        for protocol in [Protocol::Mpu, Protocol::Mavlink] {
            let what = format!("{} over {protocol} with {}", case.scene, case.ahrs);
            let errors = follow(&plan, case, protocol).unwrap_or_else(|why| panic!("{what}: {why}"));
            eprintln!("{what}: {errors}");
            failures.extend(errors.check(&case.bound).err().map(|why| format!("{what}: {why}")));
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}
