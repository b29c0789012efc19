//! `[gyro]`, `[accel]` and `[mag]`: three body axes each.

use super::{Row, Senses, Shape, Shown, Table};
use crate::sensor::units;

const DEGREES: f64 = 1f64.to_degrees();

pub(super) static GYRO: Row = Row {
    name: "gyro",
    shape: Shape::Triad,
    senses: Senses::Rate,
    components: &["x", "y", "z"],
    unit: "rad/s",
    column_unit: "rad_s",
    units: &units::GYRO_UNITS,
    usual_rate: None,
    keys: Vec::new,
    may_repeat: false,
    shown: Shown {
        title: "Gyroscope",
        label: "angular rate (deg/s)",
        in_chart: f64::to_degrees,
        unit: "deg/s",
        walk_unit: "deg/√s",
        scale: DEGREES,
    },
    table: Table::TRIAD,
};

pub(super) static ACCEL: Row = Row {
    name: "accel",
    shape: Shape::Triad,
    senses: Senses::Force,
    components: &["x", "y", "z"],
    unit: "m/s^2",
    column_unit: "m_s2",
    units: &units::ACCEL_UNITS,
    usual_rate: None,
    keys: Vec::new,
    may_repeat: false,
    shown: Shown {
        title: "Accelerometer",
        label: "specific force (m/s²)",
        in_chart: |value| value,
        unit: "m/s²",
        walk_unit: "m/s/√s",
        scale: 1.0,
    },
    table: Table::TRIAD,
};

pub(super) static MAG: Row = Row {
    name: "mag",
    shape: Shape::Triad,
    senses: Senses::Field,
    components: &["x", "y", "z"],
    unit: "uT",
    column_unit: "ut",
    units: &units::MAG_UNITS,
    usual_rate: None,
    keys: Vec::new,
    may_repeat: false,
    shown: Shown {
        title: "Magnetometer",
        label: "magnetic field (µT)",
        in_chart: |value| value,
        unit: "µT",
        walk_unit: "µT·√s",
        scale: 1.0,
    },
    table: Table::TRIAD,
};
