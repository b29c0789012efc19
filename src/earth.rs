//! Gravity, magnetic field and pressure at a place, and the places that are some metres away.
//!
//! ```
//! use ratetable::earth::{Place, density, normal_gravity, pressure};
//!
//! let gravity = normal_gravity(Place { latitude: 45f64.to_radians(), ..Place::ORIGIN });
//! assert!((gravity - 9.8062).abs() < 1e-4);
//! assert!((pressure(1000.0, 101_325.0) - 89_875.0).abs() < 10.0);
//! assert!((density(0.0, 101_325.0) - 1.225).abs() < 1e-4);
//! ```

mod atmosphere;
mod ellipsoid;
mod field;

pub use atmosphere::{
    SEA_LEVEL_PRESSURE, density, dynamic_pressure, indicated_airspeed, pressure, pressure_altitude,
};
pub use field::magnetic_field;

use crate::geometry::{Nav, Vector};
use ::time::{Date, Month};

/// Standard gravity, m/s² (CGPM 1901).
pub const STANDARD_GRAVITY: f64 = 9.80665;

/// The field of a scene that names neither a field nor a place: 50 µT dipping 60° towards true north.
pub fn default_field() -> Vector<Nav> {
    Vector::new(25.0, 0.0, 50.0 * libm::sin(60f64.to_radians()))
}

/// A place on or above the WGS 84 ellipsoid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Geodetic, rad, north positive.
    pub latitude: f64,
    /// rad, east positive.
    pub longitude: f64,
    /// Above the ellipsoid, m.
    pub altitude: f64,
}

impl Place {
    /// Where a scene is that does not say so: on the equator at the prime meridian, at sea level.
    pub const ORIGIN: Place = Place { latitude: 0.0, longitude: 0.0, altitude: 0.0 };
}

/// A calendar date.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Day {
    /// Such as 2026.
    pub year: i32,
    /// 1 to 12.
    pub month: u8,
    /// 1 to 31.
    pub day: u8,
}

impl Day {
    /// From `2026-11-22`; `None` if that is no date.
    pub fn parse(text: &str) -> Option<Day> {
        let mut parts = text.split('-');
        let (year, month, day) = (parts.next()?, parts.next()?, parts.next()?);
        if parts.next().is_some() || year.len() != 4 || month.len() != 2 || day.len() != 2 {
            return None;
        }
        let day = Day { year: year.parse().ok()?, month: month.parse().ok()?, day: day.parse().ok()? };
        day.date().map(|_| day)
    }

    /// Seconds from 1970-01-01 00:00 UTC to this day's start.
    pub fn unix_seconds(self) -> i64 {
        let epoch = Date::from_calendar_date(1970, Month::January, 1).map_or(0, Date::to_julian_day);
        let days = self.date().map_or(0, Date::to_julian_day) - epoch;
        i64::from(days) * 86_400
    }

    fn date(self) -> Option<Date> {
        Date::from_calendar_date(self.year, Month::try_from(self.month).ok()?, self.day).ok()
    }
}

/// WGS 84 normal gravity at the ellipsoid (Somigliana) with the second-order free-air term, m/s², down
/// (NIMA TR8350.2, third edition, eq. 4-1 and 4-3; good to 10⁻⁶ m/s² below 20 km).
pub fn normal_gravity(place: Place) -> f64 {
    use ellipsoid::{A, E2};
    const EQUATOR: f64 = 9.780_325_335_9;
    const K: f64 = 0.001_931_852_652_41;
    const F: f64 = 1.0 / 298.257_223_563;
    const M: f64 = 0.003_449_786_506_84;
    let sine = libm::sin(place.latitude);
    let s2 = sine * sine;
    let at_ellipsoid = EQUATOR * (1.0 + K * s2) / libm::sqrt(1.0 - E2 * s2);
    let h = place.altitude / A;
    at_ellipsoid * (1.0 - 2.0 * (1.0 + F + M - 2.0 * F * s2) * h + 3.0 * h * h)
}

/// How far magnetic north lies east of true north, rad.
pub fn declination(field: Vector<Nav>) -> f64 {
    libm::atan2(field.v.y, field.v.x)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn place(latitude: f64, longitude: f64, altitude: f64) -> Place {
        Place { latitude: latitude.to_radians(), longitude: longitude.to_radians(), altitude }
    }

    #[test]
    fn normal_gravity_is_that_of_wgs_84() {
        // NIMA TR8350.2: equator, pole, and the mean-latitude value 9.80620 at 45°.
        for (latitude, expected) in [(0.0, 9.780_325_335_9), (90.0, 9.832_184_937_9), (45.0, 9.806_197_769)] {
            assert!((normal_gravity(place(latitude, 0.0, 0.0)) - expected).abs() < 1e-8, "{latitude}");
        }
        let gradient =
            (normal_gravity(place(45.0, 0.0, 1000.0)) - normal_gravity(place(45.0, 0.0, 0.0))) / 1000.0;
        assert!((gradient + 3.086e-6).abs() < 2e-9, "free air is -0.3086 mGal a metre: {gradient}");
    }

    #[test]
    fn the_field_is_noaas_test_value() {
        // WMM2025 test values (NOAA): 2025.0, 0 km, 80 N 0 E.
        let field = magnetic_field(place(80.0, 0.0, 0.0), Day { year: 2025, month: 1, day: 1 }).unwrap();
        let expected = Vector::new(6.5216, 0.1459, 54.7915);
        assert!((field - expected).length() < 2e-4, "{field:?}");
        assert!((declination(expected).to_degrees() - 1.28).abs() < 0.01);
    }

    #[test]
    fn a_date_outside_the_model_is_refused() {
        assert!(magnetic_field(place(0.0, 0.0, 0.0), Day { year: 2050, month: 1, day: 1 }).is_err());
    }

    #[test]
    fn days_are_counted_from_1970() {
        assert_eq!(Day::parse("1970-01-02").unwrap().unix_seconds(), 86_400);
        assert_eq!(Day::parse("2026-11-22").unwrap().unix_seconds(), 1_795_305_600);
        for bad in ["2026-13-01", "2026-02-30", "22.11.2026", "2026-1-1", ""] {
            assert_eq!(Day::parse(bad), None, "{bad}");
        }
    }
}
