//! `[reference]`: attitude computed from error-free readings, to stand beside the exact truth in a dataset.

use super::section::Section;
use super::suggest;
use crate::geometry::{Body, Vector};
use crate::motion::Trajectory;
use crate::motion::method::{Choice, METHODS, MethodKind, ToleranceError, choose, ecompass, find};
use crate::quantity::{Kind, Sign};
use crate::sensor::{SensorKind, SensorPlan};
use crate::time::{Rate, SimTime};

/// What a reference is computed from, and when: at the ends of its steps, from t = 0 on.
#[derive(Clone, Copy, Debug)]
pub enum Reference {
    /// The true angular rate, step by step.
    Gyro {
        /// How it is stepped.
        method: &'static MethodKind,
        /// The samples it reads a second: the gyro's rate unless the scene gives another.
        rate: Rate,
    },
    /// The same, by the cheapest method and step that stay within a tolerance.
    Auto {
        /// The largest angle from the truth, rad.
        tolerance: f64,
        /// The gyro's, which its steps are parts or multiples of.
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
            Reference::Gyro { .. } | Reference::Auto { .. } => FROM[0],
            Reference::AccelMag { .. } => FROM[1],
        }
    }

    /// The name of what computes it, [`AUTO`] where that is still to be chosen.
    pub fn method(&self) -> &'static str {
        match self {
            Reference::Gyro { method, .. } => method.name,
            Reference::Auto { .. } => AUTO,
            Reference::AccelMag { .. } => "triad",
        }
    }

    /// How often it reads its sensor.
    pub fn rate(&self) -> Rate {
        match *self {
            Reference::Gyro { rate, .. } | Reference::Auto { rate, .. } | Reference::AccelMag { rate } => {
                rate
            }
        }
    }

    /// With [`Reference::Auto`] replaced by what it chooses for `trajectory` up to `end`; the choice, if there was one.
    ///
    /// # Errors
    /// Nothing stays within the tolerance.
    pub fn settled(
        self,
        trajectory: &Trajectory,
        end: SimTime,
    ) -> Result<(Reference, Option<Choice>), ToleranceError> {
        let Reference::Auto { tolerance, rate } = self else { return Ok((self, None)) };
        let choice = choose(trajectory, rate, end, tolerance.to_degrees())?;
        Ok((Reference::Gyro { method: choice.method, rate: choice.rate }, Some(choice)))
    }

    /// As it is written in a scene that leaves nothing open.
    pub(super) fn write(&self, table: &mut toml::Table) {
        table.insert("from".into(), self.from().into());
        if let Reference::Gyro { method, rate } = self {
            table.insert("method".into(), method.name.into());
            table.insert("rate".into(), rate.to_string().into());
            table.remove("tolerance");
        }
    }
}

const FROM: [&str; 2] = ["gyro", "accel-mag"];
/// The paper's own.
const DEFAULT: &str = "paper";
/// The method that is chosen for the scene.
pub const AUTO: &str = "auto";
/// Of [`AUTO`], unless the scene gives another.
const TOLERANCE: &str = "0.001 deg";

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
    let reference = if from == FROM[0] {
        let stepping = stepping(&section);
        sensors.and_then(|sensors| of_gyro(&section, sensors, stepping?))
    } else {
        // A method left over from the gyro does no harm: there are no steps here.
        section.has("method");
        for key in ["rate", "tolerance"] {
            if section.has(key) {
                section.mistake(key, "needs from = \"gyro\": accel-mag has no steps");
            }
        }
        sensors.and_then(|sensors| of_accel_mag(&section, sensors, trajectory))
    };
    let mut resolved = section.finish();
    reference.map(|reference| {
        reference.write(&mut resolved);
        (reference, resolved)
    })
}

/// What the scene says of the steps.
enum Stepping {
    /// A method, at the gyro's rate or at one of its own.
    Named(&'static MethodKind, Option<Rate>),
    /// Within so many radians.
    Within(f64),
}

fn stepping(section: &Section<'_>) -> Option<Stepping> {
    let name = section.text("method", Some(DEFAULT))?;
    if name == AUTO {
        if section.has("rate") {
            section.mistake("rate", "needs a named method: `auto` chooses the rate itself");
        }
        return section
            .scalar("tolerance", Kind::ANGLE.signed(Sign::Positive), Some(TOLERANCE))
            .map(Stepping::Within);
    }
    if section.has("tolerance") {
        section.mistake(
            "tolerance",
            format!("needs method = \"{AUTO}\": `{name}` does not adapt to a tolerance"),
        );
    }
    let rate = section.has("rate").then(|| section.rate("rate", None));
    let method = find(&name);
    if method.is_none() {
        let names: Vec<_> = METHODS.iter().map(|method| method.name).chain([AUTO]).collect();
        let near = suggest::did_you_mean(&name, names.iter().copied());
        section.mistake("method", format!("`{name}` is not a method ({}){near}", names.join(", ")));
    }
    match rate {
        // What is wrong with it has been said.
        Some(None) => None,
        rate => Some(Stepping::Named(method?, rate.flatten())),
    }
}

fn rate(sensors: &[SensorPlan], kind: SensorKind) -> Option<Rate> {
    sensors.iter().find(|sensor| sensor.kind == kind).map(|sensor| sensor.rate)
}

fn of_gyro(section: &Section<'_>, sensors: &[SensorPlan], stepping: Stepping) -> Option<Reference> {
    let gyro = rate(sensors, SensorKind::Gyro);
    if gyro.is_none() {
        section.mistake("from", "a reference from the gyro needs a [gyro] with its rate");
    }
    Some(match stepping {
        Stepping::Named(method, own) => Reference::Gyro { method, rate: own.or(gyro)? },
        Stepping::Within(tolerance) => Reference::Auto { tolerance, rate: gyro? },
    })
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
