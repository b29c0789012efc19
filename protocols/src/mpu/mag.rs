//! Type 02: the AK8963 magnetometer inside an MPU-9250.
//!
//! Registers 0x02 to 0x09 exactly as they lie in the part: little-endian two's complement, in the
//! AK8963's own axes, which differ from the gyro's (see [`swap_mag_axes`]).
//!
//! [`swap_mag_axes`]: super::registers::swap_mag_axes

use core::ops::Range;

use crate::bytes;
use crate::error::Error;

/// The packet type on the wire.
pub const TYPE: u8 = 0x02;

/// Bytes of payload.
pub const LEN: usize = 8;

mod field {
    use super::Range;

    pub(super) const ST1: Range<usize> = 0..1;
    pub(super) const FIELD: Range<usize> = 1..7;
    pub(super) const ST2: Range<usize> = 7..8;
}

/// A view of the payload's bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Payload<T>(T);

impl<T: AsRef<[u8]>> Payload<T> {
    /// Takes `bytes` as the payload of a `mag` packet.
    ///
    /// # Errors
    /// [`Error::Length`] unless there are exactly [`LEN`] bytes.
    pub fn new_checked(bytes: T) -> Result<Self, Error> {
        Error::check_length(LEN, bytes.as_ref().len())?;
        Ok(Self(bytes))
    }

    /// Status 1: data ready, data overrun.
    pub fn st1(&self) -> u8 {
        bytes::le(self.0.as_ref(), field::ST1)
    }

    /// Raw counts along the AK8963's x, y and z, before the sensitivity adjustment.
    pub fn field(&self) -> [i16; 3] {
        bytes::les(self.0.as_ref(), field::FIELD)
    }

    /// Status 2: overflow, output width.
    pub fn st2(&self) -> u8 {
        bytes::le(self.0.as_ref(), field::ST2)
    }
}

impl<T: AsRef<[u8]> + AsMut<[u8]>> Payload<T> {
    /// Sets [`st1`](Self::st1).
    pub fn set_st1(&mut self, value: u8) {
        bytes::put_le(self.0.as_mut(), field::ST1, value);
    }

    /// Sets [`field`](Self::field).
    pub fn set_field(&mut self, value: [i16; 3]) {
        bytes::put_les(self.0.as_mut(), field::FIELD, value);
    }

    /// Sets [`st2`](Self::st2).
    pub fn set_st2(&mut self, value: u8) {
        bytes::put_le(self.0.as_mut(), field::ST2, value);
    }
}

/// The payload of a `mag` packet as plain values.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Repr {
    /// Status 1: data ready, data overrun.
    pub st1: u8,
    /// Raw counts along the AK8963's x, y and z, before the sensitivity adjustment.
    pub field: [i16; 3],
    /// Status 2: overflow, output width.
    pub st2: u8,
}

impl Repr {
    /// Reads every field of a view.
    pub fn parse<T: AsRef<[u8]>>(payload: &Payload<T>) -> Self {
        Self { st1: payload.st1(), field: payload.field(), st2: payload.st2() }
    }

    /// Bytes that [`emit`](Self::emit) writes.
    pub const fn buffer_len(&self) -> usize {
        LEN
    }

    /// Writes every field into a view.
    pub fn emit<T: AsRef<[u8]> + AsMut<[u8]>>(&self, payload: &mut Payload<T>) {
        payload.set_st1(self.st1);
        payload.set_field(self.field);
        payload.set_st2(self.st2);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOLDEN: [u8; LEN] = [0x01, 0x7b, 0x00, 0x38, 0xfe, 0x08, 0x80, 0x10];

    fn repr() -> Repr {
        Repr { st1: 1, field: [123, -456, -32760], st2: 16 }
    }

    #[test]
    fn deconstruct() {
        let payload = Payload::new_checked(&GOLDEN).unwrap();
        assert_eq!(payload.st1(), 1);
        assert_eq!(payload.field(), [123, -456, -32760]);
        assert_eq!(payload.st2(), 16);
        assert!(Payload::new_checked(&GOLDEN[1..]).is_err());
    }

    #[test]
    fn construct() {
        let mut bytes = [0xff; LEN];
        let mut payload = Payload::new_checked(&mut bytes).unwrap();
        payload.set_st1(1);
        payload.set_field([123, -456, -32760]);
        payload.set_st2(16);
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
