use super::*;
use crate::geometry::{Attitude, Vector, angle_between, exp, log};
use crate::motion::{Trajectory, rest};
use crate::time::{NANOS, SimTime};

fn case(name: &str) -> Case<'static> {
    built_in().into_iter().find(|case| case.name == name).unwrap_or_else(|| panic!("no motion {name}"))
}

#[test]
fn the_rate_is_the_derivative_of_the_attitude() {
    // Those without a closed form come from their rate, to 10⁻¹² rad: a wider difference, and a few instants.
    let (closed, found) = ((40, 1e-6), (3, 2e-5));
    for case in built_in() {
        let (instants, h) = if matches!(&*case.name, "E" | "H") { found } else { closed };
        let (name, path) = (case.name, case.path);
        for i in 0..instants {
            let t = 0.123_45 + 0.171 * f64::from(i);
            let turned = log(path.attitude(t - h).conjugate() * path.attitude(t + h)) / (2.0 * h);
            let off = (turned - (path.rate(t - h) + path.rate(t + h)) / 2.0).length();
            assert!(off < 2e-7 * (1.0 + turned.length()), "{name} at {t}: {off}");
        }
    }
}

#[test]
fn the_increment_is_the_integral_of_the_rate() {
    for case in built_in() {
        for (from, to) in [(0.0, 0.01), (0.3, 0.7), (0.49, 0.51), (1.2, 2.6), (3.0, 3.0001)] {
            // A midpoint sum whose panels end at the reversals of H: good to 10⁻⁹ with 200 000 of them.
            let edges = [
                from,
                0.5f64.clamp(from, to),
                1.5f64.clamp(from, to),
                2.0f64.clamp(from, to),
                2.5f64.clamp(from, to),
                to,
            ];
            let n = 40_000;
            let sum: DVec3 = edges
                .windows(2)
                .map(|edge| {
                    let h = (edge[1] - edge[0]) / f64::from(n);
                    (0..n).map(|i| case.path.rate(edge[0] + (f64::from(i) + 0.5) * h)).sum::<DVec3>() * h
                })
                .sum();
            let off = (case.path.increment(from, to) - sum).length();
            assert!(off < 2e-8, "{} over [{from}, {to}]: {off}", case.name);
        }
    }
}

#[test]
fn increments_add_up_over_any_division() {
    for case in built_in() {
        let n = 977;
        let bound = |k: i32| 1.7 * f64::from(k) / f64::from(n);
        let sum: DVec3 = (0..n).map(|k| case.path.increment(bound(k), bound(k + 1))).sum();
        let whole = case.path.increment(0.0, 1.7);
        let off = (sum - whole).length();
        assert!(off < 2e-14 * (10.0 + whole.length()), "{}: {off}", case.name);
    }
}

#[test]
fn an_attitude_found_from_the_rate_is_the_truth_to_a_billionth_of_a_degree() {
    // Its own halving of the step, and beside a closed form.
    let sines = Sines::three_axes();
    let (_, change) = reference::attitude(|t| sines.rate(t), &[0.0, 60.0]);
    assert!(change.to_degrees() < 1e-10, "{change}");
    let cone = case("A").path;
    let (found, change) = reference::attitude(|t| cone.rate(t), &[0.0, 20.0]);
    let off = angle_between(cone.attitude(0.0) * found, cone.attitude(20.0));
    assert!(change.to_degrees() < 1e-10 && off.to_degrees() < 1e-9, "{change} {off}");
}

#[test]
fn pitch_passes_through_both_poles() {
    let pitch = case("F").path;
    for (t, angle) in [(2.0, 90.0f64), (4.0, 180.0), (6.0, 270.0), (60.0, 2700.0)] {
        let expected = exp(DVec3::new(0.0, angle.to_radians(), 0.0));
        assert!(angle_between(pitch.attitude(t), expected) < 1e-12, "{t}");
    }
}

#[test]
fn a_day_is_sampled_at_no_more_than_100_hz() {
    assert_eq!(case("G").rates, [25, 50, 100]);
    assert_eq!(case("A").rates, RATES);
    assert_eq!(quick().len(), 4);
}

#[test]
fn a_scenes_motion_is_a_path_too() {
    let still = vec![(SimTime(NANOS), rest())];
    let trajectory = Trajectory::new(Attitude::IDENTITY, still, vec![], Vector::ZERO, Vector::ZERO);
    let path = OfTrajectory(&trajectory);
    assert_eq!((path.attitude(0.3), path.rate(0.3)), (DQuat::IDENTITY, DVec3::ZERO));
    assert_eq!(path.increment(0.1, 0.2), DVec3::ZERO);
}
