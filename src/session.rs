//! The live loop: prepare, wait, send.
//!
//! ```text
//! producer thread: player ─ encoders ─▶ ring ─▶ pacing thread: wait until due, write ─▶ links
//!                                  ring of replies ─▶ (between packets)                    │
//!                                          └── control (this thread, tokio): dialogues ◀───┘ Ctrl-C, the command
//! ```
//!
//! A prescribed motion does not depend on the wall clock, so everything is computed ahead and the pacing thread only
//! waits and writes: the cost of the models never shows up as jitter. It allocates nothing and takes no lock.
//!
//! Two times go by. *Stream time* is what packets are due at, from the first one on. *Scene time* begins when the
//! scene does: at once, or after a rest in which the vehicle is held still for the other side's estimator to settle.

mod answers;
mod command;
mod control;
mod ears;
mod error;
mod event;
#[cfg(test)]
mod fault_tests;
mod finish;
mod granted;
mod hold;
mod job;
mod links;
mod lockstep;
mod outcome;
mod overload;
#[cfg(test)]
mod overload_tests;
mod pacer;
mod producer;
mod replies;
#[cfg(test)]
mod session_tests;
mod shared;
mod talk;
#[cfg(test)]
mod talk_tests;
mod tally;
#[cfg(test)]
mod tests;
mod waiting;
mod watch;
#[cfg(test)]
mod watch_tests;

pub use answers::{Judging, Off};
pub use control::run;
pub use error::SessionError;
pub use event::{Event, Progress};
pub use job::{Job, OnBytes, Tap};
pub use outcome::Outcome;
pub use pacer::Speed;
pub use watch::{Record, Watch, Watched};

use shared::{Item, Shared};
