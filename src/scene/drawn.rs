//! A value drawn for a run, as shown to people and written to files.

use crate::quantity::Kind;

/// A value that was drawn once for this run.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Drawn {
    /// Such as `gyro.noise_std`.
    pub key: String,
    /// What was drawn, as a scene would write it.
    pub value: String,
    /// The same for a person: a number, or one an axis, in `unit`.
    #[serde(skip)]
    pub numbers: Vec<f64>,
    /// The unit in which the scene or the part's file gives the distribution.
    #[serde(skip)]
    pub unit: String,
}

impl Drawn {
    /// In the unit of `written`, the end of a distribution as written; in the first of `kind` where that has no size of
    /// its own, as °C.
    pub(super) fn new(
        key: String,
        value: String,
        values: &[f64],
        kind: Kind,
        written: Option<&str>,
    ) -> Drawn {
        let unit = written.map(unit_of).filter(|unit| !unit.is_empty());
        let sized = unit.and_then(|unit| Some((unit, kind.unit(unit).ok()?.to_f64())));
        let (unit, size) = sized.unwrap_or((kind.units()[0], 1.0));
        let numbers = values.iter().map(|value| value / size).collect();
        Drawn { key, value, numbers, unit: unit.to_string() }
    }
}

/// What stands behind the number or vector of a quantity.
fn unit_of(text: &str) -> &str {
    if let Some((_, unit)) = text.rsplit_once(']') {
        return unit.trim();
    }
    let ends = text.char_indices().map(|(i, _)| i).chain([text.len()]).rev();
    let is_number = |at: &usize| text[..*at].trim().parse::<f64>().is_ok();
    ends.into_iter().find(is_number).map_or("", |at| text[at..].trim())
}
