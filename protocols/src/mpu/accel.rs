//! Type 04: the accelerometer alone.
//!
//! Registers 0x3B to 0x40 exactly as they lie in the chip: big-endian two's complement, chip axes.

use core::ops::Range;

use crate::bytes;
use crate::error::Error;

/// The packet type on the wire.
pub const TYPE: u8 = 0x04;

/// Bytes of payload.
pub const LEN: usize = 6;

mod field {
    use super::Range;

    pub(super) const ACCEL: Range<usize> = 0..6;
}

/// A view of the payload's bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Payload<T>(T);

impl<T: AsRef<[u8]>> Payload<T> {
    /// Takes `bytes` as the payload of an `accel` packet.
    ///
    /// # Errors
    /// [`Error::Length`] unless there are exactly [`LEN`] bytes.
    pub fn new_checked(bytes: T) -> Result<Self, Error> {
        Error::check_length(LEN, bytes.as_ref().len())?;
        Ok(Self(bytes))
    }

    /// Raw counts along the chip's x, y and z: specific force.
    pub fn accel(&self) -> [i16; 3] {
        bytes::bes(self.0.as_ref(), field::ACCEL)
    }
}

impl<T: AsRef<[u8]> + AsMut<[u8]>> Payload<T> {
    /// Sets [`accel`](Self::accel).
    pub fn set_accel(&mut self, value: [i16; 3]) {
        bytes::put_bes(self.0.as_mut(), field::ACCEL, value);
    }
}

/// The payload of an `accel` packet as plain values.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Repr {
    /// Raw counts along the chip's x, y and z: specific force.
    pub accel: [i16; 3],
}

impl Repr {
    /// Reads every field of a view.
    pub fn parse<T: AsRef<[u8]>>(payload: &Payload<T>) -> Self {
        Self { accel: payload.accel() }
    }

    /// Bytes that [`emit`](Self::emit) writes.
    pub const fn buffer_len(&self) -> usize {
        LEN
    }

    /// Writes every field into a view.
    pub fn emit<T: AsRef<[u8]> + AsMut<[u8]>>(&self, payload: &mut Payload<T>) {
        payload.set_accel(self.accel);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOLDEN: [u8; LEN] = [0x00, 0x00, 0x00, 0x00, 0x40, 0x00];

    fn repr() -> Repr {
        Repr { accel: [0, 0, 16384] }
    }

    #[test]
    fn deconstruct() {
        let payload = Payload::new_checked(&GOLDEN).unwrap();
        assert_eq!(payload.accel(), [0, 0, 16384]);
        assert!(Payload::new_checked(&GOLDEN[1..]).is_err());
    }

    #[test]
    fn construct() {
        let mut bytes = [0xff; LEN];
        let mut payload = Payload::new_checked(&mut bytes).unwrap();
        payload.set_accel([0, 0, 16384]);
        assert_eq!(bytes, GOLDEN);
    }

    #[test]
    fn parse() {
        assert_eq!(Repr::parse(&Payload::new_checked(&GOLDEN).unwrap()), repr());
    }

    #[test]
    fn emit() {
        let mut bytes = [0xff; LEN];
        assert_eq!(repr().buffer_len(), LEN);
        repr().emit(&mut Payload::new_checked(&mut bytes).unwrap());
        assert_eq!(bytes, GOLDEN);
    }
}
