//! Where the vehicle starts, what it does, what pushes it, and the place it is at.

use super::document::Value;
use super::section::Section;
use super::suggest;
use crate::double::Double;
use crate::earth::{self, Day};
use crate::geometry::{Attitude, Axes, Nav, Vector};
use crate::motion::{self, Context, Force, Misfit, Motion, Push, Trajectory};
use crate::quantity::{self, Kind, Sign};
use crate::time::SimTime;
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI};

fn plain(triple: [Double; 3]) -> DVec3 {
    DVec3::from_array(triple.map(Double::to_f64))
}

pub(super) struct Start {
    pub attitude: Attitude,
    /// Whether the scene says so.
    given: bool,
    /// Over the ground, m/s, where the scene says it.
    pub velocity: Option<Vector<Nav>>,
    pub resolved: toml::Table,
}

/// `[start]`: three angles or a quaternion, and a velocity.
pub(super) fn start(top: &Section<'_>) -> Start {
    let section = top.table("start");
    let given = section.has("attitude") || section.has("quaternion");
    let attitude = section.attitude(Some("[0, 0, 0] deg")).unwrap_or(Attitude::IDENTITY);
    let velocity = section.vector("velocity", Kind::SPEED, None);
    let velocity = velocity.map(|velocity| section.axes().nav_in(plain(velocity)));
    Start { attitude, given, velocity, resolved: section.finish() }
}

impl Start {
    /// Where the scene left it open and its first motion begins.
    fn settle(&mut self, attitude: Attitude, axes: Axes) {
        let q = axes.attitude_out(attitude);
        self.attitude = attitude;
        self.resolved.remove("attitude");
        self.resolved.insert("quaternion".into(), vec![q.w, q.x, q.y, q.z].into());
    }

    /// Says in the scene as resolved with which velocity it begins, where that matters and it left it open.
    pub fn settle_velocity(&mut self, velocity: Vector<Nav>, axes: Axes) {
        if self.velocity.is_none() {
            let text = quantity::text_vector(axes.nav_out(velocity).to_array(), "m/s");
            self.resolved.insert("velocity".into(), text.into());
        }
    }
}

pub(super) struct Earth {
    pub gravity: Vector<Nav>,
    pub field: Vector<Nav>,
    pub place: Option<earth::Place>,
    pub wind: Vector<Nav>,
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
            section.mistake("date", format!("`{text}` is not a date: write it like \"2026-11-22\""));
        }
        day
    });
    let gravity = if section.has("gravity") {
        gravity(&section)
    } else {
        let strength = place.map_or(earth::STANDARD_GRAVITY, earth::normal_gravity);
        section.resolve("gravity", quantity::text_scalar(strength, "m/s^2"));
        Vector::new(0.0, 0.0, strength)
    };
    let field = if section.has("field") {
        section.vector("field", Kind::FIELD, None).map_or(Vector::ZERO, |field| axes.nav_in(plain(field)))
    } else {
        let field = modelled_field(&section, place, day);
        section.resolve("field", quantity::text_vector(axes.nav_out(field).to_array(), "uT"));
        field
    };
    let wind = section.has("wind").then(|| section.vector("wind", Kind::SPEED, None)).flatten();
    let wind = wind.map_or(Vector::ZERO, |wind| axes.nav_in(plain(wind)));
    Earth { gravity, field, wind, place, day, resolved: section.finish() }
}

/// One number pulls straight down; a vector is the acceleration of free fall in nav axes.
fn gravity(section: &Section<'_>) -> Vector<Nav> {
    let is_vector = section
        .entry("gravity")
        .is_some_and(|entry| matches!(&entry.node.value, Value::Text(text) if text.contains('[')));
    if is_vector {
        let given = section.vector("gravity", Kind::ACCELERATION, None).map(plain);
        return section.axes().nav_in(given.unwrap_or_default());
    }
    let strength = section.scalar("gravity", Kind::ACCELERATION.signed(Sign::NonNegative), None);
    Vector::new(0.0, 0.0, strength.unwrap_or_default())
}

