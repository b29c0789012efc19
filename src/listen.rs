//! The meter on anybody's stream: a simulator's, a real board's, another program's of this name.
//!
//! [`Meter`] is the pure core: bytes and when they arrived in, rates, intervals, losses and damage out. [`listen`]
//! feeds it from a link until the sender leaves, the time is over or the user ends it.
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

mod live;
mod meter;
mod pace;
mod stream;

pub use live::listen;
pub use meter::Meter;
pub use stream::Stream;

use crate::link::{Address, LinkError};
use crate::time::SimTime;
use crate::wire::Protocol;
use std::time::Duration;

/// What to listen to.
#[derive(Clone, Debug)]
pub struct Job {
    /// What the packets look like.
    pub protocol: Protocol,
    /// Where they come from.
    pub address: Address,
    /// For how long from the first bytes on; `None` until the sender leaves.
    pub span: Option<Duration>,
    /// How long to wait for the first packet; zero waits without end.
    pub wait: Duration,
}

/// What happens meanwhile.
#[derive(Debug)]
#[non_exhaustive]
pub enum Event<'a> {
    /// Something the user should know.
    Notice(String),
    /// The link is open: protocol and what to connect to.
    Ready(&'a str),
    /// How far it is.
    Progress(Progress<'a>),
}

/// How far it is.
#[derive(Debug)]
pub struct Progress<'a> {
    /// Since the first bytes.
    pub elapsed: Duration,
    /// What was heard so far.
    pub meter: &'a Meter,
    /// Samples a second of each stream over about the last second, Hz.
    pub rates: &'a [f64],
}

/// What came of it.
#[derive(Debug)]
pub struct Heard {
    /// What was opened.
    pub name: String,
    /// Whether the user ended it.
    pub interrupted: bool,
    /// Everything counted.
    pub meter: Meter,
}

/// Why nothing could be heard.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ListenError {
    /// The link could not be opened or broke.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// The link cannot bring anything.
    #[error("nothing comes from {link}: {right}")]
    Mute {
        /// The link as asked for.
        link: String,
        /// What would be right.
        right: &'static str,
    },
    /// Not a byte came.
    #[error("not a byte came from {link} {}: {check}", within(*waited))]
    Silence {
        /// What was opened.
        link: String,
        /// For how long, where it was that which ended it.
        waited: Option<Duration>,
        /// What to look at.
        check: &'static str,
    },
    /// Bytes came and none of them made a packet.
    #[error("{bytes} bytes came from {link}, and no valid {} packet: {}", protocol.name(), other(*reads_as))]
    Noise {
        /// What was opened.
        link: String,
        /// How many.
        bytes: u64,
        /// As what they were read.
        protocol: Protocol,
        /// The protocol that they do read as.
        reads_as: Option<Protocol>,
    },
    /// The system refused what listening needs.
    #[error("could not {doing}: {source}")]
    System {
        /// What was tried.
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
