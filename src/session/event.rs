//! Events that a run reports while it goes on.

use super::off::Off;
use super::shared::LaneCounts;
use crate::bus::Change;
use crate::geometry::Attitude;
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
    /// Somebody has to come before anything is streamed: told once a second.
    Waiting {
        /// Who has to do what: `a reader to open /tmp/imu`.
        whom: &'a str,
        /// The longest remaining wait.
        left: Duration,
    },
    /// The stream starts with the vehicle held still.
    Still,
    /// The scene starts.
    Started,
    /// Progress of the run.
    Progress(Progress),
    /// Each link's counts, beside the progress.
    Links(&'a [LinkProgress]),
    /// Attitudes that came back since the last such event: the link's index, and for each the scene time at which it
    /// held, as far as known by now.
    Estimates(usize, &'a [(SimTime, Attitude)]),
    /// A driver has set a sensor on a bus.
    Set(&'a Change),
}

/// One link's counts so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LinkProgress {
    /// Packets that it took.
    pub packets: u64,
    /// Bytes in them.
    pub bytes: u64,
    /// Packets that it did not take.
    pub dropped: u64,
    /// Packets that wait for it here.
    pub queued: u64,
    /// Bytes that the other side has not read, if the system tells.
    pub unread: Option<u64>,
    /// Bytes that came back.
    pub received: u64,
    /// Damaged packets among them, where they are packets.
    pub damaged: Option<u64>,
}

impl LinkProgress {
    /// What a lane has published.
    pub(super) fn of(counts: &LaneCounts) -> LinkProgress {
        LinkProgress {
            packets: counts.packets.get(),
            bytes: counts.bytes.get(),
            dropped: counts.dropped.get(),
            queued: counts.queued.get(),
            ..LinkProgress::default()
        }
    }
}

/// Progress of a run.
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    /// Scene time; during the rest, how long the vehicle has been held still.
    pub t: SimTime,
    /// Stream time, the rest included.
    pub stream: SimTime,
    /// Whether this is the rest before the scene.
    pub still: bool,
    /// Packets sent.
    pub packets: u64,
    /// Samples lost.
    pub dropped: u64,
    /// The truth at that time; body to nav.
    pub truth: Attitude,
    /// The newest estimate, and its error.
    pub estimate: Option<(Attitude, Off)>,
}
