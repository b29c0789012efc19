//! A whole series of estimates against the truth.

use super::delay::{self, Fit, Series};
use super::looks::{ALIKE, BAD, MISTAKES, SHARE, heading_offset, turned_back};
use super::sampled::Sampled;
use super::{AttitudeError, clock, offset};
use crate::geometry::{Attitude, Axes};
use crate::time::SimTime;
use glam::DQuat;
use serde::Serialize;
use std::ops::Range;

/// The truth as a function of time.
pub type Truth<'a> = &'a dyn Fn(SimTime) -> Attitude;

/// What is known of the time at which an estimate held.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stamp {
    /// The scene's time of the newest sample it rests on, as echoed: exact.
    Sample(SimTime),
    /// Time of the other side's own clock, ns since whenever.
    Own(i64),
    /// Nothing but its arrival.
    Arrival,
}

/// An estimate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timed {
    /// When it arrived, in scene time; of an estimate in a file, the time that stands beside it.
    pub arrival: SimTime,
    /// When it held, as far as it says.
    pub stamp: Stamp,
    /// What it says: body to nav, of about unit length.
    pub attitude: Attitude,
}

/// What is taken out of the estimates before they are judged.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Align {
    /// Nothing.
    #[default]
    None,
    /// One constant turn about the vertical: what an estimator without a magnetometer cannot know.
    Heading,
}

/// What clock `arrival` is a time of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Clock {
    /// The scene's: an estimate is late by its delay, from half a second early to two seconds late.
    #[default]
    Scene,
    /// One of which nothing is known: a log since some boot. [`Options::until`] has to be finite.
    Foreign,
}

/// How to judge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Options {
    /// What is taken out.
    pub align: Align,
    /// Which clock.
    pub clock: Clock,
    /// From when on the truth is known and estimates count.
    pub from: SimTime,
    /// Until when.
    pub until: SimTime,
    /// The axes in which the estimates were written before they were read, and in which mistakes were made.
    pub axes: Axes,
}

impl Default for Options {
    fn default() -> Options {
        Options {
            align: Align::None,
            clock: Clock::Scene,
            from: SimTime::ZERO,
            until: SimTime::FOREVER,
            axes: Axes::NedFrd,
        }
    }
}

/// How the delay is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum DelayKnown {
    /// The time of the sample was echoed.
    Echoed,
    /// By where the motion agrees best.
    Estimated,
    /// It is not.
    Unknown,
}

/// What a series of estimates amounts to; errors are those at the time at which each held.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Figures {
    /// How many estimates were judged.
    pub samples: u64,
    /// Root mean square of the whole error.
    pub rms_deg: f64,
    /// The largest whole error.
    pub max_deg: f64,
    /// Root mean square of the tilt.
    pub inclination_rms_deg: f64,
    /// The largest tilt.
    pub inclination_max_deg: f64,
    /// Root mean square of the turn about the vertical.
    pub heading_rms_deg: f64,
    /// The largest turn about the vertical.
    pub heading_max_deg: f64,
    /// How much later than it held an estimate came, the median where it is known of each.
    pub delay_ms: Option<f64>,
    /// How it is known.
    pub delay_known: DelayKnown,
    /// Why it is not.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub delay_doubt: Option<&'static str>,
    /// How much the estimates' own clock was ahead of the scene's, delay included, where it is another.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub clock_offset_s: Option<f64>,
    /// The constant heading that was taken out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub heading_offset_deg: Option<f64>,
    /// The mistake that explains a large error: `NED/ENU swapped`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub looks: Option<String>,
    /// What the root mean square would be without it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub looks_rms_deg: Option<f64>,
}

/// One estimate that was judged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// When it held, in scene time.
    pub t: SimTime,
    /// What it said, less what was taken out.
    pub attitude: Attitude,
    /// How far that is from the truth.
    pub error: AttitudeError,
}

/// A series of estimates with its figures.
#[derive(Clone, Debug, PartialEq)]
pub struct Judged {
    /// The figures.
    pub figures: Figures,
    /// Each estimate, in the order given.
    pub rows: Vec<Row>,
}

/// Judges the estimates of one source. Those whose stamps are not of the kind that most have are left out, and so are
/// those for which there is no truth.
///
/// `None` where none is left.
pub fn judge(truth: Truth<'_>, estimates: &[Timed], options: &Options) -> Option<Judged> {
    judge_readings(truth, estimates, &[], options)
}

