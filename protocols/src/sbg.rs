//! `sbg`: sbgECom, what an SBG Systems unit sends and is asked.
//!
//! A packet is `FF 5A | id | class | length u16 | payload | crc u16 | 33`, all little-endian, the checksum low byte
//! first. It is CRC-16/KERMIT over id to payload. Vectors are forward, right, down.
//!
//! ```
//! use ratetable_protocols::sbg::{self, Packet};
//!
//! let mut bytes = [0; sbg::MAX_LEN];
//! let len = sbg::encode(&Packet::InfoRequest, &mut bytes)?;
//! assert_eq!(bytes[..len], [0xff, 0x5a, 0x04, 0x10, 0x00, 0x00, 0x79, 0xf7, 0x33]);
//!
//! let mut back = None;
//! sbg::Decoder::new().feed(&bytes[..len], |received| back = received.ok().and_then(|it| it.packet));
//! assert_eq!(back, Some(Packet::InfoRequest));
//! # Ok::<(), ratetable_protocols::Error>(())
//! ```

use core::ops::Range;

use crc::CRC_16_KERMIT;

use crate::bytes;
use crate::checksum::Checksum;
use crate::error::Error;

pub mod air_data;
mod decoder;
pub mod imu_short;
pub mod info;
pub mod mag;
pub mod quat;

pub use decoder::Decoder;

static CRC: Checksum<true> = Checksum::new(&CRC_16_KERMIT);

mod field {
    use super::Range;

    pub(super) const START: Range<usize> = 0..2;
    pub(super) const ID: usize = 2;
    pub(super) const CLASS: usize = 3;
    pub(super) const LEN: Range<usize> = 4..6;
}

const START: [u8; 2] = [0xff, 0x5a];

/// The last byte.
const END: u8 = 0x33;

/// Bytes before the payload.
pub const HEADER_LEN: usize = field::LEN.end;

/// Bytes of checksum and end behind the payload.
pub const TAIL_LEN: usize = 3;

/// Bytes of the longest packet that [`encode`] writes.
pub const MAX_LEN: usize = HEADER_LEN + info::LEN + TAIL_LEN;

/// The class of what a unit sends by itself.
pub const LOG: u8 = 0;

/// The class of commands and their answers.
pub const COMMAND: u8 = 16;

/// A packet as it arrived.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Received {
    /// Its class.
    pub class: u8,
    /// Which of that class.
    pub id: u8,
    /// What it says; `None` if class and id are not known here.
    pub packet: Option<Packet>,
}

macro_rules! packets {
    ($($(#[$doc:meta])* $name:ident($module:ident),)*) => {
        /// What is said at once.
        #[derive(Debug, Clone, Copy, PartialEq)]
        pub enum Packet {
            $($(#[$doc])* $name($module::Repr),)*
            /// To the unit: which device are you? Answered by [`Packet::Info`].
            InfoRequest,
        }

        impl Packet {
            /// Class and id on the wire.
            pub const fn kind(&self) -> (u8, u8) {
                match self {
                    $(Self::$name(_) => ($module::CLASS, $module::ID),)*
                    Self::InfoRequest => (info::CLASS, info::ID),
                }
            }

            /// Bytes of payload.
            pub const fn payload_len(&self) -> usize {
                match self {
                    $(Self::$name(repr) => repr.buffer_len(),)*
                    Self::InfoRequest => 0,
                }
            }

            /// Reads a payload; `None` if class and id are not known here.
            ///
            /// # Errors
            /// [`Error::Length`] if the payload is shorter than its id's. A longer one is read as far as it is known:
            /// newer units may add fields.
            pub fn parse(class: u8, id: u8, payload: &[u8]) -> Result<Option<Self>, Error> {
                if (class, id) == (info::CLASS, info::ID) && payload.is_empty() {
                    return Ok(Some(Self::InfoRequest));
                }
                $(if (class, id) == ($module::CLASS, $module::ID) {
                    let payload = $module::Payload::new_checked(payload)?;
                    return Ok(Some(Self::$name($module::Repr::parse(&payload))));
                })*
                Ok(None)
            }

            /// Writes the payload.
            ///
            /// # Errors
            /// [`Error::Length`] unless `payload` has [`payload_len`](Self::payload_len) bytes.
            pub fn emit(&self, payload: &mut [u8]) -> Result<(), Error> {
                Error::check_length(self.payload_len(), payload.len())?;
                match self {
                    $(Self::$name(repr) => repr.emit(&mut $module::Payload::new_checked(payload)?),)*
                    Self::InfoRequest => {}
                }
                Ok(())
            }
        }
    };
}

packets! {
    /// What gyroscope and accelerometer read.
    ImuShort(imu_short),
    /// What the magnetometer reads, and the accelerometer again.
    Mag(mag),
    /// What the barometer reads.
    AirData(air_data),
    /// The attitude.
    Quat(quat),
    /// Which device it is.
    Info(info),
}

/// Writes one packet and returns its length.
///
/// # Errors
/// [`Error::BufferTooSmall`] if `out` cannot hold it; [`MAX_LEN`] bytes always can.
pub fn encode(packet: &Packet, out: &mut [u8]) -> Result<usize, Error> {
    let len = packet.payload_len();
    let crc_at = HEADER_LEN + len;
    let needed = crc_at + TAIL_LEN;
    let out = out.get_mut(..needed).ok_or(Error::BufferTooSmall { needed })?;
    let (class, id) = packet.kind();
    bytes::copy(&START, &mut out[field::START]);
    bytes::copy(&[id, class], &mut out[field::ID..field::LEN.start]);
    bytes::put_le(out, field::LEN, len as u16);
    packet.emit(&mut out[HEADER_LEN..crc_at])?;
    let crc = CRC.of(&out[field::ID..crc_at]);
    bytes::put_le(out, crc_at..crc_at + 2, crc);
    bytes::put_le(out, crc_at + 2..needed, END);
    Ok(needed)
}
