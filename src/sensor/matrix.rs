//! Scale error, misalignment and cross-coupling as one matrix: `reading = M·signal`, `M = matrix·(I + S)·R`.
//!
//! S is the diagonal of `scale_error`. R turns the signal onto axes that are turned by the rotation vector
//! `misalignment` against the body's, `R = exp(−[θ×])`: to first order `1 − [θ×]` (Titterton & Weston, *Strapdown
//! Inertial Navigation Technology*, 2nd ed., sec. 4.4 and 8.3). `matrix` is a full 3×3, the identity for a part
//! without errors. All three are in body axes, as every vector of a scene.

use super::{Block, Kinds, Stage, Term, TermKind, linear};
use crate::geometry;
use crate::keys::{Key, KeyError, Takes, Values};
use crate::quantity::Kind;
use glam::{DMat3, DVec3};

pub(super) static KIND: TermKind = TermKind {
    name: "matrix",
    about: "scale error, misalignment and cross-coupling as one matrix",
    serves: Kinds::TRIADS,
    stage: Stage::Signal,
    needs: &[],
    keys: |_| {
        vec![
            Key {
                name: "scale_error",
                takes: Takes::PerAxis(Kind::RATIO),
                default: Some("0"),
                about: "how much more than the truth an axis reads",
            },
            Key {
                name: "misalignment",
                takes: Takes::BodyVector(Kind::ANGLE),
                default: Some("0"),
                about: "rotation vector of the sensor's axes relative to the body's",
            },
            Key {
                name: "matrix",
                takes: Takes::Matrix(Kind::RATIO),
                default: None,
                about: "matrix that multiplies an error-free reading, after scale error and misalignment",
            },
        ]
    },
    build: |values, _| {
        let matrix = matrix(values);
        if matrix.determinant().abs() < 1e-12 {
            let message = "this matrix has no inverse: it loses an axis; an error-free one is [[1, 0, 0], [0, 1, 0], [0, 0, 1]]";
            let key = if values.has("matrix") { "matrix" } else { "scale_error" };
            return Err(KeyError::new(key, message));
        }
        Ok((matrix != DMat3::IDENTITY).then(|| Box::new(Matrix(matrix)) as Box<dyn Term>))
    },
};

/// What scale error, misalignment and cross-coupling multiply a signal by, in body axes.
pub fn matrix(values: &Values) -> DMat3 {
    let scale = DVec3::ONE + values.vector("scale_error").unwrap_or_default();
    let turned = DMat3::from_quat(geometry::exp(-values.vector("misalignment").unwrap_or_default()));
    values.matrix("matrix").unwrap_or_default() * DMat3::from_diagonal(scale) * turned
}

struct Matrix(DMat3);

impl Term for Matrix {
    #[inline(always)]
    fn apply(&mut self, block: &mut Block) {
        linear::transform(self.0, &mut block.reading);
    }
}
