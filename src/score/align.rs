//! Constant rotations between the frames of estimate and truth, in closed form.
//!
//! With the world rotated by `A` and the body by `B` an estimate is `q = A ⊗ q_truth ⊗ B`, which is linear in each.
//! The pair that brings the truth closest to all estimates is the first pair of singular vectors of a 4 × 4 matrix
//! (the closed form of the hand-eye problem `AX = YB` for rotations). A rotation that the motion does not determine
//! stays the identity. With the body unchanged, `A` is the mean of the errors `q ⊗ q_truth*` (Markley et al.,
//! *Averaging Quaternions*, JGCD 30(4), 2007).

use super::figures::Aligned;
use crate::geometry::log;
use glam::DQuat;
use nalgebra::{Matrix4, SymmetricEigen, Vector4};

/// The rotations to remove from the estimates before judging.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Align {
    /// Nothing.
    #[default]
    None,
    /// One constant turn about the vertical: what an estimator without a magnetometer cannot know.
    Heading,
    /// One constant rotation of the nav axes.
    World,
    /// One constant rotation of the nav axes and one of the body's.
    Frames,
}

/// The constant rotations of an estimate: of the world and of the body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Frames {
    world: DQuat,
    body: DQuat,
}

impl Frames {
    /// No rotation.
    pub const SAME: Frames = Frames { world: DQuat::IDENTITY, body: DQuat::IDENTITY };

    /// The best rotations for pairs of estimate and truth.
    pub fn of(align: Align, pairs: impl Iterator<Item = (DQuat, DQuat)>) -> Frames {
        match align {
            Align::None => Frames::SAME,
            Align::Heading => {
                let turn = heading(pairs.map(|(q, truth)| q * truth.conjugate()));
                Frames { world: DQuat::from_rotation_z(turn), ..Frames::SAME }
            }
            Align::World => {
                Frames { world: mean(pairs.map(|(q, truth)| q * truth.conjugate())), ..Frames::SAME }
            }
            Align::Frames => both(pairs),
        }
    }

    /// An estimate without these rotations.
    pub fn undone(&self, q: DQuat) -> DQuat {
        self.world.conjugate() * q * self.body.conjugate()
    }

    /// The rotations as angles.
    pub fn angles(&self) -> Aligned {
        Aligned {
            world_deg: log(self.world).length().to_degrees(),
            body_deg: log(self.body).length().to_degrees(),
            heading_deg: heading(std::iter::once(self.world)).to_degrees(),
        }
    }
}

/// The constant turn about the vertical that brings the estimates closest to the truth, rad: the `ψ` that maximises
/// `Σ (e_w·cos(ψ/2) + e_z·sin(ψ/2))²`.
fn heading(errors: impl Iterator<Item = DQuat>) -> f64 {
    let (sine, cosine) =
        errors.fold((0.0, 0.0), |(s, c), e| (s + 2.0 * e.w * e.z, c + e.w * e.w - e.z * e.z));
    libm::atan2(sine, cosine)
}

/// A quaternion as a column: w, x, y, z.
fn column(q: DQuat) -> Vector4<f64> {
    Vector4::new(q.w, q.x, q.y, q.z)
}

fn quat(v: Vector4<f64>) -> DQuat {
    DQuat::from_xyzw(v[1], v[2], v[3], v[0])
}

/// The mean of rotations with arbitrary quaternion signs: the eigenvector of the largest eigenvalue of `Σ e eᵀ`.
pub(super) fn mean(errors: impl Iterator<Item = DQuat>) -> DQuat {
    let sum: Matrix4<f64> = errors.map(column).map(|e| e * e.transpose()).sum();
    let eigen = SymmetricEigen::new(sum);
    quat(eigen.eigenvectors.column(eigen.eigenvalues.imax()).into_owned()).normalize()
}

