//! Bias walk: the paper's per-sample step, and the rate random walk of IEEE 952.
//!
//! `b ← b + σ·n` after each sample, with σ = `bias_step_std` (paper: `n_bg`, whatever the rate), or
//! σ = K·√dt with K = `bias_random_walk`, whose growth K·√t does not depend on the rate.

use super::wander::wander;
use super::{Block, Context, Kinds, Stage, Term, TermKind};
use crate::keys::{Key, Takes, Values};
use crate::quantity::Sign;
use crate::random::Normals;
use glam::DVec3;

pub(super) static KIND: TermKind = TermKind {
    name: "bias_walk",
    about: "the bias takes a normal step after each sample",
    serves: Kinds::ALL,
    stage: Stage::Bias,
    needs: &[],
    keys: |sensor| {
        let units = sensor.units();
        vec![
            Key {
                name: "bias_step_std",
                takes: Takes::PerAxis(units.reading.signed(Sign::NonNegative)),
                default: Some("0"),
                about: "standard deviation of the bias's step each sample (the paper's n_b)",
            },
            Key {
                name: "bias_random_walk",
                takes: Takes::PerAxis(units.bias_walk),
                default: Some("0"),
                about: "IEEE 952 rate random walk K: the bias grows as K·√t at any rate",
            },
        ]
    },
    build: |values, context| {
        let step = step(values, context);
        Ok((step != DVec3::ZERO).then(|| {
            let normals = context.normals("bias_walk", step);
            Box::new(Walk { step, bias: DVec3::ZERO, normals }) as Box<dyn Term>
        }))
    },
};

/// The σ of one step, per axis, in the reading's unit; the two independent walks add in variance.
pub fn step(values: &Values, context: &Context) -> DVec3 {
    let per_sample = values.vector("bias_step_std").unwrap_or_default();
    let per_root_second =
        values.vector("bias_random_walk").unwrap_or_default() * libm::sqrt(context.rate.period());
    DVec3::from_array([0, 1, 2].map(|axis| libm::hypot(per_sample[axis], per_root_second[axis])))
}

struct Walk {
    step: DVec3,
    bias: DVec3,
    normals: Normals,
}

impl Term for Walk {
    #[inline(always)]
    fn apply(&mut self, block: &mut Block) {
        let step = self.step.to_array();
        let next = move |axis: usize, walk, n| walk + step[axis] * n;
        self.bias = wander(&mut self.normals, self.bias, &mut block.bias, next);
    }

    fn normals(&self) -> usize {
        self.normals.count()
    }
}
