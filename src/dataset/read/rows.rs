//! What readers of one format share: the rows that they give, and what they say of a file that has none.

use super::super::DatasetError;
use crate::sensor::SensorKind;
use std::path::Path;

/// Columns of a table: `t_ns`, and those that were asked for.
#[derive(Debug, Default)]
pub(super) struct Rows {
    pub times: Vec<i64>,
    pub columns: Vec<Vec<f64>>,
}

/// Which table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum What {
    Truth,
    Sensor(SensorKind),
}

impl What {
    pub fn name(self) -> &'static str {
        match self {
            What::Truth => "truth",
            What::Sensor(kind) => kind.name(),
        }
    }

    pub fn columns(self) -> Vec<String> {
        match self {
            What::Truth => ["qw", "qx", "qy", "qz"].map(String::from).into(),
            What::Sensor(kind) => ["x", "y", "z"].map(|axis| format!("{axis}_{}", kind.column_unit())).into(),
        }
    }
}

/// A mistake of the whole file.
pub(super) fn refuse(file: &Path, problem: impl ToString) -> DatasetError {
    DatasetError::Content { place: file.display().to_string(), problem: problem.to_string() }
}

/// The places of the columns asked for among those that a file has.
pub(super) fn places(file: &Path, has: &[String], names: &[&str]) -> Result<Vec<usize>, DatasetError> {
    let find = |name: &&str| has.iter().position(|column| column == name);
    let missing =
        |name: &str| refuse(file, format!("has no column `{name}`; its columns are {}", has.join(", ")));
    names.iter().map(|name| find(name).ok_or_else(|| missing(name))).collect()
}

/// Opens a file; how many bytes it has.
pub(super) fn open(file: &Path) -> Result<(std::io::BufReader<std::fs::File>, u64), DatasetError> {
    let opened = std::fs::File::open(file).map_err(DatasetError::io("read", file))?;
    let len = opened.metadata().map_err(DatasetError::io("read", file))?.len();
    Ok((std::io::BufReader::with_capacity(1 << 18, opened), len))
}