/// Both rotations. With `G_ij = Σ q·(e_i ⊗ q_truth ⊗ e_j)` over the unit quaternions `e`, `Σ q·(A ⊗ q_truth ⊗ B)`
/// is `Aᵀ G B`, so they are the first singular vectors of `G`.
fn both(pairs: impl Iterator<Item = (DQuat, DQuat)>) -> Frames {
    let mut last: Option<(DQuat, DQuat)> = None;
    let mut sum = Matrix4::zeros();
    for (mut q, mut truth) in pairs {
        // Choose an estimate's sign to be continuous in time when the truth's is.
        if let Some((q_before, truth_before)) = last {
            q = if q.dot(q_before) < 0.0 { -q } else { q };
            truth = if truth.dot(truth_before) < 0.0 { -truth } else { truth };
        }
        last = Some((q, truth));
        sum += column(q) * column(truth).transpose();
    }
    let units = [0, 1, 2, 3].map(|i| quat(Vector4::ith(i, 1.0)));
    let mut g = Matrix4::from_fn(|i, j| {
        let image = |n: usize| column(units[i] * units[n] * units[j]);
        (0..4).map(|n| sum.column(n).dot(&image(n))).sum::<f64>()
    });
    let (values, _) = singular(&g);
    if values[0] - values[1] < TIED * values[0] {
        g[(0, 0)] += if g[(0, 0)] < 0.0 { -1e-6 } else { 1e-6 } * values[0];
    }
    let (_, world) = singular(&g);
    let body = quat((g.transpose() * column(world)).normalize());
    Frames { world, body }
}

/// Singular values that differ by less than this share leave a turn of 0.01 deg undetermined.
const TIED: f64 = 4e-9;

/// The two largest singular values, and the left vector of the first.
fn singular(g: &Matrix4<f64>) -> ([f64; 2], DQuat) {
    let eigen = SymmetricEigen::new(g * g.transpose());
    let mut order = [0, 1, 2, 3];
    order.sort_by(|&a, &b| eigen.eigenvalues[b].total_cmp(&eigen.eigenvalues[a]));
    let value = |i: usize| libm::sqrt(eigen.eigenvalues[order[i]].max(0.0));
    ([value(0), value(1)], quat(eigen.eigenvectors.column(order[0]).into_owned()).normalize())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{angle_between, exp};
    use glam::DVec3;
    use proptest::prelude::*;

    fn motion(k: i32) -> DQuat {
        let t = f64::from(k) * 0.1;
        exp(DVec3::new(libm::sin(t), 0.0, 0.0)) * exp(DVec3::new(0.0, libm::cos(1.3 * t), 0.7 * t))
    }

    proptest! {
        #[test]
        fn both_rotations_come_back_whatever_they_are(
            a in prop::array::uniform3(-2.0..2.0f64), b in prop::array::uniform3(-2.0..2.0f64),
        ) {
            let (a, b) = (exp(DVec3::from_array(a)), exp(DVec3::from_array(b)));
            // The signs of the quaternions are arbitrary.
            let sign = |k: i32| if k % 7 == 3 { -1.0 } else { 1.0 };
            let pairs = (0..200).map(|k| (a * motion(k) * b * sign(k), motion(k)));
            let found = Frames::of(Align::Frames, pairs.clone());
            prop_assert!(angle_between(found.world, a) < 1e-6 && angle_between(found.body, b) < 1e-6, "{found:?}");
            for (q, truth) in pairs {
                prop_assert!(angle_between(found.undone(q), truth) < 1e-6);
            }
        }

        #[test]
        fn the_world_alone_comes_back(a in prop::array::uniform3(-2.0..2.0f64)) {
            let a = exp(DVec3::from_array(a));
            let found = Frames::of(Align::World, (0..200).map(|k| (-(a * motion(k)), motion(k))));
            prop_assert!(angle_between(found.world, a) < 1e-7 && found.body == DQuat::IDENTITY);
        }
    }

    #[test]
    fn what_the_motion_does_not_tell_stays_as_it_is() {
        // If the motion only turns about the vertical, headings of world and body are indistinguishable.
        let turn = |k: i32| exp(DVec3::Z * f64::from(k) * 0.05);
        let off = exp(DVec3::Z * 0.4);
        let found = Frames::of(Align::Frames, (0..100).map(|k| (off * turn(k), turn(k))));
        assert!(angle_between(found.undone(off * turn(7)), turn(7)) < 1e-6);
        let angles = found.angles();
        assert!((angles.world_deg + angles.body_deg - 0.4f64.to_degrees()).abs() < 1e-3, "{angles:?}");
        // Equal frames give no rotation.
        let none = Frames::of(Align::Frames, (0..100).map(|k| (turn(k), turn(k)))).angles();
        assert!(none.world_deg < 1e-4 && none.body_deg < 1e-4, "{none:?}");
    }

    #[test]
    fn angles_are_told_with_the_heading_by_its_sign() {
        let found = Frames::of(Align::Heading, (0..9).map(|k| (exp(DVec3::Z * -0.3) * motion(k), motion(k))));
        let angles = found.angles();
        assert!((angles.heading_deg + 0.3f64.to_degrees()).abs() < 1e-9);
        assert!((angles.world_deg - 0.3f64.to_degrees()).abs() < 1e-9 && angles.body_deg == 0.0);
    }
}
