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

//!
//! # The library's face
//!
//! | to | use |
//! |---|---|
//! | load a scene, or build one in Rust | [`scene::Plan`], [`scene::Builder`] |
//! | play it: readings with their truth, in order of time | [`player::Player`] |
//! | turn readings into packets, and packets back into samples | [`wire::encoder`], [`wire::samples::Samples`] |
//! | stream over a serial port, pty or socket, in real time | [`link::Link`], [`clock::Precise`], or all of it: [`session::run`] |
//! | measure a stream | [`listen::Meter`] |
//! | write a dataset, read one | [`dataset::write()`], [`dataset::read`] |
//! | score an estimate against the truth | [`score::judge`] |
//! | study methods and sensors | [`study`] |
//!
//! `examples/` has a sensor model of one's own streamed over a pty, and a dataset in memory. Features: `cli` (the
//! program, on by default), `charts`, `filters`, `live`, `ulog`, `wmm`, `parquet`, `mcap`; a library takes
//! `default-features = false` and those that it uses.

// `eprintln!` panics where standard error is closed or full: `cli::tell` does not.
#![warn(clippy::print_stderr)]

pub mod bus;
#[cfg(feature = "cli")]
pub mod cli;
pub mod clock;
pub mod dataset;
mod double;
pub mod earth;
pub mod effects;
#[cfg(feature = "filters")]
pub mod filters;
pub mod geometry;
pub mod interrupt;
mod keys;
pub mod link;
pub mod listen;
#[cfg(feature = "live")]
pub mod live;
pub mod motion;
#[doc(hidden)] // For the benchmark of pacing alone.
pub mod os;
mod parallel;
pub mod player;
pub mod quantity;
mod random;
pub mod report;
#[cfg(any(feature = "live", feature = "mcap"))]
// Each feature sends some of the messages.
#[cfg_attr(not(all(feature = "live", feature = "mcap")), allow(dead_code))]
mod ros;
pub mod scene;
pub mod schedule;
pub mod score;
pub mod sensor;
pub mod session;
pub mod study;
pub mod table;
pub mod time;
pub mod wire;
