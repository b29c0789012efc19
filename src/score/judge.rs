//! Judges a whole series of estimates against the truth.

use super::Aligned;
use super::align::{Align, Frames};
use super::bench::{Bench, STEP};
use super::figures::{DelayKnown, Errors, Figures, Fitted};
use super::given::{Clock, Delay, Options, Row, Timed, Truth};
use super::looks::{ALIKE, BAD, MISTAKES, SHARE};
use super::place::{self, Placed, Undone};
use super::series::Series;
use super::stamped::Stamped;
use crate::geometry::{Attitude, Axes};
use crate::time::SimTime;
use glam::DQuat;

/// Why estimates cannot be judged.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Unjudged {
    /// None of them has a time at which the truth is known and estimates count.
    #[error("no estimate is at a time that the truth covers")]
    NoTruth,
    /// The times at which they held are unknown.
    #[error("{0}")]
    When(String),
}

/// A judged series of estimates.
#[derive(Clone, Debug)]
pub struct Judged {
    /// The summary.
    pub figures: Figures,
    /// What the user should know about its clock.
    pub note: Option<String>,
    /// A constant rotation that explains most of a large error, and the root mean square without it, deg.
    pub turned: Option<(Aligned, f64)>,
    /// When each estimate given to [`judge`] held, as far as known.
    pub held: Vec<SimTime>,
    series: Series,
    options: Options,
    ahead: i64,
    frames: Frames,
}

impl Judged {
    /// Each estimate that has a truth, in the given order, with its error. On the truth's own clock the times are
    /// as given, unless the options remove the delay.
    pub fn rows(&self, truth: Truth<'_>, mut each: impl FnMut(Row)) {
        let options = self.options;
        if let Some(bench) = Bench::new(truth, &self.series, options, false) {
            bench.rows(&self.series, self.ahead, self.frames).for_each(&mut each);
        }
    }
}

