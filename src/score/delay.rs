//! How much later than the truth an estimate is, from the motion itself.
//!
//! Against the truth `d` earlier, estimate `i` has the error `e_i(d) = q_i ⊗ q_truth(t_i − d)*` in nav axes. The delay
//! is the `d` at which the errors scatter least *about their own mean*, so that a constant error (a heading that is
//! off, a declination) is not taken for a delay: with `v` the mean of the `e_i` as rotations (the eigenvector of the
//! largest eigenvalue of `Σ e_i e_iᵀ`; Markley et al., *Averaging Quaternions*, JGCD 30(4), 2007), it minimises
//! `mean |e_i − (v·e_i)·v|²`.
//!
//! At an even angular rate in nav axes a delay *is* a constant error, and nobody can tell which. Near the minimum
//! `e_i ≈ v + ω_i·d`, so its standard error is that of a slope: `σ / (sd(ω)·√N)`, with as many independent errors as
//! their correlation from one to the next leaves.

use super::sampled::Sampled;
use crate::geometry::log;
use glam::{DMat4, DQuat, DVec3, DVec4};
use std::ops::Range;

/// An angular rate that varies by less than this tells nothing: 0.2 deg/s.
const LEAST_RATE: f64 = 0.0035;
/// A delay whose standard error is above this is not told, s.
const WORST: f64 = 0.02;
/// Where the search ends, ns.
const FINE: i64 = 1000;

/// Estimates with their times, ns.
pub(super) struct Series {
    pub times: Vec<i64>,
    pub attitudes: Vec<DQuat>,
}

impl Series {
    /// Every k-th, so that about `count` are left.
    pub fn thinned(&self, count: usize) -> Series {
        let every = self.times.len().div_ceil(count).max(1);
        Series {
            times: self.times.iter().copied().step_by(every).collect(),
            attitudes: self.attitudes.iter().copied().step_by(every).collect(),
        }
    }

    /// The errors against the truth `delay` earlier, each with the time at which its estimate held.
    fn errors(&self, truth: At<'_>, delay: i64) -> Vec<(i64, DQuat)> {
        let held = self.times.iter().map(|t| t.saturating_sub(delay)).zip(&self.attitudes);
        held.filter_map(|(t, q)| Some((t, *q * truth(t)?.conjugate()))).collect()
    }
}

/// The truth at a time in ns, where it is known.
pub(super) type At<'a> = &'a dyn Fn(i64) -> Option<DQuat>;

/// The delay that was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Fit {
    /// ns; positive where the estimate is late.
    pub delay: i64,
    /// Why it should not be believed.
    pub doubt: Option<&'static str>,
}

/// The delay within `window` (ns), looked for every `step` ns on the grid and then between.
pub(super) fn find(grid: &Sampled, series: &Series, window: Range<i64>, step: i64) -> Option<Fit> {
    let on_grid = |t| grid.at(t);
    let thin = series.thinned(800);
    let count = (window.end - window.start) / step;
    let delays: Vec<i64> = (0..=count).map(|i| window.start + i * step).collect();
    let costs: Vec<f64> =
        delays.iter().map(|&delay| scatter(&thin, &on_grid, delay).unwrap_or(f64::INFINITY)).collect();
    let best = least(&delays, &costs)?;
    if best == 0 || best + 1 == delays.len() {
        let doubt = "the best agreement lies at the end of what was searched";
        return Some(Fit {
            delay: delays[best],
            doubt: Some(told(grid, &thin, delays[best]).unwrap_or(doubt)),
        });
    }
    let delay = refine(&thin, &on_grid, delays[best - 1]..delays[best + 1]);
    Some(Fit { delay, doubt: told(grid, &series.thinned(4000), delay) })
}

/// The delay within `window`, to a microsecond, by golden sections.
pub(super) fn refine(series: &Series, truth: At<'_>, window: Range<i64>) -> i64 {
    const GOLDEN: f64 = 0.618_033_988_749_895;
    let cost = |delay| scatter(series, truth, delay).unwrap_or(f64::INFINITY);
    let (mut low, mut high) = (window.start, window.end);
    let inner = |low: i64, high: i64, share: f64| low + libm::round((high - low) as f64 * share) as i64;
    let (mut a, mut b) = (inner(low, high, 1.0 - GOLDEN), inner(low, high, GOLDEN));
    let (mut cost_a, mut cost_b) = (cost(a), cost(b));
    while high - low > FINE {
        if cost_a <= cost_b {
            (high, b, cost_b) = (b, a, cost_a);
            a = inner(low, high, 1.0 - GOLDEN);
            cost_a = cost(a);
        } else {
            (low, a, cost_a) = (a, b, cost_b);
            b = inner(low, high, GOLDEN);
            cost_b = cost(b);
        }
    }
    i64::midpoint(low, high)
}

