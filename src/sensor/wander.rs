//! Biases that wander: a state an axis, moved on by a normal number after each sample.

use super::block::Columns;
use crate::random::Normals;
use glam::DVec3;

/// Adds each axis's state to its column, sample by sample, and moves it on: `state ← next(axis, state, n)`. Gives back
/// the states after the last. The axes go side by side, for each must wait for its own state before.
#[inline(always)]
pub(super) fn wander(
    normals: &mut Normals,
    states: DVec3,
    columns: &mut Columns,
    next: impl Fn(usize, f64, f64) -> f64,
) -> DVec3 {
    let mut states = states.to_array();
    let [x, y, z] = columns;
    normals.runs(x.len(), |at, [nx, ny, nz]| {
        let biases = x[at.clone()].iter_mut().zip(&mut y[at.clone()]).zip(&mut z[at]);
        for (((x, y), z), ((nx, ny), nz)) in biases.zip(nx.iter().zip(ny).zip(nz)) {
            for (axis, (bias, n)) in [(x, nx), (y, ny), (z, nz)].into_iter().enumerate() {
                *bias += states[axis];
                states[axis] = next(axis, states[axis], *n);
            }
        }
    });
    DVec3::from_array(states)
}
