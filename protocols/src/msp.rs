//! `msp`: questions to a flight controller and its answers, in MSPv2 frames.
//!
//! One frame is `$X`, the direction (`<` to the controller, `>` from it, `!` refused), then
//! `flags u8 | command u16 | size u16 | payload | crc u8`. Numbers are little-endian; the checksum
//! is CRC-8/DVB-S2 over flags to payload. What a payload means depends on command and direction.
//! A real controller answers at most 100 frames a second and holds about four.
//!
//! ```
//! use ratetable_protocols::msp::{self, Message, attitude};
//!
//! let message = Message::Attitude(attitude::Repr { roll: 300, pitch: -100, yaw: 90 });
//! let mut bytes = [0; msp::MAX_LEN];
//! let len = msp::encode(&message, &mut bytes)?;
//!
//! let mut decoder = msp::Decoder::new();
//! let mut back = None;
//! decoder.feed(&bytes[..len], |received| back = received.ok().and_then(|received| received.message));
//! assert_eq!(back, Some(message));
//! # Ok::<(), ratetable_protocols::Error>(())
//! ```

use core::ops::Range;

use crc::{CRC_8_DVB_S2, Crc, Table};

use crate::bytes;
use crate::error::Error;

pub mod api_version;
pub mod attitude;
pub mod attitude_quaternion;
mod decoder;
pub mod fc_variant;
pub mod fc_version;
pub mod raw_imu;
pub mod simulator;
pub mod simulator_air;
pub mod simulator_reply;
pub mod status;

pub use decoder::Decoder;

static CRC: Crc<u8, Table<16>> = Crc::<u8, Table<16>>::new(&CRC_8_DVB_S2);

mod field {
    use super::Range;

    pub(super) const START: Range<usize> = 0..2;
    pub(super) const DIRECTION: Range<usize> = 2..3;
    pub(super) const FLAGS: Range<usize> = 3..4;
    pub(super) const COMMAND: Range<usize> = 4..6;
    pub(super) const SIZE: Range<usize> = 6..8;
}

const START: [u8; 2] = *b"$X";

/// Bytes before the payload.
pub const HEADER_LEN: usize = field::SIZE.end;

/// Bytes of checksum behind the payload.
pub const CRC_LEN: usize = 1;

/// Bytes of the longest payload that [`encode`] writes.
pub const MAX_PAYLOAD_LEN: usize = simulator_air::LEN;

/// Bytes of the longest frame that [`encode`] writes.
pub const MAX_LEN: usize = HEADER_LEN + MAX_PAYLOAD_LEN + CRC_LEN;

/// Which way a frame goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Direction {
    /// To the flight controller.
    Request,
    /// From it.
    Reply,
    /// From it: it does not know the command, or cannot do it.
    Refusal,
}

impl Direction {
    /// The character on the wire.
    pub const fn symbol(self) -> u8 {
        match self {
            Self::Request => b'<',
            Self::Reply => b'>',
            Self::Refusal => b'!',
        }
    }

    /// The direction with this character.
    const fn from_symbol(symbol: u8) -> Option<Self> {
        match symbol {
            b'<' => Some(Self::Request),
            b'>' => Some(Self::Reply),
            b'!' => Some(Self::Refusal),
            _ => None,
        }
    }
}

/// A frame as it arrived.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Received {
    /// Which way it goes.
    pub direction: Direction,
    /// The command.
    pub command: u16,
    /// What it says; `None` if it has a payload and its command is not known here in that direction.
    pub message: Option<Message>,
}

