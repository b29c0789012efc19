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

    /// Changes columns of body components on the chip's axes: `change` gets one column a chip axis, and −1.0 where the
    /// column is the chip's times that, which spares turning it over and back.
    #[inline(always)]
    pub(super) fn on_chip(self, columns: &mut [Vec<f64>; 3], mut change: impl FnMut(&mut [f64], f64)) {
        if let Some(axes) = self.right_angles() {
            for (body, sign) in axes {
                change(&mut columns[body], sign);
            }
        } else {
            turn(self.to_chip, columns);
            columns.iter_mut().for_each(|column| change(column, 1.0));
            turn(self.to_chip.transpose(), columns);
        }
    }

    /// Whether each chip axis lies along one of the body's.
    pub fn is_right_angled(self) -> bool {
        self.right_angles().is_some()
    }

    /// For a right-angle mount, which body axis each chip axis lies on, and its sign.
    fn right_angles(self) -> Option<[(usize, f64); 3]> {
        let rows = self.to_chip.transpose();
        let along = |row: DVec3| (0..3).find(|&i| row[i].abs() == 1.0).map(|i| (i, row[i]));
        Some([along(rows.x_axis)?, along(rows.y_axis)?, along(rows.z_axis)?])
    }
}

/// Every sample of three columns multiplied by the matrix.
#[inline(always)]
fn turn(by: DMat3, columns: &mut [Vec<f64>; 3]) {
    let [x, y, z] = columns;
    for ((x, y), z) in x.iter_mut().zip(y).zip(z) {
        (*x, *y, *z) = (by * DVec3::new(*x, *y, *z)).into();
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
