//! What an update of a filter costs.

use crate::filters::{Filter, FilterKind, Readings, Setup};
use crate::geometry::{Attitude, Body, Vector};
use crate::time::SimTime;
use std::hint::black_box;
use std::time::Duration;

/// Gyro readings that are gone through again and again.
const UPDATES: usize = 1024;
/// The least length of a batch.
const BATCH: Duration = Duration::from_micros(200);

/// A batch is no more rounds than this, even for a clock that stands still.
const MOST_ROUNDS: u32 = 64;

/// What a filter is fed, in order of time.
#[derive(Clone, Copy, Debug)]
enum Fed {
    Gyro(Vector<Body>),
    Accel(Vector<Body>),
    Mag(Vector<Body>),
}

/// The first readings of a scene, to be timed on.
#[derive(Clone, Debug)]
pub struct Clip {
    fed: Vec<Fed>,
    updates: usize,
    setup: Setup,
}

impl Clip {
    /// Of readings with the gyro at `rate_hz`; without the magnetometer's unless `with_mag`.
    pub fn new(readings: &Readings, with_mag: bool, rate_hz: u32) -> Clip {
        let gyro = &readings.gyro[..readings.gyro.len().min(UPDATES)];
        let end = gyro.last().map_or(SimTime::ZERO, |(t, _)| *t);
        let mut fed: Vec<(SimTime, Fed)> = gyro.iter().map(|&(t, rate)| (t, Fed::Gyro(rate))).collect();
        let upto = |column: &[(SimTime, Vector<Body>)], of: fn(Vector<Body>) -> Fed| {
            let due = column.iter().take_while(|(t, _)| *t <= end);
            due.map(|&(t, v)| (t, of(v))).collect::<Vec<_>>()
        };
        fed.extend(upto(&readings.accel, Fed::Accel));
        let mag = if with_mag { &readings.mag[..] } else { &[] };
        fed.extend(upto(mag, Fed::Mag));
        // A stable sort: at one instant gyro, accelerometer, magnetometer.
        fed.sort_by_key(|(t, _)| *t);
        let seconds = gyro.len() as f64 / f64::from(rate_hz);
        let every = |column: &[(SimTime, Vector<Body>)]| {
            seconds / column.iter().take_while(|(t, _)| *t <= end).count().max(1) as f64
        };
        let setup = Setup {
            gyro_s: 1.0 / f64::from(rate_hz),
            accel_s: every(&readings.accel),
            mag_s: every(mag),
            has_mag: !mag.is_empty(),
            start: Attitude::IDENTITY,
        };
        Clip { updates: gyro.len(), fed: fed.into_iter().map(|(_, fed)| fed).collect(), setup }
    }

    /// Nanoseconds an update of `kind`: a reading of the gyro, those of the others that fall to it, and the attitude
    /// after it. The least of seven batches of at least 0.2 ms, because whatever else runs on the machine only adds.
    pub fn ns_per_update(&self, kind: &FilterKind, now: &dyn Fn() -> Duration) -> f64 {
        let mut filter = kind.build(&self.setup);
        let mut time = |rounds: u32| {
            let start = now();
            for _ in 0..rounds {
                self.feed(&mut *filter);
            }
            now().saturating_sub(start)
        };
        let mut rounds = 1;
        while time(rounds) < BATCH && rounds < MOST_ROUNDS {
            rounds *= 2;
        }
        let best = (0..7).map(|_| time(rounds)).min().unwrap_or_default();
        best.as_nanos() as f64 / (f64::from(rounds) * self.updates.max(1) as f64)
    }

    fn feed(&self, filter: &mut dyn Filter) {
        for fed in &self.fed {
            match *fed {
                Fed::Gyro(rate) => {
                    black_box(filter.attitude());
                    filter.gyro(self.setup.gyro_s, black_box(rate));
                }
                Fed::Accel(force) => filter.accel(black_box(force)),
                Fed::Mag(field) => filter.mag(black_box(field)),
            }
        }
    }
}
