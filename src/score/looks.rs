//! The usual mistakes of axes, order and sign: each is undone on an estimate with a large error, to see whether it
//! fits.

use crate::geometry::{Axes, Euler, exp};
use glam::{DQuat, DVec3};
use std::f64::consts::{FRAC_PI_2, PI};

/// An estimate with a larger error than this is examined for a mistake, rad: 10 deg RMS.
pub(super) const BAD: f64 = 10.0 * PI / 180.0;
/// A mistake is named if undoing it leaves less than this share of the error, and less than [`BAD`].
pub(super) const SHARE: f64 = 0.2;
/// Mistakes are equivalent to the best if they explain the error at most this factor, and this much (rad), worse.
pub(super) const ALIKE: (f64, f64) = (1.5, 0.1 * PI / 180.0);

/// One mistake and its correction.
pub(super) struct Mistake {
    /// The text after "estimate looks".
    pub name: &'static str,
    pub undo: fn(DQuat) -> DQuat,
}

/// In the order of preference where a motion does not distinguish them.
pub(super) const MISTAKES: [Mistake; 17] = [
    Mistake { name: "NED/ENU swapped", undo: |q| Axes::EnuFlu.attitude_in(q).q },
    Mistake { name: "FRD/FLU swapped (body axes alone)", undo: |q| q * turn(DVec3::X, PI) },
    Mistake {
        name: "NED/ENU swapped (nav axes alone)",
        undo: |q| Axes::EnuFlu.attitude_in(q).q * turn(DVec3::X, PI),
    },
    Mistake {
        name: "north-west-up, forward-left-up instead of NED-FRD",
        undo: |q| turn(DVec3::X, PI) * q * turn(DVec3::X, PI),
    },
    Mistake { name: "conjugated (nav to body instead of body to nav)", undo: |q| q.conjugate() },
    Mistake { name: "w last, read as w first", undo: |q| DQuat::from_xyzw(q.w, q.x, q.y, q.z) },
    Mistake { name: "w first, read as w last", undo: |q| DQuat::from_xyzw(q.y, q.z, q.w, q.x) },
    Mistake { name: "yaw sign flipped", undo: |q| euler(q, |a| Euler { yaw: -a.yaw, ..a }) },
    Mistake { name: "pitch sign flipped", undo: |q| euler(q, |a| Euler { pitch: -a.pitch, ..a }) },
    Mistake { name: "roll sign flipped", undo: |q| euler(q, |a| Euler { roll: -a.roll, ..a }) },
    Mistake {
        name: "roll and pitch swapped",
        undo: |q| euler(q, |a| Euler { roll: a.pitch, pitch: a.roll, ..a }),
    },
    Mistake {
        name: "with yaw counted anticlockwise from east",
        undo: |q| euler(q, |a| Euler { yaw: FRAC_PI_2 - a.yaw, ..a }),
    },
    Mistake { name: "in radians read as degrees", undo: |q| euler(q, to_degrees) },
    Mistake { name: "turned by 90 deg about the vertical", undo: |q| turn(DVec3::Z, -FRAC_PI_2) * q },
    Mistake { name: "turned by -90 deg about the vertical", undo: |q| turn(DVec3::Z, FRAC_PI_2) * q },
    Mistake { name: "turned by 180 deg about the vertical", undo: |q| turn(DVec3::Z, PI) * q },
    Mistake { name: "turned by 180 deg about body z", undo: |q| q * turn(DVec3::Z, PI) },
];

fn turn(axis: DVec3, angle: f64) -> DQuat {
    exp(axis * angle)
}

fn euler(q: DQuat, undo: fn(Euler) -> Euler) -> DQuat {
    undo(Euler::from_quat(q)).to_quat()
}

fn to_degrees(a: Euler) -> Euler {
    Euler { roll: a.roll.to_degrees(), pitch: a.pitch.to_degrees(), yaw: a.yaw.to_degrees() }
}
