//! The part's temperature: constant, or warming up by its own heat.
//!
//! `T(t) = ambient + rise·(1 − e^(−t/τ))` from the scene's start: the step response of one thermal mass (Newton's law
//! of cooling). Coefficients count from 25 °C, at which datasheets hold.

use super::strides::{STRIDE, strides};
use super::{Block, Context, Kinds, Stage, Term, TermKind};
use crate::keys::{Key, KeyError, Name, Values};
use crate::quantity::{Kind, Sign};
use crate::time::{Rate, SimTime};

/// Where temperature coefficients count from, and what packets report of a sensor without a temperature, °C.
pub const REFERENCE: f64 = 25.0;

/// The part's temperature, a table of its own.
pub const TEMPERATURE: Name<Values> = Name::new("temperature");
const AMBIENT: Name<f64> = Name::new("ambient");
const RISE: Name<f64> = Name::new("rise");
const TIME_CONSTANT: Name<f64> = Name::new("time_constant");

static KEYS: [Key; 3] = [
    AMBIENT.scalar(Kind::TEMPERATURE, "at the start").or("25 degC"),
    RISE.scalar(Kind::TEMPERATURE_DIFFERENCE, "the total temperature rise").or("0 K"),
    TIME_CONSTANT.scalar(Kind::TIME.signed(Sign::Positive), "after which all but 1/e of the rise is done"),
];

pub(super) static KIND: TermKind = TermKind {
    name: "temperature",
    about: "the part's temperature: its coefficients use it and its packets report it",
    serves: Kinds::BY_COMPONENT,
    stage: Stage::Signal,
    needs: &[],
    keys: |_| {
        vec![TEMPERATURE.table(
            &KEYS,
            Some(AMBIENT.name()),
            "\"35 degC\", or { ambient = \"25 degC\", rise = \"15 K\", time_constant = \"60 s\" } for a part that warms up",
            "the part's temperature (default 25 degC)",
        )]
    },
    build: |values, context| {
        let Some(given) = values.get(TEMPERATURE) else { return Ok(None) };
        let ambient = given.get(AMBIENT).unwrap_or(REFERENCE);
        let (rise, tau) = (given.get(RISE).unwrap_or_default(), given.get(TIME_CONSTANT));
        if rise != 0.0 && tau.is_none() {
            let message = "a rise also needs a `time_constant`, such as \"60 s\"";
            return Err(KeyError::new(TEMPERATURE, message));
        }
        Ok(Some(Box::new(Warming::new(ambient, rise, tau.unwrap_or(1.0), context))))
    },
};

struct Warming {
    /// At the end.
    warm: f64,
    rise: f64,
    /// 1/s.
    rate: f64,
    ticks: Rate,
    phase: SimTime,
    /// e^(−j·dt/τ).
    decays: [f64; STRIDE],
    k: u64,
}

impl Warming {
    fn new(ambient: f64, rise: f64, tau: f64, context: &Context) -> Warming {
        let step = context.clock.period() / tau;
        Warming {
            warm: ambient + rise,
            rise,
            rate: 1.0 / tau,
            ticks: context.clock,
            phase: context.phase,
            decays: std::array::from_fn(|j| libm::exp(-(j as f64) * step)),
            k: 0,
        }
    }
}

impl Term for Warming {
    #[inline(always)]
    fn apply(&mut self, block: &mut Block) {
        let n = block.len();
        if self.rise == 0.0 {
            block.temperature.resize(n, self.warm);
        } else {
            for stride in strides(self.k, n) {
                let t = (self.phase + self.ticks.tick(stride.anchor)).seconds();
                let missing = self.rise * libm::exp(-t * self.rate);
                let decays = &self.decays[stride.offset..][..stride.samples.len()];
                block.temperature.extend(decays.iter().map(|decay| self.warm - missing * decay));
            }
        }
        self.k += n as u64;
    }
}
