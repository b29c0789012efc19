//! `mavlink`: the messages of MAVLink 1 and 2 that a sensor emulator speaks.
//!
//! MAVLink 2: `FD | len u8 | incompatible u8 | compatible u8 | seq u8 | system u8 | component u8 |
//! id u24 | payload | crc u16`, trailing zeros of the payload cut except for one byte.
//! MAVLink 1: `FE | len u8 | seq u8 | system u8 | component u8 | id u8 | payload | crc u16`.
//! The checksum (CRC-16/MCRF4XX) covers everything after the first byte and then `CRC_EXTRA`, a
//! byte that stands for the message's list of fields. Numbers are little-endian.
//!
//! A new message is one file, its `mod` line and one line in the table below.
//!
//! ```
//! use ratetable_protocols::mavlink::{self, Decoder, Header, Message, Version, heartbeat};
//!
//! let header = Header { version: Version::V2, seq: 0, system: 1, component: 1 };
//! let message = Message::Heartbeat(heartbeat::Repr { mavlink_version: 3, ..Default::default() });
//! let mut bytes = [0; mavlink::MAX_LEN];
//! let len = mavlink::encode(&header, &message, &mut bytes)?;
//!
//! let mut back = None;
//! Decoder::new().feed(&bytes[..len], |received| back = received.ok());
//! assert_eq!(back.and_then(|received| received.message), Some(message));
//! # Ok::<(), ratetable_protocols::Error>(())
//! ```

use crc::CRC_16_MCRF4XX;

use crate::bytes;
use crate::checksum::Checksum;
use crate::error::Error;

pub mod attitude;
pub mod attitude_quaternion;
pub mod command_ack;
pub mod command_long;
mod decoder;
mod dialect;
pub mod heartbeat;
pub mod highres_imu;
pub mod hil_actuator_controls;
pub mod hil_gps;
pub mod hil_sensor;
pub mod hil_state_quaternion;
mod param_id;
pub mod param_request_read;
pub mod param_value;
pub mod raw_imu;
pub mod scaled_imu;
pub mod scaled_imu2;
pub mod scaled_imu3;
pub mod system_time;
pub mod timesync;

pub use decoder::Decoder;
pub use dialect::{KNOWN, Known, known};
pub use param_id::{PARAM_ID_LEN, param_id, param_name};

static CRC: Checksum<true> = Checksum::new(&CRC_16_MCRF4XX);

/// Bytes of the longest payload of any message.
pub const MAX_PAYLOAD_LEN: usize = 255;

/// Bytes of the longest packet, a MAVLink 2 signature included.
pub const MAX_LEN: usize = Version::V2.header_len() + MAX_PAYLOAD_LEN + CRC_LEN + SIGNATURE_LEN;

/// Bytes of checksum behind the payload.
const CRC_LEN: usize = 2;

/// Bytes of signature behind the checksum, where there is one.
const SIGNATURE_LEN: usize = 13;

/// Bytes of the stamp in front of each packet of a log.
pub const STAMP_LEN: usize = 8;

/// The version of the framing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Version {
    /// MAVLink 1: 8-bit message ids, no extension fields.
    V1,
    /// MAVLink 2.
    #[default]
    V2,
}

impl Version {
    /// The first byte of a packet.
    pub const fn magic(self) -> u8 {
        match self {
            Self::V1 => 0xfe,
            Self::V2 => 0xfd,
        }
    }

    /// The version that starts with this byte.
    const fn from_magic(magic: u8) -> Option<Self> {
        match magic {
            0xfe => Some(Self::V1),
            0xfd => Some(Self::V2),
            _ => None,
        }
    }

    /// Bytes before the payload.
    pub const fn header_len(self) -> usize {
        match self {
            Self::V1 => 6,
            Self::V2 => 10,
        }
    }
}

/// Who says it, and how.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Header {
    /// Version of the framing.
    pub version: Version,
    /// Counts every packet of this sender on the link, wrapping.
    pub seq: u8,
    /// The sender's system id.
    pub system: u8,
    /// The sender's component id.
    pub component: u8,
}

/// A packet as it arrived.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Received {
    /// Who says it, and how.
    pub header: Header,
    /// The message id.
    pub id: u32,
    /// The message; `None` if it is not one of those that are read here.
    pub message: Option<Message>,
    /// Whether its checksum was checked, which takes an id of the table [`KNOWN`]: of another not even the number is
    /// sure.
    pub checked: bool,
    /// The stamp in front of it in a log of [`Decoder::stamped`], µs; no checksum covers it.
    pub stamp_us: Option<u64>,
    /// Bytes of the packet.
    pub len: usize,
    /// Bytes since the packet before that belong to none.
    pub skipped: usize,
}

