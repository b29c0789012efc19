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
    normals.runs(
        x.len(),
        #[inline(always)]
        |at, [nx, ny, nz]| {
            // On the way through a run the states stay in registers.
            let [mut sx, mut sy, mut sz] = states;
            let biases = x[at.clone()].iter_mut().zip(&mut y[at.clone()]).zip(&mut z[at]);
            for (((x, y), z), ((nx, ny), nz)) in biases.zip(nx.iter().zip(ny).zip(nz)) {
                *x += sx;
                *y += sy;
                *z += sz;
                (sx, sy, sz) = (next(0, sx, *nx), next(1, sy, *ny), next(2, sz, *nz));
            }
            states = [sx, sy, sz];
        },
    );
    DVec3::from_array(states)
}
