//! `[[setting]]`: another rate, range or filter of a sensor from a time on, as a driver sets a chip.

use super::document::{Table, Value};
use super::parts::{self, File};
use super::preset;
use super::reader::Reader;
use super::section::Section;
use super::{Plan, output_rate};
use crate::keys::Key;
use crate::quantity::{self, Sign};
use crate::sensor::{self, FILTER, SensorKind, SensorPlan, Setting};
use crate::time::{Rate, SimTime};

/// The keys of a sensor that a setting may change, besides its rate.
const KEYS: [&str; 4] = ["range", "resolution", "filter", "delay"];
/// The rate of a sensor that takes no samples.
const OFF: &str = "off";
/// In the place of a filter.
const NONE: &str = "none";

/// Gives each setting to its sensor; every one as resolved.
pub(super) fn settings(top: &Section<'_>, sensors: &mut [SensorPlan]) -> Vec<toml::Value> {
    let mut resolved = Vec::new();
    for mut section in top.tables("setting") {
        if let Some((i, setting)) = read(&mut section, sensors, top.seed()) {
            sensors[i].settings.push(setting);
        }
        resolved.push(section.finish().into());
    }
    resolved
}

/// A setting, and which of the sensors it is for.
fn read(section: &mut Section<'_>, sensors: &[SensorPlan], seed: u64) -> Option<(usize, Setting)> {
    let start = section.time("start", Some("0 s"), Sign::NonNegative);
    let Some(i) = of_sensor(section, sensors) else {
        section.allow_everything();
        return None;
    };
    let plan = &sensors[i];
    let before = plan.settings.last();
    let rate = rate(section, before.map_or(Some(plan.rate), |before| before.rate));
    if let Some(part) = plan.part.and_then(|part| sensor::parts::find(part, plan.kind))
        && let Ok(file) = File::of(part)
    {
        preset::set_up(section, plan.kind, &file, rate?.unwrap_or(plan.rate));
    }
    let unfiltered = is_none(section);
    let may_set = |key: &Key| KEYS.contains(&key.name) && !(unfiltered && key.name == FILTER.name());
    let keys: Vec<Key> = sensor::keys(plan.kind).into_iter().filter(may_set).collect();
    let mut values = before.map_or(&plan.values, |before| &before.values).clone();
    if unfiltered {
        section.text("filter", None);
        values.remove(FILTER);
    }
    let given = section.values(&keys, false);
    if section.unread(&keys, &given) {
        return None;
    }
    values.take_over(&given);
    let (start, rate) = (start?, rate?);
    if before.is_some_and(|before| start < before.start) {
        section.mistake(
            "start",
            format!("is before that of the {}'s setting above it: write them in order", plan.kind),
        );
    }
    let setting = Setting { start, rate, values };
    let errors = sensor::check(&plan.first().then(&setting).plan, seed);
    errors.iter().for_each(|error| section.mistake(error.key, &error.message));
    errors.is_empty().then_some((i, setting))
}

fn of_sensor(section: &Section<'_>, sensors: &[SensorPlan]) -> Option<usize> {
    if !section.has("sensor") {
        section.lacks("a setting needs its sensor, such as sensor = \"gyro\"".into());
        return None;
    }
    let text = section.text("sensor", None)?;
    let found = sensors.iter().position(|sensor| sensor.kind.name() == text);
    if found.is_none() {
        let names: Vec<_> = sensors.iter().map(|sensor| sensor.kind.name()).collect();
        section.mistake("sensor", format!("is `{text}`; the scene has {}", names.join(", ")));
    }
    found
}

/// The rate: `None` inside is off. `before` holds where none is given.
fn rate(section: &Section<'_>, before: Option<Rate>) -> Option<Option<Rate>> {
    match section.entry("rate").map(|entry| &entry.node.value) {
        None => Some(before),
        Some(Value::Text(text)) if text == OFF => {
            section.text("rate", None);
            Some(None)
        }
        Some(_) => section.rate("rate", None).map(Some),
    }
}

fn is_none(section: &Section<'_>) -> bool {
    matches!(section.entry("filter").map(|entry| &entry.node.value), Some(Value::Text(text)) if text == NONE)
}

