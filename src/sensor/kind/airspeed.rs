//! `[airspeed]`: a pitot tube along body x.
//!
//! It reads `q = ½·ρ·v·|v|`, in Pa: ρ is the density of the air at the vehicle's altitude (U.S. Standard Atmosphere,
//! 1976), v the speed along body x of the vehicle through the air, which the wind moves over the ground. In air that
//! comes from behind, q is negative. Below Mach 0.3 the air's compression adds less than 2.3 % to a real tube's q
//! (Anderson, *Fundamentals of Aerodynamics*, 6th ed., sec. 8.7); it is left out.

use super::baro::{sea_level_pressure, weather};
use super::{Derived, InAir, Row, Senses, Shape, Shown, Table};
use crate::earth;
use crate::geometry::{Nav, Vector};
use crate::keys::{Name, Values};
use crate::quantity::Kind;
use crate::sensor::units;
use glam::DVec3;

const WIND: Name<DVec3> = Name::new("wind");

pub(super) static ROW: Row = Row {
    name: "airspeed",
    shape: Shape::Pressure,
    senses: Senses::Air(|values| {
        let (sea_level, wind) = (sea_level_pressure(values), wind(values));
        Box::new(move |here| dynamic_pressure(here, sea_level, wind))
    }),
    components: &["pressure"],
    unit: "Pa",
    column_unit: "pa",
    units: &units::PRESSURE_UNITS,
    usual_rate: None,
    keys: || {
        let about = "velocity of the air over the ground, the same everywhere: \"[0, 5, 0] m/s\" blows to the east in ned";
        vec![weather(), WIND.nav_vector(Kind::SPEED, about).or("0")]
    },
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

/// Velocity of the air over the ground.
fn wind(values: &Values) -> Vector<Nav> {
    Vector::from_vec(values.get(WIND).unwrap_or_default())
}

/// Pa.
fn dynamic_pressure(here: &InAir, sea_level: f64, wind: Vector<Nav>) -> f64 {
    let speed = here.attitude.inverse().apply(here.velocity - wind).v.x;
    0.5 * earth::density(here.altitude, sea_level) * speed * speed.abs()
}
