//! Everything that is shown, from the beginning to now, in bounded memory.

use super::about::{About, Shown, columns};
use super::batch::Told;
use super::board::{Mail, Phase};
use super::end::End;
use super::lateness::{Lateness, Point};
use super::message::{
    Attitudes, Begin, Errors, Late, LateHistogram, Link, More, Notice, Of, Rates, Values, seconds,
};
use super::strip::Strip;
use super::track::{Fix, Track, halve};
use crate::geometry::{Attitude, AttitudeError};
use crate::scene::Plan;
use crate::session::Record;
use crate::time::{NANOS, SimTime};
use std::sync::Arc;

/// Stretches of a strip that are kept.
const KEPT: usize = 2000;
/// Stretches of a strip in one message.
const FRESH: usize = 200;
/// The shortest stretch, ns.
const STRETCH: SimTime = SimTime(NANOS / 100);
/// Between two truths that are drawn, at the least, ns.
const TRUTH: i64 = NANOS / 50;
/// Notices that are kept.
const NOTICES: usize = 1000;

/// What is kept for whoever comes later, and what is new.
#[derive(Debug)]
struct Both<T> {
    kept: T,
    fresh: T,
}

/// Everything that is shown.
pub(super) struct Story {
    pub about: About,
    plan: Option<Arc<Plan>>,
    strips: Vec<Both<Strip>>,
    told: Vec<Both<Track>>,
    late: Vec<Lateness>,
    rates: Vec<Both<Vec<(SimTime, f64)>>>,
    links: Vec<Link>,
    notices: Vec<Notice>,
    /// How many of the notices were shown.
    shown: usize,
    pub phase: Phase,
    /// Scene time now.
    pub t: Option<SimTime>,
    waiting: Option<String>,
    /// Up to when the truth was shown.
    truth: SimTime,
    pub end: Option<End>,
}

impl Story {
    /// Nothing has happened yet; a scene has its plan.
    pub(super) fn new(about: About, plan: Option<Arc<Plan>>) -> Story {
        let mut story = Story {
            plan,
            strips: Vec::new(),
            told: about
                .estimators
                .iter()
                .map(|_| Both { kept: Track::new(KEPT), fresh: Track::new(FRESH) })
                .collect(),
            late: Vec::new(),
            rates: Vec::new(),
            links: Vec::new(),
            notices: Vec::new(),
            shown: 0,
            phase: Phase::default(),
            t: None,
            waiting: None,
            truth: SimTime::ZERO,
            end: None,
            about,
        };
        story.equip();
        story
    }

    /// Room for each sensor.
    fn equip(&mut self) {
        for sensor in &self.about.sensors[self.strips.len()..] {
            let strip = |most| Strip::new(columns(sensor.kind).len(), sensor.has_truth, STRETCH, most);
            self.strips.push(Both { kept: strip(KEPT), fresh: strip(FRESH) });
            self.late.push(Lateness::default());
            self.rates.push(Both { kept: Vec::new(), fresh: Vec::new() });
        }
    }

    /// Takes in what has happened. True where there are sensors that were not there before.
    pub(super) fn take(&mut self, mail: &mut Mail) -> bool {
        (self.phase, self.waiting) = (mail.phase, mail.waiting.take());
        let before = self.t;
        self.t = mail.t.or(before);
        if !mail.links.is_empty() {
            self.links = std::mem::take(&mut mail.links);
        }
        self.notices.append(&mut mail.notices);
        let over = self.notices.len().saturating_sub(NOTICES);
        self.notices.drain(..over);
        self.shown = self.shown.saturating_sub(over);
        let grows = mail.sensors.len() > self.about.sensors.len();
        for (name, kind) in mail.sensors.iter().skip(self.about.sensors.len()) {
            self.about.sensors.push(Shown {
                name: name.clone(),
                kind: *kind,
                rate_hz: None,
                has_truth: false,
            });
        }
        self.equip();
        for heard in &mail.values {
            self.reading(heard.of, heard.t, &heard.values, &[]);
        }
        mail.told.iter().for_each(|told| self.attitude(told));
        if let Some(t) = self.t.filter(|t| Some(*t) != before) {
            mail.rates.iter().enumerate().for_each(|(of, hz)| self.rate(of, t, *hz));
        }
        self.end = mail.end.take().or(self.end.take());
        grows
    }

