//! `SCALED_IMU3` (129): an autopilot's third inertial sensor, laid out as `SCALED_IMU` is.
//!
//! ```
//! use ratetable_protocols::mavlink::{Message, scaled_imu3};
//!
//! let message = Message::ScaledImu3(scaled_imu3::Repr::default());
//! assert_eq!(message.id(), scaled_imu3::ID);
//! ```

pub use super::scaled_imu::{BASE_LEN, LEN, Payload, Repr};

/// The message id.
pub const ID: u32 = 129;

/// What the checksum is seeded with after the bytes: guards against a different field list.
pub const CRC_EXTRA: u8 = 46;
