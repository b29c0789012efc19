//! The newest sample of each sensor, for packets that carry several.

use super::Packet;
use crate::geometry::{Body, Vector};
use crate::sensor::{ByKind, Kinds, Reading, SensorKind};
use crate::time::SimTime;

/// What a sensor of this kind read last, in body axes.
pub(super) fn body(newest: &ByKind<Option<Reading>>, kind: SensorKind) -> Option<Vector<Body>> {
    newest[kind as usize].as_ref()?.body().map(|body| body.value)
}

/// The pressure that a sensor of this kind read last, Pa.
pub(super) fn pressure(newest: &ByKind<Option<Reading>>, kind: SensorKind) -> Option<f64> {
    newest[kind as usize].as_ref()?.pressure().map(|pressure| pressure.value)
}

/// The newest sample of each sensor, for packets that carry several.
#[derive(Debug, Default)]
pub(super) struct Newest {
    pub values: ByKind<Option<Reading>>,
    pub fresh: Kinds,
    replaced: ByKind<u32>,
}

impl Newest {
    pub fn take_in(&mut self, readings: &[Reading]) {
        for reading in readings {
            let i = reading.kind as usize;
            if self.fresh.contains(reading.kind) {
                self.replaced[i] = self.replaced[i].saturating_add(1);
            }
            self.fresh.insert(reading.kind);
            self.values[i] = Some(*reading);
        }
    }

    pub fn waiting(&self) -> ByKind<u64> {
        SensorKind::ALL
            .map(|kind| u64::from(self.fresh.contains(kind)) + u64::from(self.replaced[kind as usize]))
    }

    /// A packet of these bytes that carries the fresh samples among `kinds`.
    pub fn packet(&mut self, due: SimTime, kinds: Kinds, bytes: &[u8]) -> Packet {
        let mut packet = Packet::new(due, self.fresh & kinds, bytes);
        for kind in kinds.iter() {
            packet.replaced[kind as usize] = std::mem::take(&mut self.replaced[kind as usize]);
        }
        self.fresh.remove(kinds);
        packet
    }
}
