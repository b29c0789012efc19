//! Parts: what their datasheets say, each value with its source.

use super::{Brief, Item, List, Refusal};
use crate::scene::parts::{self as data, Filter, OutputRate, Scale, Settings};
use crate::sensor::SensorKind;
use crate::sensor::parts::{self, Part};

/// A row a part; all its data where it alone is asked for.
pub fn list() -> Result<List, Refusal> {
    let mut items = Vec::new();
    for part in parts::all() {
        let sensors: Vec<_> = SensorKind::ALL
            .into_iter()
            .filter_map(|kind| Some((kind, of(part, kind).transpose()?)))
            .collect();
        let has = |(kind, _): &(SensorKind, _)| kind.to_string();
        let row = vec![
            part.names.join(", "),
            sensors.iter().map(has).collect::<Vec<_>>().join(" "),
            part.about.into(),
        ];
        let mut whole = format!("{}: {}\n", part.names.join(", "), part.about);
        for (kind, text) in sensors {
            let text = text?;
            for (name, _) in part.inside.iter().filter(|(_, of)| *of == kind) {
                items.push(Item {
                    names: vec![name.to_string()],
                    brief: Brief::Row(vec![
                        name.to_string(),
                        kind.to_string(),
                        format!("in the {}", part.names[0]),
                    ]),
                    whole: format!("{name}: the {kind} of the {}\n{text}", part.names[0]),
                });
            }
            whole += &text;
        }
        let names = part.names.iter().map(|name| name.to_string()).collect();
        items.push(Item { names, brief: Brief::Row(row), whole });
    }
    items.sort_by_key(|item| item.names.first().cloned());
    Ok(List {
        heading: vec!["part", "sensors", "about"],
        items,
        below: "ranges, rates, filters, noise and tolerances of one, with their sources: ratetable list parts NAME\n"
            .into(),
    })
}

/// Everything of one sensor of a part; nothing where it has no such sensor.
fn of(part: &Part, kind: SensorKind) -> Result<Option<String>, Refusal> {
    let mut text = String::new();
    let refuse = |mistake: crate::scene::document::Mistake| Refusal(mistake.to_string());
    for value in data::sources(part).map_err(refuse)?.into_iter().filter(|value| value.sensor == kind) {
        text += &format!("  {} {} = {}\n      {}\n", value.sensor, value.key, value.value, value.source);
    }
    text += &choices(kind, &data::settings(part, kind).map_err(refuse)?);
    Ok(Some(text).filter(|text| !text.is_empty()))
}

/// What a sensor of a part can be set to.
fn choices(kind: SensorKind, settings: &Settings) -> String {
    let mut text = String::new();
    for (name, source) in &settings.sources {
        let choices = match *name {
            "scales" => settings.scales.iter().map(Scale::to_string).collect(),
            "rates" => settings.rates.iter().map(OutputRate::to_string).collect(),
            _ => settings.filters.iter().map(Filter::to_string).collect::<Vec<_>>(),
        };
        text += &format!("  {kind} {name}: {}\n      {source}\n", choices.join("; "));
    }
    text
}
