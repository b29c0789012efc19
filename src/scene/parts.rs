//! What the data files of parts say, and where each value comes from.

use super::document::{Entry, Mistake, Node, Table, Value};
use crate::quantity::{self, Kind, Sign};
use crate::sensor::parts::{Part, Sourced};
use crate::sensor::{ByKind, SensorKind};
use crate::time::{Rate, SimTime};
use std::collections::BTreeMap;
use std::f64::consts::{SQRT_2, TAU};
use std::fmt;
use std::sync::{Arc, Mutex, PoisonError};

/// The tables of settings that a sensor of a part may have.
const TABLES: [&str; 3] = ["scales", "rates", "filters"];

/// What a sensor of a part can be set to.
#[derive(Clone, Debug, Default)]
pub struct Settings {
    /// Its full scales.
    pub scales: Vec<Scale>,
    /// Its output data rates.
    pub rates: Vec<OutputRate>,
    /// Its low-pass filters.
    pub filters: Vec<Filter>,
    /// Of each of these tables that it has, `scales`, `rates` or `filters`: datasheet and page.
    pub sources: Vec<(&'static str, String)>,
}

/// A full scale and the counts that belong to it, as written.
#[derive(Clone, Debug)]
pub struct Scale {
    /// Such as `2000 deg/s`.
    pub range: String,
    /// Such as `16.4 LSB/(deg/s)`.
    pub resolution: String,
}

/// An output data rate of a part: `rate` divided by any whole number from 1 to `divide`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OutputRate {
    /// Undivided.
    pub rate: Rate,
    /// 1 where it is fixed.
    pub divide: u32,
}

/// A low-pass filter of a part.
#[derive(Clone, Debug)]
pub struct Filter {
    /// As `filter = "…"` names it; a part may give one name another bandwidth at another rate.
    pub name: String,
    /// Where its gain is 1/√2, Hz.
    pub low_pass: f64,
    /// 1, or 2 for Butterworth.
    pub order: u8,
    /// All of its delay; `None` where the sheet gives none.
    pub delay: Option<SimTime>,
    /// The undivided output data rates that it belongs to; any where there are none.
    pub at: Vec<Rate>,
}

impl Filter {
    /// The delay of the filter itself for what is slow: `1/w` or `√2/w`, w = 2π·`low_pass`, s.
    pub fn own_delay(&self) -> f64 {
        let orders = if self.order == 2 { SQRT_2 } else { 1.0 };
        orders / (TAU * self.low_pass)
    }

    /// What the sheet's delay leaves beside that of the filter itself, if anything.
    pub fn rest_of_delay(&self) -> Option<SimTime> {
        let rest = self.delay?.0 - libm::round(self.own_delay() * 1e9) as i64;
        (rest > 0).then_some(SimTime(rest))
    }
}

impl fmt::Display for Scale {
    /// `±2000 deg/s at 16.4 LSB/(deg/s)`
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "±{} at {}", self.range, self.resolution)
    }
}

impl fmt::Display for OutputRate {
    /// `8000 Hz`, `1000 Hz / 1 to 256`
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.divide {
            1 => write!(f, "{}", self.rate),
            divide => write!(f, "{} / 1 to {divide}", self.rate),
        }
    }
}

impl fmt::Display for Filter {
    /// `DLPF 2 92 Hz, delay 3.9 ms, at 1000 Hz`
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {} Hz", self.name, self.low_pass)?;
        if self.order == 2 {
            f.write_str(" of order 2")?;
        }
        if let Some(delay) = self.delay {
            write!(f, ", delay {} ms", delay.0 as f64 / 1e6)?;
        }
        let at: Vec<_> = self.at.iter().map(Rate::to_string).collect();
        if at.is_empty() { Ok(()) } else { write!(f, ", at {}", at.join(" or ")) }
    }
}

/// A part's file as read.
pub(super) struct File {
    /// As written.
    pub table: Table,
    settings: ByKind<Settings>,
}

impl File {
    /// Reads the file of a part once in the life of the program: a thousand runs of a scene name it a thousand times.
    pub fn of(part: &'static Part) -> Result<Arc<File>, Mistake> {
        static READ: Mutex<BTreeMap<&str, Arc<File>>> = Mutex::new(BTreeMap::new());
        let mut read = READ.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(file) = read.get(part.file) {
            return Ok(file.clone());
        }
        let table = Table::parse(part.text, part.file)?;
        let mut settings = ByKind::<Settings>::default();
        for kind in SensorKind::ALL {
            settings[kind as usize] = Settings::of(&table, kind)?;
        }
        let file = Arc::new(File { settings, table });
        read.insert(part.file, file.clone());
        Ok(file)
    }

    /// What a sensor can be set to.
    pub fn settings(&self, kind: SensorKind) -> &Settings {
        &self.settings[kind as usize]
    }
}

