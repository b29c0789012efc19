//! Why a dataset could not be written or read.

use crate::motion::method::{ReferenceError, ToleranceError};
use std::io;
use std::path::{Path, PathBuf};

/// What went wrong, with the path it went wrong at.
///
/// One enum for the room: a caller only shows it, so each names the path, the reason, and where it helps what
/// would be right.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DatasetError {
    /// The output folder holds something.
    #[error("{} already holds files; name another folder, or replace its contents with --force", path.display())]
    Exists {
        /// The folder.
        path: PathBuf,
    },
    /// Files that would be replaced and are not ours.
    #[error("{} has {}, which would be replaced but is in no ratetable manifest: move {} away, or name another folder", path.display(), listed(names), if names.len() == 1 { "it" } else { "them" })]
    NotOurs {
        /// The folder.
        path: PathBuf,
        /// Their names.
        names: Vec<String>,
    },
    /// The output folder holds something of ours of another kind.
    #[error("{} holds a {there}, which a {wanted} would replace or mix with; name another folder", path.display())]
    OfAnotherKind {
        /// The folder.
        path: PathBuf,
        /// What is there.
        there: String,
        /// What was to be written.
        wanted: &'static str,
    },
    /// Another process is writing into the folder.
    #[error("{} is being written by another process: wait for it to end, or name another folder", path.display())]
    Busy {
        /// The folder.
        path: PathBuf,
    },
    /// The folder came into being while its contents were made.
    #[error("{} was made by another process in the meantime: that one stays and this one is discarded; name another folder", path.display())]
    Appeared {
        /// The folder.
        path: PathBuf,
    },
    /// The output path is something else.
    #[error("{} is not a folder; name a new folder", path.display())]
    NotAFolder {
        /// The path.
        path: PathBuf,
    },
    /// A scene played for ever has no last row.
    #[error("a dataset needs an end: give a time, such as 60s, not `forever`")]
    Endless,
    /// The method of `[reference]` could not go on.
    #[error("reference.csv cannot be computed: {0}; choose another `method` in [reference]")]
    Reference(#[source] ReferenceError),
    /// `method = "auto"` found none.
    #[error("reference.csv cannot be computed: {0}; see `tolerance` in [reference]")]
    Tolerance(#[source] ToleranceError),
    /// Asked to stop.
    #[error("stopped before the dataset was complete; nothing is kept")]
    Stopped,
    /// Asked to stop between runs.
    #[error("stopped: {complete} of {of} runs are complete; run the same command again to make the others")]
    RunsStopped {
        /// Of them complete.
        complete: u64,
        /// Asked for.
        of: u64,
    },
    /// A run's folder with something else in it.
    #[error("{} holds a run of another scene, version or format; name another folder, or replace it with --force", path.display())]
    OtherRun {
        /// The folder.
        path: PathBuf,
    },
    /// The system refused.
    #[error("cannot {doing} {}: {source}", path.display())]
    Io {
        /// Such as `write`.
        doing: &'static str,
        /// The file or folder.
        path: PathBuf,
        /// The system's reason.
        source: io::Error,
    },
    /// A file that is there but cannot be understood.
    #[error("{place}: {problem}")]
    Content {
        /// File, line and column name, as far as known.
        place: String,
        /// What is wrong and what would be right.
        problem: String,
    },
}

impl DatasetError {
    /// For `map_err` of an operation at `path`.
    pub(super) fn io<'a>(doing: &'static str, path: &'a Path) -> impl Fn(io::Error) -> DatasetError + 'a {
        move |source| DatasetError::Io { doing, path: path.to_path_buf(), source }
    }
}

/// A few names, and how many more.
fn listed(names: &[String]) -> String {
    const SHOWN: usize = 5;
    let shown = names.iter().take(SHOWN).map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ");
    match names.len() {
        0..=SHOWN => shown,
        all => format!("{shown} and {} more", all - SHOWN),
    }
}
