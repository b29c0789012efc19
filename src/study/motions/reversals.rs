//! Full speed one way, then the other: the rate jumps, and its axis turns.

use super::{Path, reference};
use glam::{DQuat, DVec3};

/// `w = ±S·[cos Pt, sin Pt·cos Rt, sin Pt·sin Rt]`, the sign changing every half second. Its attitude has no
/// closed form; its integral has one.
#[derive(Clone, Copy, Debug)]
pub struct Reversals {
    /// S, rad/s.
    speed: f64,
    /// P and R, rad/s.
    turning: (f64, f64),
}

/// Seconds between two reversals.
const EVERY: f64 = 0.5;

impl Reversals {
    /// 300 deg/s about an axis that turns at 1 rad/s and 0.6 rad/s.
    pub fn about_a_turning_axis() -> Reversals {
        Reversals { speed: 300f64.to_radians(), turning: (1.0, 0.6) }
    }

    /// +1 from 0 s on, −1 from 0.5 s on, and so forth.
    fn sign(t: f64) -> f64 {
        if (t / EVERY).floor() % 2.0 == 0.0 { 1.0 } else { -1.0 }
    }

    /// The integral over bounds without a reversal between them. The axis is a sum of cosines and sines of P,
    /// P + R and P − R.
    fn between(&self, from: f64, to: f64) -> DVec3 {
        let (p, r) = self.turning;
        let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
        // ∫cos(ft) and ∫sin(ft).
        let wave = |f: f64| {
            let (sine, cosine) = libm::sincos(f * middle);
            let width = 2.0 * libm::sin(f * half) / f;
            (width * cosine, width * sine)
        };
        let ((x, _), (add_cos, add_sin), (sub_cos, sub_sin)) = (wave(p), wave(p + r), wave(p - r));
        DVec3::new(x, 0.5 * (add_sin + sub_sin), 0.5 * (sub_cos - add_cos))
            * (self.speed * Self::sign(middle))
    }

    /// The reversals within `(from, to)`, and the bounds themselves.
    fn edges(from: f64, to: f64) -> Vec<f64> {
        let (first, last) = ((from / EVERY).floor() as i64 + 1, (to / EVERY).ceil() as i64);
        let within = (first..last).map(|k| k as f64 * EVERY);
        [from].into_iter().chain(within).chain([to]).collect()
    }
}

impl Path for Reversals {
    fn attitude(&self, t: f64) -> DQuat {
        reference::attitude(|t| self.rate(t), &Self::edges(0.0, t)).0
    }

    fn rate(&self, t: f64) -> DVec3 {
        let (p, r) = self.turning;
        let ((sp, cp), (sr, cr)) = (libm::sincos(p * t), libm::sincos(r * t));
        DVec3::new(cp, sp * cr, sp * sr) * (self.speed * Self::sign(t))
    }

    fn increment(&self, from: f64, to: f64) -> DVec3 {
        Self::edges(from, to).windows(2).map(|edge| self.between(edge[0], edge[1])).sum()
    }
}
