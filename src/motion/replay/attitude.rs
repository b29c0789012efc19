//! A smooth course through logged attitudes, exact at each.
//!
//! From row i to the next, T seconds later, `q = qᵢ ⊗ exp(ρ(u))`, u = t/T. The rotation vector ρ is the quintic
//! with `ρ(0) = 0`, `ρ(1) = r = log(qᵢ* ⊗ qᵢ₊₁)` and with first and second derivatives at both ends that give the
//! rows' angular rate and angular acceleration. With the right Jacobian `J(ρ)·v = v − (1 − cos θ)/θ²·ρ×v + (θ − sin
//! θ)/θ³·ρ×(ρ×v)`, θ = |ρ|, the angular rate is `w = J(ρ)·ρ′` and the angular acceleration its derivative (J. Solà,
//! J. Deray, D. Atchuthan, *A micro Lie theory for state estimation in robotics*, 2018, eqs. 143-144; N. Mayorov,
//! *Smooth attitude interpolation*, 2018, for the course by rotation vectors, there cubic and solved for all rows
//! together).
//!
//! A row's rate and acceleration are the derivatives, at 0, of the quartic through `log(qᵢ* ⊗ qⱼ)` of the five
//! nearest rows. For even rows the attitude between them is of fifth order in their interval, the rate of fourth.
//! Across a gap it turns about one axis at one rate, the shorter way, and uses no row beyond the gap, because
//! nothing is known of what happened there.

use super::grid::Grid;
use crate::double::Double;
use crate::geometry::{Attitude, Vector, exp, log};
use crate::motion::{Kinematics, Motion};
use crate::time::{NANOS, SimTime};
use glam::{DQuat, DVec3};
use std::f64::consts::TAU;

#[derive(Debug)]
pub(super) struct AttitudeLog {
    grid: Grid,
    knots: Vec<Knot>,
    fastest: f64,
    /// Whether it uses the logged attitude itself, not turned to the vehicle's attitude at the start.
    absolute: bool,
    warnings: Vec<String>,
}

#[derive(Clone, Copy, Debug)]
struct Knot {
    /// Body to nav.
    q: DQuat,
    /// Angular rate, rad/s in body axes.
    w: DVec3,
    /// Angular acceleration, rad/s² in body axes.
    a: DVec3,
}

impl AttitudeLog {
    /// A course through `quats`, one for each row, with continuous signs.
    pub(super) fn new(grid: Grid, quats: &[DQuat], absolute: bool, warnings: Vec<String>) -> AttitudeLog {
        let mut knots = Vec::with_capacity(quats.len());
        let take = |w: DVec3, a: DVec3| knots.push(Knot { q: quats[knots.len()], w, a });
        grid.derivatives(|i, j| turn(quats, i, j), take);
        let mean = |i: usize| log(quats[i].conjugate() * quats[i + 1]).length() / grid.interval(i);
        let means = (0..grid.len() - 1).map(mean);
        // Between rows it is at most about twice as fast as at their ends and as their mean.
        let fastest = 2.0 * means.chain(knots.iter().map(|knot| knot.w.length())).fold(0.0, f64::max);
        AttitudeLog { grid, knots, fastest, absolute, warnings }
    }

    /// The rotation vector from row `i` and its derivative, at the fraction `u` of the interval of `span` seconds.
    fn course(&self, i: usize, span: f64, u: f64) -> (DVec3, DVec3) {
        let (from, to) = (self.knots[i], self.knots[i + 1]);
        let r = log(from.q.conjugate() * to.q);
        if self.grid.is_gap(i) {
            return (r * u, r / span);
        }
        let (v0, a0) = (from.w * span, from.a * span * span);
        let end = Jacobian::at(r);
        let v1 = end.undo(to.w * span);
        let a1 = end.undo(to.a * span * span - end.change(v1));
        let (d, e, f) = (r - v0 - 0.5 * a0, v1 - v0 - a0, a1 - a0);
        let (c3, c4, c5) =
            (10.0 * d - 4.0 * e + 0.5 * f, 7.0 * e - 15.0 * d - f, 6.0 * d - 3.0 * e + 0.5 * f);
        let rho = u * (v0 + u * (0.5 * a0 + u * (c3 + u * (c4 + u * c5))));
        let slope = v0 + u * (a0 + u * (3.0 * c3 + u * (4.0 * c4 + u * 5.0 * c5)));
        (rho, slope / span)
    }
}

