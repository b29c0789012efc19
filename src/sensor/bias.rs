//! Turn-on bias: fixed, or drawn once a run.

use super::{Block, Stage, Term, TermKind};
use crate::keys::{Key, Takes};
use crate::quantity::Sign;
use glam::DVec3;
use rand_distr::{Distribution, StandardNormal};

pub(super) static KIND: TermKind = TermKind {
    name: "bias",
    about: "turn-on bias: `bias` plus `bias_std` times a normal number drawn once a run",
    stage: Stage::Bias,
    keys: |sensor| {
        let reading = sensor.units().reading;
        vec![
            Key {
                name: "bias",
                takes: Takes::BodyVector(reading),
                default: Some("0"),
                about: "turn-on bias",
            },
            Key {
                name: "bias_std",
                takes: Takes::PerAxis(reading.signed(Sign::NonNegative)),
                default: Some("0"),
                about: "standard deviation of a turn-on bias drawn once a run and added to `bias`",
            },
        ]
    },
    build: |values, context| {
        let mut bias = values.vector("bias").unwrap_or_default();
        let spread = values.vector("bias_std").unwrap_or_default();
        let mut streams = context.streams("bias");
        for axis in 0..3 {
            let draw: f64 = StandardNormal.sample(&mut streams[axis]);
            if spread[axis] != 0.0 {
                bias[axis] += spread[axis] * draw;
            }
        }
        Ok((bias != DVec3::ZERO).then(|| Box::new(Bias(bias)) as Box<dyn Term>))
    },
};

struct Bias(DVec3);

impl Term for Bias {
    fn apply(&mut self, block: &mut Block) {
        for axis in 0..3 {
            block.bias[axis].iter_mut().for_each(|bias| *bias += self.0[axis]);
        }
    }
}
