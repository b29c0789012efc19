//! `mip`: what a MicroStrain inertial unit sends, as far as it concerns its own sensors.
//!
//! A packet is `75 65 | descriptor u8 | length u8 | fields | checksum u16`, a field is
//! `length u8 | descriptor u8 | data`, its length counting those two bytes. Numbers are
//! big-endian; the checksum is a Fletcher sum of two bytes over all before it.
//!
//! ```
//! use ratetable_protocols::mip::{self, imu};
//!
//! let imu = imu::Repr { gyro: Some([0.125, -0.25, 0.5]), ..Default::default() };
//! let mut bytes = [0; mip::MAX_LEN];
//! let len = mip::encode(&imu, &mut bytes)?;
//!
//! let mut back = None;
//! mip::Decoder::new().feed(&bytes[..len], |received| back = received.ok());
//! assert_eq!(back, Some(imu));
//! # Ok::<(), ratetable_protocols::Error>(())
//! ```

use crate::bytes;
use crate::error::Error;

mod decoder;
pub mod imu;

pub use decoder::Decoder;

const START: [u8; 2] = [0x75, 0x65];

/// Bytes before the fields.
pub const HEADER_LEN: usize = 4;

/// Bytes of checksum behind the fields.
pub const CHECKSUM_LEN: usize = 2;

/// Bytes of the longest packet that [`encode`] writes.
pub const MAX_LEN: usize = HEADER_LEN + imu::MAX_LEN + CHECKSUM_LEN;

/// Writes one packet and returns its length.
///
/// # Errors
/// [`Error::BufferTooSmall`] if `out` cannot hold it; [`MAX_LEN`] bytes always can.
pub fn encode(imu: &imu::Repr, out: &mut [u8]) -> Result<usize, Error> {
    let len = imu.buffer_len();
    let sum_at = HEADER_LEN + len;
    let needed = sum_at + CHECKSUM_LEN;
    let packet = out.get_mut(..needed).ok_or(Error::BufferTooSmall { needed })?;
    bytes::copy(&START, packet);
    bytes::copy(&[imu::DESCRIPTOR, len as u8], &mut packet[START.len()..]);
    imu.emit(&mut packet[HEADER_LEN..sum_at]);
    let sum = fletcher(&packet[..sum_at]);
    bytes::copy(&sum, &mut packet[sum_at..]);
    Ok(needed)
}

/// The sum of the bytes, and the sum of those sums, each modulo 256.
fn fletcher(bytes: &[u8]) -> [u8; CHECKSUM_LEN] {
    bytes.iter().fold([0; 2], |[first, second], &byte| {
        let first = first.wrapping_add(byte);
        [first, second.wrapping_add(first)]
    })
}
