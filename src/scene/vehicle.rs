//! Where the vehicle starts, what it does, what pushes it, and the place it is at.

use super::document::Value;
use super::section::Section;
use super::suggest;
use crate::double::Double;
use crate::earth::{self, Day};
use crate::geometry::{Attitude, Euler, Nav, Vector};
use crate::motion::{self, Context, Force, Motion, Push};
use crate::quantity::Kind;
use crate::time::SimTime;
use glam::{DQuat, DVec3};
use std::f64::consts::{FRAC_PI_2, PI};

fn plain(triple: [Double; 3]) -> DVec3 {
    DVec3::from_array(triple.map(Double::to_f64))
}

pub(super) struct Start {
    pub attitude: Attitude,
    pub resolved: toml::Table,
}

/// `[start]`: three angles or a quaternion.
pub(super) fn start(top: &Section<'_>) -> Start {
    let section = top.table("start");
    let q = if section.has("quaternion") {
        if section.has("attitude") {
            section.mistake("quaternion", "`attitude` already gives it: keep one of the two");
        }
        section.quaternion("quaternion").map(|[w, x, y, z]| DQuat::from_xyzw(x, y, z, w))
    } else {
        // Half angles to full precision: a decimal in degrees is not its nearest double in radians.
        section.vector("attitude", Kind::ANGLE, Some("[0, 0, 0] deg")).map(|angles| {
            Euler::quat_of_half_angles(angles.map(|angle| (angle / Double::from(2.0)).sin_cos()))
        })
    };
    let attitude = top.axes().attitude_in(q.unwrap_or(DQuat::IDENTITY));
    Start { attitude, resolved: section.finish() }
}

pub(super) struct Earth {
    pub gravity: Vector<Nav>,
    pub field: Vector<Nav>,
    pub day: Option<Day>,
    pub resolved: toml::Table,
}

/// `[earth]`: explicit vectors, or what the models say of a place and date; explicit wins, key by key.
pub(super) fn earth(top: &Section<'_>) -> Earth {
    let section = top.table("earth");
    let axes = top.axes();
    let place = place(&section);
    let day = section.text("date", None).and_then(|text| {
        let day = Day::parse(&text);
        if day.is_none() {
            section.mistake("date", format!("`{text}` is no date: write it as \"2026-11-22\""));
        }
        day
    });
    let gravity = if section.has("gravity") {
        gravity(&section)
    } else {
        let strength = place.map_or(earth::STANDARD_GRAVITY, earth::normal_gravity);
        section.resolve("gravity", crate::quantity::text_scalar(strength, "m/s^2"));
        Vector::new(0.0, 0.0, strength)
    };
    let field = if section.has("field") {
        section.vector("field", Kind::FIELD, None).map_or(Vector::ZERO, |field| axes.nav_in(plain(field)))
    } else {
        let field = modelled_field(&section, place, day);
        section.resolve("field", crate::quantity::text_vector(axes.nav_out(field).to_array(), "uT"));
        field
    };
    Earth { gravity, field, day, resolved: section.finish() }
}

/// One number pulls straight down; a vector is the acceleration of free fall in nav axes.
fn gravity(section: &Section<'_>) -> Vector<Nav> {
    let is_vector = section.entry("gravity").is_some_and(|entry| matches!(&entry.node.value, Value::Text(text) if text.contains('[')));
    let Some(given) = section.vector("gravity", Kind::ACCELERATION, None).map(plain) else { return Vector::ZERO };
    if is_vector {
        return section.axes().nav_in(given);
    }
    if given.x < 0.0 {
        section.mistake("gravity", format!("{} is negative: one number is the strength of gravity, which pulls down", given.x));
    }
    Vector::new(0.0, 0.0, given.z)
}

fn modelled_field(section: &Section<'_>, place: Option<earth::Place>, day: Option<Day>) -> Vector<Nav> {
    let Some(place) = place else { return earth::default_field() };
    let Some(day) = day else {
        if !section.has("date") {
            section.mistake("latitude", "the field at a place depends on the date: add date = \"2026-11-22\", or give `field`");
        }
        return earth::default_field();
    };
    earth::magnetic_field(place, day).unwrap_or_else(|why| {
        section.mistake("date", format!("the World Magnetic Model has no field for it: {why}"));
        earth::default_field()
    })
}

