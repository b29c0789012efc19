//! Events that a run reports while it goes on.

use super::off::Off;
use crate::time::SimTime;
use std::time::Duration;

/// An event during a run.
#[derive(Debug)]
#[non_exhaustive]
pub enum Event<'a> {
    /// Something the user should know.
    Notice(String),
    /// A link is open: its protocol and what to connect to.
    Ready(&'a str),
    /// A ground station link is open at this address.
    Ground(&'a str),
    /// Nobody has connected to that link yet, and the run waits.
    Waiting {
        /// Whom the run waits for, and where.
        whom: String,
        /// The longest remaining wait.
        left: Duration,
    },
    /// The controller on that link has not spoken yet: nothing is streamed before it does.
    Silent(&'a str),
    /// The stream starts with the vehicle held still.
    Still,
    /// The scene starts.
    Started,
    /// Progress of the run.
    Progress(Progress),
}

/// Progress of a run.
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    /// Scene time; during the rest, how long the vehicle has been held still.
    pub t: SimTime,
    /// Whether this is the rest before the scene.
    pub still: bool,
    /// Packets sent.
    pub packets: u64,
    /// Samples lost.
    pub dropped: u64,
    /// Error of the newest estimate.
    pub error: Option<Off>,
}
