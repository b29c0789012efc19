//! The sensor's own oscillator: it runs fast or slow, so that its ticks drift against the host's clock, and a sample
//! is taken a little before or after its tick.
//!
//! At an offset e the rate is `rate·(1 + e)`, exactly: tick k is due at `k/(rate·(1 + e))`. With a jitter σ a sample is
//! taken at its tick plus σ·n, within ±0.4 periods, while its time stays the tick's: white phase noise of the clock
//! (IEEE Std 1139).

use super::{Block, Column, Kinds, Stage, Term, TermKind};
use crate::keys::{Key, KeyError, Nested, Takes, Values};
use crate::quantity::{Kind, Sign};
use crate::time::Rate;

static KEYS: [Key; 2] = [
    Key {
        name: "offset",
        takes: Takes::Scalar(Kind::RATIO),
        default: Some("0"),
        about: "how much it runs fast",
    },
    Key {
        name: "jitter",
        takes: Takes::Scalar(Kind::TIME.signed(Sign::NonNegative)),
        default: Some("0"),
        about: "standard deviation of the sampling time",
    },
];

pub(super) static KIND: TermKind = TermKind {
    name: "clock_error",
    about: "samples are taken a little before or after their ticks",
    serves: Kinds::ALL,
    stage: Stage::Signal,
    needs: &[Column::Late],
    keys: |_| {
        vec![Key {
            name: "clock_error",
            takes: Takes::Table(Nested {
                keys: &KEYS,
                alone: Some("offset"),
                many: false,
                example: "\"50 ppm\", or { offset = \"50 ppm\", jitter = \"2 us\" }",
            }),
            default: None,
            about: "error of the sensor's own oscillator: its ticks drift against the host",
        }]
    },
    build: |values, context| {
        let given = values.table("clock_error").and_then(|table| table.scalar("offset")).unwrap_or_default();
        if clock(values, context.rate).is_none() {
            let message =
                format!("an offset of {} % is too large for a clock: the limit is ±10 %", given * 100.0);
            return Err(KeyError::new("clock_error", message));
        }
        Ok((jitter(values) > 0.0).then(|| Box::new(Jitter) as Box<dyn Term>))
    },
};

/// The rate as the sensor's oscillator has it, to 10⁻⁹; `None` for an offset beyond ±10 % or a rate beyond numbers.
pub fn clock(values: &Values, rate: Rate) -> Option<Rate> {
    const BILLION: u64 = 1_000_000_000;
    let offset = values.table("clock_error").and_then(|table| table.scalar("offset")).unwrap_or_default();
    let parts = libm::round(offset * BILLION as f64) as i64;
    match parts {
        0 => Some(rate),
        _ if offset.abs() <= 0.1 => rate.times(BILLION.checked_add_signed(parts)?, BILLION),
        _ => None,
    }
}

/// The standard deviation of the sampling time, s.
pub fn jitter(values: &Values) -> f64 {
    values.table("clock_error").and_then(|table| table.scalar("jitter")).unwrap_or_default()
}

struct Jitter;

impl Term for Jitter {
    #[inline(always)]
    fn apply(&mut self, block: &mut Block) {
        block.sense_late();
    }
}
