//! Finds the offset between two unrelated clocks from the motion.
//!
//! The angular rates of truth and estimate are compared at every lag at which they overlap ([`Sums`]). The best lag
//! is that at which the truth tells most of the estimate, in nats: a long overlap that agrees well. It is believed if
//! it tells much, explains most of what both turned, and no other lag that tells a fair part of that agrees nearly
//! as well: a motion that repeats agrees with itself a period later.

use super::correlate::{Alike, Sums};
use super::rates::Rates;
use super::sampled::Sampled;
use super::series::Series;
use std::ops::Range;

/// A cell of the grid: at least this, ns.
const STEP: i64 = 20_000_000;
/// The most cells of the longer of the two.
const CELLS: i64 = 1 << 17;
/// Rates are means over so many cells, the second for an estimate with more noise.
const WIDTHS: [usize; 2] = [5, 25];
/// Rows further apart than this say nothing of what is between, ns; and than so many of the median interval.
const GAP: (i64, i64) = (250_000_000, 5);
/// The truth has to tell so much of the estimate, in nats at 50 cells a second.
const LEAST_INFORMATION: f64 = 300.0;
/// And has to explain this share of what both turned.
const LEAST_SHARE: f64 = 0.5;
/// Another lag counts if it tells this share of what the best does,
const RIVAL_INFORMATION: f64 = 0.25;
/// and is apart by less than so many times what the best is.
const RIVAL_APART: f64 = 2.0;
/// The body's axes may be turned if that brings the two nearer on the grid by so many times.
const TURNED_APART: f64 = 2.0;
/// The overlap is at least this share of the shorter of the two.
const LEAST_OVERLAP: f64 = 0.1;
/// A truth that never turns faster tells nothing of time, rad/s.
const LEAST_RATE: f64 = 0.01;
/// Nor does one that agrees as well over so many ns.
const WIDEST: i64 = 2_000_000_000;
/// Of rivals as many are kept.
const RIVALS: usize = 64;

/// Where two clocks agree best.
#[derive(Clone, Debug)]
pub(super) struct Match {
    /// How much the estimate's clock is ahead of the truth's, ns.
    pub offset: i64,
    /// Where it lies for all that the grid shows, ns.
    pub within: Range<i64>,
    /// Whether the body's axes had to be turned.
    pub free: bool,
    /// What the two have in common there.
    pub alike: Alike,
    /// Other offsets at which the motion agrees about as well, ns, the nearest to [`Match::offset`] first.
    pub rivals: Vec<i64>,
    /// Why it should not be believed.
    pub doubt: Option<Doubt>,
}

/// Why a match should not be believed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Doubt {
    /// One of the two never turns, or so evenly that any time is as good.
    TooEven,
    /// Nowhere does the one follow the other.
    Unlike,
    /// Several offsets agree about as well.
    Repeats,
}

/// The best matches over every offset.
#[derive(Clone, Debug)]
pub(super) struct Found {
    /// With the body's axes as they are.
    pub fixed: Match,
    /// With the body's axes turned, where that brings the two much nearer on the grid.
    pub free: Option<Match>,
}

impl Found {
    /// What is known of the better of the two.
    fn rank(&self) -> u8 {
        rank(self.fixed.doubt).max(self.free.as_ref().map_or(0, |free| rank(free.doubt)))
    }
}

/// The best matches over every offset; `None` where there is nothing to compare.
pub(super) fn find(truth: &Sampled, series: &Series) -> Option<Found> {
    let mut best: Option<Found> = None;
    for width in WIDTHS {
        let Some((truth, estimate)) = rates(truth, series, width) else { continue };
        let sums = Sums::new(&truth, &estimate);
        let Some(fixed) = of_sums(&sums, &truth, &estimate, false) else { continue };
        let is_turned = |free: &Match| fixed.alike.worse_than(&free.alike) > TURNED_APART;
        let free = of_sums(&sums, &truth, &estimate, true).filter(is_turned);
        let found = Found { fixed, free };
        if found.fixed.doubt.is_none() {
            return Some(found);
        }
        if best.as_ref().is_none_or(|best| found.rank() > best.rank()) {
            best = Some(found);
        }
    }
    best
}