fn place(section: &Section<'_>) -> Option<earth::Place> {
    let latitude = section.scalar("latitude", Kind::ANGLE, None);
    let longitude = section.scalar("longitude", Kind::ANGLE, None);
    let altitude = section.scalar("altitude", Kind::LENGTH, None);
    for (key, other, angle, limit) in [("latitude", "longitude", latitude, FRAC_PI_2), ("longitude", "latitude", longitude, 2.0 * PI)] {
        if section.has(key) && !section.has(other) {
            section.mistake(key, format!("a place needs a `{other}` too"));
        }
        if let Some(angle) = angle.filter(|angle| angle.abs() > limit) {
            section.mistake(key, format!("{} deg is beyond ±{} deg", angle.to_degrees(), limit.to_degrees()));
        }
    }
    if section.has("altitude") && !section.has("latitude") {
        section.mistake("altitude", "an altitude needs a `latitude` and a `longitude` too");
    }
    Some(earth::Place { latitude: latitude?, longitude: longitude?, altitude: altitude.unwrap_or(0.0) })
}

pub(super) struct Motions {
    pub motions: Vec<(SimTime, Box<dyn Motion>)>,
    pub resolved: Vec<toml::Value>,
}

/// Every `[[motion]]`, read by the declaration of its kind.
pub(super) fn motions(top: &Section<'_>, gravity: f64) -> Motions {
    let (mut motions, mut resolved) = (Vec::new(), Vec::new());
    for section in top.tables("motion") {
        motions.extend(motion(&section, gravity));
        resolved.push(section.finish().into());
    }
    Motions { motions, resolved }
}

fn motion(section: &Section<'_>, gravity: f64) -> Option<(SimTime, Box<dyn Motion>)> {
    let names = motion::KINDS.map(|kind| kind.name);
    let Some(name) = section.text("kind", None) else {
        if !section.has("kind") {
            section.mistake("kind", format!("a motion needs a kind: {}", names.join(", ")));
        }
        section.allow_everything();
        return None;
    };
    let Some(kind) = motion::KINDS.into_iter().find(|kind| kind.name == name) else {
        let near = suggest::nearest(&name, names).map_or(String::new(), |near| format!(", perhaps `{near}`"));
        section.mistake("kind", format!("`{name}` is none of {}{near}", names.join(", ")));
        section.allow_everything();
        return None;
    };
    let values = section.values(kind.keys, false);
    if !section.has("duration") {
        section.mistake("duration", "a motion needs a duration, such as \"5 s\"");
    }
    let duration = section.time("duration", None)?;
    let unread = kind.keys.iter().any(|key| section.has(key.name) && !values.has(key.name));
    if unread {
        return None;
    }
    let context = Context { duration, gravity, body_sign: section.axes().body_sign() };
    match (kind.build)(&values, &context) {
        Ok(motion) => Some((duration, motion)),
        Err(error) => {
            section.mistake(error.key, error.message);
            None
        }
    }
}

pub(super) struct Forces {
    pub forces: Vec<Force>,
    pub resolved: Vec<toml::Value>,
}

/// Every `[[force]]`.
pub(super) fn forces(top: &Section<'_>) -> Forces {
    let (mut forces, mut resolved) = (Vec::new(), Vec::new());
    for section in top.tables("force") {
        forces.extend(force(&section));
        resolved.push(section.finish().into());
    }
    Forces { forces, resolved }
}

fn force(section: &Section<'_>) -> Option<Force> {
    let start = section.time("start", Some("0 s"));
    for (key, example) in [("duration", "2 s"), ("acceleration", "[0, 1.5, 0] m/s^2")] {
        if !section.has(key) {
            section.mistake(key, format!("a force needs it: {key} = \"{example}\""));
        }
    }
    let duration = section.time("duration", None);
    let acceleration = section.vector("acceleration", Kind::ACCELERATION, None);
    let frame = section.word("frame", &["body", "nav"], "body");
    let (start, acceleration) = (start?, plain(acceleration?));
    let push = match frame {
        "nav" => Push::Nav(section.axes().nav_in(acceleration)),
        _ => Push::Body(section.axes().body_in(acceleration)),
    };
    Some(Force { start, end: start + duration?, push })
}
