//! Why a run could not start.

use crate::link::LinkError;
use crate::time::SimTime;
use std::time::Duration;

/// Why a run could not start.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SessionError {
    /// A link did not open, or broke during the wait.
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
    /// Nobody connected.
    #[error("nobody came to {link} in {}: {hint}open it from the other side, or wait longer with --wait TIME, or start at once with --wait 0", seconds(*waited))]
    Nobody {
        /// What to connect to.
        link: String,
        /// How long the run waited.
        waited: Duration,
        /// What a controller of this make needs, with a separator.
        hint: String,
    },
    /// A controller never sent its opening messages.
    #[error("{link} was not heard in {}: {came}; wait longer with --wait TIME, or start at once with --wait 0", seconds(*waited))]
    Unheard {
        /// What to connect to.
        link: String,
        /// How long the run waited.
        waited: Duration,
        /// What arrived instead, and what may be wrong.
        came: String,
    },
    /// A controller's estimator did not settle.
    #[error(
        "{link} is not ready after {rested} at rest: {came}; wait longer with --wait TIME, or start at once with --wait 0"
    )]
    NotReady {
        /// What to connect to.
        link: String,
        /// How long it received the vehicle at rest.
        rested: SimTime,
        /// What it reported.
        came: String,
    },
    /// A controller asks for more packets than its link carries.
    #[error(
        "{0}; or start in spite of it, and lose what does not fit: --force, or force = true in [[output]]"
    )]
    TooSlow(String),
    /// No driver read a sample.
    #[error("no sample was read from the chips on {link} in {}: {came}; wait longer with --wait TIME, or start the scene at once with --wait 0", seconds(*waited))]
    Unread {
        /// What to connect to.
        link: String,
        /// How long the run waited.
        waited: Duration,
        /// What came instead.
        came: String,
    },
    /// The scene's sensors are no chips, or a chip was set to something unknown.
    #[error("{0}")]
    Bus(String),
    /// The command did not start.
    #[error("`{program}` could not be started: {source}")]
    Command {
        /// The program.
        program: String,
        /// Why.
        source: std::io::Error,
    },
    /// The system refused something that every run needs.
    #[error("could not {doing}: {source}")]
    System {
        /// What the run tried.
        doing: &'static str,
        /// Why not.
        source: std::io::Error,
    },
}

fn seconds(duration: Duration) -> String {
    SimTime(i64::try_from(duration.as_nanos()).unwrap_or(i64::MAX)).to_string()
}
