//! A file that a copy of the scene needs beside it.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// A file that the scene as resolved names.
#[derive(Clone, Debug, PartialEq)]
pub struct Attached {
    /// What the scene as resolved calls it.
    pub name: String,
    pub(super) path: PathBuf,
    pub(super) stamp: Stamp,
}

/// Length in bytes and time of change.
pub(super) type Stamp = (u64, Option<SystemTime>);

impl Attached {
    /// Where it was read.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// What stands in it, as when the scene was read.
    ///
    /// # Errors
    /// The system's reason, or that it has changed since.
    pub fn contents(&self) -> io::Result<Vec<u8>> {
        if stamp(&self.path)? != self.stamp {
            return Err(io::Error::other("it has changed since the scene was read; start again"));
        }
        fs::read(&self.path)
    }
}

/// The stamp of a file as it is now.
pub(super) fn stamp(path: &Path) -> io::Result<Stamp> {
    let metadata = fs::metadata(path)?;
    Ok((metadata.len(), metadata.modified().ok()))
}