/// What is known more of is kept.
fn rank(doubt: Option<Doubt>) -> u8 {
    match doubt {
        None => 3,
        Some(Doubt::Repeats) => 2,
        Some(Doubt::Unlike) => 1,
        Some(Doubt::TooEven) => 0,
    }
}

/// Both's rates, on a grid that neither is too coarse nor too long for.
fn rates(truth: &Sampled, series: &Series, width: usize) -> Option<(Rates, Rates)> {
    let times = series.times();
    let span = times.last()?.checked_sub(*times.first()?)?;
    let median = series.median_interval()?;
    let longest = span.max(truth.step().saturating_mul(truth.rows().count() as i64));
    let step = STEP.max(longest / CELLS).max(median / 5);
    let gap = |median: i64| GAP.0.max(GAP.1 * median);
    let ours = Rates::of(truth.rows(), step, width, gap(truth.step()));
    let theirs = Rates::of(series.rows(), step, width, gap(median));
    // Nothing that turns faster than the vehicle ever does follows it.
    let theirs = theirs.without_jumps(1.3 * ours.fastest() + 0.5);
    (!ours.values.is_empty() && !theirs.values.is_empty()).then_some((ours, theirs))
}

fn of_sums(sums: &Sums, truth: &Rates, estimate: &Rates, free: bool) -> Option<Match> {
    let step = truth.step;
    let least = least_cells(truth, estimate);
    let all: Vec<Option<Alike>> =
        (0..sums.len()).map(|i| Some(sums.at(i, free)).filter(|at| at.cells >= least)).collect();
    let tells = |i: usize| all.get(i).copied().flatten().map_or(f64::NEG_INFINITY, |at| at.information());
    let best = (0..all.len()).filter(|&i| all[i].is_some()).max_by(|&a, &b| tells(a).total_cmp(&tells(b)))?;
    let here = all[best]?;
    let is_peak = |i: &usize| tells(*i) > tells(i.wrapping_sub(1)) && tells(*i) >= tells(i + 1);
    let lobe = lobe(&all, best, &here);
    let mut rivals: Vec<usize> = (0..all.len())
        .filter(|i| !lobe.contains(i) && tells(*i) >= RIVAL_INFORMATION * tells(best))
        .filter(is_peak)
        .filter(|&i| all[i].is_some_and(|at| at.worse_than(&here) < RIVAL_APART))
        .collect();
    rivals.sort_by_key(|&i| i.abs_diff(best));
    rivals.truncate(RIVALS);
    let nats = tells(best) * step as f64 / STEP as f64;
    let doubt = match () {
        () if truth.fastest() < LEAST_RATE => Some(Doubt::TooEven),
        () if here.share() >= LEAST_SHARE && (lobe.end - lobe.start) as i64 * step > WIDEST => {
            Some(Doubt::TooEven)
        }
        () if nats < LEAST_INFORMATION || here.share() < LEAST_SHARE => Some(Doubt::Unlike),
        () if !rivals.is_empty() => Some(Doubt::Repeats),
        () => None,
    };
    let offset = |i: usize| sums.ahead(i) * step;
    let within = offset(lobe.start) - 2 * step..offset(lobe.end - 1) + 2 * step;
    let rivals = rivals.into_iter().map(offset).collect();
    Some(Match { offset: offset(best), within, free, alike: here, rivals, doubt })
}

/// Overlaps of fewer cells are not looked at.
fn least_cells(truth: &Rates, estimate: &Rates) -> f64 {
    let shorter = truth.values.len().min(estimate.values.len()) as f64;
    (LEAST_OVERLAP * shorter).max(25.0f64.min(0.8 * shorter))
}

/// The lags around the best that are no rivals but its own flanks.
fn lobe(all: &[Option<Alike>], best: usize, here: &Alike) -> Range<usize> {
    let is_near = |i: usize| all[i].is_some_and(|at| at.worse_than(here) < RIVAL_APART);
    let mut from = best;
    while from > 0 && is_near(from - 1) {
        from -= 1;
    }
    let mut to = best + 1;
    while to < all.len() && is_near(to) {
        to += 1;
    }
    from..to
}
