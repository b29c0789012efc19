//! A file format: each holds the same tables under the same names.

use super::error::DatasetError;
use super::folder::Folder;
use super::table::{Column, Table};
use crate::scene::Plan;
use crate::sensor::Reading;
use crate::time::SimTime;

/// A format: its name and how to begin a dataset in it.
#[derive(Debug)]
pub struct Format {
    /// As `--format` and the manifest spell it.
    pub name: &'static str,
    /// One line for the docs.
    pub about: &'static str,
    /// Creates the files that will hold these tables.
    pub open: Open,
}

/// Begins a dataset of a plan's tables in a folder.
pub type Open = fn(&Plan, &[Table], &Folder) -> Result<Box<dyn Writer>, DatasetError>;

/// A dataset being written in one format.
pub trait Writer {
    /// Adds a row to the table of that index: its time, then every column after `t_ns`.
    ///
    /// # Errors
    /// The file could not be written.
    fn row(&mut self, table: usize, t: SimTime, values: &[f64]) -> Result<(), DatasetError>;

    /// Adds a sensor's reading to the table of that index: for most formats the row that it makes, `values`.
    ///
    /// # Errors
    /// As of [`Writer::row`].
    fn reading(
        &mut self,
        table: usize,
        t: SimTime,
        _reading: &Reading,
        values: &[f64],
    ) -> Result<(), DatasetError> {
        self.row(table, t, values)
    }

    /// Completes the files, told how many rows each table got.
    ///
    /// # Errors
    /// A file could not be written.
    fn finish(self: Box<Self>, rows: &[u64]) -> Result<Vec<Written>, DatasetError>;
}

/// A file of numbers that is complete.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Written {
    /// Its name in the folder.
    pub name: String,
    /// Its rows, or messages.
    pub rows: u64,
    /// Its columns in order; none where the format has something else.
    pub columns: Vec<Column>,
}

/// The columns of a table as every format but CSV has them: `t_s`, the time in seconds, stands behind `t_ns`.
pub(super) fn with_seconds(table: &Table) -> Vec<Column> {
    let mut columns = table.columns.clone();
    columns.insert(1, Column { name: "t_s".into(), unit: "s" });
    columns
}

/// A number as CSV has it: −0 is 0.
pub(super) fn plain(value: f64) -> f64 {
    value + 0.0
}
