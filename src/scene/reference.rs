//! `[reference]`: attitude computed from error-free readings, to stand beside the exact truth in a dataset.

use super::section::Section;
use super::suggest;
use crate::geometry::{Body, Vector};
use crate::motion::Trajectory;
use crate::motion::method::{METHODS, MethodKind, ecompass, find};
use crate::sensor::{SensorKind, SensorPlan};
use crate::time::Rate;

/// What a reference is computed from, and when: at the ticks of `rate` from t = 0 on.
#[derive(Clone, Copy, Debug)]
pub enum Reference {
    /// The true angular rate, step by step.
    Gyro {
        /// How it is stepped.
        method: &'static MethodKind,
        /// The gyro's.
        rate: Rate,
    },
    /// Gravity and the field at each tick, external forces excluded.
    AccelMag {
        /// The accelerometer's.
        rate: Rate,
    },
}

impl Reference {
    /// As in `from = "…"`.
    pub fn from(&self) -> &'static str {
        match self {
            Reference::Gyro { .. } => FROM[0],
            Reference::AccelMag { .. } => FROM[1],
        }
    }

    /// At whose ticks.
    pub fn rate(&self) -> Rate {
        match self {
            Reference::Gyro { rate, .. } | Reference::AccelMag { rate } => *rate,
        }
    }

    /// The name of what computes it.
    pub fn method(&self) -> &'static str {
        match self {
            Reference::Gyro { method, .. } => method.name,
            Reference::AccelMag { .. } => "triad",
        }
    }
}

const FROM: [&str; 2] = ["gyro", "accel-mag"];
/// The paper's own.
const DEFAULT: &str = "paper";

/// The reference that the scene asks for, and its table as resolved; `sensors` is `None` where they could not all be
/// read, so that nothing is blamed on that.
pub(super) fn reference(
    top: &Section<'_>,
    sensors: Option<&[SensorPlan]>,
    trajectory: &Trajectory,
) -> Option<(Reference, toml::Table)> {
    if !top.has("reference") {
        return None;
    }
    let section = top.table("reference");
    let from = section.word("from", &FROM, FROM[0]);
    let default = (from == FROM[0]).then_some(DEFAULT);
    let method = section.text("method", default).and_then(|name| method(&section, &name));
    if section.has("tolerance") {
        section.mistake(
            "tolerance",
            "`tolerance` goes with method = \"auto\", which this version does not have",
        );
    }
    let reference = match sensors {
        Some(sensors) if from == FROM[0] => of_gyro(&section, sensors, method),
        Some(sensors) => of_accel_mag(&section, sensors, trajectory),
        None => None,
    };
    let resolved = section.finish();
    reference.map(|reference| (reference, resolved))
}

fn method(section: &Section<'_>, name: &str) -> Option<&'static MethodKind> {
    let found = find(name);
    if found.is_none() {
        let names = METHODS.map(|method| method.name);
        let why = match name {
            "auto" => format!("`auto` is not a method of this version: choose one of {}", names.join(", ")),
            _ => {
                let near = suggest::did_you_mean(name, names);
                format!("`{name}` is no method ({}){near}", names.join(", "))
            }
        };
        section.mistake("method", why);
    }
    found
}

fn rate(sensors: &[SensorPlan], kind: SensorKind) -> Option<Rate> {
    sensors.iter().find(|sensor| sensor.kind == kind).map(|sensor| sensor.rate)
}

fn of_gyro(
    section: &Section<'_>,
    sensors: &[SensorPlan],
    method: Option<&'static MethodKind>,
) -> Option<Reference> {
    let rate = rate(sensors, SensorKind::Gyro);
    if rate.is_none() {
        section.mistake("from", "a reference from the gyro needs a [gyro] with its rate");
    }
    Some(Reference::Gyro { method: method?, rate: rate? })
}

fn of_accel_mag(section: &Section<'_>, sensors: &[SensorPlan], trajectory: &Trajectory) -> Option<Reference> {
    let (accel, mag) = (rate(sensors, SensorKind::Accel), rate(sensors, SensorKind::Mag));
    if accel.is_none() || mag.is_none() {
        section
            .mistake("from", "a reference from accel-mag needs both an [accel] and a [mag] with their rates");
    }
    let (up, north) = (-trajectory.gravity(), trajectory.field());
    // The angle between the two is the same in every attitude: level stands for all.
    if let Err(why) = ecompass(Vector::<Body>::from_vec(up.v), Vector::from_vec(north.v), up, north) {
        section.mistake("from", format!("accel-mag gives no attitude here: {why}"));
        return None;
    }
    mag.and(accel).map(|rate| Reference::AccelMag { rate })
}
