//! How much later than the truth an estimate is, to a microsecond and with its standard error, from the motion itself.
//!
//! Against the truth `d` earlier, estimate `i` has the error `e_i(d) = q_i ⊗ q_truth(t_i − d)*` in nav axes. Whatever
//! constant turn of the nav axes it has, two errors a span apart are alike at the right delay: it is the `d` that
//! minimises the mean of `|log(e_j ⊗ e_i*)|²` over pairs of estimates. A long span averages the noise of an
//! estimate out, a short one leaves its wander out; of several the one with the least standard error is taken.
//!
//! Where the body's axes are turned as well, rates are compared instead: `r_i = log(q_i* ⊗ q_j)` of estimate and truth,
//! the one turned by the rotation that brings them together ([`Products::best_turn`]).
//!
//! Near the minimum a residual is `r_i ≈ g_i·d`, so the standard error is `√Σ_b (Σ_{i∈b} g_i·r_i)² / Σ|g_i|²` with the
//! pairs in blocks `b` of five seconds or more, within which residuals are not independent (H. White, *A
//! heteroskedasticity-consistent covariance matrix estimator*, Econometrica 48(4), 1980).

use super::sampled::Sampled;
use super::series::Series;
use super::turn::Products;
use crate::geometry::{log, rotate};
use glam::{DQuat, DVec3};
use std::ops::Range;

/// The truth at a time in ns, where it is known.
pub(super) type At<'a> = &'a dyn Fn(i64) -> Option<DQuat>;

/// Between the two estimates of a pair, ns.
const SPANS: [i64; 4] = [100_000_000, 300_000_000, 1_000_000_000, 3_000_000_000];
/// Compared as rates, a span turns by no more than this, rad.
const LEAST_TURN: f64 = 1.0;
/// Where a search ends, ns.
const FINE: i64 = 1000;
/// The step over which the motion's change is taken, ns.
const SLOPE: i64 = 2_000_000;
/// Residuals beyond so many times what nine of ten keep to count as if they were there: a heading that jumps, a reset.
const BEYOND: f64 = 3.0;
/// A motion whose rate changes by less than this says nothing of time, rad/s².
const LEAST_CHANGE: f64 = 0.003;
/// Within so many ns residuals are not independent: an estimate wanders over seconds.
const BLOCK: i64 = 5_000_000_000;
/// Of so many blocks the standard error is taken twice.
const FEW_BLOCKS: f64 = 3.0;
/// A delay whose standard error is above this is not told, ns.
const WORST: f64 = 20e6;
/// Of what the estimate turns, the share that the truth has to explain.
const LEAST_SHARE: f64 = 0.3;

/// The delay that was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Fit {
    /// ns; positive where the estimate is late.
    pub delay: i64,
    /// Its standard error, ns.
    pub error: f64,
    /// How far away the furthest delay is that is about as likely, ns: vibration has one a period away.
    pub rival: f64,
    /// Why it should not be believed.
    pub doubt: Option<&'static str>,
}

impl Fit {
    /// Three standard errors, or as far as the furthest rival, ns.
    pub fn spread(&self) -> f64 {
        (3.0 * self.error).max(self.rival)
    }

    /// None, known without looking.
    pub const EXACT: Fit = Fit { delay: 0, error: 0.0, rival: 0.0, doubt: None };
}

/// Why no delay follows from a motion.
pub(super) const TOO_EVEN: &str = "the motion is too even to separate a delay from a constant error";
const TOO_LOOSE: &str = "the estimate follows the motion too loosely to find a delay";
const ALIKE: &str = "several delays fit equally well, such as those one vibration period apart";
const AT_THE_END: &str = "the best fit lies at the end of the search range";

/// Pairs of estimates, compared with the truth.
pub(super) struct Pairs {
    /// ns.
    span: i64,
    pairs: Vec<[(i64, DQuat); 2]>,
    /// Whether the body's axes may be turned.
    free: bool,
}

