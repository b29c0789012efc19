//! What a part reads: the truth with the errors the scene switches on, and no others.
//!
//! Each error is a [`Term`] in a file of its own; a sensor is compiled to the list of terms its scene uses, so a
//! term that is absent costs nothing. The chain is truth → what disturbs the signal → biases →
//! white noise → range → resolution → reading.
//! To add a term: one file beside this one and one line in [`TERMS`].
//!
//! ```
//! use ratetable::{scene::Builder, sensor::SensorKind};
//!
//! let plan = Builder::new("still")
//!     .set("duration", "1 s")
//!     .sensor(SensorKind::Gyro, &[("rate", "1 kHz"), ("noise_density", "0.01 deg/s/rtHz"), ("range", "500 deg/s")])
//!     .build()?;
//! assert_eq!(plan.build(&plan.sensors[0]).terms(), ["white_noise", "range"]);
//! # Ok::<(), ratetable::scene::SceneError>(())
//! ```

mod bias;
mod bias_instability;
mod bias_temperature;
mod bias_walk;
pub mod block;
mod clock_error;
mod converter;
mod delay;
pub mod fault;
mod filter;
mod flicker;
mod g_sensitivity;
mod hard_iron;
mod kind;
mod kinds;
mod lever_arm;
mod linear;
mod matrix;
pub mod mount;
mod nonlinearity;
pub mod parts;
mod range;
mod reading;
mod resolution;
mod scale_temperature;
pub mod setting;
mod soft_iron;
mod strides;
mod temperature;
mod units;
mod vibration;
mod wander;
pub mod white_noise;

pub use bias::{BIAS, settle as settle_bias};
pub use bias_instability::{BIAS_INSTABILITY, BIAS_INSTABILITY_START, CORRELATION_TIME, is_flicker};
pub use bias_walk::{BIAS_RANDOM_WALK, BIAS_STEP_STD, step as bias_step};
pub use block::{Block, Column};
pub use clock_error::{clock, jitter};
pub use converter::{RANGE, limits, lsb};
pub use delay::delay;
pub use fault::{Fault, FaultKind};
pub use filter::{FILTER, LOW_PASS};
pub use g_sensitivity::G_SENSITIVITY;
pub use hard_iron::HARD_IRON;
pub use kind::{Air, ByKind, Claims, Derived, InAir, Row, Senses, SensorKind, Shape, Shown, Table};
pub use kinds::Kinds;
pub use lever_arm::{at_arm, lever_arm};
pub use matrix::matrix;
pub use mount::Mount;
pub use nonlinearity::NONLINEARITY;
pub use reading::{Fix, Measured, Measurement, Position, Reading};
pub use setting::{Segment, Setting};
pub use temperature::{REFERENCE as REFERENCE_TEMPERATURE, TEMPERATURE};
pub use units::Units;
pub use vibration::VIBRATION;

use crate::keys::{Key, KeyError, Values};
use crate::os;
use crate::random::{self, Normals, Stream};
use crate::time::{Rate, SimTime};
use glam::DVec3;

/// How a reading samples the truth.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sampling {
    /// The truth at the tick, as in the paper.
    #[default]
    Point,
    /// The mean over the interval that ends at the tick: what an integrating sensor sees.
    Average,
}

/// A sensor as a scene asks for it.
#[derive(Clone, Debug)]
pub struct SensorPlan {
    /// What is sensed.
    pub kind: SensorKind,
    /// Output data rate.
    pub rate: Rate,
    /// When tick 0 is due.
    pub phase: SimTime,
    /// Point or average.
    pub sampling: Sampling,
    /// From body to chip axes; `None` where the scene says nothing, so that a protocol may use its own default.
    pub mount: Option<Mount>,
    /// The part it imitates, by the name of its data file.
    pub part: Option<&'static str>,
    /// Where its chip answers on a bus, 7 bits; `None` is the chip's usual address.
    pub address: Option<u8>,
    /// The values of its error terms' keys.
    pub values: Values,
    /// What it does wrong for a while, in the order written.
    pub faults: Vec<Fault>,
    /// What it is set to while the scene plays, in order of time.
    pub settings: Vec<Setting>,
    /// How often it has been set since its first tick: its noise goes on with other random numbers each time.
    pub epoch: u32,
}

impl SensorPlan {
    /// Its rate as its own oscillator has it: what its ticks follow.
    pub fn clock(&self) -> Rate {
        clock(&self.values, self.rate).unwrap_or(self.rate)
    }

