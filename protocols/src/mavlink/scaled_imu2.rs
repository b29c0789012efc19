//! `SCALED_IMU2` (116): an autopilot's second inertial sensor, laid out as `SCALED_IMU` is.
//!
//! ```
//! use ratetable_protocols::mavlink::{Message, scaled_imu2};
//!
//! let message = Message::ScaledImu2(scaled_imu2::Repr::default());
//! assert_eq!(message.id(), scaled_imu2::ID);
//! ```

pub use super::scaled_imu::{BASE_LEN, LEN, Payload, Repr};

/// The message id.
pub const ID: u32 = 116;

/// What the checksum is seeded with after the bytes: guards against a different field list.
pub const CRC_EXTRA: u8 = 76;
