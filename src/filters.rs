//! Third-party attitude filters behind one trait: how well each does on a dataset's readings.
//!
//! Each has a file that brings its axes, units and start to ours: vectors in the body's axes (Forward-Right-Down),
//! attitude from there to North-East-Down. All start from the same first readings, take a reading when it is due, and
//! run with the defaults of their crates.
//!
//! ```
//! use ratetable::filters::from_name;
//!
//! let (filter, with_mag) = from_name("vqf-6d").ok_or("no such filter")?;
//! assert_eq!((filter.name, with_mag), ("vqf", false));
//! # Ok::<(), &str>(())
//! ```
//!
//! [`run`] passes a filter whole columns of readings; [`FilterKind::build`] gives one to feed by hand.

mod complementary;
mod eskf;
mod fusion;
mod held;
mod vqf;

use crate::geometry::{Attitude, Body, Rotation, Vector, exp};
use crate::time::SimTime;
use glam::{DMat3, DQuat, DVec3};
use std::collections::VecDeque;

/// A filter that takes each reading as it comes; several of one instant in the order gyro, accelerometer,
/// magnetometer.
pub trait Filter {
    /// Angular rate, rad/s, `dt` seconds after the one before (0 for the first).
    fn gyro(&mut self, dt: f64, rate: Vector<Body>);
    /// Specific force, m/s².
    fn accel(&mut self, force: Vector<Body>);
    /// Magnetic field, µT.
    fn mag(&mut self, field: Vector<Body>);
    /// The attitude from magnetic north; of unit length.
    fn attitude(&self) -> Attitude;
}

/// What a filter is made for.
#[derive(Clone, Copy, Debug)]
pub struct Setup {
    /// The nominal interval of the gyro, s.
    pub gyro_s: f64,
    /// Of the accelerometer.
    pub accel_s: f64,
    /// Of the magnetometer.
    pub mag_s: f64,
    /// Whether there is a magnetometer to go by.
    pub has_mag: bool,
    /// Where it starts: the attitude that the first readings show unless another is given; from magnetic north, or
    /// from any heading without a magnetometer. A filter that does not [take it](FilterKind::takes_start) finds its own.
    pub start: Attitude,
}

/// How a filter is run over readings.
#[derive(Clone, Copy, Debug, Default)]
pub struct Options {
    /// Whether it gets the magnetometer's readings.
    pub with_mag: bool,
    /// How far east of true north the field points, rad.
    pub declination: f64,
    /// Where it starts, from true north; what the first readings show unless given.
    pub start: Option<Attitude>,
}

/// A kind of filter.
pub struct FilterKind {
    /// What users call it.
    pub name: &'static str,
    /// One line of help.
    pub about: &'static str,
    /// Whether it starts at the attitude of its [`Setup`]; else it looks for its start by itself.
    pub takes_start: bool,
    make: fn(&Setup) -> Box<dyn Filter>,
}

impl FilterKind {
    /// A filter of this kind, to be fed by hand.
    pub fn build(&self, setup: &Setup) -> Box<dyn Filter> {
        (self.make)(setup)
    }
}

/// Every filter.
pub static FILTERS: [&FilterKind; 5] =
    [&vqf::KIND, &fusion::KIND, &complementary::MADGWICK, &complementary::MAHONY, &eskf::KIND];

/// After a filter's name: without the magnetometer.
pub const SIX: &str = "-6d";

/// The filter of a name such as `vqf` or `vqf-6d`, and whether it is to use the magnetometer.
pub fn from_name(name: &str) -> Option<(&'static FilterKind, bool)> {
    let (stem, with_mag) = match name.strip_suffix(SIX) {
        Some(stem) => (stem, false),
        None => (name, true),
    };
    FILTERS.into_iter().find(|kind| kind.name == stem).map(|kind| (kind, with_mag))
}

/// One sensor's readings in order of time; none where there is no such sensor.
pub type Column = Vec<(SimTime, Vector<Body>)>;

/// The readings of a dataset.
#[derive(Clone, Debug, Default)]
pub struct Readings {
    /// rad/s.
    pub gyro: Column,
    /// m/s².
    pub accel: Column,
    /// µT.
    pub mag: Column,
}

/// One sensor's readings as they come, in order of time.
pub type Stream<'a> = Box<dyn Iterator<Item = (SimTime, Vector<Body>)> + 'a>;

/// The readings of a dataset as they come: an hour of them need not be in memory.
pub struct Streams<'a> {
    /// rad/s.
    pub gyro: Stream<'a>,
    /// m/s².
    pub accel: Stream<'a>,
    /// µT.
    pub mag: Stream<'a>,
}

impl Readings {
    /// As they come.
    pub fn streams(&self) -> Streams<'_> {
        fn of(column: &Column) -> Stream<'_> {
            Box::new(column.iter().copied())
        }
        Streams { gyro: of(&self.gyro), accel: of(&self.accel), mag: of(&self.mag) }
    }
}

