//! Sensor packets for flight controllers, encoders and decoders, `no_std` and without a heap.
//!
//! One room a format: [`mpu`] carries an MPU's registers in a stream that survives damage,
//! [`mavlink`] a handful of MAVLink messages, [`msp`] INAV's simulator message and the questions
//! around it, [`vectornav`], [`mip`], [`ilabs`] and [`sbg`] what external units send to ArduPilot and PX4,
//! [`betaflight`] what Betaflight's SITL takes for its sensors. Every
//! payload file declares its fields once (`message.rs`), and the rest follows: a view over bytes (`Payload`), the
//! same as plain values (`Repr` with `parse`, `buffer_len` and `emit`), and tests over one golden array.
//!
//! What this crate promises: nothing panics on any bytes, nothing allocates, nothing reads a
//! clock, and a damaged packet costs at most itself. What it does not: bytes reordered by the
//! link are not put back in order, and MAVLink signatures are not checked.
//!
//! ```
//! use ratetable_protocols::mpu::{self, Packet, gyro};
//!
//! let mut bytes = [0; mpu::MAX_LEN];
//! let len = mpu::encode(0, 0, &Packet::Gyro(gyro::Repr { gyro: [1, -2, 3] }), &mut bytes)?;
//! assert_eq!(bytes[..len].last(), Some(&0), "a zero ends a packet");
//! # Ok::<(), ratetable_protocols::Error>(())
//! ```

#![no_std]

#[macro_use]
mod message;

pub mod betaflight;
pub mod bridge;
mod bytes;
mod checksum;
pub mod chip;
pub mod cobs;
mod error;
pub mod ilabs;
pub mod mavlink;
pub mod mip;
pub mod mpu;
pub mod msp;
pub mod sbg;
mod scanner;
mod sequence;
pub mod vectornav;

pub use error::Error;
pub use sequence::Losses;
