//! How much later than the truth an estimate is, to a microsecond and with its standard error, from the motion
//! itself.
//!
//! Against the truth `d` earlier, estimate `i` has the error `e_i(d) = q_i ⊗ q_truth(t_i − d)*` in nav axes. At the
//! right delay two errors a span apart are equal, whatever constant turn of the nav axes they contain. The delay is
//! therefore the `d` that minimises the mean of `|log(e_j ⊗ e_i*)|²` over pairs of estimates. A long span averages
//! the noise of an estimate out, a short one excludes its drift; of several spans the one with the smallest
//! standard error is used.
//!
//! If the body's axes are rotated as well, rates are compared instead: `r_i = log(q_i* ⊗ q_j)` of estimate and
//! truth, one of them rotated to match the other ([`Products::best_turn`]).
//!
//! Near the minimum a residual is `r_i ≈ g_i·d`, so the standard error is `√Σ_b (Σ_{i∈b} g_i·r_i)² / Σ|g_i|²` with
//! the pairs in blocks `b` of five seconds or more, within which residuals are not independent (H. White, *A
//! heteroskedasticity-consistent covariance matrix estimator*, Econometrica 48(4), 1980).

use super::sampled::Sampled;
use super::series::Series;
use super::turn::Products;
use crate::geometry::{log, rotate};
use glam::{DQuat, DVec3};
use std::ops::Range;

/// The truth at a time in ns, if known.
pub(super) type At<'a> = &'a dyn Fn(i64) -> Option<DQuat>;

/// The spans between the two estimates of a pair, ns.
const SPANS: [i64; 4] = [100_000_000, 300_000_000, 1_000_000_000, 3_000_000_000];
/// In a comparison of rates, the most that the body may turn in a span, rad.
const LEAST_TURN: f64 = 1.0;
/// The precision at which a search ends, ns.
const FINE: i64 = 1000;
/// The step for the motion's rate of change, ns.
const SLOPE: i64 = 2_000_000;
/// Residuals are clipped at this many times the value that nine of ten stay below: a heading that jumps, a reset.
const BEYOND: f64 = 3.0;
/// A motion whose rate changes by less than this contains no information about time, rad/s².
const LEAST_CHANGE: f64 = 0.003;
/// Residuals within this many ns are not independent: an estimate drifts over seconds.
const BLOCK: i64 = 5_000_000_000;
/// With this many blocks the standard error is doubled; with more it is enlarged less.
const FEW_BLOCKS: f64 = 3.0;
/// A delay with a standard error above this is not reported, ns.
const WORST: f64 = 20e6;
/// The share of the estimate's turning that the truth must explain.
const LEAST_SHARE: f64 = 0.3;

/// A delay found by the search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Fit {
    /// ns; positive where the estimate is late.
    pub delay: i64,
    /// Its standard error, ns.
    pub error: f64,
    /// The distance of the furthest delay that is about as likely, ns: with vibration there is one a period away.
    pub rival: f64,
    /// A reason not to trust it.
    pub doubt: Option<&'static str>,
}

impl Fit {
    /// Three standard errors, or as far as the furthest rival, ns.
    pub fn spread(&self) -> f64 {
        (3.0 * self.error).max(self.rival)
    }

    /// No delay, known without a search.
    pub const EXACT: Fit = Fit { delay: 0, error: 0.0, rival: 0.0, doubt: None };
}

/// Why a motion determines no delay.
pub(super) const TOO_EVEN: &str = "the motion is too even to separate a delay from a constant error";
const TOO_LOOSE: &str = "the estimate follows the motion too loosely to find a delay";
const ALIKE: &str = "several delays fit equally well, such as those one vibration period apart";
const AT_THE_END: &str = "the best fit lies at the end of the search range";

/// Pairs of estimates, compared with the truth.
pub(super) struct Pairs {
    /// ns.
    span: i64,
    pairs: Vec<[(i64, DQuat); 2]>,
    /// Whether the body's axes may be rotated.
    free: bool,
}

impl Pairs {
    /// About `count` pairs, about `span` ns apart.
    fn new(series: &Series, span: i64, free: bool, count: usize) -> Pairs {
        let times = series.times();
        let row = |i: usize| (times[i], series.attitude(i).q);
        let every = times.len().div_ceil(count).max(1);
        let mut other = 0;
        let mut pairs = Vec::with_capacity(times.len() / every);
        for i in (0..times.len()).step_by(every) {
            other = other.max(i + 1);
            while other < times.len() && times[other] - times[i] < span {
                other += 1;
            }
            if other == times.len() {
                break;
            }
            // Rows further apart than the span are paired directly; a gap has no pair.
            let apart = times[other] - times[i];
            if apart > 0 && (apart <= 2 * span || other == i + 1) {
                pairs.push([row(i), row(other)]);
            }
        }
        Pairs { span, pairs, free }
    }

