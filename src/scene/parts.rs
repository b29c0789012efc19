//! What the data files of parts say, and where each value comes from.

use super::document::{Entry, Mistake, Table, Value};
use crate::sensor::SensorKind;
use crate::sensor::parts::{Part, Sourced};

/// Every value of a part and where it comes from, for `list parts` and the parts' own test.
///
/// # Errors
/// The place of a value that names no source.
pub fn sources(part: &Part) -> Result<Vec<Sourced>, Mistake> {
    let table = Table::parse(part.text, part.file)?;
    let mut sourced = Vec::new();
    for kind in SensorKind::ALL {
        let Some(Value::Table(preset)) = table.get(kind.name()).map(|entry| &entry.node.value) else {
            continue;
        };
        for entry in
            preset.entries.iter().filter(|entry| !["scales", "filters"].contains(&entry.key.as_str()))
        {
            sourced.push(source_of(kind, entry)?);
        }
    }
    Ok(sourced)
}

fn source_of(kind: SensorKind, entry: &Entry) -> Result<Sourced, Mistake> {
    let text = |table: &Table, key: &str| match table.get(key).map(|entry| &entry.node.value) {
        Some(Value::Text(text)) => Some(text.clone()),
        Some(Value::Boolean(flag)) => Some(flag.to_string()),
        Some(Value::Table(table)) => {
            table.entries.first().map(|entry| format!("{} {}", entry.key, texts(&entry.node.value)))
        }
        _ => None,
    };
    let read = match &entry.node.value {
        Value::Table(table) => {
            text(table, "value").zip(text(table, "source").filter(|source| !source.trim().is_empty()))
        }
        _ => None,
    };
    let (value, source) = read.ok_or_else(|| Mistake {
        place: entry.place.clone(),
        message: format!("`{}` needs a `value` and a `source`", entry.key),
    })?;
    Ok(Sourced { sensor: kind, key: entry.key.clone(), value, source })
}

fn texts(value: &Value) -> String {
    match value {
        Value::Text(text) => text.clone(),
        Value::Array(nodes) => nodes.iter().map(|node| texts(&node.value)).collect::<Vec<_>>().join(" to "),
        other => other.what().to_string(),
    }
}
