//! Estimates from files: a table with a header, a TUM trajectory, a PX4 ULog; which of them, the file itself says.

mod table;
mod ulog;

use super::{Timed, judge::Stamp};
use crate::geometry::{Attitude, Axes};
use crate::time::SimTime;
use glam::DQuat;
use std::io;
use std::path::{Path, PathBuf};

/// What a file holds.
#[derive(Clone, Debug, PartialEq)]
pub struct Recorded {
    /// Its estimates in the order of the file, which is that of time.
    pub estimates: Vec<Timed>,
    /// The axes in which it is written.
    pub axes: Axes,
    /// Other ways to read the same columns, each with what it would mean.
    pub others: Vec<(&'static str, Vec<Attitude>)>,
    /// What the user should know of how it was read.
    pub remarks: Vec<String>,
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

/// Reads estimates. A table or a trajectory is in `axes`; a ULog says of itself that it is in NED-FRD.
///
/// # Errors
/// No such file; no columns of time and attitude; numbers that are none, quaternions that are no rotations, times out
/// of order.
pub fn read(path: &Path, axes: Axes) -> Result<Recorded, FileError> {
    let bytes = std::fs::read(path).map_err(|source| FileError::Io { path: path.to_path_buf(), source })?;
    if bytes.starts_with(ulog::MAGIC) {
        return ulog::read(path);
    }
    let Ok(text) = String::from_utf8(bytes) else {
        return Err(FileError::Content(format!(
            "{} is neither text nor a ULog: an estimate is a table with a header, a TUM trajectory or a ULog",
            path.display()
        )));
    };
    table::read(&path.display().to_string(), &text, axes)
}

/// One estimate of a file; its only time is the one beside it.
fn timed(ns: i64, attitude: Attitude) -> Timed {
    Timed { arrival: SimTime(ns), stamp: Stamp::Arrival, attitude }
}

/// Why four numbers are no rotation.
fn no_rotation(q: DQuat) -> Option<String> {
    let length = q.length();
    ((length - 1.0).abs() > 0.02 || !length.is_finite())
        .then(|| format!("a quaternion of length {length}, but a rotation's is 1"))
}

#[cfg(test)]
mod tests;
