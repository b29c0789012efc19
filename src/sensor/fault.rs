//! Faults of a sensor: temporary misbehaviour, applied after everything else, in the words of PX4's failure injection.
//!
//! A fault acts on the samples of [start, end). Those that withhold samples leave the others on their ticks. Random
//! ones draw from the stream `fault/N/KIND`, N counting the sensor's faults from 0.

use super::{Block, Context, SensorKind, Term};
use crate::keys::{Key, KeyError, Name, Values};
use crate::quantity::{Kind, Sign};
use crate::random::Stream;
use crate::time::{Rate, SimTime};
use glam::DVec3;
use rand::RngExt;
use std::collections::VecDeque;
use std::fmt;
use std::ops::Range;

const SIZE: Name<DVec3> = Name::new("size");
const SHARE: Name<f64> = Name::new("share");
const EVERY: Name<u64> = Name::new("every");
const DELAY: Name<SimTime> = Name::new("delay");

/// What goes wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FaultKind {
    /// No samples.
    Off,
    /// The last reading before it, again and again.
    Stuck,
    /// Uniform random numbers within ± `size`, or ± the range.
    Garbage,
    /// Readings of the opposite sign.
    Wrong,
    /// One sample in `every`.
    Slow,
    /// What was read `delay` earlier, in whole ticks.
    Delayed,
    /// Samples missing at random, a `share` of them.
    Intermittent,
    /// `size` added at random to a `share` of the samples.
    Spike,
    /// `size` added.
    Step,
    /// Added in proportion to time, `size` at its end.
    Ramp,
}

impl FaultKind {
    /// Every kind.
    pub const ALL: [FaultKind; 10] = [
        FaultKind::Off,
        FaultKind::Stuck,
        FaultKind::Garbage,
        FaultKind::Wrong,
        FaultKind::Slow,
        FaultKind::Delayed,
        FaultKind::Intermittent,
        FaultKind::Spike,
        FaultKind::Step,
        FaultKind::Ramp,
    ];

    /// As scenes write it.
    pub const fn name(self) -> &'static str {
        ["off", "stuck", "garbage", "wrong", "slow", "delayed", "intermittent", "spike", "step", "ramp"]
            [self as usize]
    }

    /// Its keys besides `sensor`, `kind`, `start` and `duration`.
    pub fn keys(self, sensor: SensorKind) -> Vec<Key> {
        let size = SIZE.body_vector(sensor.units().reading, "of what is added, or its bound");
        let size = sensor.turned(size);
        let share = |default, about| SHARE.scalar(Kind::RATIO.signed(Sign::NonNegative), about).or(default);
        match self {
            FaultKind::Off | FaultKind::Stuck | FaultKind::Wrong => vec![],
            FaultKind::Slow => vec![EVERY.whole(2, 1_000_000, "one sample in this many").or("10")],
            FaultKind::Delayed => vec![DELAY.duration("how old a reading is")],
            FaultKind::Intermittent => vec![share("50 %", "of the samples is missing")],
            FaultKind::Spike => vec![size, share("1 %", "of the samples has one")],
            FaultKind::Garbage | FaultKind::Step | FaultKind::Ramp => vec![size],
        }
    }
}

/// A fault of a sensor.
#[derive(Clone, Debug)]
pub struct Fault {
    /// What goes wrong.
    pub kind: FaultKind,
    /// From when on.
    pub start: SimTime,
    /// Until when.
    pub end: SimTime,
    /// The values of its kind's keys.
    pub values: Values,
}

impl fmt::Display for Fault {
    /// `stuck from 2 s to 3 s`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} from {}", self.kind.name(), self.start)?;
        if self.end < SimTime::FOREVER { write!(f, " to {}", self.end) } else { Ok(()) }
    }
}

impl Fault {
    /// Whether a value is lacking or cannot be; `range` is the sensor's.
    ///
    /// # Errors
    /// The key and what would be right.
    pub fn check(&self, sensor: SensorKind, range: Option<f64>) -> Result<(), KeyError> {
        let (kind, values) = (self.kind.name(), &self.values);
        let example = sensor.units().reading.example();
        match self.kind {
            FaultKind::Spike | FaultKind::Step | FaultKind::Ramp if !values.has(SIZE) => {
                Err(KeyError::new(SIZE, format!("a {kind} needs its size, such as size = \"{example}\"")))
            }
            FaultKind::Garbage if !values.has(SIZE) && range.is_none() => {
                let message =
                    format!("garbage needs a size, such as \"{example}\", because the sensor has no range");
                Err(KeyError::new(SIZE, message))
            }
            FaultKind::Delayed if !values.has(DELAY) => {
                Err(KeyError::new(DELAY, "a delayed sensor needs its delay, such as delay = \"50 ms\""))
            }
            FaultKind::Ramp if self.end == SimTime::FOREVER => {
                Err(KeyError::new("duration", "a ramp needs its duration: it reaches its size at the end"))
            }
            _ if values.get(SHARE).is_some_and(|share| share > 1.0) => {
                Err(KeyError::new(SHARE, "a share of the samples is at most 100 %"))
            }
            _ => Ok(()),
        }
    }