    /// Takes a reading in; `truth` is empty where it is not known.
    pub(super) fn reading(&mut self, of: usize, t: SimTime, values: &[f64], truth: &[f64]) {
        if let Some(strip) = self.strips.get_mut(of) {
            strip.kept.add(t, values, truth);
            strip.fresh.add(t, values, truth);
        }
    }

    /// Forgets the readings: they are played again.
    pub(super) fn forget_readings(&mut self) {
        for strip in &mut self.strips {
            strip.kept.take();
            strip.fresh.take();
        }
    }

    fn attitude(&mut self, told: &Told) {
        let truth = self.plan.as_ref().map(|plan| plan.trajectory.at(told.t.max(SimTime::ZERO)).attitude);
        let error = truth.map(|truth| AttitudeError::between(truth, told.attitude));
        let fix = Fix { t: told.t, attitude: told.attitude, error };
        if let Some(track) = self.told.get_mut(told.of) {
            track.kept.add(fix);
            track.fresh.add(fix);
        }
    }

    fn rate(&mut self, of: usize, t: SimTime, hz: f64) {
        let Some(rates) = self.rates.get_mut(of) else { return };
        for list in [&mut rates.kept, &mut rates.fresh] {
            list.push((t, hz));
            if list.len() > KEPT {
                halve(list);
            }
        }
    }

    /// Takes in a record of the pacing thread; the scene began at the stream time `starts`.
    pub(super) fn record(&mut self, record: Record, starts: SimTime) {
        let Record::Sample { kind, t, due, sent: Some(sent) } = record else { return };
        if t < starts {
            return;
        }
        let of = self.about.sensors.iter().position(|sensor| sensor.kind == kind);
        if let Some(late) = of.and_then(|of| self.late.get_mut(of)) {
            late.record(t - starts, due, sent);
        }
    }

    /// A sensor's lateness and rate in the last stretch of time that is over.
    pub(super) fn latest(&self, sensor: usize) -> Option<Point> {
        self.late.get(sensor)?.latest()
    }

    /// Each link's counts.
    pub(super) fn links(&self) -> &[Link] {
        &self.links
    }

    /// The first message, in JSON.
    pub(super) fn begin(&self) -> String {
        let thinned = self.strips.iter().map(|strip| &strip.kept).filter(|strip| strip.is_thinned());
        let thinned = thinned.map(|strip| strip.t.len()).max().map(|_| {
            format!("readings are drawn from the least to the greatest of each stretch of time, at most {KEPT} stretches a sensor")
        });
        json(&Begin::of(&self.about, thinned))
    }

    /// Everything up to now, in JSON.
    pub(super) fn so_far(&self) -> String {
        let strips = self.strips.iter().map(|strip| &strip.kept);
        let tracks: Vec<_> = self.told.iter().map(|track| track.kept.with_last()).collect();
        let late: Vec<_> = self.late.iter().map(Lateness::points).collect();
        let rates = self.rates.iter().map(|rates| rates.kept.as_slice());
        let mut more = self.more(strips, &tracks, &late, rates);
        more.truth = self.truth_between(SimTime::ZERO, self.t.unwrap_or_default(), KEPT as i64);
        more.notices = self.notices.clone();
        json(&more)
    }

