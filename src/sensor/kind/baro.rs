//! `[baro]`: absolute air pressure.

use super::{Derived, Row, Senses, Shape, Shown, Table};
use crate::earth::{self, pressure_altitude};
use crate::keys::{Key, Name, Values};
use crate::quantity::{Kind, Sign};
use crate::sensor::units;

const SEA_LEVEL_PRESSURE: Name<f64> = Name::new("sea_level_pressure");

pub(super) static ROW: Row = Row {
    name: "baro",
    shape: Shape::Pressure,
    senses: Senses::Air(|values| {
        let sea_level = sea_level_pressure(values);
        Box::new(move |here| earth::pressure(here.altitude, sea_level))
    }),
    components: &["pressure"],
    unit: "Pa",
    column_unit: "pa",
    units: &units::PRESSURE_UNITS,
    usual_rate: None,
    keys: || vec![weather()],
    may_repeat: false,
    shown: Shown::pressure("Barometer", "pressure (hPa)"),
    table: Table {
        convention: Some(("pressure", "of the air, absolute, Pa")),
        note: Some(
            "the pressure that it reads, the error-free one and the bias in effect; the altitude at which the
  standard atmosphere of 1976 has the pressure read (geopotential, 1013.25 hPa at 0); and the part's temperature.",
        ),
        derived: Some(Derived { column: "pressure_altitude_m", unit: "m", of: pressure_altitude }),
    },
};

/// The key that gives the pressure at altitude 0.
pub(super) fn weather() -> Key {
    SEA_LEVEL_PRESSURE
        .scalar(Kind::PRESSURE.signed(Sign::Positive), "at altitude 0: the day's weather")
        .or("101325 Pa")
}

/// The pressure at altitude 0, Pa.
pub(super) fn sea_level_pressure(values: &Values) -> f64 {
    values.get(SEA_LEVEL_PRESSURE).unwrap_or(earth::SEA_LEVEL_PRESSURE)
}
