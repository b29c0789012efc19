//! The live loop: prepare, wait, send.
//!
//! ```text
//! producer thread: player ─ encoders ─▶ ring ─▶ pacing thread: wait until due, write ─▶ links
//!                                  ring of replies ─▶ (between packets)                    │
//!                                          └── control (this thread, tokio): dialogues ◀───┘ Ctrl-C, the command
//! ```
//!
//! A prescribed motion does not depend on the wall clock. The producer therefore computes everything ahead, and the
//! pacing thread only waits and writes: the cost of the models never shows up as jitter. The pacing thread
//! allocates nothing and takes no lock.
//!
//! There are two times. *Stream time* is when packets are due, counted from the first one. *Scene time* starts with
//! the scene: at once, or after a rest that holds the vehicle still while the estimator on the other side settles.

mod absence;
mod account;
mod answers;
mod budget;
mod bus;
mod command;
mod control;
mod ears;
mod effort;
mod error;
mod event;
#[cfg(test)]
mod fault_tests;
mod feed;
mod gaps;
mod granted;
mod heard;
mod hold;
mod host;
mod job;
mod lane;
mod left;
mod off;
mod open;
mod outcome;
mod outside;
#[cfg(test)]
mod overload_tests;
mod pace;
mod pacer;
mod pacing;
mod producer;
mod producing;
mod queue;
mod replies;
mod ring;
mod run;
#[cfg(test)]
mod session_tests;
mod settling;
mod shared;
mod side;
mod step;
mod talk;
#[cfg(test)]
mod talk_tests;
mod tally;
#[cfg(test)]
mod tests;
mod watch;
#[cfg(test)]
mod watch_tests;
mod ways_out;

pub use budget::{Budget, afford};
pub use error::SessionError;
pub use event::{Event, LinkProgress, Progress};
pub use heard::Judging;
pub use job::{Job, OnBytes, Tap};
pub use off::Off;
pub use outcome::Outcome;
pub use pace::Speed;
pub use run::run;
pub use watch::{BareTimer, Record, Watch, Watched};

use shared::Shared;
