//! How large each effect is in a scene, or would be, against what each sensor can show: whether the scene models
//! enough and no more.
//!
//! An effect's size is computed from the scene's values, its motion, constants of physics and the part's datasheet;
//! one whose size follows from none of these is not listed. The rule: an effect is *seen* where it is at least half
//! a count and at least a tenth of the white noise of one sample, on some axis. A slow effect may be found below
//! that by averaging many samples: the rule is about readings.
//!
//! To add an effect: a constant [`EffectKind`] in one of the files beside this one (or a new one), and its line in
//! [`EFFECTS`]. An error term of `sensor` without an entry is still listed: its size is then measured, by building
//! the sensor with and without it.
//!
//! ```
//! use ratetable::{effects::effects, scene::Plan};
//!
//! let plan = Plan::load("still", &[])?;
//! assert!(!effects(&plan).is_empty());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod datasheet;
mod earth;
mod measured;
mod path;
mod survey;
mod terms;

pub use survey::{Survey, TICKS};

use crate::scene::Plan;
use crate::sensor::{SensorKind, SensorPlan, lsb, white_noise};
use glam::DVec3;
use serde::{Serialize, Serializer};
use std::fmt;

/// What an effect comes to, and whether the scene has it.
#[derive(Clone, Debug)]
pub struct Found {
    /// Its magnitude on each body axis, in the reading's unit.
    pub size: DVec3,
    /// Which number of the effect that is: `largest`, `standard deviation at the end`.
    pub statistic: &'static str,
    /// Whether the scene's readings have it.
    pub modelled: bool,
    /// The scene's key that it comes from, or would; `None` where not modelled in this version.
    pub key: Option<String>,
    /// What else a reader should know.
    pub note: Option<String>,
}

impl Found {
    /// An effect that this version does not model.
    pub fn left_out(size: DVec3, statistic: &'static str) -> Found {
        Found { size, statistic, modelled: false, key: None, note: None }
    }

    /// An effect that the scene has.
    pub fn modelled(size: DVec3, statistic: &'static str) -> Found {
        Found { modelled: true, ..Found::left_out(size, statistic) }
    }

    /// By this key of the scene.
    pub fn by(mut self, key: impl Into<String>) -> Found {
        self.key = Some(key.into());
        self
    }

    /// With a note.
    pub fn noting(mut self, note: impl Into<String>) -> Found {
        self.note = Some(note.into());
        self
    }
}

/// What an effect is set against: not against itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Judge {
    /// Half a count and a tenth of the noise.
    Both,
    /// Half a count alone: for noise itself.
    Resolution,
    /// A tenth of the noise alone: for rounding itself.
    Noise,
}

/// An effect: its name and how large it is.
#[derive(Debug)]
pub struct EffectKind {
    /// As `check` calls it; that of an error term is the term's.
    pub name: &'static str,
    /// What it is set against.
    pub judge: Judge,
    /// How large it is for this sensor; `None` where it does not concern it, or has no size that follows from the
    /// scene.
    pub find: fn(&Survey<'_>) -> Option<Found>,
}

/// Every effect, in the order of the table: error terms in that of their chain, what moves, the Earth.
pub static EFFECTS: [&EffectKind; 23] = [
    &terms::HARD_IRON,
    &terms::MATRIX,
    &terms::NONLINEARITY,
    &terms::BIAS,
    &terms::BIAS_INSTABILITY,
    &terms::BIAS_WALK,
    &terms::G_SENSITIVITY,
    &terms::WHITE_NOISE,
    &terms::RANGE,
    &terms::RESOLUTION,
    &path::FORCE,
    &path::PATH_ACCELERATION,
    &path::AVERAGING,
    &path::AVERAGING_OVER_SEAMS,
    &path::LEVER_ARM,
    &earth::ROTATION,
    &earth::TRANSPORT_RATE,
    &earth::CORIOLIS,
    &earth::GRAVITY_OF_PLACE,
    &earth::GRAVITY_WITH_HEIGHT,
    &earth::DECLINATION,
    &earth::FIELD_OF_PLACE,
    &earth::FIELD_ALONG_PATH,
];

/// Whether a scene has an effect, and whether its sensor would show it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The scene has it and it shows.
    Seen,
    /// The scene has it and it does not show: it could be left out.
    Needless,
    /// The scene does not have it, and it would not show.
    Negligible,
    /// The scene does not have it, and it would show.
    Missing,
}

