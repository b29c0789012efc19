//! Each filter on readings without error, on wrong ones, and beside the AHRS of the host's firmware.

use super::*;
use crate::geometry::Euler;
use glam::DVec3;
use ratetable_firmware_host_tests::ahrs::{Kind, Periods};

const GRAVITY: f64 = 9.80665;
/// 20 µT to magnetic north, which is 10 deg east of true, and 45 down.
const DECLINATION: f64 = 0.174_532_925_199_432_95;

/// With the magnetometer.
const NORTH: Options = Options { with_mag: true, declination: DECLINATION, start: None };

/// A turn with bank that swings, 20 s.
fn truth(t: f64) -> Attitude {
    let roll = 0.4 * libm::sin(0.8 * t);
    let pitch = 0.2 * libm::sin(0.5 * t) + 0.1;
    Attitude::from_quat(Euler { roll, pitch, yaw: 0.5 * t + 0.7 }.to_quat())
}

fn field() -> DVec3 {
    DVec3::new(20.0 * libm::cos(DECLINATION), 20.0 * libm::sin(DECLINATION), 45.0)
}

/// Error-free readings at 500, 250 and 100 Hz: rates averaged over the interval, so that integrating them is exact.
fn readings(spoil: fn(DVec3) -> DVec3) -> Readings {
    let at = |ms: i64| truth(ms as f64 * 1e-3);
    let times = |every: i64| (0..20_000 / every).map(move |k| k * every);
    let body = |ms: i64, v: DVec3| at(ms).inverse().apply(Vector::from_vec(v));
    let rate = |ms: i64| {
        let turn = crate::geometry::log(at(ms - 2).q.conjugate() * at(ms).q);
        Vector::from_vec(spoil(turn / 0.002))
    };
    let row = |ms: i64, v| (SimTime(ms * 1_000_000), v);
    Readings {
        gyro: times(2).map(|ms| row(ms, rate(ms))).collect(),
        accel: times(4).map(|ms| row(ms, body(ms, DVec3::NEG_Z * GRAVITY))).collect(),
        mag: times(10).map(|ms| row(ms, body(ms, field()))).collect(),
    }
}

/// The largest error after five seconds, deg.
fn worst(attitudes: &[(SimTime, Attitude)], turned: f64) -> f64 {
    let turned = exp(DVec3::Z * turned);
    let settled = attitudes.iter().filter(|(t, _)| t.seconds() >= 5.0);
    let error = |(t, q): &(SimTime, Attitude)| Attitude::from_quat(turned * q.q).angle_to(truth(t.seconds()));
    settled.map(error).fold(0.0, f64::max).to_degrees()
}

#[test]
fn every_filter_follows_the_truth_from_the_first_reading_on() {
    let readings = readings(|rate| rate);
    for (kind, bound) in FILTERS.into_iter().zip([0.05, 0.1, 0.1, 0.1, 0.1]) {
        let attitudes = run(kind, &readings, &NORTH);
        assert_eq!(attitudes.len(), readings.gyro.len());
        assert!(worst(&attitudes, 0.0) < bound, "{}: {} deg", kind.name, worst(&attitudes, 0.0));
        let (_, first) = attitudes[10];
        assert!(first.angle_to(truth(0.02)).to_degrees() < 1.0, "{} starts where it is", kind.name);
        // Without the magnetometer heading is from the start.
        let six = run(kind, &readings, &Options::default());
        assert!(worst(&six, 0.7) < 0.3, "{}: {} deg", kind.name, worst(&six, 0.7));
    }
}

#[test]
fn wrong_readings_and_a_wrong_declination_do_not_pass() {
    for kind in FILTERS {
        let error = |spoil: fn(DVec3) -> DVec3| worst(&run(kind, &readings(spoil), &NORTH), 0.0);
        assert!(error(|w| DVec3::new(w.x, w.y, -w.z)) > 2.0, "{}: a flipped gyro", kind.name);
        assert!(error(|w| DVec3::new(w.y, w.x, w.z)) > 2.0, "{}: a swapped gyro", kind.name);
        let north = worst(&run(kind, &readings(|w| w), &Options { declination: 0.0, ..NORTH }), 0.0);
        assert!((north - 10.0).abs() < 0.2, "{}: {north} deg without the declination", kind.name);
    }
}

#[test]
fn the_hosts_firmware_says_the_same() {
    let readings = readings(|rate| rate);
    for (name, kind, bound) in [("vqf", Kind::Vqf, 1e-6), ("fusion", Kind::Fusion, 0.3)] {
        let ours = run(from_name(name).unwrap().0, &readings, &NORTH);
        let periods = Periods { gyro_s: 0.002, accel_s: 0.004, mag_s: 0.01 };
        let mut theirs = kind.build(periods, DECLINATION);
        let mut worst = 0_f64;
        for (i, (t, rate)) in readings.gyro.iter().enumerate() {
            theirs.gyro(if i == 0 { 0.0 } else { 0.002 }, rate.v.to_array());
            let due =
                |column: &Column, every: usize| (i % every == 0).then(|| column[i / every].1.v.to_array());
            due(&readings.accel, 2).into_iter().for_each(|force| theirs.accel(force));
            due(&readings.mag, 5).into_iter().for_each(|field| theirs.mag(field));
            let [w, x, y, z] = theirs.attitude();
            let theirs = Attitude::from_quat(DQuat::from_xyzw(x, y, z, w));
            if t.seconds() >= 5.0 {
                worst = worst.max(ours[i].1.angle_to(theirs).to_degrees());
            }
        }
        assert!(worst < bound, "{name}: {worst} deg");
    }
}

#[test]
fn names_find_their_filter() {
    assert_eq!(from_name("mahony-6d").map(|(kind, mag)| (kind.name, mag)), Some(("mahony", false)));
    assert_eq!(from_name("vqf").map(|(kind, mag)| (kind.name, mag)), Some(("vqf", true)));
    assert!(from_name("ekf").is_none() && from_name("-6d").is_none());
    assert!(run(FILTERS[0], &Readings::default(), &NORTH).is_empty());
}

#[test]
fn a_given_start_is_where_a_filter_starts_that_takes_one() {
    let mut readings = readings(|rate| rate);
    readings.gyro.truncate(1);
    // Nothing corrects it yet.
    for column in [&mut readings.accel, &mut readings.mag] {
        column[0].0 = SimTime(1_000_000);
    }
    let given = Attitude::from_quat(Euler { roll: 0.5, pitch: -0.3, yaw: 2.0 }.to_quat());
    for with_mag in [true, false] {
        let options = Options { with_mag, start: Some(given), ..NORTH };
        for kind in FILTERS {
            let (_, first) = run(kind, &readings, &options)[0];
            let off = first.angle_to(given).to_degrees();
            assert_eq!(off < 1e-4, kind.takes_start, "{} with_mag={with_mag}: {off} deg", kind.name);
        }
    }
}
