//! The magnetic field of a place on a day.

use super::{Day, Place};
use crate::geometry::{Nav, Vector};

/// The World Magnetic Model's field (µT) at a place on a day.
///
/// # Errors
/// Why the model has none, or that this build has no model.
#[cfg(feature = "wmm")]
pub fn magnetic_field(place: Place, day: Day) -> Result<Vector<Nav>, String> {
    use world_magnetic_model::GeomagneticField;
    use world_magnetic_model::uom::si::angle::degree;
    use world_magnetic_model::uom::si::f32::{Angle, Length};
    use world_magnetic_model::uom::si::length::meter;
    use world_magnetic_model::uom::si::magnetic_flux_density::nanotesla;
    let date = day.date().ok_or("no such date")?;
    let field = GeomagneticField::new(
        Length::new::<meter>(place.altitude as f32),
        Angle::new::<degree>(place.latitude.to_degrees() as f32),
        Angle::new::<degree>(place.longitude.to_degrees() as f32),
        date,
    )
    .map_err(|error| error.to_string())?;
    let microtesla = |nt: f32| f64::from(nt) / 1000.0;
    Ok(Vector::new(
        microtesla(field.x().get::<nanotesla>()),
        microtesla(field.y().get::<nanotesla>()),
        microtesla(field.z().get::<nanotesla>()),
    ))
}

/// The World Magnetic Model's field (µT) at a place on a day.
///
/// # Errors
/// This build has no model.
#[cfg(not(feature = "wmm"))]
pub fn magnetic_field(_: Place, _: Day) -> Result<Vector<Nav>, String> {
    Err("this build has no World Magnetic Model: build it with the feature `wmm`, or give the field".into())
}
