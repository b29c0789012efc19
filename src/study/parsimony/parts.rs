//! What of a scene can be left out: error terms of its sensors, and effects that a key of the scene switches on. Each is
//! left out as a user would, by taking its keys out of the scene as resolved.

use crate::scene::Plan;
use crate::sensor::{Sampling, Senses, SensorKind, SensorPlan, TERMS};
use glam::DVec3;
use std::collections::BTreeSet;
use toml::{Table, Value};

/// Terms whose keys mean something else, or nothing, without those of another.
const TOGETHER: [&[&str]; 2] = [&["bias_instability", "flicker"], &["flicker", "bias_instability"]];
/// What acts only where the part has a temperature.
const BY_TEMPERATURE: &[&str] = &["temperature", "bias_temperature", "scale_temperature"];

/// What can be left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum What {
    /// An error term, by its name.
    Term(&'static str),
    /// Every fault of the sensor.
    Faults,
    /// `sampling = "average"`.
    Average,
    /// A `[[force]]`, counted from 0.
    Force(usize),
    /// The wind of `[earth]`.
    Wind,
}

/// One thing that a scene has and could do without.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Part {
    /// Whose it is; `None` for the scene's own.
    pub sensor: Option<SensorKind>,
    /// What it is.
    pub what: What,
}

impl Part {
    /// As tables call it.
    pub fn name(&self) -> String {
        match self.what {
            What::Term(name) => name.into(),
            What::Faults => "faults".into(),
            What::Average => "averaging".into(),
            What::Force(index) => format!("force {}", index + 1),
            What::Wind => "wind".into(),
        }
    }

    /// Whose it is: a sensor's name, or `scene`.
    pub fn owner(&self) -> &'static str {
        self.sensor.map_or("scene", SensorKind::name)
    }

    /// Whether it is this error term.
    pub fn is_term(&self, name: &str) -> bool {
        matches!(self.what, What::Term(term) if term == name)
    }

    /// The keys of its sensor's table that it is left out with.
    pub fn keys(&self) -> Vec<&'static str> {
        match (self.sensor, self.what) {
            (Some(kind), What::Term(name)) => keys(kind, name),
            (Some(_), What::Average) => vec!["sampling"],
            _ => Vec::new(),
        }
    }
}

/// The keys that a term is left out with: its own, and those that are nothing without them.
fn keys(kind: SensorKind, name: &str) -> Vec<&'static str> {
    let alone = [name];
    let terms = match name {
        "temperature" => BY_TEMPERATURE,
        _ => TOGETHER.into_iter().find(|terms| terms[0] == name).unwrap_or(&alone),
    };
    let kinds = TERMS.into_iter().filter(|term| term.serves.contains(kind) && terms.contains(&term.name));
    kinds.flat_map(|term| (term.keys)(kind)).map(|key| key.name).collect()
}

/// Everything of a scene that can be left out, sensor by sensor in the order of their chains, then the scene's own.
pub fn parts(plan: &Plan) -> Vec<Part> {
    let mut parts = Vec::new();
    for sensor in &plan.sensors {
        parts.extend(of_sensor(plan, sensor));
    }
    let forces = 0..plan.trajectory.forces().len();
    parts.extend(forces.map(|index| Part { sensor: None, what: What::Force(index) }));
    let feels = |sensor: &SensorPlan| matches!(sensor.kind.row().senses, Senses::Air(_));
    if plan.trajectory.wind().v != DVec3::ZERO && plan.sensors.iter().any(feels) {
        parts.push(Part { sensor: None, what: What::Wind });
    }
    parts
}

fn of_sensor(plan: &Plan, sensor: &SensorPlan) -> Vec<Part> {
    let built = plan.build(sensor);
    // A clock that is only fast is no term of the chain: it moves the ticks.
    let has = |name: &str| {
        built.terms().contains(&name) || (name == "clock_error" && sensor.clock() != sensor.rate)
    };
    let terms = TERMS.into_iter().map(|term| term.name).filter(|name| has(name)).map(What::Term);
    let faults = Some(What::Faults).filter(|_| !sensor.faults.is_empty());
    let average = Some(What::Average).filter(|_| sensor.sampling == Sampling::Average);
    let all = terms.chain(faults).chain(average);
    all.map(|what| Part { sensor: Some(sensor.kind), what }).collect()
}

/// The scene as resolved without these parts. A sensor that loses one no longer names its `part`, whose values are all
/// written out there: the part would bring them back.
pub fn without(resolved: &Table, left_out: &[Part]) -> Table {
    let mut scene = resolved.clone();
    for part in left_out {
        let Some(kind) = part.sensor else { continue };
        if let Some(Value::Table(sensor)) = scene.get_mut(kind.name()) {
            sensor.remove("part");
            part.keys().into_iter().for_each(|key| drop(sensor.remove(key)));
        }
    }
    let gone: BTreeSet<What> =
        left_out.iter().filter(|part| part.sensor.is_none()).map(|part| part.what).collect();
    keep(&mut scene, "force", |index, _| !gone.contains(&What::Force(index)));
    keep(&mut scene, "fault", |_, fault| {
        let sensor = fault.get("sensor").and_then(Value::as_str);
        !left_out.iter().any(|part| part.what == What::Faults && Some(part.owner()) == sensor)
    });
    if let (true, Some(Value::Table(earth))) = (gone.contains(&What::Wind), scene.get_mut("earth")) {
        earth.remove("wind");
    }
    scene
}

/// Keeps what `wanted` says of the tables of a list; a list that is left empty goes.
fn keep(scene: &mut Table, list: &str, wanted: impl Fn(usize, &Value) -> bool) {
    let Some(Value::Array(tables)) = scene.get_mut(list) else { return };
    let mut index = 0;
    tables.retain(|table| {
        index += 1;
        wanted(index - 1, table)
    });
    if tables.is_empty() {
        scene.remove(list);
    }
}