    /// What its error terms are built from.
    pub fn context(&self, seed: u64) -> Context {
        let mount = self.mount.unwrap_or_default();
        Context {
            sensor: self.kind,
            rate: self.rate,
            clock: self.clock(),
            phase: self.phase,
            sampling: self.sampling,
            mount,
            seed,
            epoch: self.epoch,
        }
    }
}

/// What an error term is built from, besides its keys.
#[derive(Clone, Copy, Debug)]
pub struct Context {
    /// Whose term it is.
    pub sensor: SensorKind,
    /// The sensor's output data rate, of which its statistics are.
    pub rate: Rate,
    /// The rate as its own oscillator has it, which its ticks follow.
    pub clock: Rate,
    /// When tick 0 is due.
    pub phase: SimTime,
    /// Point or average.
    pub sampling: Sampling,
    /// From body to chip axes.
    pub mount: Mount,
    /// The scene's seed.
    pub seed: u64,
    /// How often the sensor has been set to something else.
    pub epoch: u32,
}

impl Context {
    /// The three streams of the term called `term`.
    pub fn streams(&self, term: &str) -> [Stream; 3] {
        random::axes(self.seed, &format!("{}/{term}", self.sensor))
    }

    /// The same, new after each setting of the sensor.
    pub fn fresh_streams(&self, term: &str) -> [Stream; 3] {
        random::axes(self.seed, &self.fresh(term))
    }

    /// Normal numbers of those streams, on the axes on which `size` is not zero.
    pub fn normals(&self, term: &str, size: DVec3) -> Normals {
        let wanted = size.to_array().map(|size| size != 0.0);
        random::normals(self.seed, &self.fresh(term), wanted)
    }

    fn fresh(&self, term: &str) -> String {
        match self.epoch {
            0 => format!("{}/{term}", self.sensor),
            epoch => format!("{}/{term}#{epoch}", self.sensor),
        }
    }
}

/// One error of one sensor, applied to its samples in order; what it does never depends on where blocks begin.
pub trait Term: Send {
    /// Changes the bias or the reading of every sample of the block. Marked `#[inline(always)]`, and so all that it
    /// calls a sample, for [`Term::act`] to compile it for wider vectors.
    fn apply(&mut self, block: &mut Block);

    /// The same with the widest vectors of this processor.
    fn act(&mut self, block: &mut Block) {
        os::widest(
            #[inline(always)]
            || self.apply(block),
        );
    }

    /// Normal numbers that it draws for each sample.
    fn normals(&self) -> usize {
        0
    }

    /// What a sensor that is set to something else goes on with: the bias where it has wandered to.
    fn state(&self) -> Vec<DVec3> {
        Vec::new()
    }

    /// Goes on with such a state.
    fn resume(&mut self, _state: &[DVec3]) {}
}

/// Where in the chain a term acts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Changes the reading before there is a bias in it: what reaches the sensing element, and how it answers.
    Signal,
    /// Adds to the bias.
    Bias,
    /// Changes the reading, bias included.
    Reading,
}

/// What a builder makes of a term's values: nothing, when the scene does not use it.
pub type Built = Result<Option<Box<dyn Term>>, KeyError>;

/// An error term: its name, its keys and how to build it.
pub struct TermKind {
    /// As `check` and the docs call it; also the name of its streams.
    pub name: &'static str,
    /// One line for the docs.
    pub about: &'static str,
    /// Which kinds of sensor can have it.
    pub serves: Kinds,
    /// Where it acts.
    pub stage: Stage,
    /// What it needs of the truth besides the error-free reading.
    pub needs: &'static [Column],
    /// Its keys for a sensor.
    pub keys: fn(SensorKind) -> Vec<Key>,
    /// From values to a term.
    pub build: fn(&Values, &Context) -> Built,
}

/// Every error term, in the order of the chain.
pub static TERMS: [&TermKind; 21] = [
    &temperature::KIND,
    &clock_error::KIND,
    &delay::KIND,
    &lever_arm::KIND,
    &soft_iron::KIND,
    &hard_iron::KIND,
    &filter::KIND,
    &vibration::KIND,
    &matrix::KIND,
    &scale_temperature::KIND,
    &nonlinearity::KIND,
    &bias::KIND,
    &bias_instability::KIND,
    &flicker::KIND,
    &bias_walk::KIND,
    &bias_temperature::KIND,
    &g_sensitivity::KIND,
    &white_noise::KIND,
    &kind::VELOCITY_NOISE,
    &range::KIND,
    &resolution::KIND,
];

