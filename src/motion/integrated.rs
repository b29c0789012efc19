//! The attitude of a motion given only by its angular rate: solved once, then evaluated at any time.
//!
//! Sixth-order Magnus steps (S. Blanes, F. Casas, J. Oteo, J. Ros, *The Magnus expansion and some of its
//! applications*, Physics Reports 470, 2009, sec. 5.4), halved until two solutions agree within 10⁻¹⁰ degrees over
//! the whole segment. The finer one, about 64 times more accurate, is kept. Every step ends at a node, so an
//! attitude costs one step from the node before it, in any order of times. A node takes 40 bytes, a step two nodes;
//! there are at most four million steps.

use super::{Kinematics, Motion};
use crate::double::Double;
use crate::geometry::{Attitude, Vector, angle_between, exp};
use glam::{DQuat, DVec3};
use std::fmt::Debug;

/// An angular rate of the body that is an analytic function of time.
pub(super) trait BodyRate: Debug + Send + Sync {
    /// The rate at `t` seconds from the segment's start, rad/s in body axes.
    fn at(&self, t: f64) -> DVec3;

    /// A bound on how fast it turns or changes, rad/s.
    fn fastest(&self) -> f64;
}

/// Two solutions closer than this (rad, just below 10⁻¹⁰ degrees) count as exact.
const ENOUGH: f64 = 1.7e-12;

/// The most steps of two nodes each.
const MOST_STEPS: f64 = 4_194_304.0;

/// A motion whose attitude is the solution of `q′ = ½·q ⊗ w(t)`.
#[derive(Debug)]
pub(super) struct Integrated<R> {
    pub(super) rate: R,
    nodes: Vec<Node>,
}

/// The attitude at one time, relative to the segment's start.
#[derive(Clone, Copy, Debug)]
struct Node {
    t: f64,
    q: DQuat,
}

impl<R: BodyRate> Integrated<R> {
    /// Solves between the first and the last of `edges` (seconds from the segment's start); the rate is smooth
    /// between edges. `None` if it changes too fast for too long, so that more than the allowed steps would be
    /// needed.
    pub(super) fn new(rate: R, edges: &[f64]) -> Option<Self> {
        let mut step = 0.5 / rate.fastest().max(1e-3);
        loop {
            let length: f64 = edges.windows(2).map(|edge| edge[1] - edge[0]).sum();
            if length / step + edges.len() as f64 > MOST_STEPS {
                return None;
            }
            if let Some(nodes) = solve(&rate, edges, step) {
                return Some(Integrated { rate, nodes });
            }
            step *= 0.5;
        }
    }

    fn before(&self, t: f64) -> Node {
        let after = self.nodes.partition_point(|node| node.t <= t);
        self.nodes[after.saturating_sub(1)]
    }
}

impl<R: BodyRate> Motion for Integrated<R> {
    fn at(&self, start: Attitude, t: Double) -> Kinematics {
        let node = self.before(t.to_f64());
        let since = (t - Double::from(node.t)).to_f64();
        let turn = node.q * exp(magnus_6(&self.rate, node.t, since));
        Kinematics {
            attitude: start.turned(turn.normalize()),
            rate: Vector::from_vec(self.rate.at(t.to_f64())),
            acceleration: Vector::ZERO,
        }
    }

    fn fastest(&self) -> f64 {
        self.rate.fastest()
    }
}

/// The nodes of steps of at most half of `step`, unless those of twice the length disagree.
fn solve(rate: &impl BodyRate, edges: &[f64], step: f64) -> Option<Vec<Node>> {
    let mut node = Node { t: edges.first().copied().unwrap_or(0.0), q: DQuat::IDENTITY };
    let mut coarse = node.q;
    let mut nodes = vec![node];
    for edge in edges.windows(2) {
        let steps = ((edge[1] - edge[0]) / step).ceil().max(1.0);
        let h = (edge[1] - edge[0]) / steps;
        for k in 0..steps as u64 {
            let from = edge[0] + k as f64 * h;
            coarse = (coarse * exp(magnus_6(rate, from, h))).normalize();
            for (t, next) in [(from, from + 0.5 * h), (from + 0.5 * h, edge[0] + (k + 1) as f64 * h)] {
                let q = (node.q * exp(magnus_6(rate, t, next - t))).normalize();
                node = Node { t: next, q };
                nodes.push(node);
            }
            // Written so that NaN fails too.
            let agree = angle_between(coarse, node.q) < ENOUGH;
            if !agree {
                return None;
            }
        }
    }
    Some(nodes)
}

