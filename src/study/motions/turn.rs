//! Constant angular rate: `q = exp(w·t)`.

use super::Path;
use crate::double::Double;
use glam::{DQuat, DVec3};

/// Turns for ever about a fixed axis from a given attitude. The phase is kept to 31 digits.
#[derive(Clone, Copy, Debug)]
pub struct Turn {
    start: DQuat,
    rate: DVec3,
    axis: DVec3,
    half_speed: Double,
}

impl Turn {
    /// At `rate`, rad/s, from the identity.
    pub fn new(rate: DVec3) -> Turn {
        let square = |x: f64| Double::from(x) * x;
        let speed = (square(rate.x) + square(rate.y) + square(rate.z)).sqrt();
        let part = |w: f64| if speed.hi > 0.0 { (Double::from(w) / speed).to_f64() } else { 0.0 };
        Turn {
            start: DQuat::IDENTITY,
            rate,
            axis: DVec3::from(rate.to_array().map(part)),
            half_speed: speed * 0.5,
        }
    }

    /// At `speed` degrees a second about `axis`, of any length.
    pub fn degrees(speed: f64, axis: DVec3) -> Turn {
        Turn::new(axis.normalize() * speed.to_radians())
    }

    /// The same from another attitude.
    pub fn from(self, start: DQuat) -> Turn {
        Turn { start, ..self }
    }
}

impl Path for Turn {
    fn attitude(&self, t: f64) -> DQuat {
        let (sine, cosine) = (self.half_speed * t).sin_cos();
        let b = self.axis * sine;
        self.start * DQuat::from_xyzw(b.x, b.y, b.z, cosine)
    }

    fn rate(&self, _: f64) -> DVec3 {
        self.rate
    }

    fn increment(&self, from: f64, to: f64) -> DVec3 {
        self.rate * (to - from)
    }
}
