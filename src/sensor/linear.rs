//! Linear maps of columns: a column at a time, without a branch a sample.

use super::block::Columns;
use glam::DMat3;

/// Every sample multiplied by the matrix.
#[inline(always)]
pub(super) fn transform(by: DMat3, columns: &mut Columns) {
    let [a, b, c] = by.transpose().to_cols_array_2d();
    let [x, y, z] = columns;
    if DMat3::from_diagonal(by.diagonal()) == by {
        for (column, factor) in [(x, a[0]), (y, b[1]), (z, c[2])] {
            column.iter_mut().for_each(|value| *value *= factor);
        }
        return;
    }
    for ((x, y), z) in x.iter_mut().zip(y).zip(z) {
        let v = [*x, *y, *z];
        *x = a[0] * v[0] + a[1] * v[1] + a[2] * v[2];
        *y = b[0] * v[0] + b[1] * v[1] + b[2] * v[2];
        *z = c[0] * v[0] + c[1] * v[1] + c[2] * v[2];
    }
}

/// The matrix times every sample of `from`, added to `to`.
#[inline(always)]
pub(super) fn add_product(by: DMat3, from: &Columns, to: &mut Columns) {
    let [x, y, z] = from;
    for (row, column) in by.transpose().to_cols_array_2d().into_iter().zip(to) {
        for (((sum, x), y), z) in column.iter_mut().zip(x).zip(y).zip(z) {
            *sum += row[0] * x + row[1] * y + row[2] * z;
        }
    }
}
