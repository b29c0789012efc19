//! A sine of angular rate about each axis.

use super::{Path, reference};
use glam::{DQuat, DVec3};
use std::f64::consts::TAU;

/// `w_i = A_i·sin(2π·f_i·t + p_i)`. Its attitude has no closed form.
#[derive(Clone, Copy, Debug)]
pub struct Sines {
    /// rad/s.
    amplitude: [f64; 3],
    /// rad/s.
    frequency: [f64; 3],
    /// rad.
    phase: [f64; 3],
}

impl Sines {
    /// 30, 20, 40 deg/s at 0.3, 0.5, 0.2 Hz with phases 0, 1, 2 rad.
    pub fn three_axes() -> Sines {
        Sines {
            amplitude: [30.0, 20.0, 40.0].map(f64::to_radians),
            frequency: [0.3, 0.5, 0.2].map(|hertz: f64| hertz * TAU),
            phase: [0.0, 1.0, 2.0],
        }
    }

    fn each(&self, value: impl Fn(f64, f64, f64) -> f64) -> DVec3 {
        let axis = |i: usize| value(self.amplitude[i], self.frequency[i], self.phase[i]);
        DVec3::new(axis(0), axis(1), axis(2))
    }
}

impl Path for Sines {
    fn attitude(&self, t: f64) -> DQuat {
        reference::attitude(|t| self.rate(t), &[0.0, t]).0
    }

    fn rate(&self, t: f64) -> DVec3 {
        self.each(|amplitude, frequency, phase| amplitude * libm::sin(frequency * t + phase))
    }

    fn increment(&self, from: f64, to: f64) -> DVec3 {
        // −cos b + cos a = 2·sin((a + b)/2)·sin((b − a)/2): near bounds do not cancel.
        self.each(|amplitude, frequency, phase| {
            let middle = frequency * (0.5 * (from + to)) + phase;
            2.0 * amplitude / frequency * libm::sin(middle) * libm::sin(0.5 * frequency * (to - from))
        })
    }
}