/// [`judge`] for estimates that can be read in other ways, each with what it would mean: `in degrees read as radians`.
/// If the reading given is far off and one of the others is not, that is named.
pub fn judge_readings(
    truth: Truth<'_>,
    estimates: &[Timed],
    others: &[(&'static str, Vec<Attitude>)],
    options: &Options,
) -> Option<Judged> {
    let stamped = Stamped::of(estimates);
    let bench = Bench::new(truth, &stamped.times, stamped.is_echoed, *options)?;
    let series = |attitude: &dyn Fn(usize) -> Attitude| Series {
        times: stamped.times.clone(),
        attitudes: stamped.of.iter().map(|&i| attitude(i).q.normalize()).collect(),
    };
    let given = series(&|i| estimates[i].attitude);
    let placed = bench.place(&given)?;
    let mut judged = bench.judged(&given, &placed)?;
    judged.figures.delay_ms = match placed.known {
        DelayKnown::Unknown => None,
        _ if options.clock == Clock::Foreign => None,
        _ => stamped.delay_ms(estimates, placed.delay),
    };
    if judged.figures.rms_deg.to_radians() > BAD {
        let others = others.iter().filter(|(_, attitudes)| attitudes.len() == estimates.len());
        let others = others.map(|(name, attitudes)| (*name, series(&|i| attitudes[i]).thinned(LOOK)));
        let undone = |undo: fn(DQuat) -> DQuat| {
            let Series { times, attitudes } = given.thinned(LOOK);
            let axes = options.axes;
            let undo = |q| axes.attitude_in(undo(axes.attitude_out(Attitude::from_quat(q)))).q;
            Series { times, attitudes: attitudes.into_iter().map(undo).collect() }
        };
        let mistakes = MISTAKES.iter().map(|mistake| (mistake.name, undone(mistake.undo)));
        bench.look(others.chain(mistakes).collect(), &mut judged.figures);
    }
    Some(judged)
}

/// As many estimates are looked through for mistakes.
const LOOK: usize = 300;

/// The estimates that count, by number, each with a time on one clock.
struct Stamped {
    of: Vec<usize>,
    times: Vec<i64>,
    is_echoed: bool,
}

impl Stamped {
    fn of(estimates: &[Timed]) -> Stamped {
        let kind = |stamp: Stamp| match stamp {
            Stamp::Sample(_) => 0,
            Stamp::Own(_) => 1,
            Stamp::Arrival => 2,
        };
        let count = |of: usize| estimates.iter().filter(|estimate| kind(estimate.stamp) == of).count();
        let most = (0..3).max_by_key(|&of| (count(of), 2 - of)).unwrap_or(0);
        let is_good = |estimate: &Timed| {
            estimate.attitude.q.is_finite() && (0.5..2.0).contains(&estimate.attitude.q.length())
        };
        let counts = |i: &usize| kind(estimates[*i].stamp) == most && is_good(&estimates[*i]);
        let of: Vec<usize> = (0..estimates.len()).filter(counts).collect();
        let arrivals: Vec<i64> = of.iter().map(|&i| estimates[i].arrival.0).collect();
        let stamp = |&i: &usize| match estimates[i].stamp {
            Stamp::Sample(t) => t.0,
            Stamp::Own(t) => t,
            Stamp::Arrival => estimates[i].arrival.0,
        };
        let stamps: Vec<i64> = of.iter().map(stamp).collect();
        let times = if most == 1 { clock::onto_ours(&stamps, &arrivals).unwrap_or(arrivals) } else { stamps };
        Stamped { of, times, is_echoed: most == 0 }
    }

    /// The median of arrival less when it held.
    fn delay_ms(&self, estimates: &[Timed], delay: i64) -> Option<f64> {
        let late = |(&i, &t): (&usize, &i64)| estimates[i].arrival.0 - (t - delay);
        let mut delays: Vec<i64> = self.of.iter().zip(&self.times).map(late).collect();
        delays.sort_unstable();
        delays.get(delays.len() / 2).map(|&ns| ns as f64 * 1e-6)
    }
}

/// Where a series lies in time.
struct Placed {
    delay: i64,
    known: DelayKnown,
    doubt: Option<&'static str>,
}

/// The truth and what is asked of it.
struct Bench<'a> {
    truth: Truth<'a>,
    options: Options,
    is_echoed: bool,
    grid: Sampled,
}

/// The delays that are looked for, ns.
const DELAYS: Range<i64> = -500_000_000..2_000_000_000;
/// How finely: a motion of 60 Hz still has its dip between.
const STEP: i64 = 4_000_000;

impl Bench<'_> {
    /// `None` where there is nothing to judge.
    fn new<'a>(truth: Truth<'a>, times: &[i64], is_echoed: bool, options: Options) -> Option<Bench<'a>> {
        let (first, last) = (*times.iter().min()?, *times.iter().max()?);
        let (mut from, mut until) = (options.from.0, options.until.0);
        if options.clock == Clock::Scene {
            from = from.max(first.saturating_sub(DELAYS.end));
            until = until.min(last.saturating_sub(DELAYS.start));
        }
        let grid = if is_echoed { Sampled::new(truth, 0, -1) } else { Sampled::new(truth, from, until) };
        Some(Bench { truth, options, is_echoed, grid })
    }

    fn at(&self, t: i64) -> Option<DQuat> {
        let t = SimTime(t);
        (self.options.from <= t && t <= self.options.until).then(|| (self.truth)(t).q)
    }

    /// When the estimates of a series held.
    fn place(&self, series: &Series) -> Option<Placed> {
        if self.is_echoed {
            return Some(Placed { delay: 0, known: DelayKnown::Echoed, doubt: None });
        }
        let Some(mut fit) = self.fit(series, STEP) else {
            return Some(Placed {
                delay: self.fallback(series)?,
                known: DelayKnown::Unknown,
                doubt: Some("no part of the motion is in both"),
            });
        };
        if fit.doubt.is_some() {
            // What cannot be told is not guessed: as the times are given, or for a clock of its own as found.
            let delay = if self.options.clock == Clock::Scene { 0 } else { fit.delay };
            return Some(Placed { delay, known: DelayKnown::Unknown, doubt: fit.doubt });
        }
        let near = fit.delay - STEP..fit.delay + STEP;
        fit.delay = delay::refine(&series.thinned(4000), &|t| self.at(t), near);
        Some(Placed { delay: fit.delay, known: DelayKnown::Estimated, doubt: None })
    }

    fn fit(&self, series: &Series, step: i64) -> Option<Fit> {
        match self.options.clock {
            Clock::Scene => delay::find(&self.grid, series, DELAYS, step),
            Clock::Foreign => {
                let span = self.options.from.0..self.options.until.0;
                let (offset, width) = offset::find(&self.grid, span, series)?;
                let reach = 250_000_000.max(2 * width);
                delay::find(&self.grid, series, offset - reach..offset + reach, step)
            }
        }
    }

    /// Where nothing better is known: the times as given; on a clock of its own the first estimate at the first truth,
    /// which is right of a vehicle at rest and of no other.
    fn fallback(&self, series: &Series) -> Option<i64> {
        match self.options.clock {
            Clock::Scene => Some(0),
            Clock::Foreign if self.grid.is_still() => Some(series.times.first()? - self.options.from.0),
            Clock::Foreign => None,
        }
    }

    fn judged(&self, series: &Series, placed: &Placed) -> Option<Judged> {
        let held = series.times.iter().map(|t| t.saturating_sub(placed.delay)).zip(&series.attitudes);
        let known: Vec<(SimTime, DQuat, DQuat)> =
            held.filter_map(|(t, q)| Some((SimTime(t), *q, self.at(t)?))).collect();
        let heading = match self.options.align {
            Align::None => 0.0,
            Align::Heading => heading_offset(known.iter().map(|(_, q, truth)| *q * truth.conjugate())),
        };
        let row = |&(t, q, truth): &(SimTime, DQuat, DQuat)| {
            let attitude = turned_back(Attitude::from_quat(q), heading);
            Row { t, attitude, error: AttitudeError::between(Attitude::from_quat(truth), attitude) }
        };
        let rows: Vec<Row> = known.iter().map(row).collect();
        if rows.is_empty() {
            return None;
        }
        let of = |part: fn(&AttitudeError) -> f64| {
            let squares: f64 = rows.iter().map(|row| part(&row.error) * part(&row.error)).sum();
            let max = rows.iter().map(|row| part(&row.error).abs()).fold(0.0, f64::max);
            (libm::sqrt(squares / rows.len() as f64).to_degrees(), max.to_degrees())
        };
        let (rms_deg, max_deg) = of(|error| error.total);
        let (inclination_rms_deg, inclination_max_deg) = of(|error| error.inclination);
        let (heading_rms_deg, heading_max_deg) = of(|error| error.heading);
        let is_foreign = self.options.clock == Clock::Foreign;
        let figures = Figures {
            samples: rows.len() as u64,
            rms_deg,
            max_deg,
            inclination_rms_deg,
            inclination_max_deg,
            heading_rms_deg,
            heading_max_deg,
            delay_ms: None,
            delay_known: if is_foreign { DelayKnown::Unknown } else { placed.known },
            delay_doubt: placed.doubt,
            clock_offset_s: is_foreign.then_some(placed.delay as f64 * 1e-9),
            heading_offset_deg: (self.options.align == Align::Heading).then_some(heading.to_degrees()),
            looks: None,
            looks_rms_deg: None,
        };
        Some(Judged { figures, rows })
    }

    /// Names the mistake that explains a large error, if there is one.
    fn look(&self, candidates: Vec<(&'static str, Series)>, figures: &mut Figures) {
        let rms = |series: &Series| {
            let fit = self.fit(series, 5 * STEP).filter(|fit| fit.doubt.is_none());
            let delay = match fit {
                _ if self.is_echoed => 0,
                Some(fit) => fit.delay,
                None => self.fallback(series)?,
            };
            let placed = Placed { delay, known: DelayKnown::Unknown, doubt: None };
            Some(self.judged(series, &placed)?.figures.rms_deg.to_radians())
        };
        let tried: Vec<(&str, f64)> =
            candidates.iter().filter_map(|(name, series)| Some((*name, rms(series)?))).collect();
        let Some(best) = tried.iter().map(|(_, rms)| *rms).reduce(f64::min) else { return };
        if best > BAD || best > SHARE * figures.rms_deg.to_radians() {
            return;
        }
        let alike = tried.iter().filter(|(_, rms)| *rms <= ALIKE.0 * best + ALIKE.1);
        let names: Vec<&str> = alike.map(|(name, _)| *name).take(3).collect();
        figures.looks = Some(names.join(" or "));
        figures.looks_rms_deg = Some(best.to_degrees());
    }
}