/// Of the dips that are as deep as the deepest, the one nearest to no delay: a motion that repeats has many.
fn least(delays: &[i64], costs: &[f64]) -> Option<usize> {
    let finite = || costs.iter().copied().filter(|cost| cost.is_finite());
    let (lowest, highest) = (finite().reduce(f64::min)?, finite().reduce(f64::max)?);
    let deep = lowest + 0.01 * (highest - lowest);
    let cost = |i: usize| costs.get(i).copied().unwrap_or(f64::INFINITY);
    let is_dip = |i: &usize| {
        let i = *i;
        costs[i] <= deep && costs[i] <= cost(i + 1) && (i == 0 || costs[i] <= cost(i - 1))
    };
    (0..costs.len()).filter(is_dip).min_by_key(|&i| delays[i].abs())
}

/// How much the errors scatter about their mean; `None` where fewer than half of the estimates have a truth.
fn scatter(series: &Series, truth: At<'_>, delay: i64) -> Option<f64> {
    let errors = series.errors(truth, delay);
    if errors.len() < 2 || 2 * errors.len() < series.times.len() {
        return None;
    }
    let mean = mean(&errors);
    let off = errors.iter().map(|(_, e)| (*e - mean * mean.dot(*e)).length_squared());
    Some(off.sum::<f64>() / errors.len() as f64)
}

/// The mean of rotations whose signs are free.
fn mean(errors: &[(i64, DQuat)]) -> DQuat {
    let mut sum = DMat4::ZERO;
    for (_, e) in errors {
        let e = DVec4::from(*e);
        sum += DMat4::from_cols(e * e.x, e * e.y, e * e.z, e * e.w);
    }
    // Squaring leaves the eigenvector of the largest eigenvalue; its column is as good as any that is not null.
    for _ in 0..8 {
        sum = sum * (1.0 / sum.to_cols_array().iter().fold(0.0_f64, |most, x| most.max(x.abs())));
        sum = sum * sum;
    }
    let columns = [sum.x_axis, sum.y_axis, sum.z_axis, sum.w_axis];
    let longest = columns.into_iter().max_by(|a, b| a.length_squared().total_cmp(&b.length_squared()));
    DQuat::from_vec4(longest.unwrap_or(DVec4::W)).normalize()
}

/// Why a delay should not be believed, if there is a reason.
fn told(grid: &Sampled, series: &Series, delay: i64) -> Option<&'static str> {
    let errors = series.errors(&|t| grid.at(t), delay);
    let rates: Vec<DVec3> = errors.iter().filter_map(|(t, _)| grid.rate(*t)).collect();
    let mean_rate = rates.iter().sum::<DVec3>() / rates.len().max(1) as f64;
    let variance = rates.iter().map(|rate| (*rate - mean_rate).length_squared()).sum::<f64>();
    let sd = libm::sqrt(variance / rates.len().max(1) as f64);
    if sd < LEAST_RATE {
        return Some("the motion is too even to tell a delay from a constant error");
    }
    let mean = mean(&errors);
    let off: Vec<DVec3> = errors.iter().map(|(_, e)| log(*e * mean.conjugate())).collect();
    let square = off.iter().map(|v| v.length_squared()).sum::<f64>();
    let next = off.windows(2).map(|pair| pair[0].dot(pair[1])).sum::<f64>();
    let alike = if square > 0.0 { (next / square).clamp(0.0, 0.999) } else { 0.0 };
    let independent = (off.len() as f64 * (1.0 - alike) / (1.0 + alike)).max(1.0);
    let sigma = libm::sqrt(square / 3.0 / off.len().max(1) as f64);
    (sigma / (sd * libm::sqrt(independent)) > WORST)
        .then_some("the estimate follows the motion too loosely to tell a delay")
}