    /// Both truths of each pair for an estimate that is `delay` late.
    fn truths(&self, truth: At<'_>, delay: i64) -> Vec<Option<[DQuat; 2]>> {
        let at = |t: i64| truth(t.saturating_sub(delay));
        self.pairs.iter().map(|[(a, _), (b, _)]| Some([at(*a)?, at(*b)?])).collect()
    }

    /// The difference of each pair, rad/s, where the truth is known.
    fn residuals(&self, truth: At<'_>, delay: i64) -> Vec<Option<DVec3>> {
        let truths = self.truths(truth, delay);
        let seconds = |[(a, _), (b, _)]: &[(i64, DQuat); 2]| (b - a) as f64 * 1e-9;
        if !self.free {
            let apart = |(pair, truths): (&[(i64, DQuat); 2], &Option<[DQuat; 2]>)| {
                let [a, b] = (*truths)?;
                let (first, second) = (pair[0].1 * a.conjugate(), pair[1].1 * b.conjugate());
                Some(log(second * first.conjugate()) / seconds(pair))
            };
            return self.pairs.iter().zip(&truths).map(apart).collect();
        }
        let rates: Vec<Option<[DVec3; 2]>> = self
            .pairs
            .iter()
            .zip(&truths)
            .map(|(pair, truths)| {
                let [a, b] = (*truths)?;
                let span = seconds(pair);
                Some([log(a.conjugate() * b) / span, log(pair[0].1.conjugate() * pair[1].1) / span])
            })
            .collect();
        let mut products = Products::default();
        rates.iter().flatten().for_each(|[truth, estimate]| products.add(*truth, *estimate));
        let (turn, _) = products.best_turn();
        rates.iter().map(|rates| rates.map(|[truth, estimate]| rotate(turn, estimate) - truth)).collect()
    }

    /// The mean square of the residuals, clipped at `cap`; `None` if fewer than half of `most` pairs have a truth.
    fn cost(&self, truth: At<'_>, delay: i64, cap: f64, most: usize) -> Option<f64> {
        let residuals = self.residuals(truth, delay);
        let (mut sum, mut count) = (0.0, 0);
        for r in residuals.into_iter().flatten() {
            sum += r.length_squared().min(cap * cap);
            count += 1;
        }
        (count >= 2 && 2 * count >= most).then(|| sum / count as f64)
    }

    /// The number of pairs with a truth.
    fn count(&self, truth: At<'_>, delay: i64) -> usize {
        self.truths(truth, delay).iter().flatten().count()
    }

    /// The clipping limit for a window, from the residuals at its ends: within the window, a residual that only
    /// shows a different delay counts in full.
    fn cap(&self, truth: At<'_>, window: &Range<i64>) -> f64 {
        let ends = [window.start, window.end].map(|delay| self.most(truth, delay));
        ends[0].max(ends[1])
    }

    /// The size of a residual beyond which it is a jump, rad/s: a multiple of the value that nine of ten stay
    /// below.
    fn most(&self, truth: At<'_>, delay: i64) -> f64 {
        let mut sizes: Vec<f64> = self.residuals(truth, delay).iter().flatten().map(|r| r.length()).collect();
        let ninth = sizes.len() * 9 / 10;
        if sizes.is_empty() {
            return f64::INFINITY;
        }
        BEYOND * *sizes.select_nth_unstable_by(ninth, f64::total_cmp).1 + 1e-6
    }

    /// The minimum of the cost within a window, to a microsecond, by golden sections.
    fn refine(&self, truth: At<'_>, window: Range<i64>) -> i64 {
        let cap = self.cap(truth, &window);
        let most = self.count(truth, i64::midpoint(window.start, window.end));
        golden(window, |delay| self.cost(truth, delay, cap, most).unwrap_or(f64::INFINITY))
    }

    /// The standard error of a delay, ns, and a reason not to trust it.
    fn told(&self, truth: At<'_>, delay: i64) -> (f64, Option<&'static str>) {
        let cap = self.most(truth, delay);
        let [here, before, after] =
            [0, -SLOPE, SLOPE].map(|step| self.residuals(truth, delay.saturating_add(step)));
        let mut sums = Slopes::new((2 * self.span).max(BLOCK));
        for (i, pair) in self.pairs.iter().enumerate() {
            let (Some(r), Some(a), Some(b)) = (here[i], before[i], after[i]) else { continue };
            if r.length() <= cap {
                let span = (pair[1].0 - pair[0].0) as f64 * 1e-9;
                let turned = log(pair[0].1.conjugate() * pair[1].1) / span;
                sums.add(pair[0].0, r, (b - a) / (2.0 * SLOPE as f64 * 1e-9), turned);
            }
        }
        sums.told()
    }
}

