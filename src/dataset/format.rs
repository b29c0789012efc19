//! File formats as a table: each holds the same tables under the same names.

use super::csv;
use super::error::DatasetError;
use super::folder::Folder;
use super::table::Table;
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

/// Begins a dataset of these tables in a folder.
pub type Open = fn(&[Table], &Folder) -> Result<Box<dyn Writer>, DatasetError>;

/// Every format.
pub static FORMATS: [&Format; 1] = [&csv::FORMAT];

impl Format {
    /// The format of that name.
    pub fn from_name(name: &str) -> Option<&'static Format> {
        FORMATS.into_iter().find(|format| format.name == name)
    }
}

/// A dataset being written in one format.
pub trait Writer {
    /// Adds a row to the table of that index: its time, then every column after `t_ns`.
    ///
    /// # Errors
    /// The file could not be written.
    fn row(&mut self, table: usize, t: SimTime, values: &[f64]) -> Result<(), DatasetError>;

    /// Completes the files: the name of each and the index of the table it holds.
    ///
    /// # Errors
    /// A file could not be written.
    fn finish(self: Box<Self>) -> Result<Vec<(String, usize)>, DatasetError>;
}
