//! Turns a plan into readings in time order, in blocks: the pure core shared by live runs and datasets.
//!
//! No clock, no I/O, no threads. It evaluates the truth once for each distinct tick; each sensor due then gets its
//! error-free reading from it and makes its own from that. Block boundaries do not change the result.
//!
//! ```
//! use ratetable::{player::{BLOCK, Player}, scene::Plan, time::SimTime};
//!
//! let plan = Plan::load("still", &[])?;
//! let mut readings = 0;
//! Player::new(&plan, SimTime(1_000_000_000), BLOCK).play(|moment| {
//!     readings += moment.readings.len();
//!     Ok::<(), std::convert::Infallible>(())
//! })?;
//! assert!(readings > 0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod feed;

pub use feed::Feed;

use crate::earth::Place;
use crate::geometry::{Body, Nav, Vector};
use crate::keys::KeyError;
use crate::motion::{Trajectory, Truth, TruthColumns, Wants};
use crate::scene::Plan;
use crate::schedule::{Schedule, Ticks};
use crate::sensor::{
    Block, Fix, Measured, Measurement, Position, REFERENCE_TEMPERATURE, Reading, Segment, Senses, Sensor,
    SensorKind, SensorPlan, Setting, Shape,
};
use crate::time::SimTime;
use std::collections::VecDeque;

/// The default number of distinct ticks in a block.
pub const BLOCK: usize = 256;

/// Everything due at one time: the truth and the readings, in the plan's order of sensors.
#[derive(Clone, Copy, Debug)]
pub struct Moment<'a> {
    /// The time.
    pub t: SimTime,
    /// The exact truth at that time.
    pub truth: &'a Truth,
    /// One reading for each due sensor, except those that a fault withholds.
    pub readings: &'a [Reading],
}

/// A block: the truth at every distinct tick, and each sensor's samples.
#[derive(Clone, Copy)]
pub struct Columns<'a> {
    /// At every distinct tick of any sensor; what was not asked for may have no values.
    pub truth: &'a TruthColumns,
    channels: &'a [Channel],
}

impl Columns<'_> {
    /// The samples of one of the plan's sensors.
    pub fn sensor(&self, sensor: usize) -> &Block {
        &self.channels[sensor].block
    }

    /// Each sensor's samples, in the plan's order.
    pub fn sensors(&self) -> impl Iterator<Item = &Block> {
        self.channels.iter().map(|channel| &channel.block)
    }
}

struct Channel {
    kind: SensorKind,
    origin: Place,
    sensor: Sensor,
    block: Block,
    /// Samples in earlier blocks.
    done: u64,
    feed: Feed,
    /// What it is set to now, and later, in order of time, at work.
    now: Segment,
    later: VecDeque<(Segment, Sensor)>,
}

/// Plays a plan.
pub struct Player<'a> {
    trajectory: &'a Trajectory,
    schedule: Schedule,
    channels: Vec<Channel>,
    /// What the sensors need of the truth.
    wants: Wants,
    truth: TruthColumns,
    /// Which sensors are due at each of its times: bit i is set for sensor i.
    due: Vec<u32>,
    block: usize,
    end: SimTime,
    seed: u64,
}

