//! Turn-on bias: fixed, or drawn once per run.

use super::{Block, Context, Kinds, Stage, Term, TermKind};
use crate::keys::{Name, Values};
use crate::quantity::Sign;
use glam::DVec3;

/// The turn-on bias, in body axes and the reading's unit.
pub const BIAS: Name<DVec3> = Name::new("bias");
const BIAS_STD: Name<DVec3> = Name::new("bias_std");

pub(super) static KIND: TermKind = TermKind {
    name: "bias",
    about: "turn-on bias: `bias` plus `bias_std` times a normal random number drawn once per run",
    serves: Kinds::ALL,
    stage: Stage::Bias,
    needs: &[],
    keys: |sensor| {
        let reading = sensor.units().reading;
        vec![
            BIAS.body_vector(reading, "turn-on bias").or("0"),
            BIAS_STD
                .per_axis(
                    reading.signed(Sign::NonNegative),
                    "standard deviation of a turn-on bias drawn once per run and added to `bias`",
                )
                .or("0"),
        ]
    },
    build: |values, _| {
        let bias = values.get(BIAS).unwrap_or_default();
        Ok((bias != DVec3::ZERO).then(|| Box::new(Bias(bias)) as Box<dyn Term>))
    },
};

/// Draws the turn-on bias of a run: `bias` becomes what was drawn, in body axes and the reading's unit, and
/// `bias_std` zero. `None`, with nothing changed, where no spread is given.
pub fn settle(values: &mut Values, context: &Context) -> Option<DVec3> {
    let spread = values.get(BIAS_STD).filter(|spread| *spread != DVec3::ZERO)?;
    let mut bias = values.get(BIAS).unwrap_or_default();
    bias += spread * DVec3::from_array(context.normals("bias", spread).draw());
    values.set(BIAS, bias);
    values.set(BIAS_STD, DVec3::ZERO);
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