fn modelled_field(section: &Section<'_>, place: Option<earth::Place>, day: Option<Day>) -> Vector<Nav> {
    let Some(place) = place else { return earth::default_field() };
    let Some(day) = day else {
        if !section.has("date") {
            section.mistake("latitude", "the magnetic field at a place depends on the day: add a `date`, such as \"2026-11-22\", or give `field` itself");
        }
        return earth::default_field();
    };
    if !(-1e3..=850e3).contains(&place.altitude) {
        section.mistake("altitude", "the World Magnetic Model covers -1 km to 850 km: give `field` itself");
        return earth::default_field();
    }
    earth::magnetic_field(place, day).unwrap_or_else(|why| {
        section.mistake(
            "date",
            format!("the World Magnetic Model has no field for it ({why}): give `field` itself"),
        );
        earth::default_field()
    })
}

fn place(section: &Section<'_>) -> Option<earth::Place> {
    let latitude = section.scalar("latitude", Kind::ANGLE, None);
    let longitude = section.scalar("longitude", Kind::ANGLE, None);
    let altitude = section.scalar("altitude", Kind::LENGTH, None);
    let mut inside = true;
    for (key, other, angle, limit) in
        [("latitude", "longitude", latitude, FRAC_PI_2), ("longitude", "latitude", longitude, 2.0 * PI)]
    {
        if section.has(key) && !section.has(other) {
            section.mistake(key, format!("a place needs a `{other}` too"));
        }
        if let Some(angle) = angle.filter(|angle| angle.abs() > limit) {
            inside = false;
            let given = quantity::text_scalar(angle, "deg");
            section.mistake(key, format!("{given} is beyond ±{} deg", limit.to_degrees()));
        }
    }
    if section.has("altitude") && !section.has("latitude") && !section.has("longitude") {
        section.mistake("altitude", "an altitude needs a `latitude` and a `longitude` too");
    }
    let (latitude, longitude) = (latitude?, longitude?);
    // 190° east is 170° west.
    let longitude = longitude - 2.0 * PI * libm::round(longitude / (2.0 * PI));
    inside.then_some(earth::Place { latitude, longitude, altitude: altitude.unwrap_or(0.0) })
}

pub(super) struct Motions {
    pub motions: Vec<(SimTime, Box<dyn Motion>)>,
    pub resolved: Vec<toml::Value>,
}

/// Every `[[motion]]`, read by the declaration of its kind; the first finds the vehicle at `start`, or settles that
/// where the scene leaves it open.
pub(super) fn motions(top: &Section<'_>, gravity: f64, start: &mut Start) -> Motions {
    let (mut motions, mut resolved) = (Vec::new(), Vec::new());
    let mut here = start.attitude;
    for (index, section) in top.tables("motion").into_iter().enumerate() {
        let anywhere = index == 0 && !start.given;
        if let Some((duration, motion)) = motion(&section, gravity, index, here, anywhere) {
            if let Some(begins) = motion.begins().filter(|_| anywhere) {
                here = begins;
                start.settle(begins, section.axes());
            }
            motion.warnings().iter().for_each(|warning| section.reader.warn(warning.clone()));
            here = motion.at(here, duration.exact_seconds()).attitude;
            motions.push((duration, motion));
        }
        resolved.push(section.finish().into());
    }
    Motions { motions, resolved }
}

