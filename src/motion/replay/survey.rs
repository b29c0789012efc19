//! Finds missing rows and jumps in a log, for the user.
//!
//! A gap is an interval of more than three times the median. A jump is a change between two rows that its
//! neighbours do not explain (the Hampel identifier, L. Davies and U. Gather, *The identification of multiple
//! outliers*, JASA 88(423), 1993): the rate of change differs from the median of the four before and the four after
//! by more than ten times the median of their own differences, and by more than 1 deg of attitude or 10 deg/s of
//! rate within the interval.

use super::grid::Grid;
use super::log::Log;
use crate::geometry::log;
use glam::{DQuat, DVec3};

/// Changes on each side to compare with.
const SIDE: usize = 4;
/// How many times their spread counts as a jump.
const BEYOND: f64 = 10.0;
/// The smallest jump: of attitude, rad, and of angular rate, rad/s.
const LEAST_TURN: f64 = 1.0 * std::f64::consts::PI / 180.0;
const LEAST_RATE: f64 = 10.0 * std::f64::consts::PI / 180.0;
/// How many of a kind are listed one by one.
const SHOWN: usize = 3;

/// The first few, and the number of others.
pub(super) fn some_of(all: Vec<String>) -> impl Iterator<Item = String> {
    let more = all.len().saturating_sub(SHOWN);
    let count = all.len();
    all.into_iter().take(SHOWN).enumerate().map(move |(i, one)| {
        if more > 0 && i + 1 == SHOWN.min(count) { format!("{one} (and {more} more like it)") } else { one }
    })
}

/// The gaps.
pub(super) fn gaps<const N: usize>(log: &Log<N>) -> impl Iterator<Item = String> {
    let grid = &log.grid;
    let gaps = (0..grid.len() - 1).filter(|&i| grid.is_gap(i)).map(|i| {
        format!(
            "{}: a gap of {} after the previous row, where rows are {} apart (median); the motion interpolates linearly across it",
            log.place(i + 1),
            grid.at(i + 1) - grid.at(i),
            grid.median
        )
    });
    some_of(gaps.collect())
}

/// The jumps of an attitude log.
pub(super) fn attitude_jumps<const N: usize>(log: &Log<N>, quats: &[DQuat]) -> impl Iterator<Item = String> {
    let step = |i: usize| self::log(quats[i].conjugate() * quats[i + 1]);
    jumps(log, step, LEAST_TURN, "deg")
}

/// The jumps of a rate log.
pub(super) fn rate_jumps<const N: usize>(log: &Log<N>, rates: &[DVec3]) -> impl Iterator<Item = String> {
    jumps(log, |i| rates[i + 1] - rates[i], LEAST_RATE, "deg/s")
}

fn jumps<const N: usize>(
    log: &Log<N>,
    step: impl Fn(usize) -> DVec3,
    least: f64,
    unit: &str,
) -> impl Iterator<Item = String> {
    let grid = &log.grid;
    let jumps = (0..grid.len() - 1).filter(|&i| !grid.is_gap(i)).filter_map(|i| {
        // Of two neighbours, one has changed by at least half of the difference; most rows need no closer look.
        let beyond = (step(i).length() > 0.5 * least).then(|| beyond(grid, &step, i, least))??;
        Some(format!(
            "{}: jumps by {:.3} {unit} from the previous row, {:.3} {unit} more than its neighbours explain",
            log.place(i + 1),
            step(i).length().to_degrees(),
            beyond.to_degrees()
        ))
    });
    some_of(jumps.collect())
}

/// By how much the step after row `i` differs from its neighbours', if that is a jump.
fn beyond(grid: &Grid, step: impl Fn(usize) -> DVec3, i: usize, least: f64) -> Option<f64> {
    let around = i.saturating_sub(SIDE)..(i + SIDE + 1).min(grid.len() - 1);
    let pace = |j: usize| step(j) / grid.interval(j);
    let near: Vec<_> = around.filter(|&j| j != i && !grid.is_gap(j)).map(pace).collect();
    if near.is_empty() {
        return None;
    }
    let axis = |axis: usize| median(near.iter().map(|pace| pace[axis]));
    let usual = DVec3::new(axis(0), axis(1), axis(2));
    let spread = median(near.iter().map(|pace| (*pace - usual).length()));
    let off = (pace(i) - usual).length();
    (off > BEYOND * spread && off * grid.interval(i) > least).then(|| off * grid.interval(i))
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<_> = values.collect();
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}
