//! What is sensed: the kinds of sensor, one row of a table each.
//!
//! Everything that differs from kind to kind is in its [`Row`], in a file of its own. To add a kind: its file, its
//! variant, its line in `ROWS`.

mod airspeed;
mod baro;
mod gps;
mod triads;

pub use gps::Claims;
pub(super) use gps::VELOCITY_NOISE;

use super::units::Units;
use crate::geometry::{Attitude, Nav, Vector};
use crate::keys::{Key, Takes, Values};
use crate::quantity::Kind;
use std::fmt;

/// What is sensed. The order is that in which readings due together go out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum SensorKind {
    /// Angular rate, rad/s.
    Gyro,
    /// Specific force, m/s².
    Accel,
    /// Magnetic field, µT.
    Mag,
    /// Air pressure, Pa.
    Baro,
    /// Position and velocity.
    Gps,
    /// Differential pressure of a pitot tube, Pa.
    Airspeed,
}

/// Every kind's row, in order.
const ROWS: ByKind<&Row> =
    [&triads::GYRO, &triads::ACCEL, &triads::MAG, &baro::ROW, &gps::ROW, &airspeed::ROW];

/// One value for each kind of sensor, by `kind as usize`.
pub type ByKind<T> = [T; SensorKind::COUNT];

/// What a reading is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Shape {
    /// Three body axes.
    Triad,
    /// One number, Pa.
    Pressure,
    /// Three nav axes, and a velocity.
    Position,
}

/// What of the truth a kind senses.
#[non_exhaustive]
pub enum Senses {
    /// The angular rate of an instant, rad/s.
    Rate,
    /// The specific force of an instant, m/s².
    Force,
    /// The magnetic field of an instant, µT.
    Field,
    /// The displacement from the start, m, and the velocity, m/s.
    Course,
    /// A pressure, Pa, that follows from where the vehicle is and how it moves; made from the values of the kind's keys.
    Air(fn(&Values) -> Air),
}

/// The pressure (Pa) that a kind senses of a vehicle in the air.
pub type Air = Box<dyn Fn(&InAir) -> f64 + Send>;

/// A vehicle in the air.
#[derive(Clone, Copy, Debug)]
pub struct InAir {
    /// Above the ellipsoid, m.
    pub altitude: f64,
    /// Its velocity through the air, m/s along nav axes.
    pub airspeed: Vector<Nav>,
    /// Body to nav.
    pub attitude: Attitude,
}

/// All that differs from kind to kind of sensor.
pub struct Row {
    /// As scenes, reports and files call it.
    pub name: &'static str,
    /// What a reading is made of.
    pub shape: Shape,
    /// What of the truth it senses.
    pub senses: Senses,
    /// What its components are called.
    pub components: &'static [&'static str],
    /// The unit of a reading as a scene spells it.
    pub unit: &'static str,
    /// The unit of a reading as it ends a column's name.
    pub column_unit: &'static str,
    /// Which units its keys take.
    pub units: &'static Units,
    /// Its rate where the scene gives none; `None` where the scene must.
    pub usual_rate: Option<&'static str>,
    /// Its keys besides those of every sensor and of its error terms.
    pub keys: fn() -> Vec<Key>,
    /// Whether a healthy one may say the same thing for long.
    pub may_repeat: bool,
    /// How people like to see it.
    pub shown: Shown,
    /// Its table in a dataset.
    pub table: Table,
}

/// How people like to see readings of a kind.
pub struct Shown {
    /// What it is called above a chart.
    pub title: &'static str,
    /// The label of a chart's axis, with its unit.
    pub label: &'static str,
    /// From the reading's unit to the chart's.
    pub in_chart: fn(f64) -> f64,
    /// The unit in which a plan tells noise and counts: degrees are easier to judge than radians.
    pub unit: &'static str,
    /// Of the random walk of the reading's integral.
    pub walk_unit: &'static str,
    /// From the reading's unit to that.
    pub scale: f64,
}

