//! Many attitudes of a constant rate in sequence, at a fraction of the cost of the closed form.
//!
//! Time from the segment's start is cut into cells in which half the angle grows by at most 1/8 rad. At a cell's
//! start the attitude is the motion's own closed form; within it, `q = q_cell ⊗ exp(w·δ/2)` with sine and cosine
//! from their series, accurate to half a unit in the last place. Cells lie on a fixed grid, so an attitude depends
//! only on its time, not on earlier calls, and no error accumulates.

use super::Motion;
use crate::geometry::{Attitude, Nav, Vector};
use crate::os;
use crate::time::SimTime;
use glam::{DQuat, DVec3};

/// The largest half angle within a cell, rad.
const HALF_ANGLE: f64 = 0.125;
/// The longest cell, ns.
const LONGEST: f64 = 1e9;

/// Steps through one segment.
pub(super) struct Stepped {
    /// Half the rate, rad/ns.
    half: DVec3,
    cell_ns: i64,
    cell: DQuat,
    from: i64,
    until: i64,
}

impl Stepped {
    /// Steps at this constant rate, rad/s.
    pub(super) fn new(rate: DVec3) -> Stepped {
        let half = rate * 0.5e-9;
        let cell_ns = (HALF_ANGLE / half.length()).clamp(1.0, LONGEST) as i64;
        Stepped { half, cell_ns, cell: DQuat::IDENTITY, from: 0, until: 0 }
    }

    /// The attitudes at times `since` the start of the segment, which began at `start`; any order works, increasing
    /// order is cheap.
    pub(super) fn at<const N: usize>(
        &mut self,
        motion: &dyn Motion,
        start: Attitude,
        since: [SimTime; N],
    ) -> Many<N> {
        let (first, last) = (since[0].0, since[N - 1].0);
        if first < self.from || first >= self.until {
            self.from = first.div_euclid(self.cell_ns) * self.cell_ns;
            self.until = self.from.saturating_add(self.cell_ns);
            self.cell = motion.at(start, SimTime(self.from).exact_seconds()).attitude.q;
        }
        if last >= self.until {
            // Across two cells: compute each separately.
            let mut many = Many { q: [[0.0; N]; 4] };
            for (i, &since) in since.iter().enumerate() {
                let one = self.at(motion, start, [since]);
                (0..4).for_each(|k| many.q[k][i] = one.q[k][0]);
            }
            return many;
        }
        let ns = since.map(|since| (since.0 - self.from) as f64);
        os::widest(
            #[inline(always)]
            || self.within(ns),
        )
    }

    /// The attitudes at these nanoseconds into the cell. It applies the same operations to each element of several
    /// columns, which the processor does two at a time.
    #[inline(always)]
    fn within<const N: usize>(&self, ns: [f64; N]) -> Many<N> {
        let DQuat { x, y, z, w } = self.cell;
        let mut q = [[0.0; N]; 4];
        for i in 0..N {
            let (hx, hy, hz) = (self.half.x * ns[i], self.half.y * ns[i], self.half.z * ns[i]);
            let square = hx * hx + hy * hy + hz * hz;
            let (sinc, c) = (series(square, &SINC), series(square, &COS));
            let (bx, by, bz) = (hx * sinc, hy * sinc, hz * sinc);
            q[0][i] = w * bx + x * c + y * bz - z * by;
            q[1][i] = w * by - x * bz + y * c + z * bx;
            q[2][i] = w * bz + x * by - y * bx + z * c;
            q[3][i] = w * c - x * bx - y * by - z * bz;
        }
        Many { q }
    }
}

/// Several attitudes as columns x, y, z, w.
pub(super) struct Many<const N: usize> {
    q: [[f64; N]; 4],
}

impl<const N: usize> Many<N> {
    /// One of them.
    pub(super) fn attitude(&self, i: usize) -> Attitude {
        let [x, y, z, w] = &self.q;
        Attitude::from_quat(DQuat::from_xyzw(x[i], y[i], z[i], w[i]))
    }