/// The sums for the standard error.
struct Slopes {
    block: i64,
    number: i64,
    current: f64,
    weight: f64,
    blocks: f64,
    weights: f64,
    slopes: f64,
    residuals: f64,
    turned: f64,
    count: f64,
}

impl Slopes {
    fn new(block: i64) -> Slopes {
        let [current, weight, blocks, weights, slopes, residuals, turned, count] = [0.0; 8];
        Slopes { block, number: i64::MIN, current, weight, blocks, weights, slopes, residuals, turned, count }
    }

    /// Adds a pair that starts at `t`: its difference, the change of that with the delay, and the turn of the
    /// estimate.
    fn add(&mut self, t: i64, r: DVec3, slope: DVec3, turned: DVec3) {
        let number = t.div_euclid(self.block);
        if number != self.number {
            self.blocks += self.current * self.current;
            self.weights += self.weight * self.weight;
            (self.current, self.weight, self.number) = (0.0, 0.0, number);
        }
        self.current += slope.dot(r);
        self.weight += slope.length_squared();
        self.slopes += slope.length_squared();
        self.residuals += r.length_squared();
        self.turned += turned.length_squared();
        self.count += 1.0;
    }

    fn told(&self) -> (f64, Option<&'static str>) {
        if self.count < 2.0 || libm::sqrt(self.slopes / self.count) < LEAST_CHANGE {
            return (f64::INFINITY, Some(TOO_EVEN));
        }
        let error = libm::sqrt(self.blocks + self.current * self.current) / self.slopes * 1e9;
        // A motion within a few blocks shows little of how residuals scatter.
        let blocks = self.slopes * self.slopes / (self.weights + self.weight * self.weight);
        let error = error * (1.0 + FEW_BLOCKS / blocks);
        let loose = error > WORST || self.residuals > (1.0 - LEAST_SHARE) * self.turned;
        (error, loose.then_some(TOO_LOOSE))
    }
}