/// Every value of a part and where it comes from, for `list parts` and the parts' own test.
///
/// # Errors
/// The place of a value that names no source.
pub fn sources(part: &Part) -> Result<Vec<Sourced>, Mistake> {
    let table = Table::parse(part.text, part.file)?;
    let mut sourced = Vec::new();
    for kind in SensorKind::ALL {
        let entries = sensor(&table, kind).into_iter().flat_map(|preset| &preset.entries);
        for entry in entries.filter(|entry| !TABLES.contains(&entry.key.as_str())) {
            sourced.push(source_of(kind, entry)?);
        }
    }
    Ok(sourced)
}

/// What a sensor of the part can be set to; nothing for one that it has not.
///
/// # Errors
/// The place of what is no setting, or of settings without a source.
pub fn settings(part: &Part, kind: SensorKind) -> Result<Settings, Mistake> {
    Settings::of(&Table::parse(part.text, part.file)?, kind)
}

/// The table of a sensor in a part's file.
pub(super) fn sensor(file: &Table, kind: SensorKind) -> Option<&Table> {
    table(file.get(kind.name())?)
}

fn table(entry: &Entry) -> Option<&Table> {
    match &entry.node.value {
        Value::Table(table) => Some(table),
        _ => None,
    }
}

impl Settings {
    fn of(file: &Table, kind: SensorKind) -> Result<Settings, Mistake> {
        let mut settings = Settings::default();
        let Some(preset) = sensor(file, kind) else { return Ok(settings) };
        for name in TABLES {
            let Some(entry) = preset.get(name) else { continue };
            let wrong = |entry: &Entry, needs: &str| Mistake {
                place: entry.place.clone(),
                message: format!("`{}` of {kind} needs {needs}", entry.key),
            };
            let lacks = || wrong(entry, "a `source` and an array of `settings`, or `like` another sensor's");
            let given = table(entry).ok_or_else(lacks)?;
            let source =
                text(given, "source").filter(|source| !source.trim().is_empty()).ok_or_else(lacks)?;
            settings.sources.push((name, source));
            let like = text(given, "like").and_then(|other| table(file.get(&other)?));
            let rows = like.and_then(|other| table(other.get(name)?)).unwrap_or(given);
            let Some(Value::Array(rows)) = rows.get("settings").map(|entry| &entry.node.value) else {
                return Err(lacks());
            };
            for row in rows {
                settings.add(name, row).ok_or_else(|| Mistake {
                    place: row.place.clone(),
                    message: format!("this is not a setting of the {name} of {kind}"),
                })?;
            }
        }
        Ok(settings)
    }

    fn add(&mut self, name: &str, row: &Node) -> Option<()> {
        let Value::Table(row) = &row.value else { return None };
        match name {
            "scales" => {
                self.scales.push(Scale { range: text(row, "range")?, resolution: text(row, "resolution")? })
            }
            "rates" => self.rates.push(OutputRate {
                rate: rate(&text(row, "rate")?)?,
                divide: whole(row, "divide").map_or(Some(1), |divide| u32::try_from(divide).ok())?,
            }),
            _ => self.filters.push(Filter {
                name: text(row, "name")?,
                low_pass: Kind::FREQUENCY.scalar(&text(row, "low_pass")?).ok()?.to_f64(),
                order: if whole(row, "order") == Some(2) { 2 } else { 1 },
                delay: match text(row, "delay") {
                    Some(delay) => Some(SimTime(quantity::duration_ns(&delay, Sign::NonNegative).ok()?)),
                    None => None,
                },
                at: match row.get("at").map(|entry| &entry.node.value) {
                    None => Vec::new(),
                    Some(Value::Array(rates)) => {
                        rates.iter().map(|node| rate(&texts(&node.value))).collect::<Option<_>>()?
                    }
                    Some(_) => return None,
                },
            }),
        }
        Some(())
    }
}

pub(super) fn rate(text: &str) -> Option<Rate> {
    let (numerator, denominator) = quantity::rate(text).ok()?;
    Rate::new(numerator, denominator)
}

fn whole(table: &Table, key: &str) -> Option<i128> {
    match table.get(key)?.node.value {
        Value::Integer(number) => Some(number),
        _ => None,
    }
}

fn text(table: &Table, key: &str) -> Option<String> {
    match &table.get(key)?.node.value {
        Value::Text(text) => Some(text.clone()),
        _ => None,
    }
}

fn source_of(kind: SensorKind, entry: &Entry) -> Result<Sourced, Mistake> {
    let value = |table: &Table| match table.get("value").map(|entry| &entry.node.value) {
        Some(Value::Text(text)) => Some(text.clone()),
        Some(Value::Boolean(flag)) => Some(flag.to_string()),
        Some(Value::Table(table)) => {
            table.entries.first().map(|entry| format!("{} {}", entry.key, texts(&entry.node.value)))
        }
        _ => None,
    };
    let read = table(entry)
        .and_then(|table| value(table).zip(text(table, "source").filter(|source| !source.trim().is_empty())));
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
