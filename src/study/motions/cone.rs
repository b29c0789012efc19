//! Coning: `q = [cos(a/2), 0, sin(a/2)·cos Wt, sin(a/2)·sin Wt]`.

use super::Path;
use crate::double::Double;
use glam::{DQuat, DVec3};

/// The body's x axis goes round a cone of half-angle a at W rad/s (Bortz 1971):
/// `w = [−2W·sin²(a/2), −W·sin a·sin Wt, W·sin a·cos Wt]`.
#[derive(Clone, Copy, Debug)]
pub struct Cone {
    /// Sine and cosine of a/2.
    half: (f64, f64),
    sin_angle: f64,
    /// W, rad/s.
    frequency: Double,
}

impl Cone {
    /// Of a half-angle (rad), at so many turns a second.
    pub fn new(half_angle: Double, hertz: Double) -> Cone {
        Cone {
            half: (half_angle * 0.5).sin_cos(),
            sin_angle: half_angle.sin_cos().0,
            frequency: hertz * Double::TAU,
        }
    }

    /// The drift (rad/s) of a method that takes each increment for a turn about a fixed axis:
    /// `½·W·sin²(a)·(1 − sin(Wh)/(Wh))`.
    pub fn drift_of_one_increment(&self, h: f64) -> f64 {
        let phase = self.frequency.hi * h;
        0.5 * self.frequency.hi * self.sin_angle * self.sin_angle * (1.0 - libm::sin(phase) / phase)
    }
}

impl Path for Cone {
    fn attitude(&self, t: f64) -> DQuat {
        let (sine, cosine) = (self.frequency * t).sin_cos();
        let (s, c) = self.half;
        DQuat::from_xyzw(0.0, s * cosine, s * sine, c)
    }

    fn rate(&self, t: f64) -> DVec3 {
        let (sine, cosine) = libm::sincos(self.frequency.hi * t);
        let across = self.sin_angle;
        let (s, _) = self.half;
        DVec3::new(-2.0 * s * s, -across * sine, across * cosine) * self.frequency.hi
    }

    fn increment(&self, from: f64, to: f64) -> DVec3 {
        // The difference of the cosines of two near angles, without cancellation.
        let turn = self.frequency.hi * (to - from);
        let (sine, cosine) = libm::sincos(self.frequency.hi * (0.5 * (from + to)));
        let across = 2.0 * self.sin_angle * libm::sin(0.5 * turn);
        let (s, _) = self.half;
        DVec3::new(-2.0 * s * s * turn, -across * sine, across * cosine)
    }
}
