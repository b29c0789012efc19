//! Both estimators on error-free readings of known motions, and on wrong ones.

use super::common::{Body, DECLINATION_RAD, LEVEL, SLOW_TURN, TILTED, TURNING};
use ratetable_firmware_host_tests::Sample;
use ratetable_firmware_host_tests::ahrs::{Kind, Periods};
use ratetable_firmware_host_tests::quaternion::{angle_between, to_euler};

/// Seconds of each case, and what is left out at its start.
const SECONDS: u64 = 30;
const SETTLE_US: u64 = 5_000_000;

/// The largest error that is allowed, deg.
fn bound_deg(kind: Kind) -> f64 {
    match kind {
        Kind::Vqf => 0.1,
        Kind::Fusion => 0.5,
    }
}

/// The largest angle between estimate and truth after settling, deg.
fn worst_deg(kind: Kind, body: Body, every_us: [u64; 3], spoil: impl Fn(Sample) -> Sample) -> f64 {
    let [gyro_s, accel_s, mag_s] = every_us.map(|us| us as f64 * 1e-6);
    let mut ahrs = kind.build(Periods { gyro_s, accel_s, mag_s }, DECLINATION_RAD);
    let mut last_us = 0;
    let mut worst = 0_f64;
    for sample in body.samples(SECONDS, every_us).into_iter().map(spoil) {
        if let Some(rate) = sample.gyro {
            ahrs.gyro((sample.t_us - last_us) as f64 * 1e-6, rate);
            last_us = sample.t_us;
            if sample.t_us >= SETTLE_US {
                let truth = body.attitude(sample.t_us as f64 * 1e-6);
                worst = worst.max(angle_between(truth, ahrs.attitude()));
            }
        }
        sample.accel.into_iter().for_each(|force| ahrs.accel(force));
        sample.mag.into_iter().for_each(|field| ahrs.mag(field));
    }
    worst.to_degrees()
}

#[test]
fn the_attitude_follows_truth_at_equal_and_at_different_rates() {
    for kind in [Kind::Vqf, Kind::Fusion] {
        for every_us in [[10_000; 3], [1_000, 2_000, 10_000], [2_000, 5_000, 20_000]] {
            for body in [LEVEL, TILTED, TURNING, SLOW_TURN] {
                let worst = worst_deg(kind, body, every_us, |sample| sample);
                assert!(worst < bound_deg(kind), "{kind} {body:?} {every_us:?}: {worst} deg");
            }
        }
    }
}

type Spoil = fn(Sample) -> Sample;

#[test]
fn wrong_axes_signs_scales_and_declination_do_not_pass() {
    let swapped_gyro: Spoil = |s| Sample { gyro: s.gyro.map(|[x, y, z]| [x, z, y]), ..s };
    let flipped_gyro: Spoil = |s| Sample { gyro: s.gyro.map(|[x, y, z]| [x, y, -z]), ..s };
    let degrees_gyro: Spoil = |s| Sample { gyro: s.gyro.map(|w| w.map(|c| c * 1.2)), ..s };
    let swapped_accel: Spoil = |s| Sample { accel: s.accel.map(|[x, y, z]| [y, x, z]), ..s };
    let gravity_sign: Spoil = |s| Sample { accel: s.accel.map(|f| f.map(|c| -c)), ..s };
    let swapped_mag: Spoil = |s| Sample { mag: s.mag.map(|[x, y, z]| [y, x, z]), ..s };
    let flipped_mag: Spoil = |s| Sample { mag: s.mag.map(|[x, y, z]| [x, y, -z]), ..s };
    let spoils = [
        ("gyro axes swapped", swapped_gyro),
        ("gyro sign flipped", flipped_gyro),
        ("gyro scale wrong", degrees_gyro),
        ("accelerometer axes swapped", swapped_accel),
        ("gravity instead of specific force", gravity_sign),
        ("magnetometer axes swapped", swapped_mag),
        ("magnetometer sign flipped", flipped_mag),
    ];
    for kind in [Kind::Vqf, Kind::Fusion] {
        for (name, spoil) in spoils {
            let worst = worst_deg(kind, TURNING, [2_000, 4_000, 10_000], spoil);
            assert!(worst > 2.0 * bound_deg(kind), "{kind}, {name}: only {worst} deg");
        }
    }
}

#[test]
fn without_a_magnetometer_tilt_is_right_and_heading_starts_at_zero() {
    for kind in [Kind::Vqf, Kind::Fusion] {
        let mut ahrs = kind.build(Periods::default(), DECLINATION_RAD);
        for (k, sample) in TILTED.samples(20, [10_000; 3]).into_iter().enumerate() {
            ahrs.gyro(if k == 0 { 0.0 } else { 0.01 }, sample.gyro.unwrap());
            ahrs.accel(sample.accel.unwrap());
        }
        let [roll, pitch, yaw] = to_euler(ahrs.attitude()).map(f64::to_degrees);
        assert!((roll - 30.0).abs() < 0.1, "{kind}: roll {roll}");
        assert!((pitch - 10.0).abs() < 0.1, "{kind}: pitch {pitch}");
        assert!(yaw.abs() < 10.0, "{kind}: yaw {yaw}");
    }
}
