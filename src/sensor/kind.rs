//! What is sensed.

use super::units::{self, Units};
use std::fmt;

/// What is sensed. The order is that in which readings due together go out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum SensorKind {
    /// Angular rate, rad/s.
    Gyro,
    /// Specific force, m/s².
    Accel,
    /// Magnetic field, µT.
    Mag,
    /// Air pressure, Pa: one number, which stands for x; y and z are 0.
    Baro,
    /// Position, m north, east and down of the start, and velocity: nav axes in place of the body's.
    Gps,
}

/// One value for each kind of sensor, by `kind as usize`.
pub type ByKind<T> = [T; SensorKind::COUNT];

impl SensorKind {
    /// How many kinds there are.
    pub const COUNT: usize = 5;

    /// Every kind, in order.
    pub const ALL: ByKind<SensorKind> =
        [SensorKind::Gyro, SensorKind::Accel, SensorKind::Mag, SensorKind::Baro, SensorKind::Gps];

    /// Those of three body axes, in order; they come first in [`SensorKind::ALL`].
    pub const TRIADS: [SensorKind; 3] = [SensorKind::Gyro, SensorKind::Accel, SensorKind::Mag];

    /// Whether it senses three body axes, of the truth at a tick.
    pub const fn is_triad(self) -> bool {
        matches!(self, SensorKind::Gyro | SensorKind::Accel | SensorKind::Mag)
    }

    /// As scenes, reports and files call it.
    pub const fn name(self) -> &'static str {
        ["gyro", "accel", "mag", "baro", "gps"][self as usize]
    }

    /// What its components are called.
    pub const fn axes(self) -> &'static [&'static str] {
        match self {
            SensorKind::Gyro | SensorKind::Accel | SensorKind::Mag => &["x", "y", "z"],
            SensorKind::Baro => &["pressure"],
            SensorKind::Gps => &["north", "east", "down"],
        }
    }

    /// The unit of a reading as a scene spells it.
    pub const fn unit(self) -> &'static str {
        ["rad/s", "m/s^2", "uT", "Pa", "m"][self as usize]
    }

    /// The unit of a reading as it ends a column's name.
    pub const fn column_unit(self) -> &'static str {
        ["rad_s", "m_s2", "ut", "pa", "m"][self as usize]
    }

    /// Which units this sensor's keys take.
    pub const fn units(self) -> &'static Units {
        match self {
            SensorKind::Gyro => &units::GYRO_UNITS,
            SensorKind::Accel => &units::ACCEL_UNITS,
            SensorKind::Mag => &units::MAG_UNITS,
            SensorKind::Baro => &units::BARO_UNITS,
            SensorKind::Gps => &units::GPS_UNITS,
        }
    }
}

impl fmt::Display for SensorKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
