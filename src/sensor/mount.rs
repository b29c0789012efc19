//! How a part is mounted: the rotation from body to chip axes.

use crate::geometry::{Body, Chip, Rotation, Vector, rotate};
use glam::{DMat3, DQuat, DVec3};
use std::fmt;

/// The rotation from body (Forward-Right-Down) to chip axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mount {
    to_chip: DMat3,
}

impl Default for Mount {
    /// Chip axes are body axes.
    fn default() -> Self {
        Mount { to_chip: DMat3::IDENTITY }
    }
}

impl Mount {
    /// Chip z up when the vehicle is flat, x forward: how MPU-style chips are drawn on a board.
    pub fn flu() -> Mount {
        Mount::from_name("flu").unwrap_or_default()
    }

    /// One of the 24 right-angle mounts by three letters: where the chip's x, y and z point, out of (f)orward,
    /// (b)ack, (r)ight, (l)eft, (u)p and (d)own. `None` if it is no right-handed set of axes.
    pub fn from_name(name: &str) -> Option<Mount> {
        let mut rows = [DVec3::ZERO; 3];
        if name.chars().count() != 3 {
            return None;
        }
        for (row, letter) in rows.iter_mut().zip(name.chars()) {
            *row = match letter.to_ascii_lowercase() {
                'f' => DVec3::X,
                'b' => DVec3::NEG_X,
                'r' => DVec3::Y,
                'l' => DVec3::NEG_Y,
                'd' => DVec3::Z,
                'u' => DVec3::NEG_Z,
                _ => return None,
            };
        }
        let to_chip = DMat3::from_cols(rows[0], rows[1], rows[2]).transpose();
        (to_chip.determinant() == 1.0).then_some(Mount { to_chip })
    }

    /// Any rotation from body to chip axes.
    pub fn from_rotation(rotation: Rotation<Body, Chip>) -> Mount {
        let column = |v| rotate(rotation.q, v);
        Mount { to_chip: DMat3::from_cols(column(DVec3::X), column(DVec3::Y), column(DVec3::Z)) }
    }

    /// As a rotation.
    pub fn rotation(self) -> Rotation<Body, Chip> {
        Rotation::from_quat(DQuat::from_mat3(&self.to_chip))
    }

    /// A body vector on the chip's axes.
    pub fn to_chip(self, v: Vector<Body>) -> Vector<Chip> {
        Vector::from_vec(self.to_chip * v.v)
    }

    /// A chip vector on the body's axes.
    pub fn to_body(self, v: Vector<Chip>) -> Vector<Body> {
        Vector::from_vec(self.to_chip.transpose() * v.v)
    }

    /// Changes columns of body components on the chip's axes: `change` gets the sample's index and components.
    pub(super) fn on_chip(
        self,
        columns: &mut [Vec<f64>; 3],
        mut change: impl FnMut(usize, [f64; 3]) -> [f64; 3],
    ) {
        let [x, y, z] = columns;
        let same_axes = self.to_chip == DMat3::IDENTITY;
        for (i, ((x, y), z)) in x.iter_mut().zip(y).zip(z).enumerate() {
            let body = DVec3::new(*x, *y, *z);
            let out = if same_axes {
                DVec3::from_array(change(i, body.to_array()))
            } else {
                let chip = change(i, (self.to_chip * body).to_array());
                self.to_chip.transpose() * DVec3::from_array(chip)
            };
            (*x, *y, *z) = (out.x, out.y, out.z);
        }
    }
}

impl fmt::Display for Mount {
    /// The three letters of a right-angle mount, or the quaternion `[w, x, y, z]` from body to chip.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let letter = |row: DVec3| match row.to_array() {
            [1.0, 0.0, 0.0] => Some('f'),
            [-1.0, 0.0, 0.0] => Some('b'),
            [0.0, 1.0, 0.0] => Some('r'),
            [0.0, -1.0, 0.0] => Some('l'),
            [0.0, 0.0, 1.0] => Some('d'),
            [0.0, 0.0, -1.0] => Some('u'),
            _ => None,
        };
        let rows = self.to_chip.transpose();
        match [rows.x_axis, rows.y_axis, rows.z_axis].map(letter) {
            [Some(x), Some(y), Some(z)] => write!(f, "{x}{y}{z}"),
            _ => {
                let q = self.rotation().q;
                write!(f, "[{}, {}, {}, {}]", q.w, q.x, q.y, q.z)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_are_24_right_angle_mounts_and_each_undoes_itself() {
        let letters = ['f', 'b', 'r', 'l', 'u', 'd'];
        let mut count = 0;
        for x in letters {
            for y in letters {
                for z in letters {
                    let name: String = [x, y, z].iter().collect();
                    let Some(mount) = Mount::from_name(&name) else { continue };
                    count += 1;
                    let v = Vector::new(1.0, 2.0, 3.0);
                    assert_eq!(mount.to_body(mount.to_chip(v)), v);
                    assert_eq!(mount.to_string(), name);
                    assert!((mount.rotation().apply(v) - mount.to_chip(v)).length() < 1e-14, "{name}");
                }
            }
        }
        assert_eq!(count, 24);
    }

    #[test]
    fn flu_turns_y_and_z_over() {
        assert_eq!(Mount::flu().to_chip(Vector::new(1.0, 2.0, 3.0)), Vector::new(1.0, -2.0, -3.0));
        for bad in ["fru", "ffd", "fr", "frdx", "xyz"] {
            assert_eq!(Mount::from_name(bad), None, "{bad} is left-handed, repeated or unknown");
        }
    }
}
