//! The bias that acceleration gives a gyroscope: `b += G·f`, f the true specific force at the gyro's ticks (Groves,
//! *Principles of GNSS, Inertial, and Multisensor Integrated Navigation Systems*, 2nd ed., eq. 4.17).

use super::{Block, Column, Kinds, SensorKind, Stage, Term, TermKind, linear};
use crate::keys::Name;
use crate::quantity::Kind;
use glam::DMat3;

/// Bias for each m/s² of specific force, rad/s, in body axes.
pub const G_SENSITIVITY: Name<DMat3> = Name::new("g_sensitivity");

pub(super) static KIND: TermKind = TermKind {
    name: "g_sensitivity",
    about: "bias of a gyroscope in proportion to the specific force",
    serves: Kinds::of(&[SensorKind::Gyro]),
    stage: Stage::Bias,
    needs: &[Column::Force],
    keys: |_| {
        vec![G_SENSITIVITY.matrix(
            Kind::G_SENSITIVITY,
            "bias for each g of specific force, along the same axis (a vector) or across (three rows)",
        )]
    },
    build: |values, _| {
        let matrix = values.get(G_SENSITIVITY).unwrap_or(DMat3::ZERO);
        Ok((matrix != DMat3::ZERO).then(|| Box::new(GSensitivity(matrix)) as Box<dyn Term>))
    },
};

struct GSensitivity(DMat3);

impl Term for GSensitivity {
    #[inline(always)]
    fn apply(&mut self, block: &mut Block) {
        linear::add_product(self.0, &block.force, &mut block.bias);
    }
}
