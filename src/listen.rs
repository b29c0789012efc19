//! A meter for any stream: from a simulator, a real board, or another instance of this program.
//!
//! [`Meter`] is the pure core: it turns bytes and their arrival times into rates, intervals, losses and damage.
//! [`listen`] feeds it from a link until the sender leaves, the time is over or the user stops it.
//!
//! ```
//! use ratetable::{listen::Meter, wire::Protocol};
//!
//! let mut meter = Meter::new(Protocol::Csv);
//! for k in 0..11 {
//!     let line = format!("{},gyro,0,0,0.1\n", k * 10_000_000);
//!     meter.arrived(line.as_bytes(), Some(k * 10_000_000));
//! }
//! meter.finish();
//! assert_eq!((meter.counts().packets, meter.counts().damaged), (11, 0));
//! ```

mod asking;
mod live;
mod meter;
mod pace;
mod stream;

pub use asking::Told;
pub use live::listen;
pub use meter::{Meter, Value};
pub use stream::Stream;

use crate::link::{Address, LinkError};
use crate::time::SimTime;
use crate::wire::Protocol;
use std::time::Duration;

/// What to listen to.
#[derive(Clone, Debug)]
pub struct Job {
    /// The format of the packets.
    pub protocol: Protocol,
    /// Where to receive them.
    pub address: Address,
    /// How long to listen after the first bytes; `None` until the sender leaves.
    pub span: Option<Duration>,
    /// Timeout for the first packet; zero waits without end.
    pub wait: Duration,
    /// Whether to ask a controller for its attitude, as a ground station does.
    pub attitude: bool,
    /// Whether to pass on what the samples say.
    pub values: bool,
}

/// An event while listening.
#[derive(Debug)]
#[non_exhaustive]
pub enum Event<'a> {
    /// Something the user should know.
    Notice(String),
    /// The link is open: protocol and what to connect to.
    Ready(&'a str),
    /// Progress of the measurement.
    Progress(Progress<'a>),
    /// What the samples of a read said, and when it came: since the first bytes, or `None` of a recording.
    Values(Option<SimTime>, &'a [Value]),
    /// Attitudes that a controller told since the last such event.
    Told(&'a [Told]),
}

/// Progress of the measurement.
#[derive(Debug)]
pub struct Progress<'a> {
    /// Time since the first bytes.
    pub elapsed: Duration,
    /// What arrived so far.
    pub meter: &'a Meter,
    /// Samples a second of each stream over about the last second, Hz.
    pub rates: &'a [f64],
}

/// The result.
#[derive(Debug)]
pub struct Heard {
    /// The name of the opened link.
    pub name: String,
    /// Whether the user stopped it.
    pub interrupted: bool,
    /// Everything counted.
    pub meter: Meter,
    /// The attitude that a controller told, where it was asked.
    pub told: Vec<Told>,
}

/// Why the measurement failed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ListenError {
    /// The link did not open, or failed.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// The link cannot receive.
    #[error("nothing comes from {link}: {right}")]
    Mute {
        /// The requested link.
        link: String,
        /// What would be right.
        right: &'static str,
    },
    /// No byte arrived.
    #[error("not a byte came from {link} {}: {check}", within(*waited))]
    Silence {
        /// The name of the opened link.
        link: String,
        /// How long it waited, if the timeout ended it.
        waited: Option<Duration>,
        /// What to check.
        check: &'static str,
    },
    /// Bytes arrived, but no packet.
    #[error("{bytes} bytes came from {link}, and no valid {} packet: {}", protocol.name(), other(*reads_as))]
    Noise {
        /// The name of the opened link.
        link: String,
        /// The number of bytes.
        bytes: u64,
        /// The expected protocol.
        protocol: Protocol,
        /// The protocol that they match.
        reads_as: Option<Protocol>,
    },
    /// The system refused something that listening needs.
    #[error("could not {doing}: {source}")]
    System {
        /// What it tried.
        doing: &'static str,
        /// Why not.
        source: std::io::Error,
    },
}

fn within(waited: Option<Duration>) -> String {
    let ns = |waited: Duration| SimTime(i64::try_from(waited.as_nanos()).unwrap_or(i64::MAX));
    waited.map_or("before it ended".into(), |waited| format!("within {} (--wait)", ns(waited)))
}

fn other(reads_as: Option<Protocol>) -> String {
    match reads_as {
        Some(protocol) => format!("they read as {0}, so listen to {0}@…", protocol.name()),
        None => "is it another protocol or another baud rate?".into(),
    }
}

#[cfg(test)]
mod tests;
