//! `vectornav`: what a VN-100 sends, and the commands that it is set up with.
//!
//! ArduPilot asks for [`imu`] and [`ahrs`] packets, PX4 for [`inertial`] and [`navigation`] ones.
//!
//! A binary packet is `FA | groups | payload | crc u16`: the groups say which outputs follow, the
//! payload is little-endian, and the checksum, CRC-16/XMODEM over groups to payload, is sent high
//! byte first. A [`line::Line`] is a command or the answer to one: `$text*XX` and CR LF, where XX
//! is the exclusive or of the text's bytes in hexadecimal. Both share the link.
//!
//! ```
//! use ratetable_protocols::vectornav::{self, Packet, line::Line};
//!
//! let packet = Packet::Line(Line::new("VNRRG,01")?);
//! let mut bytes = [0; vectornav::MAX_LEN];
//! let len = vectornav::encode(&packet, &mut bytes)?;
//! assert_eq!(&bytes[..len], b"$VNRRG,01*72\r\n");
//!
//! let mut back = None;
//! vectornav::Decoder::new().feed(&bytes[..len], |received| back = received.ok());
//! assert_eq!(back, Some(packet));
//! # Ok::<(), ratetable_protocols::Error>(())
//! ```

use crc::CRC_16_XMODEM;

use crate::bytes;
use crate::checksum::Checksum;
use crate::error::Error;

pub mod ahrs;
mod decoder;
pub mod imu;
pub mod inertial;
pub mod line;
pub mod navigation;

pub use decoder::Decoder;

static CRC: Checksum<false> = Checksum::new(&CRC_16_XMODEM);

/// The first byte of a binary packet.
const SYNC: u8 = 0xfa;

/// Bytes of checksum behind a payload.
const CRC_LEN: usize = 2;

/// Bytes of the longest packet.
pub const MAX_LEN: usize = binary_len(navigation::GROUPS, navigation::LEN);

const _: () = assert!(line::MAX_LEN <= MAX_LEN);

/// What is said at once.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Packet {
    /// What the inertial sensors read.
    Imu(imu::Repr),
    /// The attitude.
    Ahrs(ahrs::Repr),
    /// What gyro and accelerometer read, as PX4 asks for it.
    Inertial(inertial::Repr),
    /// What the other sensors read and the unit's own estimate, as PX4 asks for it.
    Navigation(navigation::Repr),
    /// A command, or the answer to one.
    Line(line::Line),
}

impl Packet {
    /// What it is called.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Imu(_) => "imu",
            Self::Ahrs(_) => "ahrs",
            Self::Inertial(_) => "inertial",
            Self::Navigation(_) => "navigation",
            Self::Line(_) => "line",
        }
    }

    /// Bytes on the wire.
    pub const fn buffer_len(&self) -> usize {
        match self {
            Self::Imu(_) => binary_len(imu::GROUPS, imu::LEN),
            Self::Ahrs(_) => binary_len(ahrs::GROUPS, ahrs::LEN),
            Self::Inertial(_) => binary_len(inertial::GROUPS, inertial::LEN),
            Self::Navigation(_) => binary_len(navigation::GROUPS, navigation::LEN),
            Self::Line(line) => line.buffer_len(),
        }
    }
}

/// Bytes of a binary packet.
const fn binary_len(groups: &[u8], payload_len: usize) -> usize {
    1 + groups.len() + payload_len + CRC_LEN
}

/// Writes one packet and returns its length.
///
/// # Errors
/// [`Error::BufferTooSmall`] if `out` cannot hold it; [`MAX_LEN`] bytes always can.
pub fn encode(packet: &Packet, out: &mut [u8]) -> Result<usize, Error> {
    let needed = packet.buffer_len();
    let out = out.get_mut(..needed).ok_or(Error::BufferTooSmall { needed })?;
    match packet {
        Packet::Imu(repr) => {
            repr.emit(&mut imu::Payload::new_checked(payload(imu::GROUPS, out))?);
            seal(out);
        }
        Packet::Ahrs(repr) => {
            repr.emit(&mut ahrs::Payload::new_checked(payload(ahrs::GROUPS, out))?);
            seal(out);
        }
        Packet::Inertial(repr) => {
            repr.emit(&mut inertial::Payload::new_checked(payload(inertial::GROUPS, out))?);
            seal(out);
        }
        Packet::Navigation(repr) => {
            repr.emit(&mut navigation::Payload::new_checked(payload(navigation::GROUPS, out))?);
            seal(out);
        }
        Packet::Line(line) => line.emit(out),
    }
    Ok(needed)
}

/// Writes what comes before the payload, and gives the payload's place.
fn payload<'b>(groups: &[u8], out: &'b mut [u8]) -> &'b mut [u8] {
    let at = 1 + groups.len();
    bytes::put_le(out, 0..1, SYNC);
    bytes::copy(groups, &mut out[1..at]);
    let end = out.len() - CRC_LEN;
    &mut out[at..end]
}

/// Writes the checksum.
fn seal(out: &mut [u8]) {
    let crc_at = out.len() - CRC_LEN;
    let crc = CRC.of(&out[1..crc_at]);
    bytes::put_be(out, crc_at..crc_at + CRC_LEN, crc);
}
