//! Turn-on bias: fixed, or drawn once per run.

use super::{Block, Context, Kinds, Stage, Term, TermKind};
use crate::double::Double;
use crate::keys::{Key, Takes, Value, Values};
use crate::quantity::Sign;
use glam::DVec3;

pub(super) static KIND: TermKind = TermKind {
    name: "bias",
    about: "turn-on bias: `bias` plus `bias_std` times a normal random number drawn once per run",
    serves: Kinds::ALL,
    stage: Stage::Bias,
    needs: &[],
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
                about: "standard deviation of a turn-on bias drawn once per run and added to `bias`",
            },
        ]
    },
    build: |values, _| {
        let bias = values.vector("bias").unwrap_or_default();
        Ok((bias != DVec3::ZERO).then(|| Box::new(Bias(bias)) as Box<dyn Term>))
    },
};

/// Draws the turn-on bias of a run: `bias` becomes what was drawn, in body axes and the reading's unit, and
/// `bias_std` zero. `None`, with nothing changed, where no spread is given.
pub fn settle(values: &mut Values, context: &Context) -> Option<DVec3> {
    let spread = values.vector("bias_std").filter(|spread| *spread != DVec3::ZERO)?;
    let mut bias = values.vector("bias").unwrap_or_default();
    bias += spread * DVec3::from_array(context.normals("bias", spread).draw());
    let triple = |v: DVec3| Value::Triple(v.to_array().map(Double::from));
    values.insert("bias", triple(bias));
    values.insert("bias_std", triple(DVec3::ZERO));
    Some(bias)
}

struct Bias(DVec3);

impl Term for Bias {
    #[inline(always)]
    fn apply(&mut self, block: &mut Block) {
        for axis in 0..3 {
            block.bias[axis].iter_mut().for_each(|bias| *bias += self.0[axis]);
        }
    }
}
