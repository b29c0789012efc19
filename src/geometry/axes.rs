//! How a scene and its dataset write vectors and attitudes: the only conversion between their axes and ours.

use super::{Attitude, Body, Nav, Vector};
use glam::{DQuat, DVec3};
use std::f64::consts::{FRAC_1_SQRT_2, SQRT_2};
use std::fmt;

/// The axes of a scene file and of the datasets made from it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Axes {
    /// Nav North-East-Down, body Forward-Right-Down: the program's own.
    #[default]
    NedFrd,
    /// Nav East-North-Up, body Forward-Left-Up.
    EnuFlu,
}

impl Axes {
    /// Every spelling a scene accepts.
    pub const NAMES: [&'static str; 2] = ["ned-frd", "enu-flu"];

    /// The axes a scene names, or `None`.
    pub fn from_name(name: &str) -> Option<Axes> {
        match name {
            "ned-frd" => Some(Axes::NedFrd),
            "enu-flu" => Some(Axes::EnuFlu),
            _ => None,
        }
    }

    /// A nav vector as written, taken inside.
    pub fn nav_in(self, v: DVec3) -> Vector<Nav> {
        Vector::from_vec(self.swap_nav(v))
    }

    /// A body vector as written, taken inside.
    pub fn body_in(self, v: DVec3) -> Vector<Body> {
        Vector::from_vec(self.flip_body(v))
    }

    /// A nav vector as these axes write it.
    pub fn nav_out(self, v: Vector<Nav>) -> DVec3 {
        self.swap_nav(v.v)
    }

    /// A body vector as these axes write it.
    pub fn body_out(self, v: Vector<Body>) -> DVec3 {
        self.flip_body(v.v)
    }

    /// An attitude as written, taken inside.
    pub fn attitude_in(self, q: DQuat) -> Attitude {
        Attitude::from_quat(match self {
            Axes::NedFrd => q,
            Axes::EnuFlu => turn_frames(q) * FRAC_1_SQRT_2,
        })
    }

    /// An attitude as these axes write it. Level facing east in ENU-FLU comes out as exactly `[1, 0, 0, 0]`.
    pub fn attitude_out(self, q: Attitude) -> DQuat {
        match self {
            Axes::NedFrd => q.q,
            Axes::EnuFlu => turn_frames(q.q) / SQRT_2,
        }
    }

    /// +1 or −1: the sign of body y and z in these axes against ours.
    pub fn body_sign(self) -> f64 {
        match self {
            Axes::NedFrd => 1.0,
            Axes::EnuFlu => -1.0,
        }
    }

    // Each of the two maps is its own inverse. Adding 0 turns −0 into 0.
    fn swap_nav(self, v: DVec3) -> DVec3 {
        match self {
            Axes::NedFrd => v,
            Axes::EnuFlu => DVec3::new(v.y, v.x, -v.z + 0.0),
        }
    }

    fn flip_body(self, v: DVec3) -> DVec3 {
        match self {
            Axes::NedFrd => v,
            Axes::EnuFlu => DVec3::new(v.x, -v.y + 0.0, -v.z + 0.0),
        }
    }
}

/// `√2 · (half turn about x + y) ⊗ q ⊗ (half turn about x)`, sign free: ENU-FLU to NED-FRD, and its own inverse.
fn turn_frames(q: DQuat) -> DQuat {
    DQuat::from_xyzw(q.x + q.y, q.x - q.y, q.w - q.z, q.w + q.z)
}

impl fmt::Display for Axes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(Self::NAMES[*self as usize])
    }
}

#[cfg(test)]
mod tests {
    use super::super::{angle_between, exp, rotate};
    use super::*;

    #[test]
    fn rotating_then_converting_is_converting_then_rotating() {
        let axes = Axes::EnuFlu;
        for v in [DVec3::new(0.3, -1.2, 0.5), DVec3::new(-2.0, 0.1, 0.9)] {
            let (written, body) = (exp(v), DVec3::new(1.0, 2.0, 3.0));
            let inside = axes.attitude_in(written).apply(axes.body_in(body));
            assert!((axes.nav_out(inside) - rotate(written, body)).length() < 1e-14);
            assert!(angle_between(axes.attitude_out(axes.attitude_in(written)), written) < 1e-15);
        }
    }

    #[test]
    fn level_facing_east_is_the_exact_identity_of_enu_flu() {
        let east = Axes::EnuFlu.attitude_in(DQuat::IDENTITY);
        assert_eq!(Axes::EnuFlu.attitude_out(east), DQuat::IDENTITY);
        assert!((east.apply(Vector::new(1.0, 0.0, 0.0)).v - DVec3::Y).length() < 1e-15, "forward is East");
        assert!((east.apply(Vector::new(0.0, 0.0, 1.0)).v - DVec3::Z).length() < 1e-15, "down is Down");
    }

    #[test]
    fn names_read_back() {
        for name in Axes::NAMES {
            assert_eq!(Axes::from_name(name).unwrap().to_string(), name);
        }
        assert_eq!(Axes::from_name("ned"), None);
    }
}
