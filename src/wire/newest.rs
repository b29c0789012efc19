//! The newest sample of each sensor, for packets that carry several.

use super::{MAX_PACKET, Options, Packet};
use crate::geometry::{Body, Vector};
use crate::sensor::{ByKind, Kinds, Measurement, REFERENCE_TEMPERATURE, Reading, SensorKind};
use crate::time::SimTime;

/// The last value of each sensor: a part of its reading, which has six times the bytes. Three components and the
/// temperature of the sensor, °C, lie side by side, so that a packet reads them as they were written.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Told {
    values: ByKind<[f64; 4]>,
    has: Kinds,
}

impl Told {
    /// Whether a sensor of this kind has a value; never for a receiver, whose fix is not kept.
    pub fn has(&self, kind: SensorKind) -> bool {
        self.has.contains(kind)
    }

    /// Its value in body axes.
    pub fn body(&self, kind: SensorKind) -> Option<Vector<Body>> {
        let [x, y, z, _] = self.values[kind as usize];
        self.has(kind).then(|| Vector::new(x, y, z))
    }

    /// Its pressure, Pa.
    pub fn pressure(&self, kind: SensorKind) -> Option<f64> {
        self.has(kind).then(|| self.values[kind as usize][0])
    }

    /// Temperature of the sensor, °C.
    pub fn temperature(&self, kind: SensorKind) -> Option<f64> {
        self.has(kind).then(|| self.values[kind as usize][3])
    }

    /// Replaces the value of a sensor, or removes it.
    pub fn put(&mut self, kind: SensorKind, body: Option<Vector<Body>>) {
        match body {
            Some(body) => self.say(kind, body.v.to_array(), REFERENCE_TEMPERATURE),
            None => self.has.remove(kind.into()),
        }
    }

    #[inline]
    fn say(&mut self, kind: SensorKind, [x, y, z]: [f64; 3], temperature: f64) {
        self.values[kind as usize] = [x, y, z, temperature];
        self.has.insert(kind);
    }

    /// Makes a reading the `n`th of a mean.
    fn merge(&mut self, reading: &Reading, n: u32) {
        let Some(value) = value(reading) else { return };
        let share = 1.0 / f64::from(n);
        let mean = &mut self.values[reading.kind as usize];
        mean.iter_mut().zip(value).for_each(|(mean, value)| *mean += (value - *mean) * share);
    }

    #[inline]
    fn take_in(&mut self, reading: &Reading) {
        if let Some(value) = value(reading) {
            self.say(reading.kind, value, reading.temperature);
        }
    }
}

/// The components of a reading; `None` for a fix. A pressure is the first.
#[inline]
fn value(reading: &Reading) -> Option<[f64; 3]> {
    match &reading.measurement {
        Measurement::Triad(triad) => Some(triad.value.v.to_array()),
        Measurement::Pressure(pressure) => Some([pressure.value, 0.0, 0.0]),
        Measurement::Position(_) => None,
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

    /// Appends a packet with the fresh samples among `kinds`. `write` gets the newest values and the place for the bytes,
    /// and returns how many there are.
    #[inline]
    pub fn append(
        &mut self,
        out: &mut Vec<Packet>,
        due: SimTime,
        kinds: Kinds,
        write: impl FnOnce(&Told, &mut [u8; MAX_PACKET]) -> usize,
    ) {
        let packet = Packet::append(out, due, self.fresh & kinds, |bytes| write(&self.told, bytes));
        self.hand_over(kinds, packet);
    }

    /// The packet takes over what these sensors have waiting.
    #[inline]
    fn hand_over(&mut self, kinds: Kinds, packet: &mut Packet) {
        let thinned = self.thinned & kinds;
        if !thinned.is_empty() {
            for kind in thinned.iter() {
                packet.replaced[kind as usize] = std::mem::take(&mut self.replaced[kind as usize]);
            }
            self.thinned.remove(thinned);
            packet.merges = self.means;
        }
        self.fresh.remove(kinds);
    }
}
