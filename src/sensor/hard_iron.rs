//! Hard iron: magnetised parts of the vehicle add a field that turns with it: `reading = field + h` (Vasconcelos
//! et al., *Geometric approach to strapdown magnetometer calibration in sensor frame*, IEEE TAES 47(2), 2011, eq. 2).

use super::{Block, Kinds, SensorKind, Stage, Term, TermKind};
use crate::keys::{Key, Takes};
use crate::quantity::Kind;
use glam::DVec3;

pub(super) static KIND: TermKind = TermKind {
    name: "hard_iron",
    about: "a field fixed to the vehicle, after soft iron and before the sensor's own scale",
    serves: Kinds::of(&[SensorKind::Mag]),
    stage: Stage::Signal,
    needs: &[],
    keys: |_| {
        vec![Key {
            name: "hard_iron",
            takes: Takes::BodyVector(Kind::FIELD),
            default: Some("0"),
            about: "field of the vehicle's magnetised parts",
        }]
    },
    build: |values, _| {
        let field = values.vector("hard_iron").unwrap_or_default();
        Ok((field != DVec3::ZERO).then(|| Box::new(HardIron(field)) as Box<dyn Term>))
    },
};

struct HardIron(DVec3);

impl Term for HardIron {
    #[inline(always)]
    fn apply(&mut self, block: &mut Block) {
        for (column, field) in block.reading.iter_mut().zip(self.0.to_array()) {
            column.iter_mut().for_each(|reading| *reading += field);
        }
    }
}
