//! A scene as written, and the plan that is checked and compiled from it.
//!
//! ```text
//! TOML text ─ document (every value knows its place) ─ section (keys, units, defaults, draws) ─ Plan
//! ```
//!
//! Every mistake of a scene is collected, each as one message with file, line, column, the bad value and what
//! would be right. The plan carries the scene as resolved: every default, preset and drawn value filled in.

mod attached;
mod build;
pub mod builtin;
mod columns;
mod declared;
pub mod document;
mod draw;
mod drawn;
mod faults;
mod file;
mod fixed_keys;
mod kalibr;
mod keyframes;
mod nested;
mod numbers;
mod output;
pub(crate) mod output_rate;
mod outside;
pub mod parts;
mod preset;
mod reader;
mod reference;
mod rest;
mod section;
mod sensors;
pub mod settings;
mod suggest;
mod sweep;
mod target;
mod vehicle;

pub use attached::Attached;
pub use build::Builder;
pub use document::Location;
pub use drawn::Drawn;
pub use faults::OutputFault;
pub use fixed_keys::{FIXED_KEYS, SENSOR_KEYS, takes};
pub use output::{Destination, Output, Overload};
pub use reference::{AUTO, Reference};
pub use suggest::nearest;
pub use sweep::{Runs, SweptKey, SweptValue};
pub use target::{TARGETS, Target, Tells};

use crate::earth::{self, Day};
use crate::geometry::Axes;
use crate::motion::Trajectory;
use crate::quantity::Sign;
use crate::sensor::{Sensor, SensorPlan};
use crate::time::SimTime;
use document::{Mistake, Table};
use reader::Reader;
use section::Section;
use std::fmt;
use std::path::{Path, PathBuf};

/// A scene, checked and compiled: all that a run needs to know.
#[derive(Debug)]
pub struct Plan {
    /// The scene's name.
    pub name: String,
    /// From which every random number comes.
    pub seed: u64,
    /// How long it lasts.
    pub duration: SimTime,
    /// How it is written, and the datasets made from it.
    pub axes: Axes,
    /// Where on Earth it is, if it says so.
    pub site: Option<earth::Place>,
    /// The scene's date, if it has one.
    pub day: Option<Day>,
    /// Limits of the report, such as `sensors.gyro.late_us.p99<200`, each with its place.
    pub limits: Vec<(String, Location)>,
    /// What is true.
    pub trajectory: Trajectory,
    /// What is sensed: gyro, accel, mag, baro, gps, as far as the scene has them.
    pub sensors: Vec<SensorPlan>,
    /// The attitude to be computed beside the exact truth, if any.
    pub reference: Option<Reference>,
    /// Where the scene itself sends its packets.
    pub outputs: Vec<Output>,
    /// What becomes of packets on their way: the scene's own outputs have these already, others are to be equipped.
    pub output_faults: Vec<OutputFault>,
    /// Values drawn once for this run.
    pub drawn: Vec<Drawn>,
    /// Files that the scene as resolved names, which a copy of it needs beside it.
    pub attached: Vec<Attached>,
    /// Every file that it was read from: the scene itself, where it is one, and those that it names.
    pub files: Vec<PathBuf>,
    /// Warnings about the scene before it plays, each with its place.
    pub warnings: Vec<String>,
    /// The scene as resolved, in TOML: playing it gives the same bytes.
    pub resolved: String,
}

impl Plan {
    /// Where it begins: its place, or where latitude, longitude and altitude are 0.
    pub fn origin(&self) -> earth::Place {
        self.site.unwrap_or(earth::Place::ORIGIN)
    }

    /// Reads a scene: a path to a TOML file or the name of a built-in, with `--set` overrides.
    ///
    /// # Errors
    /// No such scene, or every mistake in it.
    pub fn load(scene: &str, sets: &[String]) -> Result<Plan, SceneError> {
        let (text, source, name) = source(scene)?;
        Plan::parse(&text, &source, &name, sets)
    }

    /// Reads a scene's text. `source` is what messages call it, `name` its name unless it gives one. A file that the
    /// scene names is looked for in the folder of `source` as a path; one that `--set` names, in the current folder.
    ///
    /// # Errors
    /// Every mistake in it.
    pub fn parse(text: &str, source: &str, name: &str, sets: &[String]) -> Result<Plan, SceneError> {
        let one = |mistake| SceneError { mistakes: vec![mistake] };
        let mut table = Table::parse(text, source).map_err(one)?;
        for set in sets {
            table.set(set).map_err(one)?;
        }
        Plan::of(table, source, name)
    }

