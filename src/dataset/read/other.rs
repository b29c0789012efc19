//! The tables of a dataset that was written without CSV: which file has them, and the checks that all formats share.

use super::super::DatasetError;
use super::super::listed;
#[cfg(feature = "mcap")]
use super::mcap;
#[cfg(feature = "parquet")]
use super::parquet;
use super::rows::{Rows, What};
use super::{RecordedTruth, axes};
use super::{mat, npy, tum};
use crate::geometry::{Body, Vector};
use crate::sensor::SensorKind;
use crate::time::SimTime;
use glam::{DQuat, DVec3};
use std::path::{Path, PathBuf};

/// Time and value of each reading.
type Readings = Vec<(SimTime, Vector<Body>)>;

/// How a format is read: of its file, the table and the columns of these names.
type Read = fn(&Path, What, &[&str]) -> Result<Rows, DatasetError>;

/// Every format but CSV, the one to be preferred first: its name, its file if that is one for all tables, its reader
/// if this build has it.
const FORMATS: [(&str, Option<&str>, Option<Read>); 5] = [
    ("npy", None, Some(npy::read)),
    ("mat", None, Some(mat::read)),
    #[cfg(feature = "parquet")]
    ("parquet", None, Some(parquet::read)),
    #[cfg(not(feature = "parquet"))]
    ("parquet", None, None),
    #[cfg(feature = "mcap")]
    ("mcap", Some("dataset.mcap"), Some(mcap::read)),
    #[cfg(not(feature = "mcap"))]
    ("mcap", Some("dataset.mcap"), None),
    ("tum", None, Some(tum::read)),
];

/// Whether the manifest of a folder says that it holds a sensor's readings.
pub(super) fn lists(folder: &Path, kind: SensorKind) -> bool {
    let json = listed::read_json(folder).unwrap_or_default();
    let sensors = json.get("sensors").and_then(|sensors| sensors.as_array());
    sensors.into_iter().flatten().any(|sensor| sensor.get("name").is_some_and(|name| *name == kind.name()))
}

/// The attitudes of a dataset without `truth.csv`; `None` if no other format has them either.
pub(super) fn truth(folder: &Path) -> Result<Option<RecordedTruth>, DatasetError> {
    let Some((file, rows)) = rows(folder, What::Truth)? else { return Ok(None) };
    let axes = axes(&file)?;
    let mut attitudes = Vec::with_capacity(rows.times.len());
    for (i, t) in rows.times.iter().enumerate() {
        let [w, x, y, z] = [0, 1, 2, 3].map(|of| rows.columns[of][i]);
        let q = DQuat::from_xyzw(x, y, z, w);
        if (q.length() - 1.0).abs() > 1e-3 {
            let problem =
                format!("[{w}, {x}, {y}, {z}] has length {}, but a rotation has length 1", q.length());
            return Err(wrong(&file, i, "qw..qz", problem));
        }
        attitudes.push((SimTime(*t), axes.attitude_in(q)));
    }
    Ok(Some(RecordedTruth { axes, attitudes }))
}

/// One sensor's readings of a dataset without its CSV; `None` if no other format has them either.
pub(super) fn readings(folder: &Path, kind: SensorKind) -> Result<Option<Readings>, DatasetError> {
    let Some((file, rows)) = rows(folder, What::Sensor(kind))? else { return Ok(None) };
    let axes = axes(&file)?;
    let value = |i: usize| DVec3::from_array([0, 1, 2].map(|axis| rows.columns[axis][i]));
    let reading = |(i, t): (usize, &i64)| (SimTime(*t), axes.body_in(value(i)));
    Ok(Some(rows.times.iter().enumerate().map(reading).collect()))
}

/// The rows of a table, in order of time and every number finite, with the file that has them.
fn rows(folder: &Path, what: What) -> Result<Option<(PathBuf, Rows)>, DatasetError> {
    let names = what.columns();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    for (format, file, read) in FORMATS {
        let file = folder.join(file.map_or(format!("{}.{format}", what.name()), String::from));
        if !file.exists() {
            continue;
        }
        let Some(read) = read else {
            let problem = format!(
                "this build does not read {format}: `cargo build --release --features {format}` builds one that does, and `generate --format csv` makes a dataset that any build reads"
            );
            return Err(DatasetError::Content { place: file.display().to_string(), problem });
        };
        let rows = read(&file, what, &names)?;
        check(&file, &rows, &names)?;
        return Ok(Some((file, rows)));
    }
    if folder.join("dataset.resd").exists() {
        let problem = "RESD holds the readings as a chip's model takes them, and no truth: generate it with --format csv, npy, mat, parquet or mcap too";
        let place = folder.display().to_string();
        return Err(DatasetError::Content { place, problem: problem.into() });
    }
    if what != What::Truth && folder.join("truth.tum").exists() && lists(folder, SensorKind::Gyro) {
        let problem = format!(
            "TUM trajectories hold only attitudes, and {} has no other format with readings: generate it with --format csv, npy, mat, parquet or mcap too",
            what.name()
        );
        return Err(DatasetError::Content { place: folder.display().to_string(), problem });
    }
    Ok(None)
}

fn check(file: &Path, rows: &Rows, names: &[&str]) -> Result<(), DatasetError> {
    if let Some(i) = rows.times.windows(2).position(|pair| pair[1] <= pair[0]) {
        let problem =
            format!("{} is not after {}, the time of the previous row", rows.times[i + 1], rows.times[i]);
        return Err(wrong(file, i + 1, "t_ns", problem));
    }
    for (column, name) in rows.columns.iter().zip(names) {
        if column.len() != rows.times.len() {
            let problem = format!("has {} rows, and t_ns {}", column.len(), rows.times.len());
            return Err(DatasetError::Content {
                place: format!("{}, column {name}", file.display()),
                problem,
            });
        }
        if let Some(i) = column.iter().position(|value| !value.is_finite()) {
            return Err(wrong(file, i, name, format!("{} is not a number", column[i])));
        }
    }
    Ok(())
}

/// A mistake in a row, the first of which is row 1.
fn wrong(file: &Path, row: usize, column: &str, problem: String) -> DatasetError {
    DatasetError::Content { place: format!("{}, row {}, column {column}", file.display(), row + 1), problem }
}
