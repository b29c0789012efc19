//! The sensor's own oscillator: it runs fast or slow, so that its ticks drift against the host's clock, and a sample
//! is taken a little before or after its tick.
//!
//! At an offset e the rate is `rate·(1 + e)`, exactly: tick k is due at `k/(rate·(1 + e))`. With a jitter σ a sample is
//! taken at its tick plus σ·n, within ±0.4 periods, while its time stays the tick's: white phase noise of the clock
//! (IEEE Std 1139).

use super::{Block, Column, Kinds, Stage, Term, TermKind};
use crate::keys::{Key, KeyError, Name, Values};
use crate::quantity::{Kind, Sign};
use crate::time::Rate;

const CLOCK_ERROR: Name<Values> = Name::new("clock_error");
const OFFSET: Name<f64> = Name::new("offset");
const JITTER: Name<f64> = Name::new("jitter");

static KEYS: [Key; 2] = [
    OFFSET.scalar(Kind::RATIO, "how much it runs fast").or("0"),
    JITTER.scalar(Kind::TIME.signed(Sign::NonNegative), "standard deviation of the sampling time").or("0"),
];

pub(super) static KIND: TermKind = TermKind {
    name: "clock_error",
    about: "samples are taken a little before or after their ticks",
    serves: Kinds::ALL,
    stage: Stage::Signal,
    needs: &[Column::Late],
    keys: |_| {
        vec![CLOCK_ERROR.table(
            &KEYS,
            Some(OFFSET.name()),
            "\"50 ppm\", or { offset = \"50 ppm\", jitter = \"2 us\" }",
            "error of the sensor's own oscillator: its ticks drift against the host",
        )]
    },
    build: |values, context| {
        if clock(values, context.rate).is_none() {
            let given = own(values, OFFSET) * 100.0;
            let message = format!("an offset of {given} % is too large for a clock: the limit is ±10 %");
            return Err(KeyError::new(CLOCK_ERROR, message));
        }
        Ok((jitter(values) > 0.0).then(|| Box::new(Jitter) as Box<dyn Term>))
    },
};

/// The rate as the sensor's oscillator has it, to 10⁻⁹; `None` for an offset beyond ±10 % or a rate beyond numbers.
pub fn clock(values: &Values, rate: Rate) -> Option<Rate> {
    const BILLION: u64 = 1_000_000_000;
    let offset = own(values, OFFSET);
    let parts = libm::round(offset * BILLION as f64) as i64;
    match parts {
        0 => Some(rate),
        _ if offset.abs() <= 0.1 => rate.times(BILLION.checked_add_signed(parts)?, BILLION),
        _ => None,
    }
}

/// The standard deviation of the sampling time, s.
pub fn jitter(values: &Values) -> f64 {
    own(values, JITTER)
}

/// A number of the table.
fn own(values: &Values, name: Name<f64>) -> f64 {
    values.get(CLOCK_ERROR).and_then(|table| table.get(name)).unwrap_or_default()
}

struct Jitter;

impl Term for Jitter {
    #[inline(always)]
    fn apply(&mut self, block: &mut Block) {
        block.sense_late();
    }
}