    fn of(table: Table, source: &str, name: &str) -> Result<Plan, SceneError> {
        let reader = Reader::new(source);
        let plan = read(&reader, table, name);
        match reader.finish() {
            Ok(found) => {
                let mut files = found.files;
                files.extend(Some(PathBuf::from(source)).filter(|path| path.is_file()));
                let warnings = [found.warnings, outside::warnings(&plan)].concat();
                Ok(Plan { drawn: found.drawn, attached: found.attached, files, warnings, ..plan })
            }
            Err(mistakes) => Err(SceneError { mistakes }),
        }
    }

    /// The faults of sensors that acted on a sample before `end`: `gyro stuck from 2 s to 3 s`.
    pub fn faults_until(&self, end: SimTime) -> Vec<String> {
        let of = |sensor: &SensorPlan| {
            let before = |t: SimTime| sensor.ticks_before(t);
            let acted = sensor.faults.iter().filter(|fault| before(fault.start) < before(fault.end.min(end)));
            acted.map(|fault| format!("{} {fault}", sensor.kind)).collect::<Vec<_>>()
        };
        self.sensors.iter().flat_map(of).collect()
    }

    /// Every fault that the scene asks for: `gyro stuck from 2 s to 3 s`, `drop from 2 s of every output`.
    pub fn faults(&self) -> Vec<String> {
        let of_outputs = self.output_faults.iter().map(OutputFault::to_string);
        self.faults_until(SimTime::FOREVER).into_iter().chain(of_outputs).collect()
    }

    /// The scene as resolved, lasting until `end`, with the reference as it was settled: playing it gives the bytes of
    /// a run that ended there.
    pub fn resolved_until(&self, end: SimTime, reference: Option<&Reference>) -> String {
        let Ok(mut scene) = self.resolved.parse::<toml::Table>() else { return self.resolved.clone() };
        if end != self.duration {
            scene.insert("duration".into(), end.to_string().into());
        }
        if let (Some(reference), Some(table)) = (reference, scene.get_mut("reference")) {
            table.as_table_mut().into_iter().for_each(|table| reference.write(table));
        }
        scene.to_string()
    }

    /// The sensor at work.
    ///
    /// # Panics
    /// Never for a sensor of this plan: its terms were built once when the scene was read.
    pub fn build(&self, sensor: &SensorPlan) -> Sensor {
        self.build_without(sensor, &[])
    }

    /// The same without the error terms called so.
    ///
    /// # Panics
    /// As [`Plan::build`].
    pub fn build_without(&self, sensor: &SensorPlan, left_out: &[&str]) -> Sensor {
        Sensor::without(sensor, self.seed, left_out)
            .unwrap_or_else(|error| unreachable!("checked when read: {error:?}"))
    }
}

/// The text of a scene by its path or built-in name, what messages call it, and its name unless it gives one.
fn source(scene: &str) -> Result<(String, String, String), SceneError> {
    let (text, source) = match (builtin::text(scene), Path::new(scene)) {
        (Some(text), path) if !path.exists() => (text.to_string(), format!("{scene} (built-in)")),
        (_, path) => {
            let unreadable = |error| SceneError::unreadable(scene, &error);
            (std::fs::read_to_string(path).map_err(unreadable)?, scene.to_string())
        }
    };
    let stem = Path::new(scene).file_stem().map_or(scene.to_string(), |stem| stem.to_string_lossy().into());
    Ok((text, source, stem))
}

