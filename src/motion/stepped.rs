//! Many instants of a constant rate at once, at a fraction of the cost of the closed form.
//!
//! Time from the segment's start is cut into cells in which half the angle grows by at most π/2. At a cell's middle
//! the attitude is the motion's own closed form, q; at δ from there it is `q ⊗ exp(w·δ/2)`, and with n the axis and
//! s, c the sine and cosine of half the angle |w|·δ a vector that is v in the body at the middle is
//! `v + s·(P·s + Q·c)`, P = −2·(v − n(n·v)), Q = −2·n×v (Rodrigues). Cells lie on a fixed grid, so what comes out
//! depends only on the time, not on what else is asked, and no error accumulates.
//!
//! The half angle is within π/4 and errs by 2·2⁻⁵³ of itself, sine and cosine by a unit in the last place, the products
//! and sums by one each: altogether less than 10⁻¹⁵ rad of half the angle, 1.2·10⁻¹³ degrees.

use super::Motion;
use crate::double::small_sin_cos;
use crate::geometry::{Attitude, Body, Nav, Vector};
use crate::os;
use crate::time::SimTime;
use glam::{DQuat, DVec3};
use std::f64::consts::FRAC_PI_2;

/// How far half the angle grows in a cell, rad.
const HALF_ANGLE: f64 = FRAC_PI_2;
/// The longest cell, ns.
const LONGEST: f64 = 1e9;

/// Steps through one segment.
pub(super) struct Stepped<'a> {
    motion: &'a dyn Motion,
    /// The attitude at the segment's start.
    start: Attitude,
    axis: DVec3,
    /// Half the angular speed, rad/ns.
    half_speed: f64,
    cell_ns: i64,
}

/// Consecutive instants in one cell: the attitude in its middle, and sine and cosine of half the angle from there.
pub(super) struct Cell<'a> {
    middle: Attitude,
    axis: DVec3,
    sines: &'a [f64],
    cosines: &'a [f64],
}

/// Memory for the instants of a cell.
#[derive(Clone, Debug, Default)]
pub(super) struct Scratch {
    angles: Vec<f64>,
    sines: Vec<f64>,
    cosines: Vec<f64>,
}

impl<'a> Stepped<'a> {
    /// Steps `motion`, of this constant rate (rad/s), which begins at `start`.
    pub fn new(motion: &'a dyn Motion, rate: Vector<Body>, start: Attitude) -> Stepped<'a> {
        let speed = rate.length();
        let half_speed = speed * 0.5e-9;
        // Even, for its middle to be a whole nanosecond.
        let cell_ns = (HALF_ANGLE / half_speed).clamp(2.0, LONGEST) as i64 & !1;
        let axis = if speed > 0.0 { rate.v / speed } else { DVec3::ZERO };
        Stepped { motion, start, axis, half_speed, cell_ns }
    }

    /// Calls `each` with every cell that has some of the times `since` the start of the segment, which are in order.
    pub fn cells(&self, since: &[SimTime], scratch: &mut Scratch, mut each: impl FnMut(Cell<'_>)) {
        let mut rest = since;
        while let Some(first) = rest.first() {
            let from = first.0.div_euclid(self.cell_ns) * self.cell_ns;
            let middle = from.saturating_add(self.cell_ns / 2);
            let until = from.saturating_add(self.cell_ns);
            let within = rest.partition_point(|t| t.0 < until).max(1);
            os::widest(
                #[inline(always)]
                || scratch.turn(&rest[..within], middle, self.half_speed),
            );
            let middle = self.motion.at(self.start, SimTime(middle).exact_seconds()).attitude;
            let Scratch { sines, cosines, .. } = &*scratch;
            each(Cell { middle, axis: self.axis, sines, cosines });
            rest = &rest[within..];
        }
    }
}

impl Scratch {
    /// Sine and cosine of half the angle at each time from `middle`.
    #[inline(always)]
    fn turn(&mut self, since: &[SimTime], middle: i64, half_speed: f64) {
        let Scratch { angles, sines, cosines } = self;
        angles.clear();
        angles.extend(since.iter().map(|t| (t.0 - middle) as i32 as f64 * half_speed));
        sines.resize(since.len(), 0.0);
        cosines.resize(since.len(), 0.0);
        for ((angle, sine), cosine) in angles.iter().zip(sines).zip(cosines) {
            (*sine, *cosine) = small_sin_cos(*angle);
        }
    }
}

impl Cell<'_> {
    /// Appends the attitudes, as columns x, y, z, w.
    pub fn attitudes(&self, to: &mut [Vec<f64>; 4]) {
        let q = self.middle.q;
        let turned = q * DQuat::from_xyzw(self.axis.x, self.axis.y, self.axis.z, 0.0);
        for (column, (still, turned)) in to.iter_mut().zip(q.to_array().into_iter().zip(turned.to_array())) {
            os::widest(
                #[inline(always)]
                || column.extend(self.pairs().map(|(s, c)| still * c + turned * s)),
            );
        }
    }

    /// Appends a nav vector in body axes at each, as columns x, y, z.
    pub fn seen(&self, v: Vector<Nav>, to: &mut [Vec<f64>; 3]) {
        let (v, n) = (self.middle.inverse().apply(v).v, self.axis);
        let (p, q) = ((v - n * n.dot(v)) * -2.0, n.cross(v) * -2.0);
        for (axis, column) in to.iter_mut().enumerate() {
            let (v, p, q) = (v[axis], p[axis], q[axis]);
            os::widest(
                #[inline(always)]
                || column.extend(self.pairs().map(|(s, c)| v + s * (p * s + q * c))),
            );
        }
    }

    #[inline(always)]
    fn pairs(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        self.sines.iter().copied().zip(self.cosines.iter().copied())
    }
}

#[cfg(test)]
mod tests {
    use super::super::rotate::constant;
    use super::*;
    use crate::geometry::{angle_between, exp};

