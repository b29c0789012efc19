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

/// Options for reading a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Reading {
    /// The axes of a table or a trajectory.
    pub axes: Axes,
    /// The columns, for tables whose names do not identify them or that have columns with these names.
    pub columns: Choice,
}

/// The content of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Recorded {
    /// Its attitudes, body to nav, in the order of the file.
    pub attitudes: Vec<Packed>,
    /// Their times, in order except at the breaks, and the unit if the file gives it.
    pub times: Times,
    /// The name of the time column in messages.
    pub time_name: String,
    /// Its axes.
    pub axes: Axes,
    /// Other ways to read the same columns, each with its meaning.
    pub others: Vec<(&'static str, Vec<Packed>)>,
    /// What the user should know about how it was read.
    pub remarks: Vec<String>,
    /// The number of rows, and of those left out.
    pub rows: Rows,
}

/// Why a file was not read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FileError {
    /// The system failed to read it.
    #[error("cannot read {}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: io::Error,
    },
    /// The file exists but is invalid: every mistake, one line each.
    #[error("{0}")]
    Content(String),
}

impl From<TableError> for FileError {
    fn from(error: TableError) -> FileError {
        FileError::Content(error.to_string())
    }
}

/// The command that rejects a file of another kind, and what it reads.
const READER: &str = "`score` does not read: it reads tables with a header, TUM trajectories and PX4 ULogs";
/// The number of first bytes that identify a file.
const HEAD: u64 = 4096;
/// The first bytes of every ULog.
const ULOG: &[u8] = b"ULog\x01\x12\x35";

/// Reads estimates. A table or a trajectory is in `axes`; a ULog states that it is in NED-FRD.
///
/// # Errors
/// Those of [`read_as`].
pub fn read(path: &Path, axes: Axes) -> Result<Recorded, FileError> {
    read_as(path, &Reading { axes, ..Reading::default() })
}

/// Reads estimates. It leaves out rows without an attitude and rows out of order, counts them in [`Recorded::rows`]
/// and mentions them in [`Recorded::remarks`].
///
/// # Errors
/// There is no such file, or it is of another kind; it has no columns of time and attitude; it has words instead of
/// numbers, or quaternions that are no rotations; no row is usable.
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
    // A file that cannot rewind, such as a pipe, uses its buffered start.
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
