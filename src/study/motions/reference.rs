//! The attitude of a motion that is known by its rate alone.

use crate::geometry::{angle_between, exp};
use glam::{DQuat, DVec3};

/// Two solutions nearer than this (rad, 6·10⁻¹¹ degrees) are taken for the truth.
const ENOUGH: f64 = 1e-12;

/// The attitude at the last of `edges`, from the identity at the first, and by how much (rad) the last halving of
/// the step changed it. Between two edges the rate is smooth.
///
/// Sixth-order Magnus steps, halved until two solutions in a row agree to 10⁻¹² rad; the finer is given.
pub(super) fn attitude(rate: impl Fn(f64) -> DVec3, edges: &[f64]) -> (DQuat, f64) {
    let solve = |per_second: f64| {
        let panels = edges.windows(2).map(|edge| panel(&rate, edge[0], edge[1], per_second));
        panels.fold(DQuat::IDENTITY, |q, turn| q * turn).normalize()
    };
    let mut per_second = 16.0;
    let mut coarse = solve(per_second);
    loop {
        per_second *= 2.0;
        let fine = solve(per_second);
        let change = angle_between(coarse, fine);
        // Beyond some thousand steps a second rounding is all that changes.
        if change < ENOUGH || per_second > 2000.0 {
            return (fine, change);
        }
        coarse = fine;
    }
}

fn panel(rate: &impl Fn(f64) -> DVec3, from: f64, to: f64, per_second: f64) -> DQuat {
    let steps = ((to - from) * per_second).ceil().max(1.0);
    let h = (to - from) / steps;
    (0..steps as u64).fold(DQuat::IDENTITY, |q, step| q * exp(magnus_6(rate, from + step as f64 * h, h)))
}

/// The rotation vector of one step of h seconds: the Magnus series to sixth order from three Gauss points
/// (S. Blanes, F. Casas, J. Oteo, J. Ros, *The Magnus expansion and some of its applications*, Physics Reports 470,
/// 2009). Body rates act from the right, so that the commutator is −a×b.
fn magnus_6(rate: &impl Fn(f64) -> DVec3, t: f64, h: f64) -> DVec3 {
    let root = libm::sqrt(15.0);
    let commutator = |a: DVec3, b: DVec3| b.cross(a);
    let at = |c: f64| rate(t + c * h) * h;
    let (left, middle, right) = (at(0.5 - root / 10.0), at(0.5), at(0.5 + root / 10.0));
    let (a, b, c) = (middle, (right - left) * (root / 3.0), (right - middle * 2.0 + left) * (10.0 / 3.0));
    let ab = commutator(a, b);
    let twice = commutator(a, c * 2.0 + ab) * (-1.0 / 60.0);
    a + c / 12.0 + commutator(ab - a * 20.0 - c, b + twice) / 240.0
}