/// The rotation vector from row `i` to row `j`; of the equivalent ones, that which continues from the row between.
fn turn(quats: &[DQuat], i: usize, j: usize) -> DVec3 {
    let direct = log(quats[i].conjugate() * quats[j]);
    // Signs are continuous: below 120° the vector is unambiguous.
    if i.abs_diff(j) < 2 || quats[i].dot(quats[j]) > 0.5 {
        return direct;
    }
    let step = if j > i { j - 1 } else { j + 1 };
    let expected = turn(quats, i, step) + log(quats[step].conjugate() * quats[j]);
    let axis = if direct.length() > 1e-3 { direct.normalize() } else { expected.normalize_or_zero() };
    direct + axis * (TAU * libm::round((expected - direct).dot(axis) / TAU))
}

/// The right Jacobian of SO(3) at a rotation vector.
struct Jacobian {
    rho: DVec3,
    /// (1 − cos θ)/θ².
    a: f64,
    /// (θ − sin θ)/θ³.
    b: f64,
    /// (1 − θ/2·cot θ/2)/θ².
    c: f64,
    /// The derivatives of a and b with θ, over θ.
    da: f64,
    db: f64,
}

impl Jacobian {
    fn at(rho: DVec3) -> Jacobian {
        let squared = rho.length_squared();
        let s = squared;
        if squared < 0.0025 {
            // The series; the omitted terms are below 10⁻¹³.
            return Jacobian {
                rho,
                a: 0.5 - s / 24.0 * (1.0 - s / 30.0 * (1.0 - s / 56.0)),
                b: 1.0 / 6.0 - s / 120.0 * (1.0 - s / 42.0 * (1.0 - s / 72.0)),
                c: 1.0 / 12.0 + s / 720.0 * (1.0 + s / 42.0 * (1.0 + s / 40.0)),
                da: -1.0 / 12.0 + s / 180.0 * (1.0 - s * 3.0 / 112.0),
                db: -1.0 / 60.0 + s / 1260.0 * (1.0 - s / 48.0),
            };
        }
        let angle = squared.sqrt();
        let (sine, cosine) = libm::sincos(0.5 * angle);
        let (a, b) = (2.0 * sine * sine / s, (angle - 2.0 * sine * cosine) / (s * angle));
        let c = (1.0 - 0.5 * angle * cosine / sine) / s;
        Jacobian { rho, a, b, c, da: (2.0 * sine * cosine / angle - 2.0 * a) / s, db: (a - 3.0 * b) / s }
    }

    /// Converts a rotation vector's derivative to the angular rate.
    fn apply(&self, v: DVec3) -> DVec3 {
        let once = self.rho.cross(v);
        v - self.a * once + self.b * self.rho.cross(once)
    }

    /// Converts the angular rate to the rotation vector's derivative.
    fn undo(&self, w: DVec3) -> DVec3 {
        let once = self.rho.cross(w);
        w + 0.5 * once + self.c * self.rho.cross(once)
    }

    /// The part of the angular acceleration besides `J·ρ″`, where ρ′ is `v`.
    fn change(&self, v: DVec3) -> DVec3 {
        let once = self.rho.cross(v);
        let along = self.rho.dot(v);
        self.b * v.cross(once) - along * self.da * once + along * self.db * self.rho.cross(once)
    }
}

impl Motion for AttitudeLog {
    fn at(&self, _: Attitude, t: Double) -> Kinematics {
        let still = |attitude| Kinematics { attitude, rate: Vector::ZERO, acceleration: Vector::ZERO };
        let ns = SimTime((t.to_f64() * NANOS as f64) as i64);
        let i = self.grid.before(ns);
        let span = self.grid.interval(i);
        let u = (t - self.grid.at(i).exact_seconds()).to_f64() / span;
        if u >= 1.0 && i + 2 == self.grid.len() {
            return still(Attitude::from_quat(self.knots[i + 1].q));
        }
        let (rho, slope) = self.course(i, span, u);
        Kinematics {
            attitude: Attitude::from_quat(self.knots[i].q * exp(rho)),
            rate: Vector::from_vec(Jacobian::at(rho).apply(slope)),
            acceleration: Vector::ZERO,
        }
    }

    fn fastest(&self) -> f64 {
        self.fastest
    }

    fn next_seam(&self, t: SimTime) -> Option<SimTime> {
        self.grid.next(t)
    }

    fn length(&self) -> Option<SimTime> {
        Some(self.grid.end())
    }

    fn begins(&self) -> Option<Attitude> {
        self.absolute.then(|| Attitude::from_quat(self.knots[0].q))
    }

    fn warnings(&self) -> &[String] {
        &self.warnings
    }
}
