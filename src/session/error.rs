//! Why nothing could be run.

use crate::link::LinkError;
use crate::time::SimTime;
use std::time::Duration;

/// Why nothing could be run.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SessionError {
    /// A link could not be opened or broke while waiting.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// A controller that answers on a connection of its own is not there.
    #[error("{source}; {whom} answers there: start it first, then this")]
    Answers {
        /// Which controller.
        whom: &'static str,
        /// Why there is no connection.
        source: LinkError,
    },
    /// Nobody came.
    #[error("nobody came to {link} in {}: open it from the other side, or wait longer with --wait TIME, or start at once with --wait 0", seconds(*waited))]
    Nobody {
        /// What to connect to.
        link: String,
        /// For how long we waited.
        waited: Duration,
    },
    /// A controller never said what it begins with.
    #[error("{link} was not heard in {}: {came}; wait longer with --wait TIME, or start at once with --wait 0", seconds(*waited))]
    Unheard {
        /// What to connect to.
        link: String,
        /// For how long we waited.
        waited: Duration,
        /// What came instead, and what may be wrong.
        came: String,
    },
    /// A controller's estimator did not settle.
    #[error(
        "{link} is not ready after {rested} at rest: {came}; wait longer with --wait TIME, or start at once with --wait 0"
    )]
    NotReady {
        /// What to connect to.
        link: String,
        /// For how long it was fed the vehicle at rest.
        rested: SimTime,
        /// What came of it.
        came: String,
    },
    /// The command could not be started.
    #[error("`{program}` could not be started: {source}")]
    Command {
        /// The program.
        program: String,
        /// Why.
        source: std::io::Error,
    },
    /// The system refused what every run needs.
    #[error("could not {doing}: {source}")]
    System {
        /// What was tried.
        doing: &'static str,
        /// Why not.
        source: std::io::Error,
    },
}

fn seconds(duration: Duration) -> String {
    SimTime(i64::try_from(duration.as_nanos()).unwrap_or(i64::MAX)).to_string()
}