/// The rotation vector of one step of h seconds: the Magnus series to sixth order from three Gauss points. Body
/// rates act from the right, so the commutator is −a×b.
fn magnus_6(rate: &impl BodyRate, t: f64, h: f64) -> DVec3 {
    /// √15.
    const ROOT: f64 = 3.872_983_346_207_417;
    let commutator = |a: DVec3, b: DVec3| b.cross(a);
    let at = |c: f64| rate.at(t + c * h) * h;
    let (left, middle, right) = (at(0.5 - ROOT / 10.0), at(0.5), at(0.5 + ROOT / 10.0));
    let (a, b, c) = (middle, (right - left) * (ROOT / 3.0), (right - middle * 2.0 + left) * (10.0 / 3.0));
    let ab = commutator(a, b);
    let twice = commutator(a, c * 2.0 + ab) * (-1.0 / 60.0);
    a + c / 12.0 + commutator(ab - a * 20.0 - c, b + twice) / 240.0
}

#[cfg(test)]
mod tests {
    use super::super::tests::rate_is_the_derivative_of_attitude;
    use super::*;
    use crate::time::{NANOS, SimTime};

    /// Sines of 30, 20 and 40 deg/s at 0.3, 0.5 and 0.2 Hz, phases 0, 1 and 2 rad.
    #[derive(Clone, Copy, Debug)]
    struct Sines;

    impl BodyRate for Sines {
        fn at(&self, t: f64) -> DVec3 {
            let sine = |degrees: f64, hertz: f64, phase: f64| {
                degrees.to_radians() * libm::sin(std::f64::consts::TAU * hertz * t + phase)
            };
            DVec3::new(sine(30.0, 0.3, 0.0), sine(20.0, 0.5, 1.0), sine(40.0, 0.2, 2.0))
        }
        fn fastest(&self) -> f64 {
            std::f64::consts::TAU * 0.5
        }
    }

    /// Half-angle, rad, and frequency, rad/s.
    #[derive(Clone, Copy, Debug)]
    struct Coning(f64, f64);

    impl BodyRate for Coning {
        fn at(&self, t: f64) -> DVec3 {
            let Coning(a, w) = *self;
            let s = libm::sin(0.5 * a);
            DVec3::new(-2.0 * s * s, -libm::sin(a) * libm::sin(w * t), libm::sin(a) * libm::cos(w * t)) * w
        }
        fn fastest(&self) -> f64 {
            self.1
        }
    }

    fn turned(motion: &dyn Motion, t: f64) -> DQuat {
        motion.at(Attitude::IDENTITY, Double::from(t)).attitude.q
    }

    #[test]
    fn coning_is_its_closed_form_at_any_time_in_any_order() {
        for (degrees, hertz) in [(10f64, 0.37), (1.0, 10.0)] {
            let (a, w) = (degrees.to_radians(), std::f64::consts::TAU * hertz);
            let motion = Integrated::new(Coning(a, w), &[0.0, 60.0]).expect("it is smooth");
            let cone = |t: f64| {
                let (s, c) = (libm::sin(0.5 * a), libm::cos(0.5 * a));
                DQuat::from_xyzw(0.0, s * libm::cos(w * t), s * libm::sin(w * t), c)
            };
            for i in (0..500).rev() {
                let t = 0.12 * i as f64 + 0.0123;
                let error = angle_between(cone(0.0).conjugate() * cone(t), turned(&motion, t)).to_degrees();
                assert!(error < 1e-10, "{error} deg at {t} s of {degrees} deg at {hertz} Hz");
            }
        }
    }

    #[test]
    fn halving_the_step_once_more_moves_nothing_by_a_billionth_of_a_degree() {
        let motion = Integrated::new(Sines, &[0.0, 60.0]).expect("it is smooth");
        let step = motion.nodes[1].t;
        let finer = Integrated { rate: Sines, nodes: solve(&Sines, &[0.0, 60.0], step).expect("finer") };
        for i in 0..600 {
            let t = 0.1 * i as f64 + 0.037;
            let error = angle_between(turned(&motion, t), turned(&finer, t)).to_degrees();
            assert!(error < 1e-10, "{error} deg at {t} s");
        }
    }

    #[test]
    fn its_rate_is_the_derivative_of_its_attitude() {
        let motion = Integrated::new(Sines, &[0.0, 5.0]).expect("it is smooth");
        rate_is_the_derivative_of_attitude(&motion, Attitude::IDENTITY, SimTime(5 * NANOS));
    }

    #[test]
    fn what_would_need_too_many_nodes_or_is_no_number_is_refused() {
        #[derive(Debug)]
        struct Broken;
        impl BodyRate for Broken {
            fn at(&self, _: f64) -> DVec3 {
                DVec3::NAN
            }
            fn fastest(&self) -> f64 {
                1.0
            }
        }
        assert!(Integrated::new(Coning(1.0, 1e9), &[0.0, 60.0]).is_none());
        assert!(Integrated::new(Broken, &[0.0, 1.0]).is_none());
    }
}
