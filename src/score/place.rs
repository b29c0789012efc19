//! Determines when estimates held: on the truth's clock, or on their own clock and its offset.

use super::bench::{Bench, DELAYS, STEP};
use super::delay::{self, Fit};
use super::given::Clock;
use super::looks::{BAD, SHARE};
use super::offset::{self, Doubt, Found, Match};
use super::series::Series;
use crate::time::SimTime;

/// An estimate with a delay in this range counts as on the truth's clock, whatever its times, ns.
const PLAIN: std::ops::Range<i64> = -100_000_000..500_000_000;
/// Times that start and end this close to the truth's are on the truth's clock, ns.
const TOGETHER: i64 = 50_000_000;
/// An offset with a standard error above this is uncertain, ns.
const SHARP: f64 = 1_000_000.0;
/// Offsets that change a figure by at most this share of it, or this much (rad), need not be distinguished.
const ALIKE: (f64, f64) = (0.03, 0.02 * std::f64::consts::PI / 180.0);
/// The number of offsets to try where any is possible.
const TRIED: i64 = 33;
/// The share of the possible overlap that such an offset must have.
const OVERLAP: f64 = 0.9;
/// The number of estimates examined for that.
const LOOKED_AT: usize = 600;
/// For a possible mistake, an estimate is examined whole up to this many rows.
const ROWS: usize = 60_000;

/// The position of a series in time.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Placed {
    /// Whether its clock differs from the truth's.
    pub other: bool,
    /// How far its clock is ahead, its delay included, ns; 0 on the truth's.
    pub ahead: i64,
    /// The standard error of the offset, ns.
    pub error: Option<f64>,
    /// Whether the clock is known without doubt.
    pub certain: bool,
    /// How it was determined, for the user.
    pub note: Option<String>,
    /// The delay on the truth's clock.
    pub delay: Option<Fit>,
}

impl Placed {
    /// A series on the truth's clock.
    pub fn on_truths(delay: Option<Fit>) -> Placed {
        Placed { other: false, ahead: 0, error: None, certain: true, note: None, delay }
    }
}

/// A mistake of axes, order or sign, with the corrected estimates.
pub(super) struct Undone<'a> {
    /// The text after "estimate looks".
    pub name: &'static str,
    /// At most this many of the estimates, chosen by [`Series::thinned`].
    pub thinned: Box<dyn Fn(usize) -> Series + 'a>,
}

/// The position of a series in time, or why it is unknown.
pub(super) fn place(bench: &Bench<'_>, series: &Series, mistakes: &[Undone<'_>]) -> Result<Placed, String> {
    match bench.options.clock {
        Clock::Sample => return Ok(Placed::on_truths(Some(Fit::EXACT))),
        Clock::Truth => return Ok(Placed::on_truths(bench.delay(series, STEP))),
        Clock::Other | Clock::Auto => {}
    }
    let found = best_match(bench, series);
    let is_unlike = found.as_ref().is_some_and(|found| found.doubt == Some(Doubt::Unlike));
    let found = if is_unlike { of_a_mistake(bench, series, mistakes).or(found) } else { found };
    if let Some(found) = found.as_ref().filter(|found| found.doubt.is_none()) {
        return settle(bench, series, found);
    }
    if bench.options.clock == Clock::Auto && together(bench, series) {
        let note = "its times start and end with the truth's, so they are taken as the truth's".to_string();
        return Ok(Placed { note: Some(note), ..Placed::on_truths(bench.delay(series, STEP)) });
    }
    indifferent(bench, series, found.as_ref())
}

/// The best match; the one with rotated body axes only if they really are rotated, because an offset of part of a
/// grid cell looks similar.
fn best_match(bench: &Bench<'_>, series: &Series) -> Option<Match> {
    let Found { fixed, free } = offset::find(&bench.grid, series)?;
    let Some(free) = free else { return Some(fixed) };
    let apart = |found: &Match| delay::apart(&bench.grid, series, &found.within, step(found), found.free);
    Some(if apart(&fixed) > TURNED_APART * apart(&free) + NOTHING { free } else { fixed })
}

/// The body's axes count as rotated if that reduces the difference by this factor.
const TURNED_APART: f64 = 4.0;
/// The step for the delays of a match, ns.
fn step(found: &Match) -> i64 {
    STEP.max((found.within.end - found.within.start) / 400)
}

/// Rates that differ by less count as equal, (rad/s)².
const NOTHING: f64 = 1e-5;

/// Whether the times start and end with the truth's.
fn together(bench: &Bench<'_>, series: &Series) -> bool {
    let times = series.times();
    let (Some(&first), Some(&last)) = (times.first(), times.last()) else { return false };
    let near = TOGETHER.max(2 * series.median_interval().unwrap_or(0));
    let apart = |a: i64, b: i64| a.saturating_sub(b).saturating_abs();
    apart(first, bench.options.from.0) <= near && apart(last, bench.options.until.0) <= near
}