macro_rules! messages {
    ($($(#[$doc:meta])* $name:ident($module:ident),)*) => {
        /// A message of any id.
        #[derive(Debug, Clone, Copy, PartialEq)]
        pub enum Message {
            $($(#[$doc])* $name($module::Repr),)*
        }

        impl Message {
            /// The ids of all of them.
            pub const IDS: &[u32] = &[$($module::ID),*];

            /// The message id.
            pub const fn id(&self) -> u32 {
                match self { $(Self::$name(_) => $module::ID,)* }
            }

            /// The message's name in MAVLink's definitions, in lower case.
            pub const fn name(&self) -> &'static str {
                match self { $(Self::$name(_) => stringify!($module),)* }
            }

            /// The checksum's last byte.
            pub const fn crc_extra(&self) -> u8 {
                match self { $(Self::$name(_) => $module::CRC_EXTRA,)* }
            }

            /// Bytes of payload before trailing zeros are cut.
            pub const fn buffer_len(&self, version: Version) -> usize {
                match (self, version) {
                    $((Self::$name(_), Version::V1) => $module::BASE_LEN,
                    (Self::$name(_), Version::V2) => $module::LEN,)*
                }
            }

            /// Reads a payload; what is cut off at its end is zero, what is more is ignored.
            ///
            /// # Errors
            /// [`Error::Malformed`] if the id is not known here.
            pub fn parse(id: u32, payload: &[u8]) -> Result<Self, Error> {
                let mut whole = [0; MAX_PAYLOAD_LEN];
                bytes::copy(payload, &mut whole);
                match id {
                    $($module::ID => {
                        let payload = $module::Payload::new_checked(&whole[..$module::LEN])?;
                        Ok(Self::$name($module::Repr::parse(&payload)))
                    })*
                    _ => Err(Error::Malformed),
                }
            }

            /// Writes the payload, extension fields included, at the front of `room`.
            fn emit(&self, room: &mut [u8]) -> Result<(), Error> {
                match self {
                    $(Self::$name(repr) => {
                        let needed = $module::LEN;
                        let payload = room.get_mut(..needed).ok_or(Error::BufferTooSmall { needed })?;
                        repr.emit(&mut $module::Payload::new_checked(payload)?);
                    })*
                }
                Ok(())
            }
        }
    };
}

messages! {
    /// Who is there.
    Heartbeat(heartbeat),
    /// Date and time since boot.
    SystemTime(system_time),
    /// Asks for a parameter.
    ParamRequestRead(param_request_read),
    /// A parameter.
    ParamValue(param_value),
    /// An autopilot's own sensor in thousandths of units.
    ScaledImu(scaled_imu),
    /// An autopilot's own sensor in counts.
    RawImu(raw_imu),
    /// Attitude as Euler angles.
    Attitude(attitude),
    /// Attitude as a quaternion.
    AttitudeQuaternion(attitude_quaternion),
    /// Asks somebody to do something.
    CommandLong(command_long),
    /// What became of a command.
    CommandAck(command_ack),
    /// What an autopilot tells a simulated vehicle to do.
    HilActuatorControls(hil_actuator_controls),
    /// An autopilot's own sensors.
    HighresImu(highres_imu),
    /// The readings of an emulated vehicle.
    HilSensor(hil_sensor),
    /// Compares two clocks.
    Timesync(timesync),
    /// The position fix of an emulated vehicle.
    HilGps(hil_gps),
    /// The true state of an emulated vehicle.
    HilStateQuaternion(hil_state_quaternion),
    /// An autopilot's second sensor in thousandths of units.
    ScaledImu2(scaled_imu2),
    /// An autopilot's third sensor in thousandths of units.
    ScaledImu3(scaled_imu3),
}

/// The checksum of the bytes after the first one of a packet.
fn checksum(after_magic: &[u8], crc_extra: u8) -> u16 {
    CRC.of_both(after_magic, &[crc_extra])
}

/// Writes one packet and returns its length. What is in `out` behind the packet may change too.
///
/// # Errors
/// [`Error::BufferTooSmall`] if `out` cannot hold it ([`MAX_LEN`] bytes always can),
/// [`Error::Version`] if the id does not fit MAVLink 1.
pub fn encode(header: &Header, message: &Message, out: &mut [u8]) -> Result<usize, Error> {
    if out.len() < MAX_LEN {
        return encode_into_little(header, message, out);
    }
    let start = header.version.header_len();
    let (head, rest) = out.split_at_mut(start);
    message.emit(rest)?;
    let payload = &rest[..message.buffer_len(header.version)];
    let len = match header.version {
        Version::V1 => payload.len(),
        Version::V2 => without_zeros(payload),
    };
    put_header(header, message.id(), len as u8, head)?;
    let crc_at = start + len;
    let crc = checksum(&out[1..crc_at], message.crc_extra());
    bytes::put_le(out, crc_at..crc_at + CRC_LEN, crc);
    Ok(crc_at + CRC_LEN)
}

/// The same where `out` may have room for this packet without its zeros, but not for every one.
#[cold]
fn encode_into_little(header: &Header, message: &Message, out: &mut [u8]) -> Result<usize, Error> {
    let mut whole = [0; MAX_LEN];
    let needed = encode(header, message, &mut whole)?;
    let packet = out.get_mut(..needed).ok_or(Error::BufferTooSmall { needed })?;
    packet.copy_from_slice(&whole[..needed]);
    Ok(needed)
}

/// Bytes of a payload without its trailing zeros, at least one.
fn without_zeros(payload: &[u8]) -> usize {
    let last = payload.iter().rposition(|&byte| byte != 0).unwrap_or(0);
    payload.len().min(last + 1)
}

/// Writes what comes before the payload.
fn put_header(header: &Header, id: u32, len: u8, packet: &mut [u8]) -> Result<(), Error> {
    let &Header { version, seq, system, component } = header;
    let magic = version.magic();
    match version {
        Version::V1 => {
            let id = u8::try_from(id).map_err(|_| Error::Version)?;
            bytes::copy(&[magic, len, seq, system, component, id], packet);
        }
        Version::V2 => {
            let [a, b, c, _] = id.to_le_bytes();
            bytes::copy(&[magic, len, 0, 0, seq, system, component, a, b, c], packet);
        }
    }
    Ok(())
}
