//! An error-state Kalman filter of fifteen states, as flight controllers have: J. Solà, *Quaternion kinematics for the
//! error-state Kalman filter*, arXiv 1711.02508, 2017; the crate `multicalc`.
//!
//! It works in North-East-Down on Forward-Right-Down vectors. The crate has the filter and no sensors: what aids it is
//! ours, as is its noise, for which the crate has no defaults. Ten times a second it is told that it stands still, give
//! or take [`STILL`], which is how a controller's filter keeps level without a receiver of positions; and with each
//! reading of the magnetometer, that magnetic north is where the level part of the field points, off by [`MOST`] at
//! most. It trusts its start to six degrees, and nothing resets it. Readings of the gyro
//! are summed up to [`STEP`] before the filter takes a step, as controllers do, because a step costs two products of
//! 15 × 15 matrices; the attitude follows every reading.

use super::held::Held;
use super::{Filter, FilterKind, Setup};
use crate::geometry::{Attitude, Body, Vector, exp, log, rotate};
use glam::{DQuat, DVec3};
use multicalc::estimation::{ErrorStateKalmanFilter, ImuNoise, NominalState, NominalStateFn};
use multicalc::linear_algebra::{self as linear, Matrix};
use multicalc::scalar::Numeric;
use multicalc::spatial::{Quaternion, SO3};

/// Standard gravity, m/s².
const G: f64 = 9.80665;
/// White noise of the gyro, rad/s/√Hz: six times that of an MPU-9250, which leaves room for scale and vibration.
const GYRO_NOISE: f64 = 1e-3;
/// White noise of the accelerometer, m/s²/√Hz: that of a multirotor's vibration (0.002 g²/Hz is 0.44).
const ACCEL_NOISE: f64 = 0.35;
/// How a gyro's bias wanders, rad/s/√s.
const GYRO_WALK: f64 = 2e-5;
/// How an accelerometer's bias wanders, m/s²/√s.
const ACCEL_WALK: f64 = 1e-4;
/// The least length of a step, s: 125 steps a second.
const STEP: f64 = 0.008;
/// The speed at which standing still is no surprise, m/s.
const STILL: f64 = 1.0;
/// The interval of being told so, s.
const STILL_EVERY: f64 = 0.1;
/// Noise of the magnetic heading, rad: PX4's default, for what is wrong with a field lasts longer than a reading.
const HEADING: f64 = 0.3;
/// The most that a reading of the magnetometer may be off, rad: more counts as this.
const MOST: f64 = 0.3;
/// Standard deviations at the start: position (m), velocity (m/s), attitude (rad), biases (rad/s, m/s²). A tilt at
/// rest and a bias of the accelerometer look the same, so the bias starts small.
const START: [f64; 5] = [1.0, 0.5, 0.1, 0.05, 0.02];

pub(super) static KIND: FilterKind = FilterKind {
    name: "eskf",
    about: "error-state Kalman filter of 15 states, told that it stands still; gyro and accel bias estimation; f64",
    takes_start: true,
    make,
};

fn make(setup: &Setup) -> Box<dyn Filter> {
    let [w, x, y, z] = [setup.start.q.w, setup.start.q.x, setup.start.q.y, setup.start.q.z];
    let start = NominalState::at_rest(SO3::from_quaternion(Quaternion::new(w, x, y, z)));
    let mut variances = [0.0; 15];
    for (i, variance) in variances.iter_mut().enumerate() {
        *variance = START[i / 3] * START[i / 3];
    }
    let still = Matrix::from_diagonal([STILL * STILL; 3]);
    let filter = ErrorStateKalmanFilter::new(start, Matrix::from_diagonal(variances), noise(STEP), still);
    let filter = filter.with_gravity(linear::Vector::new([0.0, 0.0, G]));
    Box::new(Eskf { filter, accel: Held::default(), sum: Sum::default(), since: 0.0 })
}

/// The crate adds (noise × step)² a step, so it is given the noise of the mean over a step.
fn noise(step: f64) -> ImuNoise {
    let mean = |density: f64| density / libm::sqrt(step);
    ImuNoise {
        gyroscope_noise_density: mean(GYRO_NOISE),
        accelerometer_noise_density: mean(ACCEL_NOISE),
        gyroscope_bias_random_walk: GYRO_WALK,
        accelerometer_bias_random_walk: ACCEL_WALK,
    }
}

struct Eskf {
    filter: ErrorStateKalmanFilter<3>,
    accel: Held,
    sum: Sum,
    /// Seconds since it was told that it stands still.
    since: f64,
}

/// What was read since the last step.
#[derive(Clone, Copy, Debug, Default)]
struct Sum {
    seconds: f64,
    /// By the gyro, biased: the body's axes now to those at the step.
    turn: DQuat,
    /// Specific force over time in the axes at the step, m/s.
    push: DVec3,
}

/// Velocity, m/s.
struct Velocity;

impl NominalStateFn<3> for Velocity {
    fn eval<S: Numeric>(&self, state: &NominalState<S>) -> [S; 3] {
        *state.velocity().as_array()
    }
}

/// How far east of magnetic north a field in the body's axes points, rad.
struct East([f64; 3]);

impl NominalStateFn<1> for East {
    fn eval<S: Numeric>(&self, state: &NominalState<S>) -> [S; 1] {
        let field = state.orientation().act(linear::Vector::new(self.0.map(S::from_f64)));
        [field[1].atan2(field[0])]
    }
}

impl Eskf {
    /// A step over what was read; what the filter refuses changes nothing.
    fn step(&mut self) {
        let Sum { seconds, turn, push } = std::mem::take(&mut self.sum);
        let three = |v: DVec3| linear::Vector::new(v.to_array());
        self.filter.set_imu_noise(noise(seconds));
        let _ = self.filter.predict(three(log(turn) / seconds), three(push / seconds), seconds);
        self.since += seconds;
        if self.since >= STILL_EVERY {
            self.since = 0.0;
            let _ = self.filter.update(&Velocity, linear::Vector::new([0.0; 3]));
        }
    }
}

impl Filter for Eskf {
    fn gyro(&mut self, dt: f64, rate: Vector<Body>) {
        self.accel.carry(dt, rate);
        let Some(force) = self.accel.now().filter(|_| dt > 0.0) else { return };
        self.sum.seconds += dt;
        self.sum.turn *= exp(rate.v * dt);
        self.sum.push += rotate(self.sum.turn, force) * dt;
        // A millionth absorbs the rounding of a sum.
        if self.sum.seconds >= STEP * (1.0 - 1e-6) {
            self.step();
        }
    }

    fn accel(&mut self, force: Vector<Body>) {
        self.accel.put(force);
    }

    fn mag(&mut self, field: Vector<Body>) {
        // What was read up to here comes before it.
        if self.sum.seconds > 0.0 {
            self.step();
        }
        let east = East(field.v.to_array());
        let [off] = east.eval(&self.filter.nominal_state());
        let noise = Matrix::from_diagonal([HEADING * HEADING]);
        let _ = self.filter.update_other(&east, linear::Vector::new([(-off).clamp(-MOST, MOST)]), noise);
    }

    fn attitude(&self) -> Attitude {
        let state = self.filter.nominal_state();
        let [w, x, y, z] = state.orientation().quaternion().as_array();
        let bias = DVec3::from_array(*state.gyroscope_bias().as_array());
        let since = self.sum.turn * exp(bias * -self.sum.seconds);
        Attitude::from_quat((DQuat::from_xyzw(x, y, z, w) * since).normalize())
    }
}