/// Refines a clear match to a microsecond.
fn settle(bench: &Bench<'_>, series: &Series, found: &Match) -> Result<Placed, String> {
    let exact = |t: i64| bench.around(t);
    let fit = delay::near(&bench.grid, &exact, series, &found.within, step(found), found.free);
    let plain = if together(bench, series) { DELAYS } else { PLAIN };
    if bench.options.clock == Clock::Auto && plain.contains(&fit.delay) {
        return Ok(Placed::on_truths(Some(fit)));
    }
    let mut placed = Placed {
        other: true,
        ahead: fit.delay,
        error: Some(fit.error),
        certain: fit.doubt.is_none() && fit.error <= SHARP && fit.rival == 0.0,
        note: None,
        delay: None,
    };
    if placed.certain {
        return Ok(placed);
    }
    let reach = fit.spread().min((found.within.end - found.within.start) as f64) as i64;
    let (least, most) = spread(bench, series, [-reach, 0, reach].map(|off| fit.delay + off));
    let around = format!(
        "its clock is {:.3} s ahead of the truth's, give or take {:.3} s",
        seconds(fit.delay),
        reach as f64 * 1e-9
    );
    if is_alike(least, most) {
        placed.note = Some(format!("{around}; that changes the figures by less than 3 %"));
        return Ok(placed);
    }
    Err(format!("{around}: that leaves {:.3} to {:.3} deg RMS", least.to_degrees(), most.to_degrees()))
}

/// A match that becomes clear once a mistake is undone, if that also explains the error.
fn of_a_mistake(bench: &Bench<'_>, series: &Series, mistakes: &[Undone<'_>]) -> Option<Match> {
    let thin = series.thinned(ROWS);
    let tried = mistakes.iter().filter_map(|mistake| {
        let undone = (mistake.thinned)(ROWS);
        let found = offset::find(&bench.grid, &undone)?.fixed;
        if found.doubt.is_some() {
            return None;
        }
        let given = bench.rms(&thin.thinned(LOOKED_AT), found.offset)?;
        let rms = bench.rms(&undone.thinned(LOOKED_AT), found.offset)?;
        (rms < BAD && rms < SHARE * given).then_some((rms, found))
    });
    tried.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, found)| found)
}

/// Handles an offset that nothing determines but that makes no difference.
fn indifferent(bench: &Bench<'_>, series: &Series, found: Option<&Match>) -> Result<Placed, String> {
    let offsets = match found {
        Some(found) if found.doubt == Some(Doubt::Repeats) => {
            std::iter::once(found.offset).chain(found.rivals.iter().copied()).collect()
        }
        Some(found) if found.doubt == Some(Doubt::Unlike) => Vec::new(),
        _ => anywhere(bench, series),
    };
    let (least, most) = spread(bench, series, offsets.iter().copied());
    if !offsets.is_empty() && least.is_finite() && is_alike(least, most) {
        let note = "its clock is unknown, but any offset changes the figures by less than 3 %".to_string();
        let ahead = offsets[0];
        return Ok(Placed { other: true, ahead, error: None, certain: false, note: Some(note), delay: None });
    }
    Err(why(found, least, most))
}

fn why(found: Option<&Match>, least: f64, most: f64) -> String {
    let range = match least.is_finite() {
        true => format!(": that leaves {:.3} to {:.3} deg RMS", least.to_degrees(), most.to_degrees()),
        false => String::new(),
    };
    match found {
        Some(found) if found.doubt == Some(Doubt::Repeats) => {
            let shown = std::iter::once(found.offset).chain(found.rivals.iter().copied()).take(3);
            let shown: Vec<_> = shown.map(|offset| format!("{:.2} s", seconds(offset))).collect();
            let more = (found.rivals.len() + 1).saturating_sub(shown.len());
            let more = if more > 0 { format!(" or {more} more") } else { String::new() };
            format!(
                "the motion repeats, so its clock may be {}{more} ahead of the truth's{range}",
                shown.join(", ")
            )
        }
        Some(found) if found.doubt == Some(Doubt::Unlike) => {
            format!("no clock offset makes it follow the truth's motion{range}")
        }
        _ => format!("the motion is too even to find its clock's offset from the truth's{range}"),
    }
}

/// Offsets with about the largest possible overlap; the first aligns both starts.
fn anywhere(bench: &Bench<'_>, series: &Series) -> Vec<i64> {
    let times = series.times();
    let (Some(&first), Some(&last)) = (times.first(), times.last()) else { return Vec::new() };
    let (from, until) = (bench.options.from.0, bench.options.until.0);
    let (ours, theirs) = ((until - from) as f64, last.saturating_sub(first) as f64);
    let lost = (1.0 - OVERLAP) * ours.min(theirs);
    let (a, b) = (first.saturating_sub(from), last.saturating_sub(until));
    let (low, high) = (a.min(b).saturating_sub(lost as i64), a.max(b).saturating_add(lost as i64));
    let step = (high.saturating_sub(low) / (TRIED - 1)).max(1);
    std::iter::once(a).chain((0..TRIED).map(|i| low + i * step)).collect()
}

/// The smallest and largest root mean square at some offsets, rad.
fn spread(bench: &Bench<'_>, series: &Series, offsets: impl IntoIterator<Item = i64>) -> (f64, f64) {
    let thin = series.thinned(LOOKED_AT);
    let all = offsets.into_iter().map(|offset| bench.rms(&thin, offset).unwrap_or(f64::INFINITY));
    all.fold((f64::INFINITY, 0.0f64), |(least, most), rms| (least.min(rms), most.max(rms)))
}

fn is_alike(least: f64, most: f64) -> bool {
    most - least <= (ALIKE.0 * most).max(ALIKE.1)
}

fn seconds(ns: i64) -> f64 {
    SimTime(ns).seconds()
}