    /// A nav vector in body axes at each: [`rotate`](crate::geometry::rotate) by the inverse, as columns x, y, z.
    pub(super) fn to_body(&self, v: Vector<Nav>) -> [[f64; N]; 3] {
        os::widest(
            #[inline(always)]
            || self.seen(v),
        )
    }

    #[inline(always)]
    fn seen(&self, v: Vector<Nav>) -> [[f64; N]; 3] {
        let [x, y, z, w] = &self.q;
        let v = v.v;
        let mut seen = [[0.0; N]; 3];
        for i in 0..N {
            let (bx, by, bz) = (-x[i], -y[i], -z[i]);
            let (tx, ty, tz) =
                (2.0 * (by * v.z - v.y * bz), 2.0 * (bz * v.x - v.z * bx), 2.0 * (bx * v.y - v.x * by));
            seen[0][i] = v.x + w[i] * tx + (by * tz - ty * bz);
            seen[1][i] = v.y + w[i] * ty + (bz * tx - tz * bx);
            seen[2][i] = v.z + w[i] * tz + (bx * ty - tx * by);
        }
        seen
    }
}

/// sin(x)/x in x², to x¹⁰.
const SINC: [f64; 6] = [1.0, -1.0 / 6.0, 1.0 / 120.0, -1.0 / 5040.0, 1.0 / 362_880.0, -1.0 / 39_916_800.0];
/// cos(x) in x², to x¹².
const COS: [f64; 7] =
    [1.0, -0.5, 1.0 / 24.0, -1.0 / 720.0, 1.0 / 40_320.0, -1.0 / 3_628_800.0, 1.0 / 479_001_600.0];

/// The polynomial with these coefficients, the constant one first.
#[inline(always)]
fn series<const N: usize>(square: f64, coefficients: &[f64; N]) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, coefficient| sum * square + coefficient)
}

#[cfg(test)]
mod tests {
    use super::super::rotate::constant;
    use super::*;
    use crate::geometry::{angle_between, exp};

    #[test]
    fn it_is_the_closed_form_whatever_was_asked_before() {
        let start = Attitude::from_quat(exp(DVec3::new(0.3, -0.7, 1.1)));
        for rate in [[0.0; 3], [1e-9, 0.0, 0.0], [0.5, 0.0, 0.0], [0.3, -4.0, 35.0], [1e6, -1e6, 3e5]] {
            let motion = constant(rate);
            let rate = DVec3::from_array(rate);
            let times = (0..4000i64).map(|k| SimTime(k * 977_777 % 3_000_000_000));
            let mut stepped = Stepped::new(rate);
            for t in times {
                let q = stepped.at(&*motion, start, [t]).attitude(0);
                let exact = motion.at(start, t.exact_seconds()).attitude;
                assert!(angle_between(q.q, exact.q) < 1e-15, "{rate} at {t}");
                assert!((q.q.length() - 1.0).abs() < 1e-15);
                assert_eq!(q, Stepped::new(rate).at(&*motion, start, [t]).attitude(0), "{rate} at {t}");
                let v = Vector::new(3.0, -1.0, 9.80665);
                let seen = stepped.at(&*motion, start, [t]).to_body(v);
                assert_eq!(Vector::new(seen[0][0], seen[1][0], seen[2][0]), q.inverse().apply(v));
            }
            // Several at once, also across the ends of cells, equal each one alone.
            for k in 0..2000i64 {
                let times = [0, 1, 2, 3].map(|i| SimTime((4 * k + i) * 1_234_567));
                let many = stepped.at(&*motion, start, times);
                for (i, t) in times.into_iter().enumerate() {
                    assert_eq!(many.attitude(i), Stepped::new(rate).at(&*motion, start, [t]).attitude(0));
                }
            }
        }
    }
}