impl Verdict {
    const fn of(modelled: bool, seen: bool) -> Verdict {
        match (modelled, seen) {
            (true, true) => Verdict::Seen,
            (true, false) => Verdict::Needless,
            (false, false) => Verdict::Negligible,
            (false, true) => Verdict::Missing,
        }
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Verdict::Seen => "modelled and seen",
            Verdict::Needless => "modelled but below",
            Verdict::Negligible => "left out and below",
            Verdict::Missing => "left out but would be seen",
        })
    }
}

impl Serialize for Verdict {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// What one axis of a sensor can show, in the reading's unit; nothing given = an ideal sensor, which shows all.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Against {
    /// One count.
    pub resolution: Option<f64>,
    /// The standard deviation of the white noise of one sample.
    pub noise: Option<f64>,
}

impl Against {
    fn of(sensor: &SensorPlan, axis: usize, judge: Judge) -> Against {
        let noise = white_noise::sigma(&sensor.values, sensor.kind, sensor.rate).unwrap_or_default()[axis];
        Against {
            resolution: lsb(&sensor.values, sensor.kind).filter(|_| judge != Judge::Noise),
            noise: Some(noise).filter(|&noise| noise > 0.0 && judge != Judge::Resolution),
        }
    }

    /// From where on an effect is seen: half a count or a tenth of the noise, whichever is more.
    pub fn threshold(&self) -> f64 {
        f64::max(self.resolution.unwrap_or(0.0) / 2.0, self.noise.unwrap_or(0.0) / 10.0)
    }

    /// Whether an effect of this size shows.
    pub fn shows(&self, size: f64) -> bool {
        size > 0.0 && size >= self.threshold()
    }
}

/// One effect on one sensor of a scene.
#[derive(Clone, Debug, Serialize)]
pub struct Effect {
    /// Its name.
    pub effect: &'static str,
    /// Whose reading it changes.
    #[serde(serialize_with = "by_name")]
    pub sensor: SensorKind,
    /// Its magnitude on `axis`, in `unit`.
    pub size: f64,
    /// Of the size, as a scene spells it.
    pub unit: &'static str,
    /// The body axis on which it shows most.
    pub axis: &'static str,
    /// Which number of the effect the size is.
    pub statistic: &'static str,
    /// Whether the scene's readings have it.
    pub modelled: bool,
    /// What that axis can show.
    pub against: Against,
    /// What follows.
    pub verdict: Verdict,
    /// The key that it comes from, or would; absent where not modelled in this version.
    pub key: Option<String>,
    /// What else a reader should know.
    pub note: Option<String>,
}

fn by_name<S: Serializer>(kind: &SensorKind, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(kind.name())
}

impl Effect {
    /// Judges what was found on the axis where it shows most.
    fn new(name: &'static str, judge: Judge, sensor: &SensorPlan, found: Found) -> Effect {
        let against = [0, 1, 2].map(|axis| Against::of(sensor, axis, judge));
        let shown = |axis: usize| {
            let (size, threshold) = (found.size[axis], against[axis].threshold());
            (if size > 0.0 { size / threshold } else { 0.0 }, size)
        };
        let axis = (1..3).fold(0, |best, axis| if shown(axis) > shown(best) { axis } else { best });
        let size = found.size[axis];
        Effect {
            effect: name,
            sensor: sensor.kind,
            size,
            unit: sensor.kind.unit(),
            axis: ["x", "y", "z"][axis],
            statistic: found.statistic,
            modelled: found.modelled,
            against: against[axis],
            verdict: Verdict::of(found.modelled, against[axis].shows(size)),
            key: found.key,
            note: found.note,
        }
    }
}

/// Every effect on every sensor of the scene whose size follows from it, sensor by sensor: on those of three body
/// axes, of whose truth at a tick the sizes are. A barometer's and a receiver's are not looked for.
pub fn effects(plan: &Plan) -> Vec<Effect> {
    let mut effects = Vec::new();
    for sensor in plan.sensors.iter().filter(|sensor| sensor.kind.is_triad()) {
        let survey = Survey::new(plan, sensor);
        let sheet = datasheet::Sheet::of(&survey);
        for kind in EFFECTS {
            let found = (kind.find)(&survey).or_else(|| sheet.as_ref()?.left_out(kind, &survey));
            effects.extend(found.map(|found| Effect::new(kind.name, kind.judge, sensor, found)));
        }
        let measured = measured::others(&survey).into_iter();
        effects.extend(measured.map(|(name, found)| Effect::new(name, Judge::Both, sensor, found)));
    }
    effects
}

#[cfg(test)]
mod tests;
