//! The motions A to H that methods are compared on, and what may go wrong on a motion's way to a method.
//!
//! Each is analytic: attitude, angular rate and the integral of the rate at any time, in closed form where there
//! is one. The attitude of the others is found from their rate to 10⁻¹⁰ degrees.

mod cone;
mod faults;
mod reference;
mod reversals;
mod sines;
mod trajectory;
mod turn;

pub use cone::Cone;
pub use faults::{Gaps, Jitter};
pub use reversals::Reversals;
pub use sines::Sines;
pub use trajectory::OfTrajectory;
pub use turn::Turn;

use crate::double::Double;
use glam::{DQuat, DVec3};
use std::fmt::Debug;

/// A motion a method can be run on. Times in seconds from its start; body to nav; body axes.
pub trait Path: Debug + Sync {
    /// The true attitude.
    fn attitude(&self, t: f64) -> DQuat;
    /// The true angular rate, rad/s.
    fn rate(&self, t: f64) -> DVec3;
    /// The integral of the angular rate over `[from, to]`, rad, to rounding.
    fn increment(&self, from: f64, to: f64) -> DVec3;
}

/// A motion of the accuracy study.
#[derive(Debug)]
pub struct Case<'a> {
    /// `A` to `H`, or a scene's name.
    pub name: String,
    /// One line.
    pub about: String,
    /// How long it lasts, s.
    pub duration: f64,
    /// The rates (Hz) at which it is sampled.
    pub rates: Vec<u32>,
    /// The motion.
    pub path: Box<dyn Path + 'a>,
}

/// From what a hobby part gives to the fastest output of a present one.
pub const RATES: [u32; 9] = [25, 50, 100, 200, 400, 1000, 2000, 4000, 8000];
/// Those of `--quick`.
pub const QUICK_RATES: [u32; 2] = [100, 1000];

/// Motions A to H at every rate.
pub fn built_in() -> Vec<Case<'static>> {
    let case = |name: &str, about: &str, duration, path| Case {
        name: name.to_string(),
        about: about.to_string(),
        duration,
        rates: RATES.to_vec(),
        path,
    };
    let cone = |degrees: f64, hertz: f64| -> Box<dyn Path> {
        Box::new(Cone::new(Double::from(degrees) * Double::PI_OVER_180, Double::from(hertz)))
    };
    let turn =
        |speed: f64, axis: [f64; 3]| -> Box<dyn Path> { Box::new(Turn::degrees(speed, DVec3::from(axis))) };
    let mut cases = vec![
        case("A", "coning of 10 deg at 0.37 Hz", 60.0, cone(10.0, 0.37)),
        case("B", "coning of 1 deg at 10 Hz", 60.0, cone(1.0, 10.0)),
        case("C", "coning of 0.1 deg at 50 Hz", 10.0, cone(0.1, 50.0)),
        case("D", "2000 deg/s about a fixed axis", 60.0, turn(2000.0, [1.0, 2.0, 3.0])),
        case("E", "sines of 30, 20 and 40 deg/s at 0.3, 0.5 and 0.2 Hz", 60.0, Box::new(Sines::three_axes())),
        case("F", "pitch through +-90 deg at 45 deg/s", 60.0, turn(45.0, [0.0, 1.0, 0.0])),
        case("G", "10 deg/s about (1, 2, 3) for a day", 86_400.0, turn(10.0, [1.0, 2.0, 3.0])),
        case(
            "H",
            "300 deg/s reversed every 0.5 s about a turning axis",
            20.0,
            Box::new(Reversals::about_a_turning_axis()),
        ),
    ];
    // A day is long enough at 100 Hz.
    for day in cases.iter_mut().filter(|case| case.duration > 3600.0) {
        day.rates.retain(|&rate| rate <= 100);
    }
    cases
}

/// Motions A to D at [`QUICK_RATES`].
pub fn quick() -> Vec<Case<'static>> {
    let mut cases = built_in();
    cases.truncate(4);
    for case in &mut cases {
        case.rates = QUICK_RATES.to_vec();
    }
    cases
}

#[cfg(test)]
mod tests;
