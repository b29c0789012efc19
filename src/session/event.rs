//! What a run tells while it goes on.

use super::off::Off;
use crate::time::SimTime;
use std::time::Duration;

/// What happens meanwhile.
#[derive(Debug)]
#[non_exhaustive]
pub enum Event<'a> {
    /// Something the user should know.
    Notice(String),
    /// A link is open: protocol and what to connect to.
    Ready(&'a str),
    /// A ground station is spoken to there.
    Ground(&'a str),
    /// Nobody has come to that link yet: until that is so for this long, it is waited for somebody.
    Waiting {
        /// Who is waited for, and where.
        whom: String,
        /// From now on, at the most.
        left: Duration,
    },
    /// The controller on that link is waited for: nothing is streamed before it is heard.
    Silent(&'a str),
    /// The stream starts with the vehicle held still.
    Still,
    /// The scene starts.
    Started,
    /// How far it is.
    Progress(Progress),
}

/// How far a run is.
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    /// Scene time; while the vehicle is held still, for how long.
    pub t: SimTime,
    /// Whether it is held still before the scene.
    pub still: bool,
    /// Packets sent.
    pub packets: u64,
    /// Samples lost.
    pub dropped: u64,
    /// How far the newest estimate is off.
    pub error: Option<Off>,
}