/// Every key of a sensor: its error terms', then its kind's own.
pub fn keys(sensor: SensorKind) -> Vec<Key> {
    let terms = TERMS.iter().filter(|term| term.serves.contains(sensor));
    let keys = terms.flat_map(|term| (term.keys)(sensor)).map(|key| sensor.turned(key));
    keys.chain((sensor.row().keys)()).collect()
}

/// Everything wrong with a plan's values.
pub fn check(plan: &SensorPlan, seed: u64) -> Vec<KeyError> {
    TERMS.iter().filter_map(|term| (term.build)(&plan.values, &plan.context(seed)).err()).collect()
}

/// What every fault is called among the terms.
const FAULT: &str = "fault";

/// A sensor at work: the terms its scene uses.
#[derive(Default)]
pub struct Sensor {
    signals: Vec<Box<dyn Term>>,
    biases: Vec<Box<dyn Term>>,
    readings: Vec<Box<dyn Term>>,
    names: Vec<&'static str>,
    bias_names: Vec<&'static str>,
    needs: Vec<Column>,
}

impl Sensor {
    /// Compiles a plan; `seed` is the scene's.
    ///
    /// # Errors
    /// The key whose value cannot be, and what would be right.
    pub fn new(plan: &SensorPlan, seed: u64) -> Result<Sensor, KeyError> {
        Sensor::without(plan, seed, &[])
    }

    /// Compiles a plan but for the terms called so; every other draws the numbers that it draws beside them.
    ///
    /// # Errors
    /// As [`Sensor::new`].
    pub fn without(plan: &SensorPlan, seed: u64, left_out: &[&str]) -> Result<Sensor, KeyError> {
        let mut sensor = Sensor::default();
        for kind in TERMS.into_iter().filter(|kind| !left_out.contains(&kind.name)) {
            if let Some(term) = (kind.build)(&plan.values, &plan.context(seed))? {
                sensor.names.push(kind.name);
                sensor.needs.extend(kind.needs);
                match kind.stage {
                    Stage::Signal => sensor.signals.push(term),
                    Stage::Bias => {
                        sensor.bias_names.push(kind.name);
                        sensor.biases.push(term);
                    }
                    Stage::Reading => sensor.readings.push(term),
                }
            }
        }
        let faults = plan.faults.iter().filter(|_| !left_out.contains(&FAULT)).enumerate();
        for (index, fault) in faults {
            sensor.names.push(FAULT);
            let range = plan.values.get(RANGE);
            sensor.readings.push(fault.term(index, range, &plan.context(seed)));
        }
        Ok(sensor)
    }

    /// The names of its terms, in order.
    pub fn terms(&self) -> &[&'static str] {
        &self.names
    }

    /// Normal numbers that its terms draw for each sample.
    pub fn normals(&self) -> usize {
        self.signals.iter().chain(&self.biases).chain(&self.readings).map(|term| term.normals()).sum()
    }

    /// Goes on where the same sensor was, which has been set to something else.
    pub fn resume(&mut self, before: &Sensor) {
        // Only biases have a state that a setting leaves.
        let states = |sensor: &Sensor| sensor.biases.iter().map(|term| term.state()).collect::<Vec<_>>();
        if self.bias_names == before.bias_names {
            let states = states(before);
            self.biases.iter_mut().zip(&states).for_each(|(term, state)| term.resume(state));
        }
    }

    /// Whether a term needs this of the truth.
    pub fn needs(&self, column: Column) -> bool {
        self.needs.contains(&column)
    }

    /// Fills bias, reading and clipped of a block whose truth is given; blocks come in order of time.
    pub fn read(&mut self, block: &mut Block) {
        let n = block.len();
        block.clipped.clear();
        block.clipped.resize(n, false);
        block.temperature.clear();
        block.missing.clear();
        for (reading, truth) in block.reading.iter_mut().zip(&block.truth) {
            reading.clear();
            reading.extend_from_slice(truth);
        }
        for term in &mut self.signals {
            term.act(block);
        }
        for bias in &mut block.bias {
            bias.clear();
            bias.resize(n, 0.0);
        }
        for term in &mut self.biases {
            term.act(block);
        }
        if !self.biases.is_empty() {
            for (reading, bias) in block.reading.iter_mut().zip(&block.bias) {
                reading.iter_mut().zip(bias).for_each(|(reading, bias)| *reading += bias);
            }
        }
        for term in &mut self.readings {
            term.act(block);
        }
    }
}

#[cfg(test)]
mod dynamics_tests;
#[cfg(test)]
mod fault_tests;
#[cfg(test)]
mod parts_tests;
#[cfg(test)]
mod signal_tests;
#[cfg(test)]
mod tests;
