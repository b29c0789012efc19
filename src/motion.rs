//! The truth: attitude, angular rate, specific force and field at any time.
//!
//! A scene's motion is a list of segments. Each is a [`Motion`], evaluated from the segment's own start in closed
//! form, or without one from nodes solved once to 10⁻¹⁰ degrees. Nothing accumulates from samples: any order of t
//! works, and an hour at full scale loses no accuracy. To add a kind: one file beside this one and one line in
//! [`KINDS`].
//!
//! ```
//! use ratetable::{scene::Builder, sensor::SensorKind, time::SimTime};
//!
//! let plan = Builder::new("turn")
//!     .motion("rotate", &[("yaw", "20 deg/s"), ("duration", "5 s")])
//!     .sensor(SensorKind::Gyro, &[("rate", "1 Hz")])
//!     .build()?;
//! let truth = plan.trajectory.at(SimTime(2_500_000_000));
//! assert!((truth.rate.v.z - 20f64.to_radians()).abs() < 1e-15);
//! # Ok::<(), ratetable::scene::SceneError>(())
//! ```

mod circle;
mod cone;
mod hold;
mod integrated;
pub mod method;
mod random;
mod replay;
mod rock;
mod rotate;
mod stepped;
mod trajectory;
mod waypoints;

pub use trajectory::{Course, Force, Misfit, Push, Track, Trajectory, Truth, TruthColumns, Wants};

use crate::double::Double;
use crate::geometry::{Attitude, Axes, Body, Nav, Vector};
use crate::keys::{Key, KeyError, Values};
use crate::time::SimTime;
use std::fmt::Debug;

/// A segment of truth.
pub trait Motion: Debug + Send + Sync {
    /// The motion of the body `t` seconds after the segment's start, if it started at `start`.
    fn at(&self, start: Attitude, t: Double) -> Kinematics;

    /// The angular rate, if it is constant.
    fn constant_rate(&self) -> Option<Vector<Body>> {
        None
    }

    /// A bound on how fast anything in it changes, rad/s: sets the panels of a mean over an interval.
    fn fastest(&self) -> f64;

    /// The speed over the ground, m/s: 0 for a vehicle that turns on the spot.
    fn speed(&self) -> f64 {
        0.0
    }

    /// The first time after `t`, both from the segment's start, at which it is not smooth: a mean is computed
    /// between such times.
    fn next_seam(&self, t: SimTime) -> Option<SimTime> {
        let _ = t;
        None
    }

    /// Its own duration, if its kind [has a length](MotionKind::has_length).
    fn length(&self) -> Option<SimTime> {
        None
    }

    /// The attitude at its start, if it sets one instead of continuing from the vehicle's.
    fn begins(&self) -> Option<Attitude> {
        None
    }

    /// Warnings about it before it plays.
    fn warnings(&self) -> &[String] {
        &[]
    }
}

/// The attitude and its motion.
#[derive(Clone, Copy, Debug)]
pub struct Kinematics {
    /// Body to nav.
    pub attitude: Attitude,
    /// Angular rate of body relative to nav, rad/s.
    pub rate: Vector<Body>,
    /// Acceleration of the body's origin, m/s².
    pub acceleration: Vector<Nav>,
}

/// Inputs for a motion's builder besides the motion's own keys.
#[derive(Clone, Copy, Debug)]
pub struct Context {
    /// The duration of the segment.
    pub duration: SimTime,
    /// The vehicle's attitude when the motion starts.
    pub start: Attitude,
    /// Whether the scene leaves that attitude open: its first motion may begin elsewhere.
    pub anywhere: bool,
    /// The scene's seed, for a random motion.
    pub seed: u64,
    /// Its index among the scene's motions, from 0: names its streams of random numbers.
    pub index: usize,
    /// The strength of gravity, m/s².
    pub gravity: f64,
    /// The axes of the scene.
    pub axes: Axes,
}

/// The result of a builder.
pub type Built = Result<Box<dyn Motion>, KeyError>;

/// A kind of motion: its name, its keys and how to build it.
#[derive(Debug)]
pub struct MotionKind {
    /// As written in `kind = "…"`.
    pub name: &'static str,
    /// One line for `list motions`.
    pub about: &'static str,
    /// Its keys besides `kind` and `duration`.
    pub keys: &'static [Key],
    /// Whether it has its own length, so that `duration` may be absent.
    pub has_length: bool,
    /// Builds a motion from its values.
    pub build: fn(&Values, &Context) -> Built,
}

/// Every kind of motion.
pub static KINDS: [&MotionKind; 8] = [
    &hold::KIND,
    &rotate::KIND,
    &cone::KIND,
    &circle::KIND,
    &rock::KIND,
    &waypoints::KIND,
    &random::KIND,
    &replay::KIND,
];

/// No motion: after the last segment, and in a scene without motion.
pub fn rest() -> Box<dyn Motion> {
    Box::new(hold::Hold)
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::geometry::log;

    /// Compares the attitude's change over 2h with the rate's integral by Simpson's rule, away from round times,
    /// where a motion may have a seam: a test for every kind of motion.
    pub(crate) fn rate_is_the_derivative_of_attitude(
        motion: &dyn Motion,
        start: Attitude,
        duration: SimTime,
    ) {
        // 20 µs: rounding leaves ε/h, 10⁻¹¹ rad/s; the non-commuting part h²/3·w × w′, 10⁻⁸ of the fastest w here.
        let h = 20_000;
        for i in 1..40 {
            let t = duration.0 / 40 * i + 123_456;
            let at = |ns| motion.at(start, SimTime(ns).exact_seconds());
            let (before, now, after) = (at(t - h), at(t), at(t + h));
            let turned = log(before.attitude.q.conjugate() * after.attitude.q) / (2.0 * h as f64 * 1e-9);
            let mean = (before.rate.v + 4.0 * now.rate.v + after.rate.v) / 6.0;
            let slack = 1e-9 + 1e-7 * mean.length();
            assert!((turned - mean).length() < slack, "{motion:?} at {t} ns: {turned} against {mean}");
        }
    }

    /// A rate with swapped components is not the derivative: the check above can fail.
    #[test]
    #[should_panic(expected = "against")]
    fn the_derivative_check_sees_a_swapped_axis() {
        #[derive(Debug)]
        struct Swapped(Box<dyn Motion>);
        impl Motion for Swapped {
            fn at(&self, start: Attitude, t: Double) -> Kinematics {
                let truth = self.0.at(start, t);
                Kinematics { rate: Vector::from_vec(truth.rate.v.yxz()), ..truth }
            }
            fn fastest(&self) -> f64 {
                self.0.fastest()
            }
        }
        use glam::Vec3Swizzles;
        let motion = Swapped(rotate::constant([0.1, 0.2, 0.3]));
        rate_is_the_derivative_of_attitude(&motion, Attitude::IDENTITY, SimTime(1_000_000_000));
    }
}