fn motion(
    section: &Section<'_>,
    gravity: f64,
    index: usize,
    start: Attitude,
    anywhere: bool,
) -> Option<(SimTime, Box<dyn Motion>)> {
    let names = motion::KINDS.map(|kind| kind.name);
    let Some(name) = section.text("kind", None) else {
        if !section.has("kind") {
            section.lacks(format!(
                "a motion needs a kind, such as kind = \"rotate\", one of {}",
                names.join(", ")
            ));
        }
        section.allow_everything();
        return None;
    };
    let Some(kind) = motion::KINDS.into_iter().find(|kind| kind.name == name) else {
        let near = suggest::did_you_mean(&name, names);
        section.mistake(
            "kind",
            format!("`{name}` is not a kind of motion; the kinds are {}{near}", names.join(", ")),
        );
        section.allow_everything();
        return None;
    };
    section.call(format!("a `{name}` motion"));
    if !section.has("duration") && !kind.has_length {
        section.lacks("a motion needs a duration, such as duration = \"5 s\"".into());
    }
    let duration = section.time("duration", None, Sign::Positive);
    if duration.is_none() {
        // Its place among the keys, so that the scene as resolved is the same however it was found.
        section.resolve("duration", "");
    }
    let values = section.values(kind.keys, false);
    if section.unread(kind.keys, &values) {
        return None;
    }
    // Where the duration is a mistake already, nothing else is blamed on it.
    let in_time = duration.unwrap_or(SimTime::FOREVER);
    let context = Context {
        duration: in_time,
        start,
        anywhere,
        seed: section.seed(),
        index,
        gravity,
        axes: section.axes(),
    };
    match (kind.build)(&values, &context) {
        // A log has the rates that it has.
        Ok(motion) if !kind.has_length && too_fast(&*motion).is_some() => {
            section.mistake("kind", too_fast(&*motion).unwrap_or_default());
            None
        }
        Ok(motion) => {
            let own = || {
                let length = motion.length().filter(|_| !section.has("duration"))?;
                section.resolve("duration", length.to_string());
                Some(length)
            };
            Some((duration.or_else(own)?, motion))
        }
        Err(error) => {
            section.mistake(error.key, error.message);
            None
        }
    }
}

/// The fastest that a motion may turn, or what it turns by may change: a million degrees a second. A mean over an
/// interval takes a step for every radian.
const FASTEST: f64 = 1e6 * PI / 180.0;

/// What is wrong with a motion that no body makes and no machine averages.
fn too_fast(motion: &dyn Motion) -> Option<String> {
    let fastest = motion.fastest();
    // Written so that what is not a number is refused too.
    let bounded = fastest <= FASTEST * (1.0 + 1e-9);
    (!bounded).then(|| {
        let degrees = fastest.to_degrees();
        format!("this motion turns, or its rate changes, at {degrees:.3e} deg/s, above the limit of 1e6 deg/s: check its units and digits")
    })
}

/// What a user should know whose vehicle comes to a motion at another velocity than that means.
pub(super) fn misfits(trajectory: &Trajectory, axes: Axes) -> Vec<String> {
    let text = |v: Vector<Nav>| {
        // Whole millimetres: it is to be read.
        let rounded = axes.nav_out(v).to_array().map(|x| libm::round(x * 1e3) / 1e3 + 0.0);
        quantity::text_vector(rounded, "m/s")
    };
    let warn = |misfit: &Misfit| {
        format!(
            "the motion at {} starts at a velocity of {}, but the vehicle arrives with {}: position drifts by the difference; set `velocity` in [start]",
            misfit.start,
            text(misfit.meant),
            text(misfit.found)
        )
    };
    trajectory.misfits().iter().map(warn).collect()
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
    let start = section.time("start", Some("0 s"), Sign::NonNegative);
    for (key, example) in [("duration", "2 s"), ("acceleration", "[0, 1.5, 0] m/s^2")] {
        if !section.has(key) {
            section.lacks(format!("a force needs its {key}, such as {key} = \"{example}\""));
        }
    }
    let duration = section.time("duration", None, Sign::Positive);
    let acceleration = section.vector("acceleration", Kind::ACCELERATION, None);
    let frame = section.word("frame", &["body", "nav"], "body");
    let (start, acceleration) = (start?, plain(acceleration?));
    let push = match frame {
        "nav" => Push::Nav(section.axes().nav_in(acceleration)),
        _ => Push::Body(section.axes().body_in(acceleration)),
    };
    Some(Force { start, end: start + duration?, push })
}