impl<'a> Player<'a> {
    /// Plays `plan` from 0 up to, not including, `end`; after the scene's motions the vehicle holds. `block` is the
    /// number of distinct ticks to compute at a time (at least 1).
    pub fn new(plan: &'a Plan, end: SimTime, block: usize) -> Player<'a> {
        Player::without(plan, end, block, &[])
    }

    /// The same without the error terms named in `left_out`.
    pub fn without(plan: &'a Plan, end: SimTime, block: usize, left_out: &[&str]) -> Player<'a> {
        Player::built(plan, end, block, |sensor| plan.build_without(sensor, left_out))
    }

    /// The same with each sensor as `build` makes it of its plan, such as one sensor without a term that others keep.
    pub fn built(
        plan: &'a Plan,
        end: SimTime,
        block: usize,
        build: impl Fn(&SensorPlan) -> Sensor,
    ) -> Player<'a> {
        let origin = plan.origin();
        let channels = plan.sensors.iter().map(|of| {
            let mut segments = of.segments().into_iter().map(|segment| (build(&segment.plan), segment));
            let (sensor, now) = segments.next().unwrap_or_else(|| (build(of), of.first()));
            let later = segments.map(|(sensor, segment)| (segment, sensor)).collect();
            let feed = Feed::new(&now.plan, origin, plan.seed, &sensor);
            Channel { kind: of.kind, origin, sensor, block: Block::default(), done: 0, feed, now, later }
        });
        let channels: Vec<_> = channels.collect();
        let wants = channels.iter().fold(Wants::NONE, |wants, channel| wants | channel.feed.wants());
        let mut player = Player {
            trajectory: &plan.trajectory,
            schedule: Schedule::new([], end),
            wants,
            channels,
            truth: TruthColumns::default(),
            due: Vec::with_capacity(block),
            block: block.max(1),
            end,
            seed: plan.seed,
        };
        (0..player.channels.len()).for_each(|sensor| player.reschedule(sensor));
        player
    }

    fn reschedule(&mut self, sensor: usize) {
        let Segment { from, phase, clock, .. } = self.channels[sensor].now;
        self.schedule.set(sensor, clock.map(|rate| Ticks { rate, phase }), from);
    }

    /// Sets one of the plan's sensors from the setting's start on, which is not before what was played.
    ///
    /// # Errors
    /// A value that cannot be.
    pub fn set(&mut self, sensor: usize, setting: &Setting) -> Result<(), KeyError> {
        let channel = &mut self.channels[sensor];
        let last = channel.later.back().map_or(&channel.now, |(segment, _)| segment);
        let next = last.then(setting);
        let built = Sensor::new(&next.plan, self.seed)?;
        if channel.later.back().is_some_and(|(last, _)| next.from <= last.from) {
            channel.later.pop_back();
        }
        channel.later.push_back((next, built));
        Ok(())
    }

    /// When the next setting takes effect.
    fn next_setting(&self) -> SimTime {
        let next = self.channels.iter().filter_map(|channel| Some(channel.later.front()?.0.from));
        next.min().unwrap_or(SimTime::FOREVER)
    }

    /// Lets every setting of this time take effect.
    fn take_settings(&mut self, t: SimTime) {
        for sensor in 0..self.channels.len() {
            let origin = self.channels[sensor].origin;
            let channel = &mut self.channels[sensor];
            let Some((now, built)) = channel.later.pop_front_if(|(segment, _)| segment.from == t) else {
                continue;
            };
            let before = std::mem::replace(&mut channel.sensor, built);
            channel.sensor.resume(&before);
            channel.feed.set(Feed::new(&now.plan, origin, self.seed, &channel.sensor));
            channel.now = now;
            self.wants = self.wants | channel.feed.wants();
            self.reschedule(sensor);
        }
    }

    /// Computes the next block of ticks before `until`, with so much of the truth; false where there is none.
    fn next_block(&mut self, wants: Wants, until: SimTime) -> bool {
        for channel in &mut self.channels {
            channel.done += channel.block.len() as u64;
            channel.block.clear();
        }
        loop {
            let setting = self.next_setting();
            self.schedule.fill(self.block, until.min(setting), &mut self.truth.t, &mut self.due);
            if !self.due.is_empty() {
                break;
            }
            if setting >= until.min(self.end) {
                return false;
            }
            self.take_settings(setting);
        }
        self.trajectory.fill(&mut self.truth, self.wants | wants);
        for (i, channel) in self.channels.iter_mut().enumerate() {
            channel.fill(1 << i, &self.due, &self.truth, self.trajectory);
        }
        true
    }

    /// Computes the next block and returns it as columns, one sensor at a time: the fastest way where no order
    /// across sensors is needed. `wants` are the columns of the truth that the caller reads; `None` at the end.
    pub fn play_columns(&mut self, wants: Wants) -> Option<Columns<'_>> {
        self.next_block(wants, SimTime::FOREVER)
            .then_some(Columns { truth: &self.truth, channels: &self.channels })
    }

