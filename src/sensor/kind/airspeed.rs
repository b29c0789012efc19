//! `[airspeed]`: a pitot tube along body x.
//!
//! It reads `q = ½·ρ·v·|v|`, in Pa: ρ is the density of the air at the vehicle's altitude (U.S. Standard Atmosphere,
//! 1976), v the speed along body x of the vehicle through the air, which the wind moves over the ground. In air that
//! comes from behind, q is negative. Below Mach 0.3 the air's compression adds less than 2.3 % to a real tube's q
//! (Anderson, *Fundamentals of Aerodynamics*, 6th ed., sec. 8.7); it is left out.

use super::baro::{sea_level_pressure, weather};
use super::{Derived, InAir, Row, Senses, Shape, Shown, Table};
use crate::earth;
use crate::sensor::units;

pub(super) static ROW: Row = Row {
    name: "airspeed",
    shape: Shape::Pressure,
    senses: Senses::Air(|values| {
        let sea_level = sea_level_pressure(values);
        Box::new(move |here| dynamic_pressure(here, sea_level))
    }),
    components: &["pressure"],
    unit: "Pa",
    column_unit: "pa",
    units: &units::PRESSURE_UNITS,
    usual_rate: None,
    keys: || vec![weather()],
    may_repeat: false,
    shown: Shown::pressure("Pitot tube", "differential pressure (hPa)"),
    table: Table {
        convention: Some((
            "differential_pressure",
            "of a pitot tube along body x: total less static, Pa; negative in air from behind",
        )),
        note: Some(
            "the differential pressure that it reads, the error-free one and the bias in effect; the indicated
  airspeed of the pressure read (sqrt(2 q / 1.225 kg/m^3), with its sign); and the part's temperature.",
        ),
        derived: Some(Derived { column: "indicated_airspeed_m_s", unit: "m/s", of: earth::indicated_airspeed }),
    },
};

/// Pa.
fn dynamic_pressure(here: &InAir, sea_level: f64) -> f64 {
    let speed = here.attitude.inverse().apply(here.airspeed).v.x;
    0.5 * earth::density(here.altitude, sea_level) * speed * speed.abs()
}
