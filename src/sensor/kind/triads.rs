//! `[gyro]`, `[accel]` and `[mag]`: three body axes each.

use super::{Row, Senses, Shape, Shown, Table};
use crate::sensor::units::{self, Units};

const DEGREES: f64 = 1f64.to_degrees();

pub(super) static GYRO: Row = triad(
    "gyro",
    Senses::Rate,
    ["rad/s", "rad_s"],
    &units::GYRO_UNITS,
    Shown {
        title: "Gyroscope",
        label: "angular rate (deg/s)",
        in_chart: f64::to_degrees,
        unit: "deg/s",
        walk_unit: "deg/√s",
        scale: DEGREES,
    },
);

pub(super) static ACCEL: Row = triad(
    "accel",
    Senses::Force,
    ["m/s^2", "m_s2"],
    &units::ACCEL_UNITS,
    Shown::as_read("Accelerometer", "specific force (m/s²)", "m/s²", "m/s/√s"),
);

pub(super) static MAG: Row = triad(
    "mag",
    Senses::Field,
    ["uT", "ut"],
    &units::MAG_UNITS,
    Shown::as_read("Magnetometer", "magnetic field (µT)", "µT", "µT·√s"),
);

/// A sensor of three body axes; the unit of a reading as a scene spells it, and as it ends a column's name.
const fn triad(
    name: &'static str,
    senses: Senses,
    [unit, column_unit]: [&'static str; 2],
    units: &'static Units,
    shown: Shown,
) -> Row {
    Row {
        name,
        shape: Shape::Triad,
        senses,
        components: &["x", "y", "z"],
        unit,
        column_unit,
        units,
        usual_rate: None,
        keys: Vec::new,
        may_repeat: false,
        shown,
        table: Table { convention: None, note: None, derived: None },
    }
}