impl Pairs {
    /// About `count` pairs about `span` ns apart.
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
            // Rows further apart than the span have it for themselves; a gap has nothing.
            let apart = times[other] - times[i];
            if apart > 0 && (apart <= 2 * span || other == i + 1) {
                pairs.push([row(i), row(other)]);
            }
        }
        Pairs { span, pairs, free }
    }

    /// Both truths of each pair, had the estimates come `delay` late.
    fn truths(&self, truth: At<'_>, delay: i64) -> Vec<Option<[DQuat; 2]>> {
        let at = |t: i64| truth(t.saturating_sub(delay));
        self.pairs.iter().map(|[(a, _), (b, _)]| Some([at(*a)?, at(*b)?])).collect()
    }

    /// What each pair differs by, rad/s, where there is a truth.
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

    /// The mean square of the residuals, those beyond `cap` as if they were there; `None` where fewer than half of
    /// `most` pairs have a truth.
    fn cost(&self, truth: At<'_>, delay: i64, cap: f64, most: usize) -> Option<f64> {
        let residuals = self.residuals(truth, delay);
        let (mut sum, mut count) = (0.0, 0);
        for r in residuals.into_iter().flatten() {
            sum += r.length_squared().min(cap * cap);
            count += 1;
        }
        (count >= 2 && 2 * count >= most).then(|| sum / count as f64)
    }

    /// How many pairs have a truth.
    fn count(&self, truth: At<'_>, delay: i64) -> usize {
        self.truths(truth, delay).iter().flatten().count()
    }

    /// Where residuals end to count in a window, by those at its ends: within it, what only tells that the delay is
    /// another counts in full.
    fn cap(&self, truth: At<'_>, window: &Range<i64>) -> f64 {
        let ends = [window.start, window.end].map(|delay| self.most(truth, delay));
        ends[0].max(ends[1])
    }

    /// The size of a residual beyond which it is a jump, rad/s: so many times what nine of ten keep to.
    fn most(&self, truth: At<'_>, delay: i64) -> f64 {
        let mut sizes: Vec<f64> = self.residuals(truth, delay).iter().flatten().map(|r| r.length()).collect();
        let ninth = sizes.len() * 9 / 10;
        if sizes.is_empty() {
            return f64::INFINITY;
        }
        BEYOND * *sizes.select_nth_unstable_by(ninth, f64::total_cmp).1 + 1e-6
    }

    /// The least cost within a window, to a microsecond, by golden sections.
    fn refine(&self, truth: At<'_>, window: Range<i64>) -> i64 {
        let cap = self.cap(truth, &window);
        let most = self.count(truth, i64::midpoint(window.start, window.end));
        golden(window, |delay| self.cost(truth, delay, cap, most).unwrap_or(f64::INFINITY))
    }

    /// The standard error of a delay, ns, and why it should not be believed.
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

/// The sums that the standard error comes from.
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

    /// A pair from `t` on: what it differs by, how that changes with the delay, and what the estimate turned.
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
        // A motion that is all in a few blocks tells little of how residuals scatter.
        let blocks = self.slopes * self.slopes / (self.weights + self.weight * self.weight);
        let error = error * (1.0 + FEW_BLOCKS / blocks);
        let loose = error > WORST || self.residuals > (1.0 - LEAST_SHARE) * self.turned;
        (error, loose.then_some(TOO_LOOSE))
    }
}

/// The least of a function with one dip in a window, to a microsecond.
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

/// The delay within a window (ns): with the span that makes it most certain.
///
/// Every `step` ns is looked at first: where other dips are nearly as deep, as vibration has them a period apart, the
/// delay is no more certain than they are near.
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
        // The grid's chords are right to microseconds; the truth itself is exact.
        fit.delay = pairs.refine(exact, fit.delay - step / 16..fit.delay + step / 16);
        fit.doubt = (fit.rival > WORST).then_some(ALIKE);
    }
    fit
}

/// As many pairs tell which span is best, and as many the delay.
const FEW: usize = 400;
const MANY: usize = 1500;
/// Another dip counts if it is less than so many times as deep.
const RIVAL: f64 = 2.0;
/// As many dips are looked into.
const DIPS: usize = 16;
/// A residual that is nothing, rad/s.
const NOTHING: f64 = 1e-4;

impl Pairs {
    /// The deepest dip within a window, and how far away the furthest that is nearly as deep is, ns. Dips are found every
    /// `step` ns and each looked into: between two looks a narrow one may hide its depth.
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

/// The mean square of what estimate and truth differ by over the shortest span, at the best delay near one, (rad/s)².
pub(super) fn apart(grid: &Sampled, series: &Series, window: &Range<i64>, step: i64, free: bool) -> f64 {
    let on_grid: At<'_> = &|t| grid.at(t);
    let pairs = Pairs::new(series, limited(grid, SPANS[0], free), free, FEW);
    let Some((best, _)) = pairs.deepest(on_grid, window, step) else { return f64::INFINITY };
    let delay = pairs.refine(on_grid, best - step..best + step);
    let cap = pairs.most(on_grid, delay);
    pairs.cost(on_grid, delay, cap, 0).unwrap_or(f64::INFINITY)
}

/// A span over which rates can be compared.
fn limited(grid: &Sampled, span: i64, free: bool) -> i64 {
    let least = (LEAST_TURN / grid.fastest().max(1e-3) * 1e9) as i64;
    if free { span.min(least) } else { span }
}

/// The delay within `window` (ns), looked for every `step` ns on the grid and then between: of dips that are as
/// deep, as a motion that repeats has them, the one nearest to none.
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
        // What wanders moves the dip of one span by more than a step.
        fit = near(grid, exact, series, &(delays[best] - 20 * step..delays[best] + 20 * step), step, false);
    }
    if best == 0 || best + 1 == delays.len() {
        fit.doubt = fit.doubt.or(Some(AT_THE_END));
    }
    Some(fit)
}

/// Of the dips that are as deep as the deepest, the one nearest to no delay.
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
