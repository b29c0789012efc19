//! Bias that changes with temperature: `b += c·(T − 25 °C)`, the first order of IEEE Std 952-1997, sec. 5.4 (its
//! temperature sensitivity); zero for a part whose `temperature` the scene does not give.

use super::temperature::TEMPERATURE;
use super::{Block, Kinds, REFERENCE_TEMPERATURE, Stage, Term, TermKind};
use crate::keys::Name;
use glam::DVec3;

const BIAS_TEMPERATURE: Name<DVec3> = Name::new("bias_temperature");

pub(super) static KIND: TermKind = TermKind {
    name: "bias_temperature",
    about: "bias in proportion to the temperature's difference from 25 degC",
    serves: Kinds::BY_COMPONENT,
    stage: Stage::Bias,
    needs: &[],
    keys: |sensor| {
        let Some(per_kelvin) = sensor.units().per_kelvin else { return vec![] };
        vec![
            BIAS_TEMPERATURE
                .body_vector(per_kelvin, "bias per kelvin from 25 degC: acts where a `temperature` is given")
                .or("0"),
        ]
    },
    build: |values, _| {
        let per_kelvin = values.get(BIAS_TEMPERATURE).unwrap_or_default();
        let used = per_kelvin != DVec3::ZERO && values.has(TEMPERATURE);
        Ok(used.then(|| Box::new(PerKelvin(per_kelvin)) as Box<dyn Term>))
    },
};

struct PerKelvin(DVec3);

impl Term for PerKelvin {
    #[inline(always)]
    fn apply(&mut self, block: &mut Block) {
        for (column, factor) in block.bias.iter_mut().zip(self.0.to_array()) {
            for (bias, temperature) in column.iter_mut().zip(&block.temperature) {
                *bias += factor * (temperature - REFERENCE_TEMPERATURE);
            }
        }
    }
}
