//! The newest vector of a slow sensor at the rate of the gyro.

use crate::geometry::{Body, Vector, exp, rotate};
use glam::DVec3;

/// A reading carried along by the gyro until the next one: a vector fixed in nav turns the other way in the body, so a
/// magnetometer of 100 Hz is not 10 ms late in a filter that wants all three at once.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Held(Option<DVec3>);

impl Held {
    /// A new reading.
    pub fn put(&mut self, v: Vector<Body>) {
        self.0 = Some(v.v);
    }

    /// On by `dt` seconds at `rate` rad/s.
    pub fn carry(&mut self, dt: f64, rate: Vector<Body>) {
        self.0 = self.0.map(|v| rotate(exp(rate.v * -dt), v));
    }

    /// Where it points by now.
    pub fn now(&self) -> Option<DVec3> {
        self.0
    }
}
