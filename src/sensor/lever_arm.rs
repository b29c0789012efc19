//! Lever arm: an accelerometer at r from the point that moves feels `dw/dt × r + w × (w × r)` more (Titterton &
//! Weston, *Strapdown Inertial Navigation Technology*, 2nd ed., sec. 2.4). A jump of the angular rate, whose
//! derivative has no bound, adds nothing.

use super::{Block, Column, Kinds, SensorKind, Stage, Term, TermKind};
use crate::geometry::{Body, Vector};
use crate::keys::{Name, Values};
use crate::quantity::Kind;
use glam::DVec3;

const LEVER_ARM: Name<DVec3> = Name::new("lever_arm");

pub(super) static KIND: TermKind = TermKind {
    name: "lever_arm",
    about: "extra acceleration of an accelerometer off the motion's reference point: dw/dt × r + w × (w × r)",
    serves: Kinds::of(&[SensorKind::Accel]),
    stage: Stage::Signal,
    needs: &[Column::LeverArm],
    keys: |_| {
        vec![
            LEVER_ARM
                .body_vector(Kind::LENGTH, "from the motion's reference point to the accelerometer")
                .or("0"),
        ]
    },
    build: |values, _| Ok(lever_arm(values).map(|_| Box::new(LeverArm) as Box<dyn Term>)),
};

/// From the point that moves to the sensor, m, in body axes; `None` where it is at that point.
pub fn lever_arm(values: &Values) -> Option<DVec3> {
    values.get(LEVER_ARM).filter(|arm| *arm != DVec3::ZERO)
}

/// The acceleration at `arm` (m) beyond that of the point that moves, m/s², at an angular rate (rad/s) and its
/// derivative (rad/s²).
pub fn at_arm(arm: DVec3, rate: Vector<Body>, turning: Vector<Body>) -> Vector<Body> {
    Vector::from_vec(turning.v.cross(arm) + rate.v.cross(rate.v.cross(arm)))
}

struct LeverArm;

impl Term for LeverArm {
    #[inline(always)]
    fn apply(&mut self, block: &mut Block) {
        for (reading, arm) in block.reading.iter_mut().zip(&block.arm) {
            reading.iter_mut().zip(arm).for_each(|(reading, felt)| *reading += felt);
        }
    }
}
