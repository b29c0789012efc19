//! Metres of the local level plane on the WGS 84 ellipsoid.
//!
//! The plane is rolled out on the ellipsoid, so that a path that closes in metres closes in degrees too: north is
//! length along the meridian, `dφ/dn = 1/(M(φ) + h₀)`; east is length along the parallel of the latitude then reached,
//! `λ = λ₀ + e/((N(φ) + h₀)·cos φ)`; down is altitude. M and N are the radii of curvature of meridian and prime
//! vertical (Torge, Geodesy, 4th edition, eq. 4.13 and 4.15), h₀ the altitude of the start.

use super::Place;
use crate::geometry::{Nav, Vector};
use std::f64::consts::{FRAC_PI_2, PI};

/// Semi-major axis of WGS 84, m.
pub(super) const A: f64 = 6_378_137.0;
/// First eccentricity of WGS 84, squared.
pub(super) const E2: f64 = 0.006_694_379_990_13;

impl Place {
    /// The place that many metres north, east and down.
    ///
    /// The meridian's length is met within 10⁻⁵ m over 100 km. Away from the start a plane and an ellipsoid differ:
    /// a speed north, `e` metres east of it, is seen with `e·tan φ/M` of itself as a speed east (0.03 % at 1 km and
    /// 60° of latitude), and a climb of a kilometre makes the degrees 0.016 % too large. Within some metres of a pole
    /// longitude has no meaning.
    pub fn moved(self, by: Vector<Nav>) -> Place {
        let (north, east) = (by.v.x, by.v.y);
        let slope = |latitude: f64| 1.0 / (meridian(latitude) + self.altitude);
        // One step of the classical Runge-Kutta method: the radius hardly changes on the way.
        let k1 = slope(self.latitude);
        let k2 = slope(self.latitude + 0.5 * north * k1);
        let k3 = slope(self.latitude + 0.5 * north * k2);
        let k4 = slope(self.latitude + north * k3);
        let latitude = self.latitude + north / 6.0 * (k1 + 2.0 * (k2 + k3) + k4);
        let latitude = latitude.clamp(-FRAC_PI_2, FRAC_PI_2);
        let radius = (prime_vertical(latitude) + self.altitude) * libm::cos(latitude).max(1e-9);
        let longitude = self.longitude + east / radius;
        Place {
            latitude,
            longitude: if longitude.abs() > PI {
                longitude - 2.0 * PI * libm::round(longitude / (2.0 * PI))
            } else {
                longitude
            },
            altitude: self.altitude - by.v.z,
        }
    }
}

/// Radius of curvature of the meridian, m.
fn meridian(latitude: f64) -> f64 {
    let s = libm::sin(latitude);
    let w = 1.0 - E2 * s * s;
    A * (1.0 - E2) / (w * libm::sqrt(w))
}

/// Radius of curvature of the prime vertical, m.
fn prime_vertical(latitude: f64) -> f64 {
    let s = libm::sin(latitude);
    A / libm::sqrt(1.0 - E2 * s * s)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    fn place(latitude: f64, longitude: f64, altitude: f64) -> Place {
        Place { latitude: latitude.to_radians(), longitude: longitude.to_radians(), altitude }
    }

    /// Earth-centred coordinates, by the closed form of the ellipsoid.
    fn earth_centred(place: Place) -> DVec3 {
        let n = prime_vertical(place.latitude);
        let (s, c) = place.latitude.sin_cos();
        let out = (n + place.altitude) * c;
        DVec3::new(
            out * place.longitude.cos(),
            out * place.longitude.sin(),
            (n * (1.0 - E2) + place.altitude) * s,
        )
    }

    #[test]
    fn along_the_equator_and_straight_up_it_is_a_closed_form() {
        let start = place(0.0, 10.0, 500.0);
        let moved = start.moved(Vector::new(0.0, 123_456.0, -250.0));
        assert_eq!(moved.latitude, 0.0);
        assert!((moved.longitude - start.longitude - 123_456.0 / (A + 500.0)).abs() < 1e-15);
        assert_eq!(moved.altitude, 750.0);
    }

    /// The quarter meridian of WGS 84 is 10 001 965.729 m; 90 steps of a degree cover it.
    #[test]
    fn north_is_length_along_the_meridian() {
        let mut here = place(0.0, 0.0, 0.0);
        let steps = 90;
        for _ in 0..steps {
            here = here.moved(Vector::new(10_001_965.729 / f64::from(steps), 0.0, 0.0));
        }
        let short = (FRAC_PI_2 - here.latitude) * meridian(FRAC_PI_2);
        assert!(short.abs() < 2e-3, "{short} m from the pole");
    }

    #[test]
    fn a_hundred_kilometres_in_one_step_are_those_of_many() {
        for latitude in [-60.0, 0.0, 45.0, 80.0] {
            let start = place(latitude, 20.0, 100.0);
            let once = start.moved(Vector::new(1e5, 0.0, 0.0));
            let mut here = start;
            for _ in 0..1000 {
                here = here.moved(Vector::new(100.0, 0.0, 0.0));
            }
            let off = (once.latitude - here.latitude) * A;
            assert!(off.abs() < 1e-5, "{latitude}: {off} m");
        }
    }

    /// A hundred metres any way are a hundred metres in space, but for the ellipsoid's curvature.
    #[test]
    fn metres_are_metres_in_space() {
        for latitude in [-75.0, -30.0, 0.0, 59.93, 80.0] {
            let start = place(latitude, 179.9995, 300.0);
            for by in [[100.0, 0.0, 0.0], [0.0, 100.0, 0.0], [0.0, 0.0, 100.0], [-60.0, 80.0, 0.0]] {
                let by = Vector::new(by[0], by[1], by[2]);
                let moved = start.moved(by);
                assert!(moved.longitude.abs() <= PI);
                let distance = (earth_centred(moved) - earth_centred(start)).length();
                // n·e/(2M)·tan φ of an oblique step: 1.4 mm of 60 m and 80 m at 80°.
                assert!((distance - by.length()).abs() < 2.5e-3, "{latitude} {by:?}: {distance}");
            }
        }
    }

    #[test]
    fn a_path_that_closes_in_metres_closes_in_degrees() {
        let start = place(59.93, 30.31, 10.0);
        assert_eq!(start.moved(Vector::ZERO), start);
        let pole = place(90.0, 0.0, 0.0).moved(Vector::new(1.0, 1.0, 0.0));
        assert!(pole.latitude <= FRAC_PI_2 && pole.longitude.is_finite());
    }
}
