//! A part's low-pass filter on the true signal: of first order, or Butterworth of second.
//!
//! `H(s) = 1/(1 + s/w)` or `1/(1 + √2·s/w + (s/w)²)`, w = 2π·`low_pass`, where the gain is 1/√2 (Oppenheim & Willsky,
//! *Signals and Systems*, 2nd ed., sec. 6.5). It delays what is slow by 1/w or √2/w. Discretised exactly for a signal
//! that is straight from tick to tick (ramp-invariant; Franklin, Powell & Workman, *Digital Control of Dynamic
//! Systems*, 3rd ed., sec. 6.3), so that any cut-off goes with any rate; it starts settled on the first sample.

use super::{Block, Context, Kinds, Stage, Term, TermKind};
use crate::keys::{Key, KeyError, Name, Values};
use crate::quantity::{Kind, Sign};
use std::f64::consts::{SQRT_2, TAU};

/// The filter, a table of its own.
pub const FILTER: Name<Values> = Name::new("filter");
/// Within [`FILTER`]: its cut-off, Hz.
pub const LOW_PASS: Name<f64> = Name::new("low_pass");
const ORDER: Name<u64> = Name::new("order");

static KEYS: [Key; 2] = [
    LOW_PASS.scalar(Kind::FREQUENCY.signed(Sign::Positive), "cut-off: where the gain is 1/√2"),
    ORDER.whole(1, 2, "2 is Butterworth").or("1"),
];

pub(super) static KIND: TermKind = TermKind {
    name: "filter",
    about: "a low-pass filter on the true signal, of first or second order",
    serves: Kinds::BY_COMPONENT,
    stage: Stage::Signal,
    needs: &[],
    keys: |_| {
        vec![FILTER.table(
            &KEYS,
            Some(LOW_PASS.name()),
            "{ low_pass = \"92 Hz\", order = 2 }",
            "low-pass filter on the true signal; noise is given at the output and is not filtered",
        )]
    },
    build: |values, context| {
        let filter = match values.get(FILTER) {
            None => return Ok(None),
            Some(_) => LowPass::of(values).ok_or_else(|| {
                KeyError::new(FILTER, "needs a `low_pass`, such as { low_pass = \"92 Hz\" }")
            })?,
        };
        Ok(Some(Box::new(Filter::new(filter, context))))
    },
};

/// A filter as it is in continuous time.
#[derive(Clone, Copy, Debug)]
pub(super) struct LowPass {
    /// Of the cut-off, rad/s.
    w: f64,
    second_order: bool,
}

impl LowPass {
    /// The filter that a sensor's values ask for.
    pub fn of(values: &Values) -> Option<LowPass> {
        let table = values.get(FILTER)?;
        Some(LowPass { w: TAU * table.get(LOW_PASS)?, second_order: table.get(ORDER) == Some(2) })
    }

    /// Gain and phase (rad) at a frequency, Hz.
    pub fn response(&self, hz: f64) -> (f64, f64) {
        let r = TAU * hz / self.w;
        let (re, im) = if self.second_order { (1.0 - r * r, SQRT_2 * r) } else { (1.0, r) };
        (1.0 / libm::hypot(re, im), -libm::atan2(im, re))
    }
}

/// `x ← Φ·x + now·u + next·u'`, x = (output, its derivative over w); of first order without the second.
struct Filter {
    step: [[f64; 2]; 2],
    now: [f64; 2],
    next: [f64; 2],
    /// For each axis: the state and the signal of the sample before; nothing before the first.
    states: Option<[([f64; 2], f64); 3]>,
}

impl Filter {
    fn new(filter: LowPass, context: &Context) -> Filter {
        let p = filter.w * context.rate.period();
        // What a constant signal, and one that grows to 1 over the tick, leave in the state.
        let (step, constant, ramp) = if filter.second_order {
            let (a, decay) = (p / SQRT_2, libm::exp(-p / SQRT_2));
            let (sine, cosine) = (decay * libm::sin(a), decay * libm::cos(a));
            let step = [[cosine + sine, SQRT_2 * sine], [-SQRT_2 * sine, cosine - sine]];
            let constant = [1.0 - step[0][0], -step[1][0]];
            // Inverse of the system's matrix times (constant/p − input).
            let [y, v] = [constant[0] / p, constant[1] / p - 1.0];
            (step, constant, [-SQRT_2 * y - v, y])
        } else {
            let (decay, constant) = (libm::exp(-p), -libm::expm1(-p));
            ([[decay, 0.0], [0.0, 0.0]], [constant, 0.0], [1.0 - constant / p, 0.0])
        };
        let now = [constant[0] - ramp[0], constant[1] - ramp[1]];
        Filter { step, now, next: ramp, states: None }
    }
}

impl Term for Filter {
    #[inline(always)]
    fn apply(&mut self, block: &mut Block) {
        if block.is_empty() {
            return;
        }
        let settled = || [0, 1, 2].map(|axis: usize| ([block.reading[axis][0], 0.0], block.reading[axis][0]));
        let states = self.states.get_or_insert_with(settled);
        let ([[a, b], [c, d]], [e, f], [g, h]) = (self.step, self.now, self.next);
        for (([y, v], before), column) in states.iter_mut().zip(&mut block.reading) {
            for value in column {
                let (now, output, slope) = (*value, *y, *v);
                *y = a * output + b * slope + e * *before + g * now;
                *v = c * output + d * slope + f * *before + h * now;
                *before = now;
                *value = *y;
            }
        }
    }
}