/// Runs a filter over readings: the attitude after each instant at which the gyro was read, from true north if the
/// magnetometer is used, else from where it starts.
pub fn run(kind: &FilterKind, readings: &Readings, options: &Options) -> Vec<(SimTime, Attitude)> {
    let mut attitudes = Vec::with_capacity(readings.gyro.len());
    run_as_read(kind, readings.streams(), options, |t, attitude| attitudes.push((t, attitude)));
    attitudes
}

/// [`run`] for readings that are read meanwhile: `each` is told every attitude.
pub fn run_as_read(
    kind: &FilterKind,
    streams: Streams<'_>,
    options: &Options,
    mut each: impl FnMut(SimTime, Attitude),
) {
    let none: Stream<'_> = Box::new(std::iter::empty());
    let mag = if options.with_mag { streams.mag } else { none };
    let [mut gyro, mut accel, mut mag] =
        [Ahead::new(streams.gyro), Ahead::new(streams.accel), Ahead::new(mag)];
    let (Some((_, force)), Some((first, _))) = (accel.peek(), gyro.peek()) else { return };
    let has_mag = mag.peek().is_some();
    let north = if has_mag { exp(DVec3::Z * options.declination) } else { DQuat::IDENTITY };
    let given = options.start.map(|start| Attitude::from_quat(north.conjugate() * start.q));
    let setup = Setup {
        gyro_s: gyro.period(),
        accel_s: accel.period(),
        mag_s: mag.period(),
        has_mag,
        start: given.unwrap_or_else(|| start(force, mag.peek().map(|(_, field)| field))),
    };
    let mut filter = kind.build(&setup);
    let mut last = first;
    while let Some((t, rate)) = gyro.next() {
        filter.gyro((t - last).seconds(), rate);
        last = t;
        let end = gyro.peek().map_or(SimTime(t.0 + 1), |(next, _)| next);
        let mut told = false;
        // What is due with the gyro counts for this attitude, what comes before its next reading for the next.
        for until in [SimTime(t.0 + 1), end] {
            while let Some((_, force)) = accel.before(until) {
                filter.accel(force);
            }
            while let Some((_, field)) = mag.before(until) {
                filter.mag(field);
            }
            if !std::mem::replace(&mut told, true) {
                each(t, Attitude::from_quat(north * filter.attitude().q));
            }
        }
    }
}

/// As many steps tell the nominal interval.
const STEPS: usize = 10_000;

/// Readings with those that come next at hand.
struct Ahead<'a> {
    held: VecDeque<(SimTime, Vector<Body>)>,
    rest: Stream<'a>,
}

impl<'a> Ahead<'a> {
    fn new(mut readings: Stream<'a>) -> Ahead<'a> {
        let held = readings.by_ref().take(STEPS).collect();
        Ahead { held, rest: readings }
    }

    /// The nominal interval: the median of those at hand, s.
    fn period(&self) -> f64 {
        let steps = self.held.iter().zip(self.held.iter().skip(1)).map(|(a, b)| (b.0 - a.0).0);
        let mut steps: Vec<i64> = steps.collect();
        steps.sort_unstable();
        steps.get(steps.len() / 2).map_or(0.01, |&ns| ns as f64 * 1e-9)
    }

    fn peek(&mut self) -> Option<(SimTime, Vector<Body>)> {
        if self.held.is_empty() {
            self.held.extend(self.rest.next());
        }
        self.held.front().copied()
    }

    /// The next one if it is before `until`.
    fn before(&mut self, until: SimTime) -> Option<(SimTime, Vector<Body>)> {
        self.peek().filter(|(t, _)| *t < until)?;
        self.held.pop_front()
    }

    fn next(&mut self) -> Option<(SimTime, Vector<Body>)> {
        self.peek()?;
        self.held.pop_front()
    }
}

/// The attitude at rest that specific force and field show (TRIAD; H. Black, AIAA Journal 2(7), 1964); without a
/// field, with no heading.
fn start(force: Vector<Body>, field: Option<Vector<Body>>) -> Attitude {
    let down = -force.v.normalize_or(-DVec3::Z);
    let forward = field.map_or(DVec3::X, |field| field.v);
    let east = down.cross(forward).normalize_or(down.any_orthonormal_vector());
    // Rows are the nav axes in the body's; columns of the transpose.
    let body_from_nav = DMat3::from_cols(east.cross(down), east, down);
    Rotation::from_quat(DQuat::from_mat3(&body_from_nav.transpose()).normalize())
}

/// A half turn about x: Forward-Left-Up to Forward-Right-Down, North-West-Up to North-East-Down, and back.
fn flip(v: DVec3) -> [f64; 3] {
    [v.x, -v.y, -v.z]
}

#[cfg(test)]
mod tests;
