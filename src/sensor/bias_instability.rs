//! Bias instability as a first-order Gauss-Markov process.
//!
//! `b ← e^(−dt/τ)·b + σ·√(1 − e^(−2dt/τ))·n`, the exact discretisation, with stationary σ = `bias_instability` and
//! τ = `correlation_time`, started from its stationary distribution unless asked to start from zero. Its Allan
//! deviation peaks at 0.617 σ, at 1.89 τ (IEEE Std 952-1997, annex C).

use super::wander::wander;
use super::{Block, Kinds, Stage, Term, TermKind};
use crate::keys::{KeyError, Name, Values};
use crate::quantity::{Kind, Sign};
use crate::random::Normals;
use glam::DVec3;

/// The stationary standard deviation, or B of a 1/f spectrum, per axis, in the reading's unit.
pub const BIAS_INSTABILITY: Name<DVec3> = Name::new("bias_instability");
/// The time in which it decays to 1/e, per axis, s.
pub const CORRELATION_TIME: Name<DVec3> = Name::new("correlation_time");
/// Whether it is `stationary` at the start, or `zero`.
pub const BIAS_INSTABILITY_START: Name<&str> = Name::new("bias_instability_start");
/// Whether it has a 1/f spectrum instead.
pub(super) const FLICKER: Name<bool> = Name::new("flicker");

pub(super) static KIND: TermKind = TermKind {
    name: "bias_instability",
    about: "the bias wanders as a first-order Gauss-Markov process",
    serves: Kinds::ALL,
    stage: Stage::Bias,
    needs: &[],
    keys: |sensor| {
        let reading = sensor.units().reading;
        vec![
            BIAS_INSTABILITY
                .per_axis(
                    reading.signed(Sign::NonNegative),
                    "stationary standard deviation of the wandering bias; needs `correlation_time`",
                )
                .or("0"),
            CORRELATION_TIME.per_axis(
                Kind::TIME.signed(Sign::NonNegative),
                "time in which the wandering bias decays to 1/e",
            ),
            BIAS_INSTABILITY_START.word(
                &["stationary", "zero"],
                "where the wandering bias starts: drawn from its distribution, or at zero",
            ),
        ]
    },
    build: |values, context| {
        if is_flicker(values) {
            return Ok(None);
        }
        let sigma = values.get(BIAS_INSTABILITY).unwrap_or_default();
        let Some(tau) = values.get(CORRELATION_TIME) else {
            return match sigma == DVec3::ZERO {
                true => Ok(None),
                false => Err(KeyError::new(
                    BIAS_INSTABILITY,
                    "needs a `correlation_time` too, such as \"500 s\"; a bias that wanders without bound is `bias_random_walk`",
                )),
            };
        };
        if tau.min_element() <= 0.0 {
            return Err(KeyError::new(
                CORRELATION_TIME,
                "a correlation time must be above 0; a bias that is new at each sample is white noise, `noise_std`",
            ));
        }
        if sigma == DVec3::ZERO {
            return Ok(None);
        }
        let steps = context.rate.period() / tau;
        let decay = DVec3::from_array(steps.to_array().map(|x| libm::exp(-x)));
        let fresh = DVec3::from_array(steps.to_array().map(|x| libm::sqrt(-libm::expm1(-2.0 * x))));
        let mut normals = context.normals("bias_instability", sigma);
        let start = DVec3::from_array(normals.draw());
        let bias =
            if values.get(BIAS_INSTABILITY_START) == Some("zero") { DVec3::ZERO } else { sigma * start };
        Ok(Some(Box::new(GaussMarkov { bias, decay, step: sigma * fresh, normals })))
    },
};

/// Whether the bias instability has a 1/f spectrum.
pub fn is_flicker(values: &Values) -> bool {
    values.get(FLICKER) == Some(true)
}

struct GaussMarkov {
    bias: DVec3,
    decay: DVec3,
    step: DVec3,
    normals: Normals,
}

impl Term for GaussMarkov {
    #[inline(always)]
    fn apply(&mut self, block: &mut Block) {
        let (decay, step) = (self.decay.to_array(), self.step.to_array());
        let next = move |axis: usize, bias, n| decay[axis] * bias + step[axis] * n;
        self.bias = wander(&mut self.normals, self.bias, &mut block.bias, next);
    }

    fn normals(&self) -> usize {
        self.normals.count()
    }

    fn state(&self) -> Vec<DVec3> {
        vec![self.bias]
    }

    fn resume(&mut self, state: &[DVec3]) {
        state.iter().for_each(|bias| self.bias = *bias);
    }
}
