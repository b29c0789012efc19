//! Finds the offset between two unrelated clocks from the motion.
//!
//! It compares the angular rates of truth and estimate at every lag at which they overlap ([`Sums`]). The best lag
//! is the one where the truth gives most information about the estimate, in nats: a long overlap that agrees well.
//! It is trusted if it gives much information, explains most of the turning of both, and no other lag with a fair
//! part of that information agrees nearly as well: a motion that repeats agrees with itself a period later.

use super::correlate::{Alike, Sums};
use super::rates::Rates;
use super::sampled::Sampled;
use super::series::Series;
use std::ops::Range;

/// The smallest cell of the grid, ns.
const STEP: i64 = 20_000_000;
/// The most cells, for the longer of the two.
const CELLS: i64 = 1 << 17;
/// Rates are means over this many cells, the second for an estimate with more noise.
const WIDTHS: [usize; 2] = [5, 25];
/// Rows further apart than this, ns, and than this many median intervals, contain nothing about the time between.
const GAP: (i64, i64) = (250_000_000, 5);
/// The least information of the truth about the estimate, in nats at 50 cells a second.
const LEAST_INFORMATION: f64 = 300.0;
/// The least share of the turning of both that it must explain.
const LEAST_SHARE: f64 = 0.5;
/// Another lag is a rival if it has this share of the best one's information,
const RIVAL_INFORMATION: f64 = 0.25;
/// and its difference is less than this many times the best one's.
const RIVAL_APART: f64 = 2.0;
/// The body's axes may be rotated if that reduces the difference on the grid by this factor.
const TURNED_APART: f64 = 2.0;
/// The least overlap, as a share of the shorter of the two.
const LEAST_OVERLAP: f64 = 0.1;
/// A truth that never turns faster contains no information about time, rad/s.
const LEAST_RATE: f64 = 0.01;
/// Neither does one that agrees equally well over this many ns.
const WIDEST: i64 = 2_000_000_000;
/// The most rivals kept.
const RIVALS: usize = 64;

/// The best agreement of two clocks.
#[derive(Clone, Debug)]
pub(super) struct Match {
    /// How far the estimate's clock is ahead of the truth's, ns.
    pub offset: i64,
    /// The range in which the grid locates it, ns.
    pub within: Range<i64>,
    /// Whether the body's axes had to be rotated.
    pub free: bool,
    /// The agreement of the two there.
    pub alike: Alike,
    /// Other offsets at which the motion agrees about as well, ns, the closest to [`Match::offset`] first.
    pub rivals: Vec<i64>,
    /// A reason not to trust it.
    pub doubt: Option<Doubt>,
}

/// A reason not to trust a match.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Doubt {
    /// One of the two never turns, or turns so evenly that any time fits.
    TooEven,
    /// Neither follows the other anywhere.
    Unlike,
    /// Several offsets agree about equally well.
    Repeats,
}

/// The best matches over every offset.
#[derive(Clone, Debug)]
pub(super) struct Found {
    /// With the body's axes unchanged.
    pub fixed: Match,
    /// With the body's axes rotated, if that brings the two much closer on the grid.
    pub free: Option<Match>,
}

impl Found {
    /// The confidence in the better of the two.
    fn rank(&self) -> u8 {
        rank(self.fixed.doubt).max(self.free.as_ref().map_or(0, |free| rank(free.doubt)))
    }
}

/// The best matches over every offset; `None` if there is nothing to compare.
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

/// The match with the higher rank is kept.
fn rank(doubt: Option<Doubt>) -> u8 {
    match doubt {
        None => 3,
        Some(Doubt::Repeats) => 2,
        Some(Doubt::Unlike) => 1,
        Some(Doubt::TooEven) => 0,
    }
}

/// The rates of both, on a grid that is neither too coarse nor too long for either.
fn rates(truth: &Sampled, series: &Series, width: usize) -> Option<(Rates, Rates)> {
    let times = series.times();
    let span = times.last()?.checked_sub(*times.first()?)?;
    let median = series.median_interval()?;
    let longest = span.max(truth.step().saturating_mul(truth.rows().count() as i64));
    let step = STEP.max(longest / CELLS).max(median / 5);
    let gap = |median: i64| GAP.0.max(GAP.1 * median);
    let ours = Rates::of(truth.rows(), step, width, gap(truth.step()));
    let theirs = Rates::of(series.rows(), step, width, gap(median));
    // An estimate that turns faster than the vehicle ever does is jumping.
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

/// The smallest overlap examined, in cells.
fn least_cells(truth: &Rates, estimate: &Rates) -> f64 {
    let shorter = truth.values.len().min(estimate.values.len()) as f64;
    (LEAST_OVERLAP * shorter).max(25.0f64.min(0.8 * shorter))
}

/// The lags around the best that are its own flanks and no rivals.
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
