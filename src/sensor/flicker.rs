//! Bias instability with a 1/f spectrum, as IEEE Std 952-1997 (annex C) has it: `S(f) = B²/(2πf)`, two-sided, whose
//! Allan deviation is flat at √(2·ln 2/π)·B = 0.664 B, B = `bias_instability`.
//!
//! Over a stated band it is a sum of Gauss-Markov processes whose correlation times are two to a decade, each of
//! variance B²·ln r/π for a ratio r of neighbours (van der Ziel 1950; Keshner, *1/f noise*, Proc. IEEE 70(3), 1982:
//! one process a decade is within some 5 %). Below the band the spectrum is flat, above it falls as 1/f².

use super::bias_instability::{BIAS_INSTABILITY, FLICKER, is_flicker};
use super::wander::wander;
use super::{Block, Context, Kinds, Stage, Term, TermKind};
use crate::keys::{Key, KeyError, Name, Values};
use crate::quantity::{Kind, Sign};
use crate::random::Normals;
use glam::DVec3;
use std::f64::consts::{PI, TAU};

const HERTZ: Kind = Kind::FREQUENCY.signed(Sign::Positive);

const FLICKER_BAND: Name<Values> = Name::new("flicker_band");
const FROM: Name<f64> = Name::new("from");
const TO: Name<f64> = Name::new("to");

static BAND: [Key; 2] = [
    FROM.scalar(HERTZ, "where the band begins").or("0.0001 Hz"),
    TO.scalar(HERTZ, "where the band ends").or("10 Hz"),
];

pub(super) static KIND: TermKind = TermKind {
    name: "flicker",
    about: "the bias wanders with a 1/f spectrum",
    serves: Kinds::ALL,
    stage: Stage::Bias,
    needs: &[],
    keys: |_| {
        vec![
            FLICKER.flag("whether `bias_instability` is B of a 1/f spectrum, with no correlation time"),
            FLICKER_BAND.table(
                &BAND,
                None,
                "{ from = \"0.0001 Hz\", to = \"10 Hz\" }",
                "over which the spectrum is 1/f",
            ),
        ]
    },
    build: |values, context| {
        let sigma = values.get(BIAS_INSTABILITY).unwrap_or_default();
        if !is_flicker(values) {
            return Ok(None);
        }
        if sigma == DVec3::ZERO {
            return Err(KeyError::new(FLICKER, "needs a `bias_instability` too, such as \"10 deg/h\""));
        }
        let band = values.get(FLICKER_BAND);
        let end = |name, default| band.and_then(|band| band.get(name)).unwrap_or(default);
        let (from, to) = (end(FROM, 1e-4), end(TO, 10.0));
        if from >= to {
            return Err(KeyError::new(FLICKER_BAND, "needs `from` below `to`"));
        }
        Ok(Some(Box::new(Flicker::new(sigma, from, to, context))))
    },
};

/// One Gauss-Markov process on three axes.
struct Process {
    bias: DVec3,
    decay: f64,
    step: DVec3,
    normals: Normals,
}

struct Flicker(Vec<Process>);

impl Flicker {
    fn new(b: DVec3, from: f64, to: f64, context: &Context) -> Flicker {
        let decades = libm::log10(to / from);
        let count = libm::ceil(2.0 * decades).max(1.0) as usize;
        let ratio = libm::pow(to / from, 1.0 / count as f64);
        let sigma = b * libm::sqrt(libm::log(ratio) / PI);
        let process = |i: usize| {
            // In the middle of its share of the band.
            let tau = libm::pow(ratio, i as f64 + 0.5) / (TAU * to);
            let steps = context.rate.period() / tau;
            let mut normals = context.normals(&format!("flicker/{i}"), sigma);
            let start = DVec3::from_array(normals.draw());
            let step = sigma * libm::sqrt(-libm::expm1(-2.0 * steps));
            Process { bias: sigma * start, decay: libm::exp(-steps), step, normals }
        };
        Flicker((0..count).map(process).collect())
    }
}

impl Term for Flicker {
    #[inline(always)]
    fn apply(&mut self, block: &mut Block) {
        for process in &mut self.0 {
            let (decay, step) = (process.decay, process.step.to_array());
            let next = move |axis: usize, bias, n| decay * bias + step[axis] * n;
            process.bias = wander(&mut process.normals, process.bias, &mut block.bias, next);
        }
    }

    fn normals(&self) -> usize {
        self.0.iter().map(|process| process.normals.count()).sum()
    }

    fn state(&self) -> Vec<DVec3> {
        self.0.iter().map(|process| process.bias).collect()
    }

    fn resume(&mut self, state: &[DVec3]) {
        self.0.iter_mut().zip(state).for_each(|(process, bias)| process.bias = *bias);
    }
}
