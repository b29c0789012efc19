//! Estimates from files: a table with a header, a TUM trajectory or a PX4 ULog, recognised by content.

mod table;
#[cfg(feature = "ulog")]
mod ulog;

use super::Packed;
use crate::geometry::Axes;
use crate::table::{Choice, Rows, TableError, Times, is_text, kind_of};
use glam::DQuat;
use std::fs::File;
use std::io::{self, BufReader, Read, Seek};
use std::path::{Path, PathBuf};

/// How a file is read.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Reading {
    /// The axes in which a table or a trajectory is written.
    pub axes: Axes,
    /// The columns of tables whose own names say nothing, or that have columns of these names.
    pub columns: Choice,
}

/// What a file holds.
#[derive(Clone, Debug, PartialEq)]
pub struct Recorded {
    /// Its attitudes, body to nav, in the order of the file.
    pub attitudes: Vec<Packed>,
    /// Their times, in order but for the breaks; the unit where the file says it.
    pub times: Times,
    /// What messages call the times: the name of the column.
    pub time_name: String,
    /// The axes in which it is written.
    pub axes: Axes,
    /// Other ways to read the same columns, each with what it would mean.
    pub others: Vec<(&'static str, Vec<Packed>)>,
    /// What the user should know of how it was read.
    pub remarks: Vec<String>,
    /// How many rows there were, and how many are left out.
    pub rows: Rows,
}

/// Why a file could not be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FileError {
    /// The system refused.
    #[error("cannot read {}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: io::Error,
    },
    /// It is there but cannot be understood: every mistake, a line each.
    #[error("{0}")]
    Content(String),
}

impl From<TableError> for FileError {
    fn from(error: TableError) -> FileError {
        FileError::Content(error.to_string())
    }
}

/// Who does not read a file of another kind, and what it reads.
const READER: &str = "`score` does not read: it reads tables with a header, TUM trajectories and PX4 ULogs";
/// As many first bytes tell what a file is.
const HEAD: u64 = 4096;
/// How every ULog begins.
const ULOG: &[u8] = b"ULog\x01\x12\x35";

/// Reads estimates. A table or a trajectory is in `axes`; a ULog says of itself that it is in NED-FRD.
///
/// # Errors
/// As of [`read_as`].
pub fn read(path: &Path, axes: Axes) -> Result<Recorded, FileError> {
    read_as(path, &Reading { axes, ..Reading::default() })
}

/// Reads estimates. Rows without an attitude, and those out of order, are left out, counted in [`Recorded::rows`] and
/// told in [`Recorded::remarks`].
///
/// # Errors
/// No such file; one of another kind; no columns of time and attitude; words where numbers should be, quaternions that
/// are no rotations; not a row that can be used.
pub fn read_as(path: &Path, reading: &Reading) -> Result<Recorded, FileError> {
    let refused = |source| FileError::Io { path: path.to_path_buf(), source };
    let name = path.display().to_string();
    let mut file = File::open(path).map_err(refused)?;
    let mut head = Vec::new();
    file.by_ref().take(HEAD).read_to_end(&mut head).map_err(refused)?;
    if head.starts_with(ULOG) {
        #[cfg(feature = "ulog")]
        return ulog::read(path);
        #[cfg(not(feature = "ulog"))]
        return Err(FileError::Content(format!(
            "{}: is a ULog, which this build does not read: build it with the feature `ulog`",
            path.display()
        )));
    }
    if let Some(kind) = kind_of(&head) {
        return Err(FileError::Content(kind.refusal(&name, READER)));
    }
    if !is_text(&head) {
        return Err(FileError::Content(format!(
            "{name} is neither text nor a ULog: an estimate is a table with a header, a TUM trajectory or a ULog"
        )));
    }
    // What is no plain file cannot be begun anew; its beginning is at hand.
    match file.rewind() {
        Ok(()) => table::read(&name, BufReader::with_capacity(1 << 18, file), reading),
        Err(_) => table::read(&name, BufReader::new(io::Cursor::new(head).chain(file)), reading),
    }
}

/// Why four numbers are no rotation.
fn no_rotation(q: DQuat) -> Option<String> {
    let length = q.length();
    ((length - 1.0).abs() > 0.02 || !length.is_finite())
        .then(|| format!("a quaternion of length {length}, but a rotation has length 1"))
}

#[cfg(test)]
mod tests;
