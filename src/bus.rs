//! The chips of a scene on a bus, as a driver meets them: the scene is what they measure.
//!
//! No clock, no I/O and no threads. A [`Board`] plays the scene up to whatever time it is told, hands each chip its
//! samples, and follows what a driver writes: a new rate, range or filter holds from the sensor's next sample on. Until a driver
//! reads a first sample the vehicle is held at rest.
//!
//! ```
//! use ratetable::{bus::{self, Board}, scene::Plan, time::SimTime};
//! use ratetable_protocols::bridge::Bus;
//!
//! let plan = Plan::load("still", &["gyro.part=MPU-9250".into(), "accel.part=MPU-9250".into()])?;
//! let (rest, chips) = (plan.at_rest(), bus::fit(&plan.sensors, None)?);
//! let mut board = Board::new(&plan, &rest, chips, SimTime::ZERO)?;
//! board.write(0x68, &[0x1a, 0x01], false); // DLPF 1: 1 kHz
//! board.advance(SimTime(2_000_000))?;
//! let mut accel = [0; 6];
//! assert!(board.write(0x68, &[0x3b], false) && board.read(0x68, &mut accel));
//! assert!(i16::from_be_bytes([accel[4], accel[5]]) > 15_000, "1 g is 16384 counts at ±2 g");
//! assert!(board.has_begun(), "with the first sample that is read");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod board;
mod fitted;
mod following;
mod reads;

pub use board::Board;
pub use fitted::{CHIPS, ChipKind, Fitted, fit};
pub use following::Change;
pub use reads::Reads;

#[cfg(test)]
mod tests;
