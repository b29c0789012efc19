//! Many attitudes of a constant rate, one after another, at a fraction of the cost of the closed form each time.
//!
//! Time from the segment's start is cut into cells in which half the angle grows by at most 1/8 rad. At a cell's start the
//! attitude is the motion's own closed form; within, `q = q_cell ⊗ exp(w·δ/2)` with sine and cosine from their series,
//! good to half a unit in the last place. Cells lie on a fixed grid, so that an attitude depends on its time alone,
//! never on which were asked before, and nothing adds up.

use super::Motion;
use crate::geometry::Attitude;
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
    /// At this constant rate, rad/s.
    pub(super) fn new(rate: DVec3) -> Stepped {
        let half = rate * 0.5e-9;
        let cell_ns = (HALF_ANGLE / half.length()).clamp(1.0, LONGEST) as i64;
        Stepped { half, cell_ns, cell: DQuat::IDENTITY, from: 0, until: 0 }
    }

    /// The attitude `since` the start of the segment, which began at `start`; for any order of times, cheap in theirs.
    pub(super) fn at(&mut self, motion: &dyn Motion, start: Attitude, since: SimTime) -> Attitude {
        let ns = since.0;
        if ns >= self.until || ns < self.from {
            self.from = ns.div_euclid(self.cell_ns) * self.cell_ns;
            self.until = self.from.saturating_add(self.cell_ns);
            self.cell = motion.at(start, SimTime(self.from).exact_seconds()).attitude.q;
        }
        if ns == self.from || self.half == DVec3::ZERO {
            return Attitude::from_quat(self.cell);
        }
        Attitude::from_quat(self.cell * small(self.half * (ns - self.from) as f64))
    }
}

/// `exp` of a small half rotation vector: the series of sin(x)/x and cos(x) in x², to x¹⁰ and x¹².
fn small(half: DVec3) -> DQuat {
    const SINC: [f64; 5] = [-1.0 / 6.0, 1.0 / 120.0, -1.0 / 5040.0, 1.0 / 362_880.0, -1.0 / 39_916_800.0];
    const COS: [f64; 6] =
        [-0.5, 1.0 / 24.0, -1.0 / 720.0, 1.0 / 40_320.0, -1.0 / 3_628_800.0, 1.0 / 479_001_600.0];
    let y = half.length_squared();
    let sinc = 1.0 + y * (SINC[0] + y * (SINC[1] + y * (SINC[2] + y * (SINC[3] + y * SINC[4]))));
    let cos = 1.0 + y * (COS[0] + y * (COS[1] + y * (COS[2] + y * (COS[3] + y * (COS[4] + y * COS[5])))));
    let b = half * sinc;
    DQuat::from_xyzw(b.x, b.y, b.z, cos)
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
                let q = stepped.at(&*motion, start, t);
                let exact = motion.at(start, t.exact_seconds()).attitude;
                assert!(angle_between(q.q, exact.q) < 1e-15, "{rate} at {t}");
                assert!((q.q.length() - 1.0).abs() < 1e-15);
                assert_eq!(q, Stepped::new(rate).at(&*motion, start, t), "{rate} at {t}");
            }
        }
    }
}