/// What the table says; a scene with mistakes, which the reader collects, gives some plan that is not to be used.
fn read(reader: &Reader, table: Table, name: &str) -> Plan {
    let whole = table.place.clone();
    let top = Section::new(reader, "", table);
    let name = top.text("name", Some(name)).unwrap_or_default();
    let seed = top.whole("seed", 0);
    reader.seed.set(seed);
    let axes = Axes::from_name(top.word("axes", &Axes::NAMES, Axes::NAMES[0])).unwrap_or_default();
    reader.axes.set(axes);
    let limits = top.texts("limits");

    let mut start = vehicle::start(&top);
    let earth = vehicle::earth(&top);
    let motions = vehicle::motions(&top, earth.gravity.length(), &mut start);
    let forces = vehicle::forces(&top);
    let mut sensors = sensors::sensors(&top);
    let mut outputs = output::outputs(&top, sensors.complete.then_some(&sensors.plans));
    let trajectory =
        Trajectory::new(start.attitude, motions.motions, forces.forces, earth.gravity, earth.field);
    let trajectory = trajectory.in_wind(earth.wind);
    let trajectory = match start.velocity {
        Some(velocity) => trajectory.begun_at(velocity),
        None => trajectory,
    };
    let reference =
        reference::reference(&top, sensors.complete.then_some(&sensors.plans), &trajectory).unzip();
    let faults = faults::faults(&top, &mut sensors.plans, &mut outputs.outputs);
    let settings = settings::settings(&top, &mut sensors.plans);
    if sensors.plans.iter().any(|sensor| !sensor.kind.is_triad()) {
        start.settle_velocity(trajectory.start_velocity(), axes);
        vehicle::misfits(&trajectory, axes).into_iter().for_each(|warning| reader.warn(warning));
    }
    let moving = trajectory.moving_until();
    let default = (moving > SimTime::ZERO).then(|| moving.to_string());
    // What differs from run to run is the business of whoever makes several.
    let swept = top.entry("sweep").map(sweep::check).unwrap_or_default();
    swept.iter().for_each(|mistake| reader.mistake(&mistake.place, &mistake.message));
    let duration = top.time("duration", default.as_deref(), Sign::Positive);

    let mut resolved = top.finish();
    // Only of a scene without other mistakes: each of them may be why these two seem to lack.
    if reader.clean() {
        if sensors.plans.is_empty() {
            reader.mistake(
                &whole,
                "a scene needs at least one sensor, [gyro], [accel], [mag], [baro] or [gps], with its rate",
            );
        }
        if duration.is_none() {
            reader.mistake(&whole, "a scene needs a motion or a duration, such as duration = \"10 s\"");
        }
    }
    for (key, table) in [("start", start.resolved), ("earth", earth.resolved)] {
        resolved.insert(key.into(), table.into());
    }
    for (key, tables) in [
        ("motion", motions.resolved),
        ("force", forces.resolved),
        ("fault", faults.resolved),
        ("setting", settings),
    ] {
        if !tables.is_empty() {
            resolved.insert(key.into(), tables.into());
        }
    }
    for (plan, table) in sensors.plans.iter().zip(sensors.resolved) {
        resolved.insert(plan.kind.name().into(), table.into());
    }
    if let Some(table) = reference.1 {
        resolved.insert("reference".into(), table.into());
    }
    if !outputs.resolved.is_empty() {
        resolved.insert("output".into(), outputs.resolved.into());
    }
    Plan {
        name,
        seed,
        duration: duration.unwrap_or_default(),
        axes,
        site: earth.place,
        day: earth.day,
        limits,
        trajectory,
        sensors: sensors.plans,
        reference: reference.0,
        outputs: outputs.outputs,
        output_faults: faults.of_outputs,
        drawn: Vec::new(),
        attached: Vec::new(),
        files: Vec::new(),
        warnings: Vec::new(),
        resolved: resolved.to_string(),
    }
}

/// A scene that cannot be played: every mistake in it.
#[derive(Clone, Debug)]
pub struct SceneError {
    /// At least one, in the order written; those of the command line first.
    pub mistakes: Vec<Mistake>,
}

impl SceneError {
    fn unreadable(scene: &str, why: &dyn fmt::Display) -> SceneError {
        let names = builtin::SCENES.map(|(name, _)| name);
        let near = suggest::did_you_mean(scene, names);
        let message =
            format!("this is neither a scene file ({why}) nor a built-in scene ({}){near}", names.join(", "));
        SceneError { mistakes: vec![Mistake { place: Location::whole(scene), message }] }
    }
}

impl fmt::Display for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, mistake) in self.mistakes.iter().enumerate() {
            if i > 0 {
                f.write_str("\n")?;
            }
            write!(f, "{mistake}")?;
        }
        Ok(())
    }
}

impl std::error::Error for SceneError {}

#[cfg(test)]
mod aids_tests;
#[cfg(test)]
mod mistakes_tests;
#[cfg(test)]
mod motions_tests;
#[cfg(test)]
mod tests;
