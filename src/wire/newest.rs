//! The newest sample of each sensor, for packets that carry several.

use super::samples::Sensed;
use super::{Options, Packet};
use crate::geometry::{Body, Vector};
use crate::sensor::{ByKind, Kinds, Measurement, REFERENCE_TEMPERATURE, Reading, SensorKind};
use crate::time::SimTime;

/// The last value of each sensor. It keeps only this part of a reading, because a reading has six times the bytes.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Told(ByKind<Option<(Sensed, f64)>>);

impl Told {
    /// Whether a sensor of this kind has a value; never for a receiver, whose fix is not kept.
    pub fn has(&self, kind: SensorKind) -> bool {
        self.0[kind as usize].is_some()
    }

    /// Its value in body axes.
    pub fn body(&self, kind: SensorKind) -> Option<Vector<Body>> {
        self.0[kind as usize]?.0.body()
    }

    /// Its pressure, Pa.
    pub fn pressure(&self, kind: SensorKind) -> Option<f64> {
        self.0[kind as usize]?.0.pressure()
    }

    /// Temperature of the sensor, °C.
    pub fn temperature(&self, kind: SensorKind) -> Option<f64> {
        Some(self.0[kind as usize]?.1)
    }

    /// Replaces the value of a sensor, or removes it.
    pub fn put(&mut self, kind: SensorKind, body: Option<Vector<Body>>) {
        self.0[kind as usize] = body.map(|body| (Sensed::Body(body), REFERENCE_TEMPERATURE));
    }

    /// Makes a reading the `n`th of a mean.
    fn merge(&mut self, reading: &Reading, n: u32) {
        let share = 1.0 / f64::from(n);
        match (&mut self.0[reading.kind as usize], &reading.measurement) {
            (Some((Sensed::Body(mean), _)), Measurement::Triad(triad)) => {
                mean.v += (triad.value.v - mean.v) * share;
            }
            (Some((Sensed::Pressure(mean), _)), Measurement::Pressure(pressure)) => {
                *mean += (pressure.value - *mean) * share;
            }
            _ => self.take_in(reading),
        }
    }

    fn take_in(&mut self, reading: &Reading) {
        let said = match &reading.measurement {
            Measurement::Triad(triad) => Sensed::Body(triad.value),
            Measurement::Pressure(pressure) => Sensed::Pressure(pressure.value),
            Measurement::Position(_) => return,
        };
        self.0[reading.kind as usize] = Some((said, reading.temperature));
    }
}

/// The newest sample of each sensor, for packets that carry several.
#[derive(Debug, Default)]
pub(super) struct Newest {
    pub told: Told,
    pub fresh: Kinds,
    /// Whether a packet carries the mean of the samples since the packet before, not the last of them.
    means: bool,
    /// The kinds whose samples a newer one replaced before a packet carried them, and their counts.
    thinned: Kinds,
    replaced: ByKind<u32>,
}

impl Newest {
    /// For packets with these options.
    pub fn new(options: &Options) -> Newest {
        Newest { means: options.means(), ..Newest::default() }
    }

    pub fn take_in(&mut self, readings: &[Reading]) {
        for reading in readings {
            let i = reading.kind as usize;
            if !self.fresh.contains(reading.kind) {
                self.fresh.insert(reading.kind);
                self.told.take_in(reading);
                continue;
            }
            self.replaced[i] = self.replaced[i].saturating_add(1);
            self.thinned.insert(reading.kind);
            match self.means {
                true => self.told.merge(reading, self.replaced[i].saturating_add(1)),
                false => self.told.take_in(reading),
            }
        }
    }

    pub fn waiting(&self) -> ByKind<u64> {
        SensorKind::ALL
            .map(|kind| u64::from(self.fresh.contains(kind)) + u64::from(self.replaced[kind as usize]))
    }

    /// A packet of these bytes; it carries the fresh samples among `kinds`.
    pub fn packet(&mut self, due: SimTime, kinds: Kinds, bytes: &[u8]) -> Packet {
        let mut packet = Packet::new(due, self.fresh & kinds, bytes);
        let thinned = self.thinned & kinds;
        if !thinned.is_empty() {
            for kind in thinned.iter() {
                packet.replaced[kind as usize] = std::mem::take(&mut self.replaced[kind as usize]);
            }
            self.thinned.remove(thinned);
            packet.merges = self.means;
        }
        self.fresh.remove(kinds);
        packet
    }
}
