//! Bias instability as a first-order Gauss-Markov process.
//!
//! `b ← e^(−dt/τ)·b + σ·√(1 − e^(−2dt/τ))·n`, the exact discretisation, with stationary σ = `bias_instability` and
//! τ = `correlation_time`, started from its stationary distribution unless asked to start from zero. Its Allan
//! deviation peaks at 0.617 σ, at 1.89 τ (IEEE Std 952-1997, annex C).

use super::wander::wander;
use super::{Block, Kinds, Stage, Term, TermKind, flicker};
use crate::keys::{Key, KeyError, Takes};
use crate::quantity::{Kind, Sign};
use crate::random::Normals;
use glam::DVec3;

pub(super) static KIND: TermKind = TermKind {
    name: "bias_instability",
    about: "the bias wanders as a first-order Gauss-Markov process",
    serves: Kinds::ALL,
    stage: Stage::Bias,
    needs: &[],
    keys: |sensor| {
        let reading = sensor.units().reading;
        vec![
            Key {
                name: "bias_instability",
                takes: Takes::PerAxis(reading.signed(Sign::NonNegative)),
                default: Some("0"),
                about: "stationary standard deviation of the wandering bias; needs `correlation_time`",
            },
            Key {
                name: "correlation_time",
                takes: Takes::PerAxis(Kind::TIME.signed(Sign::NonNegative)),
                default: None,
                about: "time in which the wandering bias decays to 1/e",
            },
            Key {
                name: "bias_instability_start",
                takes: Takes::Word(&["stationary", "zero"]),
                default: Some("stationary"),
                about: "where the wandering bias starts: drawn from its distribution, or at zero",
            },
        ]
    },
    build: |values, context| {
        if flicker::is_on(values) {
            return Ok(None);
        }
        let sigma = values.vector("bias_instability").unwrap_or_default();
        let Some(tau) = values.vector("correlation_time") else {
            return match sigma == DVec3::ZERO {
                true => Ok(None),
                false => Err(KeyError::new(
                    "bias_instability",
                    "needs a `correlation_time` too, such as \"500 s\"; a bias that wanders without bound is `bias_random_walk`",
                )),
            };
        };
        if tau.min_element() <= 0.0 {
            return Err(KeyError::new(
                "correlation_time",
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
            if values.word("bias_instability_start") == Some("zero") { DVec3::ZERO } else { sigma * start };
        Ok(Some(Box::new(GaussMarkov { bias, decay, step: sigma * fresh, normals })))
    },
};

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
}
