//! A UART-to-I²C bridge: NXP's SC18IM700 and SC18IM704, both ends.
//!
//! A transfer is one or more messages, `S address count data…`, and `P`; between its messages the bus is not let go. The
//! address is that of the bus, shifted left by one, with bit 0 for a read. Of a read the bridge sends back exactly the
//! bytes asked for. `R` and `W` read and write the bridge's own registers, of which [`STATUS`] says how the last transfer
//! went. [`Bridge`] is the bridge's end, [`Client`] a firmware's.
//!
//! Source: NXP, SC18IM700 rev. 3 and SC18IM704 rev. 1; what real clients send was measured.
//!
//! ```
//! use ratetable_protocols::bridge::{self, Bridge, Message};
//! use ratetable_protocols::chip::{Wired, mpu::Mpu};
//!
//! let (mut chip, mut bridge) = (Mpu::mpu6050(0x68), Bridge::new());
//! let mut bytes = [0; 32];
//! let len = bridge::encode(0x68, &[Message::Write(&[0x75]), Message::Read(1)], &mut bytes)?;
//! assert_eq!(bytes[..len], [0x53, 0xd0, 1, 0x75, 0x53, 0xd1, 1, 0x50]);
//! let mut answer = None;
//! let mut bus = Wired { t_ns: 0, chips: &mut [&mut chip] };
//! bridge.feed(&bytes[..len], &mut bus, &mut |reply| answer = reply.first().copied());
//! assert_eq!(answer, Some(0x68), "WHO_AM_I");
//! # Ok::<(), ratetable_protocols::Error>(())
//! ```

mod client;
mod server;

pub use client::{Client, Port, Trouble};
pub use server::{Bridge, Bus, Counts};

use crate::Error;

/// Starts a message.
pub const START: u8 = b'S';
/// Ends a transfer or a command.
pub const STOP: u8 = b'P';
/// Reads registers of the bridge.
pub const READ_REGISTER: u8 = b'R';
/// Writes registers of the bridge.
pub const WRITE_REGISTER: u8 = b'W';
/// Reads the bridge's pins.
pub const READ_PINS: u8 = b'I';
/// Writes the bridge's pins.
pub const WRITE_PINS: u8 = b'O';
/// The register that says how the last transfer went.
pub const STATUS: u8 = 0x0a;
/// The most bytes in one message.
pub const MAX_MESSAGE: usize = 255;
/// The speed at which a bridge powers on, baud.
pub const FIRST_BAUD: u32 = 9600;

/// How a transfer went, by the register [`STATUS`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Status {
    /// Everything was acknowledged.
    Done = 0xf0,
    /// No chip has this address.
    NoAddress = 0xf1,
    /// A chip refused a byte.
    NoData = 0xf2,
    /// The bus was held for too long.
    TimeOut = 0xf8,
}

impl Status {
    /// The status of this byte.
    pub const fn from_byte(byte: u8) -> Option<Status> {
        match byte {
            0xf0 => Some(Status::Done),
            0xf1 => Some(Status::NoAddress),
            0xf2 => Some(Status::NoData),
            0xf8 => Some(Status::TimeOut),
            _ => None,
        }
    }
}

/// One message of a transfer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Message<'a> {
    /// Bytes for the chip.
    Write(&'a [u8]),
    /// So many bytes from the chip.
    Read(u8),
}

/// Writes a transfer with the chip at a 7-bit address; gives back its length. A write of more than [`MAX_MESSAGE`] bytes
/// becomes several messages, which a bridge takes for one write.
///
/// # Errors
/// There is no room for it.
pub fn encode(address: u8, messages: &[Message<'_>], out: &mut [u8]) -> Result<usize, Error> {
    let needed = messages.iter().map(size).sum::<usize>() + 1;
    if out.len() < needed {
        return Err(Error::BufferTooSmall { needed });
    }
    let mut at = 0;
    let mut put = |bytes: &[u8]| {
        out[at..at + bytes.len()].copy_from_slice(bytes);
        at += bytes.len();
    };
    for message in messages {
        match *message {
            Message::Read(count) => put(&[START, address << 1 | 1, count]),
            Message::Write([]) => put(&[START, address << 1, 0]),
            Message::Write(bytes) => {
                for piece in bytes.chunks(MAX_MESSAGE) {
                    put(&[START, address << 1, piece.len() as u8]);
                    put(piece);
                }
            }
        }
    }
    put(&[STOP]);
    Ok(needed)
}

fn size(message: &Message<'_>) -> usize {
    match message {
        Message::Read(_) => 3,
        Message::Write(bytes) => bytes.len() + 3 * bytes.len().div_ceil(MAX_MESSAGE).max(1),
    }
}

/// The speed that the bridge's registers 0 and 1 ask for, baud: 7372800/(16 + BRG).
pub const fn baud(brg: u16) -> u32 {
    7_372_800 / (16 + brg as u32)
}
