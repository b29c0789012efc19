//! Bias walk: the paper's per-sample step, and the rate random walk of IEEE 952.
//!
//! `b ← b + σ·n` after each sample, with σ = `bias_step_std` (paper: `n_bg`, whatever the rate), or
//! σ = K·√dt with K = `bias_random_walk`, whose growth K·√t does not depend on the rate.

use super::wander::wander;
use super::{Block, Context, Kinds, Stage, Term, TermKind};
use crate::keys::{Name, Values};
use crate::quantity::Sign;
use crate::random::Normals;
use glam::DVec3;

/// The standard deviation of a step each sample, per axis, in the reading's unit.
pub const BIAS_STEP_STD: Name<DVec3> = Name::new("bias_step_std");
/// The rate random walk K, per axis, in the reading's unit a √s.
pub const BIAS_RANDOM_WALK: Name<DVec3> = Name::new("bias_random_walk");

pub(super) static KIND: TermKind = TermKind {
    name: "bias_walk",
    about: "the bias takes a normal step after each sample",
    serves: Kinds::ALL,
    stage: Stage::Bias,
    needs: &[],
    keys: |sensor| {
        let units = sensor.units();
        vec![
            BIAS_STEP_STD
                .per_axis(
                    units.reading.signed(Sign::NonNegative),
                    "standard deviation of the bias's step each sample (the paper's n_b)",
                )
                .or("0"),
            BIAS_RANDOM_WALK
                .per_axis(units.bias_walk, "IEEE 952 rate random walk K: the bias grows as K·√t at any rate")
                .or("0"),
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
    let per_sample = values.get(BIAS_STEP_STD).unwrap_or_default();
    let per_root_second =
        values.get(BIAS_RANDOM_WALK).unwrap_or_default() * libm::sqrt(context.rate.period());
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

    fn state(&self) -> Vec<DVec3> {
        vec![self.bias]
    }

    fn resume(&mut self, state: &[DVec3]) {
        state.iter().for_each(|bias| self.bias = *bias);
    }
}
