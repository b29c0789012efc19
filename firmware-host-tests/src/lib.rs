//! A firmware's receiving side, on the host: bytes in, attitude out, as a flight controller's
//! firmware would have it.
//!
//! [`driver`] turns a stream into readings in body axes, [`ahrs`] turns readings into an
//! attitude, and [`board`] is the main loop around a UART. [`standin`] has whole flight controllers,
//! as far as their links show. Body axes are forward-right-down
//! (FRD), nav is north-east-down (NED); units are rad/s, m/s² and µT. Nothing here knows the
//! emulator: only the packets on the wire.

pub mod ahrs;
pub mod board;
pub mod driver;
pub mod quaternion;
mod sample;
pub mod standin;

pub use board::{Board, Options, Report, Step};
pub use driver::{Counts, Driver, Protocol};
pub use sample::{Sample, Unwrap};
