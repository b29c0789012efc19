//! Scale that changes with temperature: `reading *= 1 + c·(T − 25 °C)`; none for a part whose `temperature` the scene
//! does not give (IEEE Std 952-1997, sec. 5.4: the scale factor's temperature sensitivity).

use super::temperature::TEMPERATURE;
use super::{Block, Kinds, REFERENCE_TEMPERATURE, Stage, Term, TermKind};
use crate::keys::Name;
use crate::quantity::Kind;
use glam::DVec3;

const SCALE_TEMPERATURE: Name<DVec3> = Name::new("scale_temperature");

pub(super) static KIND: TermKind = TermKind {
    name: "scale_temperature",
    about: "scale error in proportion to the temperature's difference from 25 degC",
    serves: Kinds::TRIADS,
    stage: Stage::Signal,
    needs: &[],
    keys: |_| {
        vec![
            SCALE_TEMPERATURE
                .per_axis(
                    Kind::RATIO_PER_KELVIN,
                    "scale error per kelvin from 25 degC: acts where a `temperature` is given",
                )
                .or("0"),
        ]
    },
    build: |values, _| {
        let per_kelvin = values.get(SCALE_TEMPERATURE).unwrap_or_default();
        let used = per_kelvin != DVec3::ZERO && values.has(TEMPERATURE);
        Ok(used.then(|| Box::new(PerKelvin(per_kelvin)) as Box<dyn Term>))
    },
};

struct PerKelvin(DVec3);

impl Term for PerKelvin {
    #[inline(always)]
    fn apply(&mut self, block: &mut Block) {
        for (column, factor) in block.reading.iter_mut().zip(self.0.to_array()) {
            for (reading, temperature) in column.iter_mut().zip(&block.temperature) {
                *reading *= 1.0 + factor * (temperature - REFERENCE_TEMPERATURE);
            }
        }
    }
}
