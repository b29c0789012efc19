//! A rate table in software: a hardware-in-the-loop sensor emulator.
//!
//! Motion says what is true; a sensor says what the part reads; the player turns a scene into readings in order
//! of time, with no clock and no I/O. Live, the session gives each reading to wire (a packet), waits for its due
//! time, and sends it over a link; offline, the dataset writes the same readings to files.
//!
//! ```
//! use ratetable::{player::Player, scene::Plan};
//!
//! let plan = Plan::load("table-1", &[])?;
//! let mut samples = 0;
//! Player::new(&plan, plan.duration, 256).play(|moment| {
//!     samples += moment.readings.len();
//!     Ok::<(), std::convert::Infallible>(())
//! })?;
//! assert_eq!(samples, 30_000 + 30_000 + 3_000);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

// `eprintln!` panics where standard error is closed or full: `cli::tell` does not.
#![warn(clippy::print_stderr)]

#[cfg(feature = "cli")]
pub mod cli;
pub mod clock;
pub mod dataset;
pub mod double;
pub mod earth;
pub mod effects;
#[cfg(feature = "filters")]
pub mod filters;
pub mod geometry;
pub mod interrupt;
pub mod keys;
pub mod link;
pub mod listen;
pub mod motion;
pub mod os;
pub mod parallel;
pub mod player;
pub mod quantity;
pub mod random;
pub mod report;
pub mod scene;
pub mod schedule;
pub mod score;
pub mod sensor;
pub mod session;
pub mod study;
pub mod table;
pub mod time;
pub mod wire;
