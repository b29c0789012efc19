//! No motion.

use super::{Kinematics, Motion, MotionKind};
use crate::double::Double;
use crate::geometry::{Attitude, Body, Vector};

pub(super) static KIND: MotionKind = MotionKind {
    name: "hold",
    about: "holds the current attitude",
    keys: &[],
    has_length: false,
    build: |_, _| Ok(Box::new(Hold)),
};

#[derive(Debug)]
pub(super) struct Hold;

impl Motion for Hold {
    fn at(&self, start: Attitude, _: Double) -> Kinematics {
        Kinematics { attitude: start, rate: Vector::ZERO, acceleration: Vector::ZERO }
    }

    fn constant_rate(&self) -> Option<Vector<Body>> {
        Some(Vector::ZERO)
    }

    fn fastest(&self) -> f64 {
        0.0
    }
}