impl Shown {
    /// In the unit of the reading.
    const fn as_read(
        title: &'static str,
        label: &'static str,
        unit: &'static str,
        walk_unit: &'static str,
    ) -> Shown {
        Shown { title, label, in_chart: |value| value, unit, walk_unit, scale: 1.0 }
    }

    /// A pressure: its noise in Pa, its chart in hPa.
    const fn pressure(title: &'static str, label: &'static str) -> Shown {
        Shown {
            title,
            label,
            in_chart: |pascals| pascals / 100.0,
            unit: "Pa",
            walk_unit: "Pa·√s",
            scale: 1.0,
        }
    }
}

/// A kind's table in a dataset, as far as it is the kind's own.
pub struct Table {
    /// A convention that readers of the numbers have to know: its subject, and what holds.
    pub convention: Option<(&'static str, &'static str)>,
    /// What its columns are, where they are not those of a triad.
    pub note: Option<&'static str>,
    /// A column that follows from the value read.
    pub derived: Option<Derived>,
}

/// A column that follows from the value read.
pub struct Derived {
    /// Its name, which ends in its unit.
    pub column: &'static str,
    /// Its unit by itself.
    pub unit: &'static str,
    /// From the value read.
    pub of: fn(f64) -> f64,
}

impl SensorKind {
    /// How many kinds there are.
    pub const COUNT: usize = 6;

    /// Every kind, in order.
    pub const ALL: ByKind<SensorKind> = [
        SensorKind::Gyro,
        SensorKind::Accel,
        SensorKind::Mag,
        SensorKind::Baro,
        SensorKind::Gps,
        SensorKind::Airspeed,
    ];

    /// Those of three body axes, in order; they come first in [`SensorKind::ALL`].
    pub const TRIADS: [SensorKind; 3] = [SensorKind::Gyro, SensorKind::Accel, SensorKind::Mag];

    /// The kind of that name.
    pub fn from_name(name: &str) -> Option<SensorKind> {
        Self::ALL.into_iter().find(|kind| kind.name() == name)
    }

    /// The names of every kind, as in a sentence: `gyro, accel, mag`.
    pub fn names() -> String {
        Self::ALL.map(SensorKind::name).join(", ")
    }

    /// All that is known of it.
    pub const fn row(self) -> &'static Row {
        ROWS[self as usize]
    }

    /// What a reading is made of.
    pub const fn shape(self) -> Shape {
        self.row().shape
    }

    /// Whether it senses three body axes, of the truth at a tick.
    pub const fn is_triad(self) -> bool {
        matches!(self.shape(), Shape::Triad)
    }

    /// As scenes, reports and files call it.
    pub const fn name(self) -> &'static str {
        self.row().name
    }

    /// What its components are called.
    pub const fn axes(self) -> &'static [&'static str] {
        self.row().components
    }

    /// The unit of a reading as a scene spells it.
    pub const fn unit(self) -> &'static str {
        self.row().unit
    }

    /// The unit of a reading as it ends a column's name.
    pub const fn column_unit(self) -> &'static str {
        self.row().column_unit
    }

    /// Which units this sensor's keys take.
    pub const fn units(self) -> &'static Units {
        self.row().units
    }

    /// A term's key as a sensor of this kind takes it: of one component, or along nav axes. A time is no component.
    pub(super) fn turned(self, key: Key) -> Key {
        match (self.shape(), key.takes()) {
            (_, Takes::PerAxis(time)) if time.name() == Kind::TIME.name() => key,
            (Shape::Pressure, _) => key.of_one_axis(),
            (Shape::Position, _) => key.along_nav(),
            (Shape::Triad, _) => key,
        }
    }
}

impl fmt::Display for SensorKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_kind_has_its_own_row_and_the_triads_come_first() {
        for (i, kind) in SensorKind::ALL.into_iter().enumerate() {
            assert_eq!(format!("{kind:?}").to_lowercase(), kind.name());
            assert_eq!((kind as usize, kind.is_triad()), (i, i < SensorKind::TRIADS.len()));
        }
    }
}
