//! A scene without some of its parts, at any seed.

use super::parts::{self, Part, What};
use crate::player::{BLOCK, Player};
use crate::scene::{Plan, SceneError};
use crate::sensor::{SensorKind, SensorPlan};
use crate::time::SimTime;
use toml::{Table, Value};

/// The scene of a study, of which only what makes readings is left: no outputs, limits or reference.
pub struct Base {
    name: String,
    scene: Table,
    /// The same with all that the scene says.
    full: Table,
    seed: u64,
}

/// What is played: a scene's text, and a term that no key can take out of it.
#[derive(Clone)]
pub struct Variant {
    name: String,
    scene: Table,
    base_seed: u64,
    /// A term that another key needs the key of: it is left out of the chain instead.
    held: Option<(SensorKind, &'static str)>,
}

impl Base {
    /// Of a plan.
    ///
    /// # Errors
    /// The plan's resolved text, were it no scene.
    pub fn of(plan: &Plan) -> Result<Base, SceneError> {
        // It is the scene's own writer that made it.
        let mut full: Table = plan.resolved.parse().unwrap_or_default();
        // Files of the scene are read where they are, not beside a copy of it.
        let motions = full.get_mut("motion").and_then(Value::as_array_mut);
        for motion in motions.into_iter().flatten().filter_map(Value::as_table_mut) {
            for (_, value) in motion.iter_mut() {
                let file = plan.attached.iter().find(|file| value.as_str() == Some(&file.name));
                if let Some(file) = file {
                    *value = file.path().display().to_string().into();
                }
            }
        }
        let mut scene = full.clone();
        for key in ["limits", "reference", "output", "sweep"] {
            scene.remove(key);
        }
        if let Some(Value::Array(faults)) = scene.get_mut("fault") {
            faults.retain(|fault| fault.get("sensor").is_some());
        }
        let base = Base { name: plan.name.clone(), scene, full, seed: plan.seed };
        base.whole().plan(0)?;
        Ok(base)
    }

    /// All of it.
    pub fn whole(&self) -> Variant {
        self.variant(self.scene.clone(), None)
    }

    /// Without one part.
    pub fn without(&self, part: Part) -> Variant {
        let variant = self.without_all(&[part]);
        match (part, variant.plan(0)) {
            (Part { sensor: Some(kind), what: What::Term(name) }, Err(_)) => {
                self.variant(self.scene.clone(), Some((kind, name)))
            }
            _ => variant,
        }
    }

    /// Without several, by their keys alone: it may be no scene.
    pub fn without_all(&self, left_out: &[Part]) -> Variant {
        self.variant(parts::without(&self.scene, left_out), None)
    }

    /// Whether all that the scene says, outputs and reference included, is a scene without these.
    pub fn is_scene_without(&self, left_out: &[Part]) -> bool {
        self.variant(parts::without(&self.full, left_out), None).plan(0).is_ok()
    }

    fn variant(&self, scene: Table, held: Option<(SensorKind, &'static str)>) -> Variant {
        Variant { name: self.name.clone(), scene, base_seed: self.seed, held }
    }
}

impl Variant {
    /// The plan at the scene's seed and `offset` more. Values drawn once a run stay as the scene's own seed drew them.
    ///
    /// # Errors
    /// A part whose keys are gone was needed by another key.
    pub fn plan(&self, offset: u64) -> Result<Plan, SceneError> {
        let mut scene = self.scene.clone();
        let seed = self.base_seed.wrapping_add(offset) & (u64::MAX >> 1);
        scene.insert("seed".into(), (seed as i64).into());
        Plan::parse(&scene.to_string(), "", &self.name, &[])
    }

    /// The same of one sensor alone, with its faults.
    pub fn alone(&self, kind: SensorKind) -> Variant {
        let mut scene = self.scene.clone();
        for other in SensorKind::ALL.into_iter().filter(|other| *other != kind) {
            scene.remove(other.name());
        }
        if let Some(Value::Array(faults)) = scene.get_mut("fault") {
            faults.retain(|fault| fault.get("sensor").and_then(Value::as_str) == Some(kind.name()));
        }
        Variant { scene, ..self.clone() }
    }

    /// Plays one of its plans, besides without these terms of every sensor.
    pub fn player<'p>(&self, plan: &'p Plan, end: SimTime, besides: &[&'static str]) -> Player<'p> {
        Player::built(plan, end, BLOCK, |sensor: &SensorPlan| {
            let held = self.held.filter(|(kind, _)| *kind == sensor.kind).map(|(_, name)| name);
            plan.build_without(sensor, &besides.iter().copied().chain(held).collect::<Vec<_>>())
        })
    }
}
