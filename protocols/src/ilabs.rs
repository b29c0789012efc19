//! `ilabs`: the user-defined data that an Inertial Labs unit sends.
//!
//! A frame is `AA 55 | 01 | 95 | length u16 | n | n ids | data in the ids' order | sum u16`, all little-endian. The
//! length counts all but the first two bytes; the sum is the plain sum of the bytes between them and itself.
//!
//! ```
//! use ratetable_protocols::ilabs::{self, data};
//!
//! let still = data::Repr { accel: Some([0, 0, 999_597]), gyro: Some([0; 3]), ..Default::default() };
//! let mut bytes = [0; ilabs::MAX_LEN];
//! let len = ilabs::encode(&still, &mut bytes)?;
//!
//! let mut back = None;
//! ilabs::Decoder::new().feed(&bytes[..len], |received| back = received.ok());
//! assert_eq!(back, Some(still));
//! # Ok::<(), ratetable_protocols::Error>(())
//! ```

use crate::bytes;
use crate::error::Error;

pub mod data;
mod decoder;

pub use decoder::Decoder;

/// The first two bytes, the type of message, and which message it is.
const START: [u8; 4] = [0xaa, 0x55, 0x01, 0x95];

/// Bytes in front of those that the length counts.
const UNCOUNTED_LEN: usize = 2;

/// Bytes before the data: the start and the length.
pub const HEADER_LEN: usize = START.len() + 2;

/// Bytes of sum behind the data.
pub const SUM_LEN: usize = 2;

/// Bytes of the longest frame that [`encode`] writes.
pub const MAX_LEN: usize = HEADER_LEN + data::MAX_LEN + SUM_LEN;

/// Writes one frame and returns its length.
///
/// # Errors
/// [`Error::BufferTooSmall`] if `out` cannot hold it; [`MAX_LEN`] bytes always can.
pub fn encode(data: &data::Repr, out: &mut [u8]) -> Result<usize, Error> {
    let sum_at = HEADER_LEN + data.buffer_len();
    let needed = sum_at + SUM_LEN;
    let frame = out.get_mut(..needed).ok_or(Error::BufferTooSmall { needed })?;
    bytes::copy(&START, frame);
    bytes::put_le(frame, START.len()..HEADER_LEN, (needed - UNCOUNTED_LEN) as u16);
    data.emit(&mut frame[HEADER_LEN..sum_at]);
    let sum = sum(&frame[UNCOUNTED_LEN..sum_at]);
    bytes::put_le(frame, sum_at..needed, sum);
    Ok(needed)
}

/// The plain sum of the bytes, modulo 65536.
fn sum(bytes: &[u8]) -> u16 {
    bytes.iter().fold(0, |sum, &byte| sum.wrapping_add(u16::from(byte)))
}
