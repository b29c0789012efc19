//! The rotation that brings one set of vectors closest to another (B. Horn, *Closed-form solution of absolute
//! orientation using unit quaternions*, J. Opt. Soc. Am. A 4(4), 1987).

use glam::{DQuat, DVec3};
use nalgebra::{Matrix4, SymmetricEigen};

/// `Σ a bᵀ` of two sets of vectors, row by row.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Products(pub [f64; 9]);

impl Products {
    /// Adds a pair.
    pub fn add(&mut self, a: DVec3, b: DVec3) {
        for (k, sum) in self.0.iter_mut().enumerate() {
            *sum += a[k / 3] * b[k % 3];
        }
    }

    /// `Σ a·b`.
    pub fn trace(&self) -> f64 {
        self.0[0] + self.0[4] + self.0[8]
    }

    /// The rotation `R` with the largest `Σ a·(R b)`, and that sum. A rotation that the vectors do not determine
    /// stays the identity.
    pub fn best_turn(&self) -> (DQuat, f64) {
        let [xx, yx, zx, xy, yy, zy, xz, yz, zz] = self.0;
        let size = self.0.iter().fold(0.0_f64, |most, c| most.max(c.abs()));
        let w = xx + yy + zz + 1e-9 * size;
        let n = Matrix4::new(
            w,
            yz - zy,
            zx - xz,
            xy - yx,
            yz - zy,
            xx - yy - zz,
            xy + yx,
            zx + xz,
            zx - xz,
            xy + yx,
            yy - xx - zz,
            yz + zy,
            xy - yx,
            zx + xz,
            yz + zy,
            zz - xx - yy,
        );
        let eigen = SymmetricEigen::new(n);
        let largest = eigen.eigenvalues.imax();
        let q = eigen.eigenvectors.column(largest);
        (DQuat::from_xyzw(q[1], q[2], q[3], q[0]).normalize(), eigen.eigenvalues[largest])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{angle_between, exp, rotate};
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_turn_comes_back(turn in prop::array::uniform3(-1.7..1.7f64)) {
            let turn = exp(DVec3::from_array(turn));
            let mut products = Products::default();
            let mut square = 0.0;
            for b in [DVec3::X, DVec3::new(0.3, -2.0, 0.5), DVec3::new(-1.0, 0.1, 0.7)] {
                products.add(rotate(turn, b), b);
                square += b.length_squared();
            }
            let (found, sum) = products.best_turn();
            prop_assert!(angle_between(found, turn) < 1e-7 && (sum - square).abs() < 1e-7);
            prop_assert!(products.trace() <= sum + 1e-9);
        }
    }

    #[test]
    fn about_an_axis_that_nothing_tells_it_does_not_turn() {
        let mut products = Products::default();
        products.add(DVec3::Z, DVec3::Z);
        assert!(angle_between(products.best_turn().0, DQuat::IDENTITY) < 1e-6);
    }
}
