//! Effects of the Earth: its rotation, its figure, its field.

use super::{EffectKind, Found, Judge, Survey};
use crate::earth::{self, STANDARD_GRAVITY};
use crate::geometry::{Nav, Vector};
use crate::report::number;
use crate::sensor::SensorKind;
use crate::time::SimTime;
use glam::DVec3;

/// The Earth's angular rate, rad/s (WGS 84: NIMA TR8350.2, third edition, table 3.1).
const EARTH_RATE: f64 = 7.292_115e-5;
/// The least radius of curvature of the WGS 84 ellipsoid, `a·(1 − e²)`: along the meridian at the equator, m.
const LEAST_RADIUS: f64 = 6_335_439.0;
/// The mean radius of the Earth in models of its field, m (Chulliat et al., *The US/UK World Magnetic Model for
/// 2020-2025*, sec. 1.2).
const FIELD_RADIUS: f64 = 6_371_200.0;
/// The free-air gradient of gravity, 1/s² (Heiskanen and Moritz, *Physical Geodesy*, 1967, sec. 2-9).
const FREE_AIR: f64 = 3.086e-6;

/// How a size that is a bound is described.
const AT_MOST: &str = "at most";

/// The Earth's rotation, which a gyroscope senses and this program's truth, relative to nav, has not:
/// `[Ω·cos φ, 0, −Ω·sin φ]` in nav at latitude φ (Groves, *Principles of GNSS, Inertial, and Multisensor Integrated
/// Navigation Systems*, 2nd ed., sec. 2.4.5), on each body axis; without a place Ω, which no axis exceeds.
pub(super) static ROTATION: EffectKind = EffectKind {
    name: "earth_rotation",
    judge: Judge::Both,
    find: |survey| {
        if !survey.is(SensorKind::Gyro) {
            return None;
        }
        let found = match survey.plan.site {
            Some(site) => {
                let (sine, cosine) = (libm::sin(site.latitude), libm::cos(site.latitude));
                let rate = Vector::new(EARTH_RATE * cosine, 0.0, -EARTH_RATE * sine);
                Found::left_out(survey.largest_of_nav(rate), "largest")
            }
            None => Found::left_out(DVec3::splat(EARTH_RATE), AT_MOST),
        };
        let turned = (EARTH_RATE * survey.plan.duration.seconds()).to_degrees();
        Some(found.noting(format!("level ground turns by {} deg in this scene", number(turned))))
    },
};

/// Transport rate: level turns with the vehicle's way over the curved Earth, by `V/(R + h)` (Groves, eq. 5.44).
pub(super) static TRANSPORT_RATE: EffectKind = EffectKind {
    name: "transport_rate",
    judge: Judge::Both,
    find: |survey| {
        let speed = speed(survey, SensorKind::Gyro)?;
        Some(Found::left_out(DVec3::splat(speed / LEAST_RADIUS), AT_MOST))
    },
};

/// Coriolis acceleration of a vehicle that goes over a turning Earth: `2·Ω × V`, at most `2·Ω·V` (Groves, sec. 5.4).
pub(super) static CORIOLIS: EffectKind = EffectKind {
    name: "coriolis",
    judge: Judge::Both,
    find: |survey| {
        let speed = speed(survey, SensorKind::Accel)?;
        Some(Found::left_out(DVec3::splat(2.0 * EARTH_RATE * speed), AT_MOST))
    },
};

/// Normal gravity at the scene's place against the standard value (modelled), or against the value that the scene
/// gives instead (left out).
pub(super) static GRAVITY_OF_PLACE: EffectKind = EffectKind {
    name: "gravity_of_place",
    judge: Judge::Both,
    find: |survey| {
        let site = survey.plan.site.filter(|_| survey.is(SensorKind::Accel))?;
        let (there, used) = (earth::normal_gravity(site), survey.trajectory().gravity());
        let there = Vector::<Nav>::new(0.0, 0.0, there);
        let standard = Vector::new(0.0, 0.0, STANDARD_GRAVITY);
        Some(of_place(survey, there, standard, used, "gravity", "m/s²"))
    },
};