    /// Computes the next block and passes each of its moments to `each`, in time order; false at the end.
    ///
    /// # Errors
    /// An error of `each` stops the block and is returned.
    pub fn play_block<E>(&mut self, each: impl FnMut(Moment<'_>) -> Result<(), E>) -> Result<bool, E> {
        self.play_block_before(SimTime::FOREVER, each)
    }

    /// The same with the ticks before `until` alone, which may be later at the next call; false where there are no more.
    ///
    /// # Errors
    /// As [`Player::play_block`].
    pub fn play_block_before<E>(
        &mut self,
        until: SimTime,
        mut each: impl FnMut(Moment<'_>) -> Result<(), E>,
    ) -> Result<bool, E> {
        if !self.next_block(Wants::ALL, until) {
            return Ok(false);
        }
        let mut at = [0; 32];
        let mut readings = Vec::with_capacity(self.channels.len());
        for (tick, &due) in self.due.iter().enumerate() {
            readings.clear();
            for (i, channel) in self.channels.iter().enumerate().filter(|(i, _)| due >> i & 1 == 1) {
                if !channel.block.missing.get(at[i]).is_some_and(|&missing| missing) {
                    channel.push_reading(i, at[i], &mut readings);
                }
                at[i] += 1;
            }
            each(Moment { t: self.truth.t[tick], truth: &self.truth.truth(tick), readings: &readings })?;
        }
        Ok(true)
    }

    /// Plays to the end.
    ///
    /// # Errors
    /// An error of `each` stops the playing and is returned.
    pub fn play<E>(&mut self, mut each: impl FnMut(Moment<'_>) -> Result<(), E>) -> Result<(), E> {
        while self.play_block(&mut each)? {}
        Ok(())
    }
}

impl Channel {
    /// Computes the samples of the ticks whose mask in `due` has the bit `mine`.
    fn fill(&mut self, mine: u32, due: &[u32], truth: &TruthColumns, trajectory: &Trajectory) {
        if self.feed.is_plain() {
            self.feed.extend(truth, due, mine, &mut self.block);
        } else {
            for i in (0..due.len()).filter(|&i| due[i] & mine != 0) {
                self.feed.push(truth.t[i], &truth.truth(i), trajectory, &mut self.block);
            }
        }
        self.sensor.read(&mut self.block);
    }

    /// Appends a sample's reading, written in place: a triad fills a third of a reading, and copying all of it took
    /// a tenth of the time for a packet.
    #[inline(always)]
    fn push_reading(&self, sensor: usize, i: usize, readings: &mut Vec<Reading>) {
        let Block { reading, truth, bias, .. } = &self.block;
        let read = |measurement| Reading {
            sensor,
            kind: self.kind,
            k: self.done + i as u64,
            measurement,
            clipped: self.block.clipped[i],
            temperature: self.block.temperature.get(i).copied().unwrap_or(REFERENCE_TEMPERATURE),
        };
        match self.kind.shape() {
            Shape::Triad => {
                let triad =
                    Measured { value: at::<Body>(reading, i), truth: at(truth, i), bias: at(bias, i) };
                readings.push(read(Measurement::Triad(triad)));
            }
            Shape::Pressure => {
                let pressure = Measured { value: reading[0][i], truth: truth[0][i], bias: bias[0][i] };
                readings.push(read(Measurement::Pressure(pressure)));
            }
            Shape::Position => readings.push(read(Measurement::Position(self.position(i)))),
        }
    }

    /// The fix of a receiver at a sample, from metres relative to the origin.
    fn position(&self, i: usize) -> Position {
        let displacement = Measured::<Vector<Nav>> {
            value: at(&self.block.reading, i),
            truth: at(&self.block.truth, i),
            bias: at(&self.block.bias, i),
        };
        let fix = |moved, velocity| Fix { position: self.origin.moved(moved), velocity: at(velocity, i) };
        Position {
            displacement,
            fix: fix(displacement.value, &self.block.velocity),
            true_fix: fix(displacement.truth, &self.block.true_velocity),
        }
    }
}

/// The sample of three columns, in their frame.
fn at<F>(columns: &[Vec<f64>; 3], i: usize) -> Vector<F> {
    Vector::new(columns[0][i], columns[1][i], columns[2][i])
}

/// What an error-free sensor of this kind reads, in its unit; zero for a sensor that needs more than the truth of
/// an instant.
pub fn sensed(kind: SensorKind, truth: &Truth) -> Vector<Body> {
    match kind.row().senses {
        Senses::Rate => truth.rate,
        Senses::Force => truth.force,
        Senses::Field => truth.field,
        Senses::Course | Senses::Air(_) => Vector::ZERO,
    }
}

#[cfg(test)]
mod aids_tests;
#[cfg(test)]
mod settings_tests;
