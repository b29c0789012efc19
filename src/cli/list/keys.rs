//! Keys of a scene: each one's values, units, range and default.

use super::{Brief, Item, List};
use crate::keys::{Key, Takes};
use crate::motion;
use crate::quantity::Kind;
use crate::scene;
use crate::sensor::{self, SensorKind};

/// Every table and key of a scene. A table answers to its name, a key to `TABLE.KEY`, and to `KEY` where one table
/// alone has it.
pub fn list() -> List {
    let mut tables: Vec<(String, Vec<(String, String)>)> = Vec::new();
    for (of, key, about) in scene::FIXED_KEYS {
        if tables.last().is_none_or(|(name, _)| name != of) {
            tables.push((of.to_string(), Vec::new()));
        }
        let line = (key.to_string(), format!("  {key}: {about}\n"));
        tables.last_mut().into_iter().for_each(|(_, keys)| keys.push(line.clone()));
    }
    for sensor in SensorKind::ALL {
        let fixed = scene::SENSOR_KEYS.iter().filter(|(key, _)| scene::takes(sensor, key));
        let fixed = fixed.map(|(key, about)| (key.to_string(), format!("  {key}: {about}\n")));
        let own = sensor::keys(sensor).into_iter().map(|key| (key.name.to_string(), declared(&key)));
        tables.push((sensor.to_string(), fixed.chain(own).collect()));
    }
    let mut items = Vec::new();
    for (table, keys) in &tables {
        let title = if table.is_empty() { "(the scene itself)\n".into() } else { format!("[{table}]\n") };
        let lines: String = keys.iter().map(|(_, line)| line.as_str()).collect();
        let lines = title.clone() + &lines;
        let names = if table.is_empty() { vec!["scene".into()] } else { vec![table.clone()] };
        items.push(Item { names, brief: Brief::Lines(lines.clone()), whole: lines });
        for (key, line) in keys {
            let alone =
                tables.iter().flat_map(|(_, keys)| keys).filter(|(other, _)| other == key).count() == 1;
            let mut names = vec![format!("{table}.{key}").trim_start_matches('.').to_string()];
            names.extend(alone.then(|| key.clone()));
            let brief = Brief::Lines(String::new());
            items.push(Item { names, brief, whole: title.clone() + line });
        }
    }
    List { heading: Vec::new(), items, below: String::new() }
}

/// Kinds of motion, each with its keys.
pub fn motions() -> List {
    List::of_lines(motion::KINDS.iter().map(|kind| {
        let mut lines = format!("{}: {}\n", kind.name, kind.about);
        kind.keys.iter().for_each(|key| lines += &declared(key));
        (vec![kind.name.to_string()], lines)
    }))
}

/// A declared key with what it takes.
fn declared(key: &Key) -> String {
    let quantity = |kind: &Kind| format!("{}{}, such as \"{}\"", kind.name(), kind.bounds(), kind.example());
    let takes = match &key.takes() {
        Takes::Scalar(kind) | Takes::OneAxis(kind) | Takes::Resolution(kind) => quantity(kind),
        Takes::PerAxis(kind) => format!("{}, for all axes or each", quantity(kind)),
        Takes::BodyVector(kind) | Takes::NavVector(kind) => format!("{}, or a vector", quantity(kind)),
        Takes::Duration => "time, 0 or more, such as \"2 s\"".into(),
        Takes::Word(words) => words.join(" or "),
        Takes::Keyframes => "an array, such as [{ t = \"2 s\", attitude = \"[0, 30, 0] deg\" }]".into(),
        Takes::File => "a path, relative to the scene's folder".into(),
        Takes::Matrix(kind) => {
            format!(
                "{}, one number, a vector (the diagonal) or three rows, such as \"{}\"",
                kind.name(),
                kind.example()
            )
        }
        Takes::Flag => "true or false".into(),
        Takes::Whole(least, most) => format!("a whole number from {least} to {most}"),
        Takes::Table(nested) => {
            format!("a table{}, such as {}", if nested.many { " or several" } else { "" }, nested.example)
        }
        Takes::Columns(columns) => format!("columns, such as {}", columns.example()),
    };
    let default = key.default.map_or(String::new(), |default| format!(" (default {default})"));
    format!("  {}: {}; {takes}{default}\n", key.name, key.about)
}