/// What a chip's registers ask for, in the terms of its part's data.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Asked<'a> {
    /// The part's name.
    pub part: &'a str,
    /// Samples a second; `None` while it takes none.
    pub rate: Option<Rate>,
    /// Full scale, counted from the smallest that the part has.
    pub range: usize,
    /// Its filter, by the name in the part's data.
    pub filter: Option<&'a str>,
}

impl Plan {
    /// A sensor as a chip of this part is asked to be set from `start` on, and the setting as a scene writes it.
    ///
    /// # Errors
    /// What the part's data or the scene does not know.
    pub fn asked(
        &self,
        kind: SensorKind,
        start: SimTime,
        asked: &Asked<'_>,
    ) -> Result<(Setting, toml::Table), String> {
        let table = written(kind, start, asked)?;
        let text = toml::to_string(&table).map_err(|error| error.to_string())?;
        let reader = Reader::new("");
        let parsed = Table::parse(&text, asked.part).map_err(|mistake| mistake.to_string())?;
        let mut section = Section::new(&reader, "setting.0", parsed);
        let read = read(&mut section, &self.sensors, self.seed);
        let resolved = section.finish();
        let mistakes = reader.finish().err().unwrap_or_default();
        match (read, &mistakes[..]) {
            (Some((_, setting)), []) => Ok((setting, resolved)),
            (_, mistakes) => Err(mistakes.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n")),
        }
    }

    /// The same plan with these settings, as [`Plan::asked`] gave them, of sensors that had none.
    pub fn set(&mut self, settings: impl IntoIterator<Item = (SensorKind, Setting, toml::Table)>) {
        let mut written = Vec::new();
        for (kind, setting, table) in settings {
            for sensor in self.sensors.iter_mut().filter(|sensor| sensor.kind == kind) {
                sensor.settings.push(setting.clone());
            }
            written.push(toml::Value::Table(table));
        }
        if let Ok(mut scene) = self.resolved.parse::<toml::Table>() {
            scene.insert("setting".into(), toml::Value::Array(written));
            self.resolved = scene.to_string();
        }
    }
}

/// The setting as a scene writes it, every value spelled out.
fn written(kind: SensorKind, start: SimTime, asked: &Asked<'_>) -> Result<toml::Table, String> {
    let part =
        sensor::parts::find(asked.part, kind).ok_or_else(|| format!("no part is called {}", asked.part))?;
    let known = parts::settings(part, kind).map_err(|mistake| mistake.to_string())?;
    let mut table = toml::Table::new();
    let mut put = |key: &str, value: toml::Value| table.insert(key.into(), value);
    put("start", start.to_string().into());
    put("sensor", kind.name().into());
    put("rate", asked.rate.map_or(OFF.to_string(), |rate| rate.to_string()).into());
    if let Some(scale) = by_size(&known, kind).get(asked.range) {
        put("range", scale.range.clone().into());
        put("resolution", scale.resolution.clone().into());
    }
    let rate = asked.rate.unwrap_or(Rate::hz(1));
    let named = known.filters.iter().filter(|filter| asked.filter == Some(filter.name.as_str()));
    match output_rate::setting(named, &known.rates, rate) {
        None => put("filter", NONE.into()),
        Some(filter) => {
            if filter.delay.is_some() {
                put("delay", filter.rest_of_delay().unwrap_or_default().to_string().into());
            }
            let low_pass = quantity::text_scalar(filter.low_pass, "Hz");
            let mut inside = toml::Table::from_iter([("low_pass".to_string(), low_pass.into())]);
            inside.insert("order".into(), i64::from(filter.order).into());
            put("filter", inside.into())
        }
    };
    Ok(table)
}

/// The full scales of a part, the smallest first.
pub fn by_size(known: &parts::Settings, kind: SensorKind) -> Vec<&parts::Scale> {
    let unit = kind.units().reading.signed(Sign::Any);
    let size = |scale: &&parts::Scale| unit.scalar(&scale.range).map_or(f64::INFINITY, |size| size.to_f64());
    let mut scales: Vec<_> = known.scales.iter().collect();
    scales.sort_by(|a, b| size(a).total_cmp(&size(b)));
    scales
}

#[cfg(test)]
#[path = "settings_tests.rs"]
mod tests;