    /// What is new since the last call, in JSON.
    pub(super) fn news(&mut self) -> String {
        let strips: Vec<_> = self.strips.iter_mut().map(|strip| strip.fresh.take()).collect();
        let tracks: Vec<_> = self.told.iter_mut().map(|track| track.fresh.take()).collect();
        let late: Vec<_> = self.late.iter_mut().map(Lateness::fresh).collect();
        let rates: Vec<_> = self.rates.iter_mut().map(|rates| std::mem::take(&mut rates.fresh)).collect();
        let mut more = self.more(strips.iter(), &tracks, &late, rates.iter().map(Vec::as_slice));
        let now = self.t.unwrap_or_default();
        let from = std::mem::replace(&mut self.truth, now);
        more.truth = (now > from).then(|| self.truth_between(from, now, FRESH as i64 / 4)).flatten();
        more.notices = self.notices[self.shown..].to_vec();
        self.shown = self.notices.len();
        json(&more)
    }

    /// Leaves out what is new: nobody looks.
    pub(super) fn skip_news(&mut self) {
        self.strips.iter_mut().for_each(|strip| drop(strip.fresh.take()));
        self.told.iter_mut().for_each(|track| drop(track.fresh.take()));
        self.late.iter_mut().for_each(|late| drop(late.fresh()));
        self.rates.iter_mut().for_each(|rates| rates.fresh.clear());
        (self.truth, self.shown) = (self.t.unwrap_or_default(), self.notices.len());
    }

    fn more<'s>(
        &self,
        strips: impl Iterator<Item = &'s Strip>,
        tracks: &[Vec<Fix>],
        late: &[Vec<Point>],
        rates: impl Iterator<Item = &'s [(SimTime, f64)]>,
    ) -> More {
        let axes = self.about.axes;
        let readings = self.about.sensors.iter().zip(strips).enumerate();
        let readings = readings.filter(|(_, (_, strip))| !strip.t.is_empty());
        let attitude = |fix: &Fix| -> (SimTime, Attitude) { (fix.t, fix.attitude) };
        let told = tracks.iter().enumerate().filter(|(_, track)| !track.is_empty());
        let paced = late.iter().enumerate().filter(|(_, points)| !points.is_empty());
        let measured = rates.enumerate().filter(|(_, rates)| !rates.is_empty());
        let measured =
            measured.map(|(of, it)| Of { of, what: Rates::of(it.iter().map(|(t, hz)| (*t, Some(*hz)))) });
        let delivered =
            paced.clone().map(|(of, it)| Of { of, what: Rates::of(it.iter().map(|it| (it.t, it.hz))) });
        More {
            kind: "more",
            t: self.t.map(seconds),
            phase: self.phase.name(),
            waiting: self.waiting.clone(),
            truth: None,
            estimates: told
                .clone()
                .map(|(of, it)| Of { of, what: Attitudes::of(axes, it.iter().map(attitude)) })
                .collect(),
            errors: told.filter_map(|(of, it)| Some(Of { of, what: Errors::of(it)? })).collect(),
            readings: readings
                .map(|(of, (sensor, strip))| Of { of, what: Values::of(sensor.kind, strip) })
                .collect(),
            rates: measured.chain(delivered).collect(),
            lateness: paced.map(|(of, it)| Of { of, what: Late::of(it) }).collect(),
            late_histogram: LateHistogram::of(&self.late),
            links: self.links.iter().enumerate().map(|(of, it)| Of { of, what: *it }).collect(),
            notices: Vec::new(),
        }
    }

    /// The truth from `from` up to and at `to`, at so many times at most.
    fn truth_between(&self, from: SimTime, to: SimTime, most: i64) -> Option<Attitudes> {
        let plan = self.plan.as_ref()?;
        let step = TRUTH.max((to - from).0 / most.max(1));
        let count = (to - from).0 / step;
        let times =
            (0..=count).map(|k| SimTime(to.0 - (count - k) * step)).filter(|t| *t > from || count == 0);
        let at = |t: SimTime| (t, plan.trajectory.at(t).attitude);
        Some(Attitudes::of(self.about.axes, times.map(at)))
    }
}

/// A message in JSON.
pub(super) fn json(message: &impl serde::Serialize) -> String {
    // Plain data: it cannot fail.
    serde_json::to_string(message).unwrap_or_default()
}
