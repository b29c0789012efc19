//! `mpu`: what a driver reads from an MPU-6000, MPU-6050 or MPU-9250, over a byte stream.
//!
//! One packet is COBS(`type u8 | seq u8 | t_us u32 | payload | crc u16`), then a zero byte.
//! Numbers are little-endian unless a payload says otherwise; the checksum is CRC-16/IBM-3740
//! over type to payload. `seq` counts every packet on the link; `t_us` is the sample's time in
//! µs, wrapping every 71.6 minutes.
//!
//! ```
//! use ratetable_protocols::mpu::{self, Packet, gyro};
//!
//! let packet = Packet::Gyro(gyro::Repr { gyro: [1, -2, 3] });
//! let mut bytes = [0; mpu::MAX_LEN];
//! let len = mpu::encode(7, 1_000, &packet, &mut bytes)?;
//!
//! let mut decoder = mpu::Decoder::new();
//! let mut back = None;
//! decoder.feed(&bytes[..len], |received| back = received.ok());
//! assert_eq!(back, Some(mpu::Received { seq: 7, t_us: 1_000, packet }));
//! # Ok::<(), ratetable_protocols::Error>(())
//! ```

use core::ops::Range;

use crc::CRC_16_IBM_3740;

use crate::checksum::Checksum;
use crate::error::Error;
use crate::{bytes, cobs};

pub mod accel;
pub mod attitude;
pub mod config;
mod decoder;
pub mod gyro;
pub mod imu;
pub mod mag;
pub mod registers;

pub use decoder::Decoder;

static CRC: Checksum<false> = Checksum::new(&CRC_16_IBM_3740);

mod field {
    use super::Range;

    pub(super) const TYPE: Range<usize> = 0..1;
    pub(super) const SEQ: Range<usize> = 1..2;
    pub(super) const T_US: Range<usize> = 2..6;
}

/// Bytes before the payload: type, sequence number and time.
pub const HEADER_LEN: usize = field::T_US.end;

/// Bytes of checksum behind the payload.
pub const CRC_LEN: usize = 2;

/// Bytes of the longest packet before stuffing.
const MAX_BODY_LEN: usize = HEADER_LEN + attitude::LEN + CRC_LEN;

/// Bytes of the longest packet on the wire, its closing zero included.
pub const MAX_LEN: usize = cobs::max_encoded_len(MAX_BODY_LEN) + 1;

macro_rules! packets {
    ($($(#[$doc:meta])* $name:ident($module:ident),)*) => {
        /// A payload of any type.
        #[derive(Debug, Clone, Copy, PartialEq)]
        pub enum Packet {
            $($(#[$doc])* $name($module::Repr),)*
        }

        impl Packet {
            /// The type byte on the wire.
            pub const fn kind(&self) -> u8 {
                match self { $(Self::$name(_) => $module::TYPE,)* }
            }

            /// Bytes of payload.
            pub const fn buffer_len(&self) -> usize {
                match self { $(Self::$name(repr) => repr.buffer_len(),)* }
            }

            /// Reads a payload of the given type.
            ///
            /// # Errors
            /// [`Error::UnknownType`], or [`Error::Length`] if the payload is not as long as
            /// its type.
            pub fn parse(kind: u8, payload: &[u8]) -> Result<Self, Error> {
                match kind {
                    $($module::TYPE => {
                        let payload = $module::Payload::new_checked(payload)?;
                        Ok(Self::$name($module::Repr::parse(&payload)))
                    })*
                    unknown => Err(Error::UnknownType(unknown)),
                }
            }

            /// Writes the payload.
            ///
            /// # Errors
            /// [`Error::Length`] unless `payload` has [`buffer_len`](Self::buffer_len) bytes.
            pub fn emit(&self, payload: &mut [u8]) -> Result<(), Error> {
                match self {
                    $(Self::$name(repr) => {
                        repr.emit(&mut $module::Payload::new_checked(payload)?);
                    })*
                }
                Ok(())
            }
        }

        /// Payload lengths of all types.
        const PAYLOAD_LENS: &[usize] = &[$($module::LEN),*];
    };
}

packets! {
    /// Accelerometer, thermometer and gyro in one burst.
    Imu(imu),
    /// Magnetometer.
    Mag(mag),
    /// Gyro alone.
    Gyro(gyro),
    /// Accelerometer alone.
    Accel(accel),
    /// The registers that give the scales.
    Config(config),
    /// The attitude that a firmware answers with.
    Attitude(attitude),
}

/// A packet as it arrived.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Received {
    /// Counts every packet on the link, wrapping.
    pub seq: u8,
    /// The sample's time, µs, wrapping.
    pub t_us: u32,
    /// What it carries.
    pub packet: Packet,
}

/// Writes one packet, its closing zero included, and returns its length.
///
/// `t_us` is the sample's time in µs; `seq` counts every packet on the link.
///
/// # Errors
/// [`Error::BufferTooSmall`] if `out` cannot hold it; [`MAX_LEN`] bytes always can.
pub fn encode(seq: u8, t_us: u32, packet: &Packet, out: &mut [u8]) -> Result<usize, Error> {
    let crc_at = HEADER_LEN + packet.buffer_len();
    let len = crc_at + CRC_LEN;
    let needed = cobs::max_encoded_len(len) + 1;
    let out = out.get_mut(..needed).ok_or(Error::BufferTooSmall { needed })?;
    // The body lies where it becomes stuffed: every one is short, so that one byte before it is enough.
    let body = &mut out[1..=len];
    bytes::put_le(body, field::TYPE, packet.kind());
    bytes::put_le(body, field::SEQ, seq);
    bytes::put_le(body, field::T_US, t_us);
    packet.emit(&mut body[HEADER_LEN..crc_at])?;
    let crc = CRC.of(&body[..crc_at]);
    bytes::put_le(body, crc_at..len, crc);
    cobs::stuff(&mut out[..=len]);
    out[len + 1] = 0;
    Ok(needed)
}

/// Reads one packet, its closing zero left out.
///
/// # Errors
/// [`Error::Malformed`] if it cannot be unstuffed or is too short or long,
/// [`Error::Checksum`], then what [`Packet::parse`] refuses.
pub fn decode(stuffed: &[u8]) -> Result<Received, Error> {
    let mut body = [0; MAX_BODY_LEN];
    let len = cobs::decode(stuffed, &mut body).map_err(|_| Error::Malformed)?;
    let payload_len = len.checked_sub(HEADER_LEN + CRC_LEN).ok_or(Error::Malformed)?;
    let crc_at = HEADER_LEN + payload_len;
    if CRC.of(&body[..crc_at]) != bytes::le::<u16>(&body, crc_at..len) {
        return Err(Error::Checksum);
    }
    Ok(Received {
        seq: bytes::le(&body, field::SEQ),
        t_us: bytes::le(&body, field::T_US),
        packet: Packet::parse(bytes::le(&body, field::TYPE), &body[HEADER_LEN..crc_at])?,
    })
}
