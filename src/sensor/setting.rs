//! What a sensor is set to while a scene plays: another rate, range or filter, as a driver sets a chip.
//!
//! A setting holds from the sensor's first tick at or after its start. That tick is tick 0 of the new rate.

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
    /// When tick 0 is due; while it takes no samples, since when.
    pub from: SimTime,
    /// The rate of its ticks; `None` while it takes no samples.
    pub clock: Option<Rate>,
    /// The sensor as it is then.
    pub plan: SensorPlan,
}

impl Segment {
    /// The first tick at or after `t`; `t` itself where there are no ticks.
    fn tick_from(&self, t: SimTime) -> SimTime {
        let next = |clock: Rate| self.from + clock.tick(clock.ticks_before(self.from, t));
        self.clock.map_or(t, next).max(self.from)
    }

    /// Its ticks before `end`.
    fn ticks_before(&self, end: SimTime) -> u64 {
        self.clock.map_or(0, |clock| clock.ticks_before(self.from, end))
    }

    /// The sensor as it is after a setting: the state of its random numbers is `epoch`.
    pub fn then(&self, setting: &Setting) -> Segment {
        let from = self.tick_from(setting.start);
        // Before its first tick nothing has been drawn.
        let epoch = self.plan.epoch + u32::from(self.ticks_before(from) > 0);
        let plan = SensorPlan {
            rate: setting.rate.unwrap_or(self.plan.rate),
            phase: from,
            values: setting.values.clone(),
            settings: Vec::new(),
            epoch,
            ..self.plan.clone()
        };
        let clock = setting.rate.map(|rate| clock(&plan.values, rate).unwrap_or(rate));
        Segment { from, clock, plan }
    }
}

impl SensorPlan {
    /// The sensor before its first setting.
    pub fn first(&self) -> Segment {
        let plan = SensorPlan { settings: Vec::new(), ..self.clone() };
        Segment { from: self.phase, clock: Some(self.clock()), plan }
    }

    /// The sensor between its settings, in order of time; those without a tick are left out, but for the last.
    pub fn segments(&self) -> Vec<Segment> {
        let mut all = vec![self.first()];
        for setting in &self.settings {
            push(&mut all, setting);
        }
        all
    }

    /// Whether all of its ticks are also the other's.
    pub fn ticks_with(&self, other: &SensorPlan) -> bool {
        let ticks =
            |plan: &SensorPlan| plan.segments().iter().map(|it| (it.from, it.clock)).collect::<Vec<_>>();
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
                Some(clock) if left < count || i == last => return segment.from + clock.tick(left),
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

/// Goes on with a setting; the segment before goes if no tick of it is left.
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