macro_rules! messages {
    ($($(#[$doc:meta])* $name:ident($module:ident),)*) => {
        /// What a frame says.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub enum Message {
            $($(#[$doc])* $name($module::Repr),)*
            /// A frame without a payload: a question, or an answer that says no more than that.
            Empty {
                /// Which way it goes.
                direction: Direction,
                /// What is asked or answered.
                command: u16,
            },
        }

        impl Message {
            /// The command on the wire.
            pub const fn command(&self) -> u16 {
                match self {
                    $(Self::$name(_) => $module::COMMAND,)*
                    Self::Empty { command, .. } => *command,
                }
            }

            /// Which way it goes.
            pub const fn direction(&self) -> Direction {
                match self {
                    $(Self::$name(_) => $module::DIRECTION,)*
                    Self::Empty { direction, .. } => *direction,
                }
            }

            /// Bytes of payload.
            pub const fn buffer_len(&self) -> usize {
                match self {
                    $(Self::$name(repr) => repr.buffer_len(),)*
                    Self::Empty { .. } => 0,
                }
            }

            /// Reads a payload; `None` if it is not empty and the command is not known here in
            /// that direction.
            ///
            /// # Errors
            /// [`Error::Length`] if the payload is not as long as its command's.
            pub fn parse(direction: Direction, command: u16, payload: &[u8]) -> Result<Option<Self>, Error> {
                if payload.is_empty() {
                    return Ok(Some(Self::Empty { direction, command }));
                }
                // The only command with two lengths.
                if command == simulator::COMMAND
                    && direction == simulator::DIRECTION
                    && let Ok(payload) = simulator_air::Payload::new_checked(payload)
                {
                    return Ok(Some(Self::SimulatorAir(simulator_air::Repr::parse(&payload))));
                }
                $(if command == $module::COMMAND && direction == $module::DIRECTION {
                    let payload = $module::Payload::new_checked(payload)?;
                    return Ok(Some(Self::$name($module::Repr::parse(&payload))));
                })*
                Ok(None)
            }

            /// Writes the payload.
            ///
            /// # Errors
            /// [`Error::Length`] unless `payload` has [`buffer_len`](Self::buffer_len) bytes.
            pub fn emit(&self, payload: &mut [u8]) -> Result<(), Error> {
                Error::check_length(self.buffer_len(), payload.len())?;
                match self {
                    $(Self::$name(repr) => repr.emit(&mut $module::Payload::new_checked(payload)?),)*
                    Self::Empty { .. } => {}
                }
                Ok(())
            }
        }
    };
}

messages! {
    /// What the sensors of an emulated vehicle read.
    Simulator(simulator),
    /// The same with an airspeed.
    SimulatorAir(simulator_air),
    /// What INAV answers to that.
    SimulatorReply(simulator_reply),
    /// The controller's attitude.
    Attitude(attitude),
    /// Which version of MSP it speaks.
    ApiVersion(api_version),
    /// Which firmware it is.
    FcVariant(fc_variant),
    /// Which version of that firmware it is.
    FcVersion(fc_version),
    /// What its tasks do.
    Status(status),
    /// What its sensors read.
    RawImu(raw_imu),
    /// The controller's attitude as a quaternion.
    AttitudeQuaternion(attitude_quaternion),
}

impl Message {
    /// The question that a reply of this command answers.
    pub const fn question(command: u16) -> Self {
        Self::Empty { direction: Direction::Request, command }
    }
}

/// Writes one frame and returns its length.
///
/// # Errors
/// [`Error::BufferTooSmall`] if `out` cannot hold it; [`MAX_LEN`] bytes always can.
pub fn encode(message: &Message, out: &mut [u8]) -> Result<usize, Error> {
    let crc_at = HEADER_LEN + message.buffer_len();
    let needed = crc_at + CRC_LEN;
    let frame = out.get_mut(..needed).ok_or(Error::BufferTooSmall { needed })?;
    bytes::copy(&START, &mut frame[field::START]);
    bytes::put_le(frame, field::DIRECTION, message.direction().symbol());
    bytes::put_le(frame, field::FLAGS, 0_u8);
    bytes::put_le(frame, field::COMMAND, message.command());
    bytes::put_le(frame, field::SIZE, message.buffer_len() as u16);
    message.emit(&mut frame[HEADER_LEN..crc_at])?;
    let crc = CRC.checksum(&frame[field::FLAGS.start..crc_at]);
    bytes::put_le(frame, crc_at..needed, crc);
    Ok(needed)
}
