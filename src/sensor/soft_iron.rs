//! Soft iron, magnetised by the surrounding field, stretches and turns that field: `reading = M·field` (Vasconcelos
//! et al., *Geometric approach to strapdown magnetometer calibration in sensor frame*, IEEE TAES 47(2), 2011, eq. 2).

use super::{Block, Kinds, SensorKind, Stage, Term, TermKind, linear};
use crate::keys::Name;
use crate::quantity::Kind;
use glam::DMat3;

const SOFT_IRON: Name<DMat3> = Name::new("soft_iron");

pub(super) static KIND: TermKind = TermKind {
    name: "soft_iron",
    about: "the field multiplied by a matrix, before hard iron",
    serves: Kinds::of(&[SensorKind::Mag]),
    stage: Stage::Signal,
    needs: &[],
    keys: |_| {
        vec![SOFT_IRON.matrix(
            Kind::RATIO,
            "matrix that multiplies the field around the magnetometer; identity without soft iron",
        )]
    },
    build: |values, _| {
        let matrix = values.get(SOFT_IRON).unwrap_or_default();
        Ok((matrix != DMat3::IDENTITY).then(|| Box::new(SoftIron(matrix)) as Box<dyn Term>))
    },
};

struct SoftIron(DMat3);

impl Term for SoftIron {
    #[inline(always)]
    fn apply(&mut self, block: &mut Block) {
        linear::transform(self.0, &mut block.reading);
    }
}
