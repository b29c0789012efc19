//! Scale error, misalignment and cross-coupling as one matrix: `reading = M·signal`, `M = matrix·(I + S)·R`.
//!
//! S is the diagonal of `scale_error`. R turns the signal onto axes that are turned by the rotation vector
//! `misalignment` against the body's, `R = exp(−[θ×])`: to first order `1 − [θ×]` (Titterton & Weston, *Strapdown
//! Inertial Navigation Technology*, 2nd ed., sec. 4.4 and 8.3). `matrix` is a full 3×3, the identity for a part
//! without errors. All three are in body axes, as every vector of a scene.

use super::{Block, Kinds, Stage, Term, TermKind, linear};
use crate::geometry;
use crate::keys::{KeyError, Name, Values};
use crate::quantity::Kind;
use glam::{DMat3, DVec3};

const SCALE_ERROR: Name<DVec3> = Name::new("scale_error");
const MISALIGNMENT: Name<DVec3> = Name::new("misalignment");
const MATRIX: Name<DMat3> = Name::new("matrix");

pub(super) static KIND: TermKind = TermKind {
    name: "matrix",
    about: "scale error, misalignment and cross-coupling as one matrix",
    serves: Kinds::TRIADS,
    stage: Stage::Signal,
    needs: &[],
    keys: |_| {
        vec![
            SCALE_ERROR.per_axis(Kind::RATIO, "how much more than the truth an axis reads").or("0"),
            MISALIGNMENT
                .body_vector(Kind::ANGLE, "rotation vector of the sensor's axes relative to the body's")
                .or("0"),
            MATRIX.matrix(
                Kind::RATIO,
                "matrix that multiplies an error-free reading, after scale error and misalignment",
            ),
        ]
    },
    build: |values, _| {
        let matrix = matrix(values);
        if matrix.determinant().abs() < 1e-12 {
            let message = "this matrix has no inverse: it loses an axis; an error-free one is [[1, 0, 0], [0, 1, 0], [0, 0, 1]]";
            let key = if values.has(MATRIX) { MATRIX.name() } else { SCALE_ERROR.name() };
            return Err(KeyError::new(key, message));
        }
        Ok((matrix != DMat3::IDENTITY).then(|| Box::new(Matrix(matrix)) as Box<dyn Term>))
    },
};

/// What scale error, misalignment and cross-coupling multiply a signal by, in body axes.
pub fn matrix(values: &Values) -> DMat3 {
    let scale = DVec3::ONE + values.get(SCALE_ERROR).unwrap_or_default();
    let turned = DMat3::from_quat(geometry::exp(-values.get(MISALIGNMENT).unwrap_or_default()));
    values.get(MATRIX).unwrap_or_default() * DMat3::from_diagonal(scale) * turned
}

struct Matrix(DMat3);

impl Term for Matrix {
    #[inline(always)]
    fn apply(&mut self, block: &mut Block) {
        linear::transform(self.0, &mut block.reading);
    }
}
