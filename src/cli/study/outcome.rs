//! What a study gives, in every form: text for people, CSV, JSON and pictures.

use super::picture::Picture;
use crate::cli::Refusal;
use crate::live::{Chart, Grid};
use serde::Serialize;
use serde_json::{Map, Value};

/// A study's results.
pub(super) struct Outcome {
    /// Its fields among those of all studies.
    pub json: Map<String, Value>,
    /// Tables for people.
    pub text: String,
    /// The files of the folder, each by its name.
    pub files: Vec<(String, Vec<u8>)>,
    /// Its pictures, to be asked.
    pub charts: Vec<Chart>,
    /// Its tables of verdicts, to be asked.
    pub grids: Vec<Grid>,
    name: &'static str,
}

impl Outcome {
    /// Of `values`: rows are the field `name` of the JSON, a struct's fields are fields of their own.
    pub fn of<T: Serialize>(name: &'static str, values: &T, text: String) -> Result<Outcome, Refusal> {
        let json = match serde_json::to_value(values)? {
            Value::Object(fields) => fields,
            rows => Map::from_iter([(name.to_string(), rows)]),
        };
        Ok(Outcome { json, text, files: Vec::new(), charts: Vec::new(), grids: Vec::new(), name })
    }

    /// With `NAME.csv`: a header and a line a row; what is missing is empty.
    pub fn csv<T: Serialize>(self, rows: &[T]) -> Result<Outcome, Refusal> {
        let name = format!("{}.csv", self.name);
        self.table(&name, rows)
    }

    /// With one more CSV.
    pub fn table<T: Serialize>(self, name: &str, rows: &[T]) -> Result<Outcome, Refusal> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        for row in rows {
            writer.serialize(row)?;
        }
        self.file(name, writer.into_inner()?)
    }

    /// With a picture: a file, and its points.
    pub fn picture(mut self, name: &str, picture: &impl Picture) -> Result<Outcome, Refusal> {
        self.charts.extend(picture.charts());
        self.grids.extend(picture.grids());
        self.file(name, picture.svg())
    }

    /// With one more file.
    pub fn file(mut self, name: &str, bytes: impl Into<Vec<u8>>) -> Result<Outcome, Refusal> {
        self.files.push((name.to_string(), bytes.into()));
        Ok(self)
    }
}

/// Studies as one JSON object.
pub(super) fn json<'a>(
    quick: bool,
    outcomes: impl IntoIterator<Item = &'a Outcome>,
) -> Result<String, Refusal> {
    let mut all = Map::new();
    all.insert("version".into(), env!("CARGO_PKG_VERSION").into());
    all.insert("quick".into(), quick.into());
    for outcome in outcomes {
        all.extend(outcome.json.clone());
    }
    Ok(serde_json::to_string_pretty(&all)? + "\n")
}
