//! Hard iron: magnetised parts of the vehicle add a field that turns with it: `reading = field + h` (Vasconcelos
//! et al., *Geometric approach to strapdown magnetometer calibration in sensor frame*, IEEE TAES 47(2), 2011, eq. 2).

use super::{Block, Kinds, SensorKind, Stage, Term, TermKind};
use crate::keys::Name;
use crate::quantity::Kind;
use glam::DVec3;

/// The field of the vehicle's magnetised parts, µT, in body axes.
pub const HARD_IRON: Name<DVec3> = Name::new("hard_iron");

pub(super) static KIND: TermKind = TermKind {
    name: "hard_iron",
    about: "a field fixed to the vehicle, after soft iron and before the sensor's own scale",
    serves: Kinds::of(&[SensorKind::Mag]),
    stage: Stage::Signal,
    needs: &[],
    keys: |_| vec![HARD_IRON.body_vector(Kind::FIELD, "field of the vehicle's magnetised parts").or("0")],
    build: |values, _| {
        let field = values.get(HARD_IRON).unwrap_or_default();
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