/// The minimum of a function with one dip in a window, to a microsecond.
fn golden(window: Range<i64>, cost: impl Fn(i64) -> f64) -> i64 {
    const GOLDEN: f64 = 0.618_033_988_749_895;
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

/// The delay within a window (ns), for the span that makes it most certain.
///
/// A first search goes in steps of `step` ns. If other dips are nearly as deep, as with vibration a period apart,
/// the uncertainty extends to them.
pub(super) fn near(
    grid: &Sampled,
    exact: At<'_>,
    series: &Series,
    window: &Range<i64>,
    step: i64,
    free: bool,
) -> Fit {
    let on_grid: At<'_> = &|t| grid.at(t);
    let found = |pairs: &Pairs, window: Range<i64>| {
        let delay = pairs.refine(on_grid, window);
        let (error, doubt) = pairs.told(on_grid, delay);
        Fit { delay, error, rival: 0.0, doubt }
    };
    let spans = if free { &SPANS[..1] } else { &SPANS[..] };
    let tried = spans.iter().filter_map(|&span| {
        let span = limited(grid, span, free);
        let pairs = Pairs::new(series, span, free, FEW);
        let (best, rival) = pairs.deepest(on_grid, window, step)?;
        let fit = found(&pairs, best - step..best + step);
        Some((span, Fit { rival, ..fit }))
    });
    let doubtful = |fit: &Fit| (fit.doubt.is_some(), fit.spread());
    let best = tried.min_by(|(_, a), (_, b)| {
        let ((a, x), (b, y)) = (doubtful(a), doubtful(b));
        a.cmp(&b).then(x.total_cmp(&y))
    });
    let Some((span, fit)) = best else {
        return Fit {
            delay: i64::midpoint(window.start, window.end),
            error: f64::INFINITY,
            rival: 0.0,
            doubt: Some(TOO_EVEN),
        };
    };
    let pairs = Pairs::new(series, span, free, MANY);
    let mut fit = Fit { rival: fit.rival, ..found(&pairs, fit.delay - step..fit.delay + step) };
    if fit.doubt.is_none() {
        // The grid's chords are accurate to microseconds; the truth itself is exact.
        fit.delay = pairs.refine(exact, fit.delay - step / 16..fit.delay + step / 16);
        fit.doubt = (fit.rival > WORST).then_some(ALIKE);
    }
    fit
}

/// The number of pairs that determine the best span, and the number that determine the delay.
const FEW: usize = 400;
const MANY: usize = 1500;
/// Another dip counts if its cost is less than this many times that of the deepest.
const RIVAL: f64 = 2.0;
/// The number of dips examined.
const DIPS: usize = 16;
/// A negligible residual, rad/s.
const NOTHING: f64 = 1e-4;

impl Pairs {
    /// The deepest dip within a window, and the distance of the furthest one that is nearly as deep, ns. The search
    /// finds dips in steps of `step` ns and examines each: between two steps a narrow dip may hide its depth.
    fn deepest(&self, truth: At<'_>, window: &Range<i64>, step: i64) -> Option<(i64, f64)> {
        let delays: Vec<i64> =
            (0..=(window.end - window.start) / step).map(|i| window.start + i * step).collect();
        let most = delays.iter().step_by(8).map(|&delay| self.count(truth, delay)).max()?;
        let cap = self.cap(truth, window);
        let cost = |delay: i64| self.cost(truth, delay, cap, most).unwrap_or(f64::INFINITY);
        let costs: Vec<f64> = delays.iter().map(|&delay| cost(delay)).collect();
        let at = |i: usize| costs.get(i).copied().unwrap_or(f64::INFINITY);
        let is_dip =
            |i: &usize| at(*i).is_finite() && at(*i) <= at(*i + 1) && (*i == 0 || at(*i) <= at(*i - 1));
        let mut dips: Vec<usize> = (0..costs.len()).filter(is_dip).collect();
        dips.sort_by(|&a, &b| costs[a].total_cmp(&costs[b]));
        dips.truncate(DIPS);
        let look = |i: usize| {
            let delay = golden(delays[i] - step..delays[i] + step, cost);
            (delay, cost(delay).min(costs[i]))
        };
        let dips: Vec<(i64, f64)> = dips.into_iter().map(look).collect();
        let &(best, lowest) = dips.iter().min_by(|a, b| a.1.total_cmp(&b.1))?;
        let deep = RIVAL * (lowest + NOTHING * NOTHING);
        let away = dips.iter().filter(|(_, cost)| *cost < deep).map(|(delay, _)| delay.abs_diff(best)).max();
        let away = away.filter(|away| *away > step.unsigned_abs());
        Some((best, away.unwrap_or(0) as f64))
    }
}

/// The mean square of the difference between estimate and truth over the shortest span, at the best delay in a
/// window, (rad/s)².
pub(super) fn apart(grid: &Sampled, series: &Series, window: &Range<i64>, step: i64, free: bool) -> f64 {
    let on_grid: At<'_> = &|t| grid.at(t);
    let pairs = Pairs::new(series, limited(grid, SPANS[0], free), free, FEW);
    let Some((best, _)) = pairs.deepest(on_grid, window, step) else { return f64::INFINITY };
    let delay = pairs.refine(on_grid, best - step..best + step);
    let cap = pairs.most(on_grid, delay);
    pairs.cost(on_grid, delay, cap, 0).unwrap_or(f64::INFINITY)
}

/// The longest span, up to `span`, over which rates can be compared.
fn limited(grid: &Sampled, span: i64, free: bool) -> i64 {
    let least = (LEAST_TURN / grid.fastest().max(1e-3) * 1e9) as i64;
    if free { span.min(least) } else { span }
}

/// The delay within `window` (ns), searched in steps of `step` ns on the grid and then between. Of equally deep
/// dips, as in a motion that repeats, it takes the one closest to zero.
pub(super) fn within(
    grid: &Sampled,
    exact: At<'_>,
    series: &Series,
    window: Range<i64>,
    step: i64,
) -> Option<Fit> {
    let on_grid: At<'_> = &|t| grid.at(t);
    let pairs = Pairs::new(series, SPANS[2], false, 800);
    let count = (window.end - window.start) / step;
    let delays: Vec<i64> = (0..=count).map(|i| window.start + i * step).collect();
    let most = delays.iter().step_by(16).map(|&delay| pairs.count(on_grid, delay)).max()?;
    let cost = |&delay: &i64| pairs.cost(on_grid, delay, f64::INFINITY, most).unwrap_or(f64::INFINITY);
    let costs: Vec<f64> = delays.iter().map(cost).collect();
    let best = least(&delays, &costs)?;
    let mut fit = near(grid, exact, series, &(delays[best] - step..delays[best] + step), step, false);
    if fit.spread() > step as f64 {
        // Drift moves the dip of a single span by more than a step.
        fit = near(grid, exact, series, &(delays[best] - 20 * step..delays[best] + 20 * step), step, false);
    }
    if best == 0 || best + 1 == delays.len() {
        fit.doubt = fit.doubt.or(Some(AT_THE_END));
    }
    Some(fit)
}

/// Of the dips as deep as the deepest, the one closest to zero delay.
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