/// Other ways to read the same estimates, each with its meaning: `in degrees read as radians`.
pub type Readings<'a> = &'a [(&'static str, Series)];

/// Judges the estimates of one source. It leaves out those with another kind of stamp than most have, and those
/// without a truth.
///
/// # Errors
/// None is left, or nothing shows when they held.
pub fn judge(truth: Truth<'_>, estimates: &[Timed], options: &Options) -> Result<Judged, Unjudged> {
    let stamped = Stamped::of(estimates);
    let series = stamped.series(|i| estimates[i].attitude);
    let clock = if stamped.is_echoed { Clock::Sample } else { options.clock };
    let mut judged = judge_series(truth, series, &[], &Options { clock, ..*options })?;
    let figures = &mut judged.figures;
    let delay = figures.delay_ms.map_or(0, |ms| libm::round(ms * 1e6) as i64);
    if figures.delay_known != DelayKnown::Unknown && figures.clock_offset_s.is_none() {
        figures.delay_ms = stamped.delay_ms(estimates, delay);
    }
    judged.held = stamped.held(estimates, delay);
    Ok(judged)
}

/// [`judge`] for a series with plain times, which may also be read in other ways: if the given reading has a large
/// error and another has not, the figures name that one.
///
/// # Errors
/// Those of [`judge`].
pub fn judge_series(
    truth: Truth<'_>,
    series: Series,
    others: Readings<'_>,
    options: &Options,
) -> Result<Judged, Unjudged> {
    let is_echoed = options.clock == Clock::Sample;
    let bench = Bench::new(truth, &series, *options, !is_echoed).ok_or(Unjudged::NoTruth)?;
    let undone = undoings(&series, others, options.axes);
    let placed = place::place(&bench, &series, &undone).map_err(Unjudged::When)?;
    let Some((mut figures, ahead, frames)) = figures(&bench, &series, &placed)? else {
        return Err(Unjudged::NoTruth);
    };
    let mut turned = None;
    // A delay alone is no mistake.
    let fitted = figures.fitted.map_or(f64::INFINITY, |fitted| fitted.errors.rms_deg);
    let bad = figures.errors.rms_deg.min(fitted).to_radians();
    if bad > BAD
        && let Some((names, rms)) = look(&bench, &undone, placed.other, ahead, bad)
    {
        (figures.looks, figures.looks_rms_deg) = (Some(names), Some(rms.to_degrees()));
    }
    if figures.looks.is_none() && options.align == Align::None {
        turned = turned_frames(&bench, &series, ahead);
    }
    drop((bench, undone));
    Ok(Judged {
        figures,
        note: placed.note,
        turned,
        held: Vec::new(),
        options: *options,
        ahead,
        frames,
        series,
    })
}

/// The figures, the offset of the times in them, and the removed rotations.
fn figures(
    bench: &Bench<'_>,
    series: &Series,
    placed: &Placed,
) -> Result<Option<(Figures, i64, Frames)>, Unjudged> {
    let align = bench.options.align;
    let is_echoed = bench.options.clock == Clock::Sample;
    let at = |ahead: i64| {
        let frames = bench.frames(series, ahead, align);
        bench.errors(series, ahead, frames).map(|errors| (errors, ahead, frames))
    };
    let found = placed.delay.filter(|fit| fit.doubt.is_none());
    let doubt = placed.delay.map_or(Some("there is too little motion in both"), |fit| fit.doubt);
    let out = match bench.options.delay {
        _ if placed.other => None,
        Delay::Given(ns) => Some((ns, None)),
        Delay::Fit if found.is_none() => {
            return Err(Unjudged::When(format!("its delay cannot be found: {}", doubt.unwrap_or_default())));
        }
        _ => found.map(|fit| (fit.delay, Some(fit.error))),
    };
    let given = at(placed.ahead);
    let without = out.and_then(|(delay, error)| Some((at(delay)?, error)));
    let takes_out = bench.options.delay == Delay::TakeOut && without.is_some();
    let Some(main) = (if takes_out { without.map(|(it, _)| it) } else { given }) else { return Ok(None) };
    let ((errors, samples, coverage), mut ahead, mut frames) = main;
    let fitted = without.filter(|_| !takes_out && !is_echoed).map(|(((errors, ..), delay, _), error)| {
        Fitted { delay_ms: delay as f64 * 1e-6, delay_std_ms: error.map(|ns| ns * 1e-6), errors }
    });
    if let (Delay::Fit | Delay::Given(_), Some(((_, delay, without), _))) = (bench.options.delay, without) {
        (ahead, frames) = (delay, without);
    }
    let known = match (is_echoed, bench.options.delay, out.is_some()) {
        (true, ..) => DelayKnown::Echoed,
        (_, Delay::Given(_), true) => DelayKnown::Given,
        (_, _, true) => DelayKnown::Estimated,
        _ => DelayKnown::Unknown,
    };
    let as_arrived = given.filter(|_| takes_out && !is_echoed).map(|((errors, ..), ..)| errors);
    let figures = Figures {
        samples,
        errors,
        fitted,
        as_arrived: as_arrived.filter(|as_arrived: &Errors| *as_arrived != errors),
        delay_ms: out.map(|(ns, _)| ns as f64 * 1e-6),
        delay_known: known,
        delay_doubt: doubt.filter(|_| known == DelayKnown::Unknown && !placed.other),
        clock_offset_s: placed.other.then_some(placed.ahead as f64 * 1e-9),
        clock_std_ms: placed.error.filter(|ns| ns.is_finite()).map(|ns| ns * 1e-6),
        clock_certain: placed.certain,
        coverage: coverage.share,
        from_s: coverage.ends[0] as f64 * 1e-9,
        to_s: coverage.ends[1] as f64 * 1e-9,
        aligned: (align != Align::None).then(|| frames.angles()),
        heading_offset_deg: (align == Align::Heading).then(|| frames.angles().heading_deg),
        looks: None,
        looks_rms_deg: None,
    };
    Ok(Some((figures, ahead, frames)))
}

/// Each mistake with its correction.
fn undoings<'a>(series: &'a Series, others: Readings<'a>, axes: Axes) -> Vec<Undone<'a>> {
    let others = others.iter().filter(|(_, other)| other.len() == series.len());
    let others = others.map(|(name, other)| Undone { name, thinned: Box::new(|count| other.thinned(count)) });
    let mistakes = MISTAKES.iter().map(move |mistake| {
        let undo =
            move |q: DQuat| axes.attitude_in((mistake.undo)(axes.attitude_out(Attitude::from_quat(q)))).q;
        Undone { name: mistake.name, thinned: Box::new(move |count| series.thinned(count).map(undo)) }
    });
    others.chain(mistakes).collect()
}

/// The number of estimates to examine for mistakes.
const LOOK: usize = 300;

/// The mistake that explains an error of `bad` rad, if any, and the root mean square without it, rad. On the
/// truth's clock (not `other`) each is tried with its own delay.
fn look(
    bench: &Bench<'_>,
    undone: &[Undone<'_>],
    other: bool,
    ahead: i64,
    bad: f64,
) -> Option<(String, f64)> {
    let is_searched = bench.grid.rows().next().is_some() && !other;
    let rms = |undone: &Undone<'_>| {
        let undone = (undone.thinned)(LOOK);
        let fit = if is_searched { bench.delay(&undone, 5 * STEP) } else { None };
        let delay = fit.filter(|fit| fit.doubt.is_none()).map(|fit| fit.delay);
        bench.rms(&undone, delay.unwrap_or(ahead))
    };
    let tried: Vec<(&str, f64)> = undone.iter().filter_map(|it| Some((it.name, rms(it)?))).collect();
    let best = tried.iter().map(|(_, rms)| *rms).reduce(f64::min)?;
    if best > BAD || best > SHARE * bad {
        return None;
    }
    let alike = tried.iter().filter(|(_, rms)| *rms <= ALIKE.0 * best + ALIKE.1);
    let names: Vec<&str> = alike.map(|(name, _)| *name).take(3).collect();
    Some((names.join(" or "), best))
}

/// An error larger than this is examined for a constant rotation, deg RMS.
const TURNED: f64 = 1.0;

/// The constant rotations that explain an error: only that of the world if it explains as much.
fn turned_frames(bench: &Bench<'_>, series: &Series, ahead: i64) -> Option<(Aligned, f64)> {
    let thin = series.thinned(LOOK * 10);
    let (Errors { rms_deg, .. }, ..) = bench.errors(&thin, ahead, Frames::SAME)?;
    if rms_deg < TURNED {
        return None;
    }
    let without = |align: Align| {
        let frames = bench.frames(&thin, ahead, align);
        let (errors, ..) = bench.errors(&thin, ahead, frames)?;
        Some((frames.angles(), errors.rms_deg))
    };
    let tried = [Align::Heading, Align::World, Align::Frames].map(without);
    let best = tried.iter().flatten().map(|(_, rms)| *rms).reduce(f64::min)?;
    let simplest = tried.into_iter().flatten().find(|(_, rms)| *rms <= 1.2 * best + 0.02)?;
    (simplest.1 < SHARE * rms_deg).then_some(simplest)
}
