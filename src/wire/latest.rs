//! Packets at a fixed rate, each with the newest sample of every sensor: shared by `msp`, `vectornav`,
//! `mip` and `ilabs`.
//!
//! A packet goes out on time whether or not a sample is due. A later sample waits for the next packet, and a sensor
//! without a new sample repeats its last one, like a unit that holds its output registers.

use super::beat::Beat;
use super::newest::Told;
use super::{MAX_PACKET, Newest, Packet, Setup, stopped};
use crate::earth::SEA_LEVEL_PRESSURE;
use crate::geometry::{Body, Vector};
use crate::motion::Truth;
use crate::schedule::Ticks;
use crate::sensor::{ByKind, Kinds, Reading, SensorKind};
use crate::time::{Rate, SimTime};

/// What the packets carry.
pub(super) const CARRIED: Kinds =
    Kinds::of(&[SensorKind::Gyro, SensorKind::Accel, SensorKind::Mag, SensorKind::Baro]);

pub(super) struct Latest {
    newest: Newest,
    /// The sensor whose first sample begins the stream: the gyro, or without one the first sensor.
    carrier: Option<SensorKind>,
    /// What the packets carry.
    pub kinds: Kinds,
    beat: Beat,
}

impl Latest {
    /// Packets at the rate that `rate` makes of the first sensor's. Where `rate` leaves it unchanged, packets
    /// follow the sensor's ticks with the error of its clock.
    pub(super) fn new(setup: &Setup<'_>, rate: impl FnOnce(Rate) -> Rate) -> Latest {
        let carrier = setup.sensors.first();
        let (own, clock, phase) = carrier.map_or((Rate::hz(1), Rate::hz(1), SimTime::ZERO), |sensor| {
            (sensor.rate, sensor.clock(), sensor.phase)
        });
        let wanted = rate(own);
        let beat = Ticks { rate: if wanted == own { clock } else { wanted }, phase };
        let carrier = carrier.map(|sensor| sensor.kind);
        Latest { newest: Newest::new(&setup.options), carrier, kinds: CARRIED, beat: Beat::new(beat) }
    }

    /// Takes the readings due at `t` and appends the packets due up to then; `write` makes the bytes of a packet
    /// from its time and the newest readings.
    pub(super) fn encode(
        &mut self,
        t: SimTime,
        readings: &[Reading],
        out: &mut Vec<Packet>,
        mut write: impl FnMut(SimTime, &Told, &mut [u8]) -> usize,
    ) {
        let mut send = |latest: &mut Latest, due| {
            if latest.has_begun() {
                let kinds = latest.kinds;
                latest.append(out, due, kinds, |newest, bytes| write(due, newest, bytes));
            }
            latest.beat.step();
        };
        while let Some(due) = Some(self.beat.due()).filter(|&due| due < t) {
            send(self, due);
        }
        self.newest.take_in(readings);
        if self.beat.due() == t {
            send(self, t);
        }
    }

    /// The newest reading of each sensor.
    pub(super) fn newest(&self) -> &Told {
        &self.newest.told
    }

    /// The newest readings, and of those of these kinds what a vehicle reads that has stopped as it is.
    pub(super) fn stopped(&self, truth: &Truth, kinds: Kinds) -> Told {
        let mut still = self.newest.told;
        for (kind, value) in SensorKind::TRIADS.into_iter().zip(stopped(truth)) {
            still.put(kind, kinds.contains(kind).then_some(value));
        }
        still
    }

    /// Samples of each kind that no packet has carried yet.
    pub(super) fn waiting(&self) -> ByKind<u64> {
        self.newest.waiting()
    }

    /// Packets at another rate from now on.
    pub(super) fn change(&mut self, rate: Rate, now: SimTime) {
        self.beat.change(rate, now);
    }

    /// Appends a packet that carries what is new of these kinds; `write` makes its bytes from the newest readings.
    #[inline]
    pub(super) fn append(
        &mut self,
        out: &mut Vec<Packet>,
        due: SimTime,
        kinds: Kinds,
        write: impl FnOnce(&Told, &mut [u8; MAX_PACKET]) -> usize,
    ) {
        self.newest.append(out, due, kinds, write);
    }

    /// Whether the first sample is there, before which there are no packets.
    pub(super) fn has_begun(&self) -> bool {
        self.carrier.is_some_and(|kind| self.newest.told.has(kind))
    }
}

/// The barometer's newest reading, or the standard atmosphere's at sea level where the scene has none, Pa.
pub(super) fn pascals(newest: &Told) -> f64 {
    newest.pressure(SensorKind::Baro).unwrap_or(SEA_LEVEL_PRESSURE)
}

/// Body axes in units of `unit`, 0 without a reading.
pub(super) fn in_units(value: Option<Vector<Body>>, unit: f64) -> [f32; 3] {
    value.map_or([0.0; 3], |value| value.v.to_array().map(|x| (x / unit) as f32))
}