    const RATES: [[f64; 3]; 5] =
        [[0.0; 3], [1e-9, 0.0, 0.0], [0.5, 0.0, 0.0], [0.3, -4.0, 35.0], [1e6, -1e6, 3e5]];

    fn start() -> Attitude {
        Attitude::from_quat(exp(DVec3::new(0.3, -0.7, 1.1)))
    }

    /// Attitude and `v` in the body's axes at each time.
    fn stepped(rate: [f64; 3], times: &[SimTime], v: Vector<Nav>) -> Vec<(DQuat, DVec3)> {
        let motion = constant(rate);
        let stepped = Stepped::new(&*motion, Vector::from_vec(DVec3::from_array(rate)), start());
        let (mut q, mut seen): ([Vec<f64>; 4], [Vec<f64>; 3]) = Default::default();
        stepped.cells(times, &mut Scratch::default(), |cell| {
            cell.attitudes(&mut q);
            cell.seen(v, &mut seen);
        });
        let count = times.len();
        assert!(q[3].len() == count && seen[2].len() == count);
        let at = |i: usize| {
            let quat = DQuat::from_xyzw(q[0][i], q[1][i], q[2][i], q[3][i]);
            (quat, DVec3::new(seen[0][i], seen[1][i], seen[2][i]))
        };
        (0..count).map(at).collect()
    }

    /// A fifth of it, for what the closed form itself is off.
    #[test]
    fn it_is_the_closed_form_to_a_trillionth_of_a_degree() {
        let v = Vector::new(3.0, -1.0, 9.80665);
        for rate in RATES {
            let mut times: Vec<_> = (0..4000i64).map(|k| SimTime(k * 977_777 % 3_000_000_000)).collect();
            times.extend((0..4000).map(|k| SimTime(86_400_000_000_000 + k * 31_250)));
            times.sort();
            let motion = constant(rate);
            for (t, (q, seen)) in times.iter().zip(stepped(rate, &times, v)) {
                let exact = motion.at(start(), t.exact_seconds()).attitude;
                let error = angle_between(q, exact.q).to_degrees();
                assert!(error < 2e-13, "{rate:?} at {t}: {error} deg");
                assert!((q.length() - 1.0).abs() < 2e-15);
                let off = (seen - exact.inverse().apply(v).v).length() / v.length();
                assert!(off < 4e-15, "{rate:?} at {t}: {off}");
            }
        }
    }

    #[test]
    fn an_instant_depends_on_nothing_else_that_is_asked() {
        let v = Vector::new(0.2, 20.0, 45.0);
        for rate in RATES {
            let times: Vec<_> = (0..700i64).map(|k| SimTime(k * 1_234_567)).collect();
            let together = stepped(rate, &times, v);
            for (t, together) in times.iter().zip(&together) {
                assert_eq!(stepped(rate, &[*t], v)[0], *together, "{rate:?} at {t}");
            }
        }
    }
}
