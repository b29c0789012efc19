//! What a sensor is set to while a scene plays: another rate, range or filter, as a driver sets a chip.
//!
//! A setting holds from its start on. Whatever its rate, a sensor's ticks are counted from its `phase`: sensors that are set
//! to one rate one after the other tick together, as those of a chip do, which divides one clock.

use super::{SensorPlan, clock};
use crate::keys::Values;
use crate::time::{Rate, SimTime};

/// What a sensor is set to from a time on.
#[derive(Clone, Debug)]
pub struct Setting {
    /// From when.
    pub start: SimTime,
    /// Output data rate; `None` while it takes no samples.
    pub rate: Option<Rate>,
    /// The values of every key of its error terms.
    pub values: Values,
}

/// A sensor between two settings.
#[derive(Clone, Debug)]
pub struct Segment {
    /// Since when; a tick may be due later.
    pub from: SimTime,
    /// From when its ticks are counted: those from `from` on are its own.
    pub phase: SimTime,
    /// The rate of its ticks; `None` while it takes no samples.
    pub clock: Option<Rate>,
    /// The sensor as it is then.
    pub plan: SensorPlan,
}

impl Segment {
    /// Its ticks before `end`.
    fn ticks_before(&self, end: SimTime) -> u64 {
        let count = |clock: Rate| {
            clock.ticks_before(self.phase, end).saturating_sub(clock.ticks_before(self.phase, self.from))
        };
        self.clock.map_or(0, count)
    }

    /// When its tick `k` is due; `from` where there are no ticks.
    fn tick(&self, k: u64) -> SimTime {
        let due = |clock: Rate| self.phase + clock.tick(clock.ticks_before(self.phase, self.from) + k);
        self.clock.map_or(self.from, due)
    }

    /// The sensor as it is after a setting: the state of its random numbers is `epoch`.
    pub fn then(&self, setting: &Setting) -> Segment {
        let from = setting.start.max(self.from);
        // Before its first tick nothing has been drawn.
        let epoch = self.plan.epoch + u32::from(self.ticks_before(from) > 0);
        let mut plan = SensorPlan {
            rate: setting.rate.unwrap_or(self.plan.rate),
            values: setting.values.clone(),
            settings: Vec::new(),
            epoch,
            ..self.plan.clone()
        };
        let clock = setting.rate.map(|rate| clock(&plan.values, rate).unwrap_or(rate));
        let mut next = Segment { from, phase: self.phase, clock, plan: plan.clone() };
        plan.phase = next.tick(0);
        next.plan = plan;
        next
    }
}

impl SensorPlan {
    /// The sensor before its first setting.
    pub fn first(&self) -> Segment {
        let plan = SensorPlan { settings: Vec::new(), ..self.clone() };
        Segment { from: self.phase, phase: self.phase, clock: Some(self.clock()), plan }
    }

    /// The sensor between its settings, in order of time; of two from the same time on, the second.
    pub fn segments(&self) -> Vec<Segment> {
        let mut all = vec![self.first()];
        for setting in &self.settings {
            push(&mut all, setting);
        }
        all
    }

    /// Whether all of its ticks are also the other's.
    pub fn ticks_with(&self, other: &SensorPlan) -> bool {
        let ticks = |plan: &SensorPlan| {
            let all = plan.by_segment(Segment::ticks_before).into_iter().filter(|(count, _)| *count > 0);
            all.map(|(count, it)| (count, it.tick(0), it.phase, it.clock)).collect::<Vec<_>>()
        };
        ticks(self) == ticks(other)
    }

    /// How many of its ticks are due before `end`.
    pub fn ticks_before(&self, end: SimTime) -> u64 {
        self.by_segment(|segment, until| segment.ticks_before(end.min(until)))
            .iter()
            .map(|(count, _)| count)
            .sum()
    }

    /// When tick `k` is due; the last tick's time beyond those that there are.
    pub fn tick(&self, k: u64) -> SimTime {
        let mut left = k;
        let segments = self.by_segment(Segment::ticks_before);
        let last = segments.len() - 1;
        for (i, (count, segment)) in segments.into_iter().enumerate() {
            match segment.clock {
                Some(_) if left < count || i == last => return segment.tick(left),
                _ => left -= count.min(left),
            }
        }
        self.phase
    }

    /// What `count` says of each segment, given when the next one begins.
    fn by_segment(&self, count: impl Fn(&Segment, SimTime) -> u64) -> Vec<(u64, Segment)> {
        if self.settings.is_empty() {
            let first = self.first();
            return vec![(count(&first, SimTime::FOREVER), first)];
        }
        let segments = self.segments();
        let ends = segments.iter().skip(1).map(|segment| segment.from).chain([SimTime::FOREVER]);
        let counts: Vec<_> = segments.iter().zip(ends).map(|(segment, end)| count(segment, end)).collect();
        counts.into_iter().zip(segments).collect()
    }
}

/// Goes on with a setting; the segment before goes if it ends where it begins.
pub fn push(segments: &mut Vec<Segment>, setting: &Setting) {
    let Some(last) = segments.last() else { return };
    let next = last.then(setting);
    let is_idle = next.from <= last.from;
    if is_idle {
        segments.pop();
    }
    segments.push(next);
}

#[cfg(test)]
#[path = "setting_tests.rs"]
mod tests;
