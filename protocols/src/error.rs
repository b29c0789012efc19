//! Why bytes were refused, or could not be written.

use core::fmt;

/// Why bytes were refused, or could not be written.
///
/// One small type for all formats: a receiver mostly counts these, and a person who reads one
/// wants to know which check failed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Error {
    /// The buffer to write into is too small: bytes needed at least.
    BufferTooSmall {
        /// Bytes needed at least.
        needed: usize,
    },
    /// The bytes do not form a packet: a bad start, a broken stuffing, too few or too many.
    Malformed,
    /// The checksum does not match the bytes.
    Checksum,
    /// The checksum matches, but the type is not one that is known here.
    UnknownType(u8),
    /// The checksum matches, but the length is not that of the type.
    Length {
        /// Bytes that the type has.
        expected: usize,
        /// Bytes that were there.
        found: usize,
    },
    /// The message cannot be said in this version of the protocol.
    Version,
}

impl Error {
    /// Refuses `found` bytes where exactly `expected` are needed.
    pub(crate) fn check_length(expected: usize, found: usize) -> Result<(), Self> {
        if expected == found { Ok(()) } else { Err(Self::Length { expected, found }) }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::BufferTooSmall { needed } => write!(f, "the buffer needs {needed} bytes"),
            Self::Malformed => f.write_str("the bytes do not form a packet"),
            Self::Checksum => f.write_str("the checksum does not match"),
            Self::UnknownType(kind) => write!(f, "packet type {kind:02x} is not known"),
            Self::Length { expected, found } => {
                write!(f, "{found} bytes where {expected} are needed")
            }
            Self::Version => f.write_str("this protocol version has no such message"),
        }
    }
}

impl core::error::Error for Error {}
