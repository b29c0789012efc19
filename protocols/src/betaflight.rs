//! `betaflight`: what Betaflight's SITL takes from a simulator in place of its sensors, and what it sends back.
//!
//! One UDP datagram is one packet, little-endian and without a header or a checksum: [`state`] to port
//! [`STATE_PORT`], and for each one accepted [`motors`] to port [`MOTORS_PORT`] of the simulator. The firmware
//! ignores a datagram of another length. It says its attitude elsewhere, over [`msp`](crate::msp) on TCP port
//! [`MSP_PORT`].
//!
//! ```
//! use ratetable_protocols::betaflight::{self, state};
//!
//! let state = state::Repr { gyro: [0.125, 0.0, -0.5], ..state::Repr::LEVEL };
//! let mut bytes = [0; betaflight::MAX_LEN];
//! let len = betaflight::encode(&state, &mut bytes)?;
//!
//! let mut back = None;
//! betaflight::Decoder::new().feed(&bytes[..len], |received| back = received.ok());
//! assert_eq!(back, Some(state));
//! # Ok::<(), ratetable_protocols::Error>(())
//! ```

use crate::error::Error;

mod decoder;
pub mod motors;
pub mod state;

pub use decoder::Decoder;

/// The UDP port on which the firmware takes [`state`].
pub const STATE_PORT: u16 = 9003;

/// The UDP port of the simulator to which the firmware sends [`motors`].
pub const MOTORS_PORT: u16 = 9002;

/// The TCP port on which the firmware answers MSP.
pub const MSP_PORT: u16 = 5761;

/// Counts a deg/s to which the firmware scales [`state::Repr::gyro`] before it drops the fraction.
pub const GYRO_COUNTS: f64 = 16.4;

/// Counts for which the firmware then reads 1 deg/s: 32768 a 2000 deg/s.
pub const GYRO_COUNTS_READ: f64 = 16.384;

/// Counts a g (9.80665 m/s²) to which it scales [`state::Repr::accel`] before it drops the fraction.
pub const ACCEL_COUNTS: f64 = 256.0;

/// The largest count; the firmware clips there.
pub const MAX_COUNT: f64 = 32_767.0;

/// Bytes of the longest packet that [`encode`] writes.
pub const MAX_LEN: usize = state::LEN;

/// Writes one packet of readings and returns its length.
///
/// # Errors
/// [`Error::BufferTooSmall`] if `out` cannot hold it; [`MAX_LEN`] bytes always can.
pub fn encode(state: &state::Repr, out: &mut [u8]) -> Result<usize, Error> {
    let packet = out.get_mut(..state::LEN).ok_or(Error::BufferTooSmall { needed: state::LEN })?;
    state.emit(&mut state::Payload::new_checked(packet)?);
    Ok(state::LEN)
}