    /// At work on a sensor; `index` counts its faults.
    pub(super) fn term(&self, index: usize, range: Option<f64>, context: &Context) -> Box<dyn Term> {
        let before = |t| context.clock.ticks_before(context.phase, t);
        let values = &self.values;
        let late = values.get(DELAY).unwrap_or_default().seconds() / context.clock.period();
        Box::new(Faulty {
            kind: self.kind,
            ticks: before(self.start)..before(self.end),
            clock: context.clock,
            phase: context.phase,
            times: [self.start, self.end],
            size: values.get(SIZE).map_or([range.unwrap_or_default(); 3], |size| size.to_array()),
            share: values.get(SHARE).unwrap_or_default(),
            every: values.get(EVERY).unwrap_or(1),
            streams: context.fresh_streams(&format!("fault/{index}/{}", self.kind.name())),
            past: VecDeque::new(),
            kept: if self.kind == FaultKind::Delayed { libm::round(late) as usize + 1 } else { 2 },
            k: 0,
        })
    }
}

/// Three components, and the velocity that comes with a receiver's.
type Reading = [f64; 6];

struct Faulty {
    kind: FaultKind,
    /// The ticks it acts on.
    ticks: Range<u64>,
    clock: Rate,
    phase: SimTime,
    /// Start and end.
    times: [SimTime; 2],
    size: [f64; 3],
    share: f64,
    every: u64,
    streams: [Stream; 3],
    /// The newest readings as they would be without it, the oldest first, and how many are kept.
    past: VecDeque<Reading>,
    kept: usize,
    k: u64,
}

impl Term for Faulty {
    #[inline(always)]
    fn apply(&mut self, block: &mut Block) {
        for i in 0..block.len() {
            let k = self.k + i as u64;
            let reading = at(block, i);
            if self.kind == FaultKind::Delayed || (self.kind == FaultKind::Stuck && !self.is_stuck(k)) {
                self.past.push_back(reading);
                if self.past.len() > self.kept {
                    self.past.pop_front();
                }
            }
            if !self.ticks.contains(&k) {
                continue;
            }
            match self.faulty(k, reading) {
                Some(faulty) => {
                    for (column, value) in block.reading.iter_mut().zip(faulty) {
                        column[i] = value;
                    }
                    for (column, value) in block.velocity.iter_mut().zip(&faulty[3..]) {
                        column.get_mut(i).into_iter().for_each(|velocity| *velocity = *value);
                    }
                }
                None => {
                    block.missing.resize(block.truth[0].len(), false);
                    block.missing[i] = true;
                }
            }
        }
        self.k += block.len() as u64;
    }
}

fn at(block: &Block, i: usize) -> Reading {
    let [x, y, z] = [0, 1, 2].map(|axis| block.reading[axis][i]);
    let [vx, vy, vz] = [0, 1, 2].map(|axis| block.velocity[axis].get(i).copied().unwrap_or(0.0));
    [x, y, z, vx, vy, vz]
}

impl Faulty {
    /// Whether the reading to be repeated is there already.
    fn is_stuck(&self, k: u64) -> bool {
        k >= self.ticks.start && !self.past.is_empty()
    }

    /// What is read at tick k instead; nothing where there is no sample.
    fn faulty(&mut self, k: u64, reading: Reading) -> Option<Reading> {
        let mut draw = |axis: usize| self.streams[axis].random::<f64>();
        let [x, y, z, velocity @ ..] = reading;
        let with = |[x, y, z]: [f64; 3]| [x, y, z, velocity[0], velocity[1], velocity[2]];
        let plus = |times: f64| {
            let [a, b, c] = self.size.map(|size| times * size);
            with([x + a, y + b, z + c])
        };
        Some(match self.kind {
            FaultKind::Off => return None,
            FaultKind::Slow => return (k - self.ticks.start).is_multiple_of(self.every).then_some(reading),
            FaultKind::Intermittent => return (draw(0) >= self.share).then_some(reading),
            FaultKind::Stuck => *self.past.back()?,
            FaultKind::Delayed => *self.past.front()?,
            FaultKind::Garbage => with([0, 1, 2].map(|axis| self.size[axis] * (2.0 * draw(axis) - 1.0))),
            FaultKind::Wrong => reading.map(|x| -x),
            FaultKind::Spike if draw(0) < self.share => plus(1.0),
            FaultKind::Spike => reading,
            FaultKind::Step => plus(1.0),
            FaultKind::Ramp => {
                let [start, end] = self.times;
                let t = self.phase + self.clock.tick(k);
                plus((t - start).seconds() / (end - start).seconds())
            }
        })
    }
}