/// Gravity's change with height: 3.086·10⁻⁶ m/s² a metre, times how far the vehicle leaves its height, having set
/// out level.
pub(super) static GRAVITY_WITH_HEIGHT: EffectKind = EffectKind {
    name: "gravity_with_height",
    judge: Judge::Both,
    find: |survey| {
        if !survey.is(SensorKind::Accel) {
            return None;
        }
        let height = height_change(survey);
        let note = match height {
            0.0 => "no height change in this scene".to_string(),
            _ => format!("height changes by {} m", number(height)),
        };
        let size = survey.largest_of_nav(survey.down() * (FREE_AIR * height));
        Some(Found::left_out(size, "largest").noting(note))
    },
};

/// Declination: how far the field is from one of its strength and dip towards true north.
pub(super) static DECLINATION: EffectKind = EffectKind {
    name: "declination",
    judge: Judge::Both,
    find: |survey| {
        let field = survey.trajectory().field();
        let angle = earth::declination(field);
        if !survey.is(SensorKind::Mag) || angle == 0.0 {
            return None;
        }
        let to_north = Vector::new(libm::hypot(field.v.x, field.v.y), 0.0, field.v.z);
        let size = survey.largest_of_nav(field - to_north);
        let key = if is_modelled(model(survey), field) { "earth.latitude" } else { "earth.field" };
        let note = format!("{} deg", number(angle.to_degrees()));
        Some(Found::modelled(size, "largest").by(key).noting(note))
    },
};

/// The World Magnetic Model's field at the scene's place and date against the default field (modelled), or against
/// the field that the scene gives instead (left out).
pub(super) static FIELD_OF_PLACE: EffectKind = EffectKind {
    name: "field_of_place",
    judge: Judge::Both,
    find: |survey| {
        let there = model(survey).filter(|_| survey.is(SensorKind::Mag))?;
        let used = survey.trajectory().field();
        Some(of_place(survey, there, earth::default_field(), used, "field", "µT"))
    },
};

/// The field's change along the path: that of a dipole falls with the cube of the distance from its centre, so by at
/// most `3·B/R` a metre, times the way flown.
pub(super) static FIELD_ALONG_PATH: EffectKind = EffectKind {
    name: "field_along_path",
    judge: Judge::Both,
    find: |survey| {
        let speed = speed(survey, SensorKind::Mag)?;
        let way = speed * survey.trajectory().moving_until().min(survey.plan.duration).seconds();
        let gradient = 3.0 * survey.trajectory().field().length() / FIELD_RADIUS;
        Some(Found::left_out(DVec3::splat(gradient * way), AT_MOST))
    },
};

/// The vehicle's greatest speed for a sensor of this kind; `None` where it turns where it stands.
fn speed(survey: &Survey<'_>, kind: SensorKind) -> Option<f64> {
    let speed = survey.trajectory().speed(survey.plan.duration);
    (survey.is(kind) && speed > 0.0).then_some(speed)
}

fn model(survey: &Survey<'_>) -> Option<Vector<Nav>> {
    earth::magnetic_field(survey.plan.site?, survey.plan.day?).ok()
}

fn is_modelled(there: Option<Vector<Nav>>, used: Vector<Nav>) -> bool {
    there.is_some_and(|there| (there - used).length() <= 1e-12 * used.length())
}

/// What the model says of the place, against what a scene without one has, or against what stands in the way.
fn of_place(
    survey: &Survey<'_>,
    there: Vector<Nav>,
    default: Vector<Nav>,
    used: Vector<Nav>,
    key: &str,
    unit: &str,
) -> Found {
    if is_modelled(Some(there), used) {
        return Found::modelled(survey.largest_of_nav(there - default), "largest").by("earth.latitude");
    }
    let note = format!("earth.{key} replaces the {} {unit} of the place", number(there.length()));
    Found::left_out(survey.largest_of_nav(there - used), "largest").by(format!("earth.{key}")).noting(note)
}

/// The greatest distance from the height at the start, by integrating the vertical acceleration twice, m.
fn height_change(survey: &Survey<'_>) -> f64 {
    let (mut height, mut climb, mut most) = (0.0, 0.0, 0.0f64);
    let mut before = (SimTime::ZERO, survey.trajectory().kinematics(SimTime::ZERO).acceleration.v.z);
    for look in &survey.looks {
        let now = (look.t, survey.trajectory().kinematics(look.t).acceleration.v.z);
        let dt = (now.0 - before.0).seconds();
        height += dt * (climb + dt * (before.1 / 3.0 + now.1 / 6.0));
        climb += dt * (before.1 + now.1) / 2.0;
        most = most.max(f64::abs(height));
        before = now;
    }
    most
}
