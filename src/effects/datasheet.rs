//! What a part's datasheet gives and the scene leaves out.

use super::{EffectKind, Found, Survey};
use crate::scene::{self, Plan};
use crate::sensor::parts;

/// The sensor as the datasheet of its part has it, each value that is drawn at the far end of its tolerance.
pub(super) struct Sheet {
    plan: Plan,
    /// Keys of which the sheet gives a spread.
    spread: Vec<String>,
    terms: Vec<&'static str>,
}

impl Sheet {
    /// Of the part that the sensor names, if it does.
    pub fn of(survey: &Survey<'_>) -> Option<Sheet> {
        let sensor = survey.sensor;
        let part = parts::find(sensor.part?, sensor.kind)?;
        let (mut table, mut spread) = (toml::Table::new(), Vec::new());
        for value in scene::parts::sources(part).ok()?.into_iter().filter(|value| value.sensor == sensor.kind)
        {
            // `uniform LOW to HIGH`, `normal MEAN to STD`
            if let Some((_, end)) = value.value.rsplit_once(" to ") {
                spread.push(format!("{}.{}", sensor.kind, value.key));
                table.insert(value.key, end.into());
            }
        }
        table.insert("part".into(), part.names[0].into());
        table.insert("rate".into(), sensor.rate.to_string().into());
        let mut scene = toml::Table::new();
        scene.insert("duration".into(), survey.plan.duration.to_string().into());
        scene.insert(sensor.kind.name().into(), table.into());
        let plan = Plan::parse(&scene.to_string(), part.file, part.names[0], &[]).ok()?;
        let terms = plan.build(plan.sensors.first()?).terms().to_vec();
        Some(Sheet { plan, spread, terms })
    }

    /// An error term that the part has and the scene's sensor has not.
    pub fn left_out(&self, kind: &EffectKind, survey: &Survey<'_>) -> Option<Found> {
        if survey.terms.contains(&kind.name) || !self.terms.contains(&kind.name) {
            return None;
        }
        let sensor = self.plan.sensors.first()?;
        let found = (kind.find)(&survey.met_by(sensor))?;
        let note = format!("the datasheet of the {} gives it", sensor.part.unwrap_or_default());
        let is_bound = found.key.as_ref().is_some_and(|key| self.spread.contains(key));
        let statistic = if is_bound { "at most" } else { found.statistic };
        Some(Found { modelled: false, statistic, ..found }.noting(note))
    }
}
