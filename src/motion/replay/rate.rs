//! Logged angular rates: a cubic between every two rows with continuous slope, and the attitude from its integral.
//!
//! `w(t) = h₀₀·wᵢ + h₁₀·T·wᵢ′ + h₀₁·wᵢ₊₁ + h₁₁·T·wᵢ₊₁′`, the cubic Hermite polynomial (C. de Boor, *A practical
//! guide to splines*, 1978, ch. IV). A row's slope is that of the quartic through the five nearest rows, so the
//! rate between even rows is of fourth order in their interval. Across a gap the rate is linear and uses no row
//! beyond the gap. The attitude is [`Integrated`] with the rows as edges.

use super::grid::Grid;
use crate::double::Double;
use crate::geometry::Attitude;
use crate::motion::integrated::{BodyRate, Integrated};
use crate::motion::{Kinematics, Motion};
use crate::time::{NANOS, SimTime};
use glam::DVec3;

#[derive(Debug)]
pub(super) struct RateLog {
    turned: Integrated<Rates>,
    warnings: Vec<String>,
}

#[derive(Debug)]
struct Rates {
    grid: Grid,
    /// rad/s and rad/s² in body axes.
    knots: Vec<(DVec3, DVec3)>,
    fastest: f64,
}

impl RateLog {
    /// A log of `rates` (rad/s in body axes), one for each row. `None` if it is beyond what [`Integrated`] solves.
    pub(super) fn new(grid: Grid, rates: &[DVec3], warnings: Vec<String>) -> Option<RateLog> {
        let mut knots = Vec::with_capacity(rates.len());
        grid.derivatives(|_, j| rates[j], |slope, _| knots.push((rates[knots.len()], slope)));
        let fastest = rates.iter().map(|rate| rate.length()).fold(0.0, f64::max);
        let edges: Vec<_> = (0..grid.len()).map(|i| grid.at(i).seconds()).collect();
        let turned = Integrated::new(Rates { grid, knots, fastest }, &edges)?;
        Some(RateLog { turned, warnings })
    }
}

impl BodyRate for Rates {
    fn at(&self, t: f64) -> DVec3 {
        if t >= self.grid.end().seconds() {
            return DVec3::ZERO;
        }
        let i = self.grid.before(SimTime((t * NANOS as f64) as i64));
        let span = self.grid.interval(i);
        let u = (t - self.grid.at(i).seconds()) / span;
        let ((from, left), (to, right)) = (self.knots[i], self.knots[i + 1]);
        let rise = to - from;
        if self.grid.is_gap(i) {
            return from + rise * u;
        }
        let (left, right) = (left * span - rise, right * span - rise);
        from + u * (rise + (1.0 - u) * ((1.0 - u) * left - u * right))
    }

    fn fastest(&self) -> f64 {
        self.fastest
    }
}

impl Motion for RateLog {
    fn at(&self, start: Attitude, t: Double) -> Kinematics {
        self.turned.at(start, t)
    }

    fn fastest(&self) -> f64 {
        self.turned.fastest()
    }

    fn next_seam(&self, t: SimTime) -> Option<SimTime> {
        self.turned.rate.grid.next(t)
    }

    fn length(&self) -> Option<SimTime> {
        Some(self.turned.rate.grid.end())
    }

    fn warnings(&self) -> &[String] {
        &self.warnings
    }
}
