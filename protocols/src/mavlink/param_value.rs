//! `PARAM_VALUE` (22): one parameter of an autopilot.

use core::ops::Range;

use crate::bytes;
use crate::error::Error;

/// The message id.
pub const ID: u32 = 22;

/// What the checksum is seeded with after the bytes: guards against a different field list.
pub const CRC_EXTRA: u8 = 220;

/// Bytes without extension fields: the payload in MAVLink 1.
pub const BASE_LEN: usize = 25;

/// Bytes with extension fields: the payload in MAVLink 2 before trailing zeros are cut.
pub const LEN: usize = 25;

/// `param_type` of a 32-bit signed integer.
pub const INT32: u8 = 6;

/// `param_type` of a 32-bit float.
pub const REAL32: u8 = 9;

mod field {
    use super::Range;

    pub(super) const PARAM_VALUE: Range<usize> = 0..4;
    pub(super) const PARAM_COUNT: Range<usize> = 4..6;
    pub(super) const PARAM_INDEX: Range<usize> = 6..8;
    pub(super) const PARAM_ID: Range<usize> = 8..24;
    pub(super) const PARAM_TYPE: Range<usize> = 24..25;
}

/// A view of the payload's bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Payload<T>(T);

impl<T: AsRef<[u8]>> Payload<T> {
    /// Takes `bytes` as a `PARAM_VALUE` payload at full length.
    ///
    /// # Errors
    /// [`Error::Length`] unless there are exactly [`LEN`] bytes.
    pub fn new_checked(bytes: T) -> Result<Self, Error> {
        Error::check_length(LEN, bytes.as_ref().len())?;
        Ok(Self(bytes))
    }

    /// Its value; PX4 puts the bits of an integer here, ArduPilot its number.
    pub fn param_value(&self) -> f32 {
        bytes::le(self.0.as_ref(), field::PARAM_VALUE)
    }

    /// How many parameters there are.
    pub fn param_count(&self) -> u16 {
        bytes::le(self.0.as_ref(), field::PARAM_COUNT)
    }

    /// Which of them this is.
    pub fn param_index(&self) -> u16 {
        bytes::le(self.0.as_ref(), field::PARAM_INDEX)
    }

    /// Its name, ended by a zero where it is shorter: [`param_name`](super::param_name).
    pub fn param_id(&self) -> [u8; 16] {
        bytes::les(self.0.as_ref(), field::PARAM_ID)
    }

    /// `MAV_PARAM_TYPE`: [`INT32`], [`REAL32`].
    pub fn param_type(&self) -> u8 {
        bytes::le(self.0.as_ref(), field::PARAM_TYPE)
    }
}

impl<T: AsRef<[u8]> + AsMut<[u8]>> Payload<T> {
    /// Sets [`param_value`](Self::param_value).
    pub fn set_param_value(&mut self, value: f32) {
        bytes::put_le(self.0.as_mut(), field::PARAM_VALUE, value);
    }

    /// Sets [`param_count`](Self::param_count).
    pub fn set_param_count(&mut self, value: u16) {
        bytes::put_le(self.0.as_mut(), field::PARAM_COUNT, value);
    }

    /// Sets [`param_index`](Self::param_index).
    pub fn set_param_index(&mut self, value: u16) {
        bytes::put_le(self.0.as_mut(), field::PARAM_INDEX, value);
    }

    /// Sets [`param_id`](Self::param_id).
    pub fn set_param_id(&mut self, value: [u8; 16]) {
        bytes::put_les(self.0.as_mut(), field::PARAM_ID, value);
    }

    /// Sets [`param_type`](Self::param_type).
    pub fn set_param_type(&mut self, value: u8) {
        bytes::put_le(self.0.as_mut(), field::PARAM_TYPE, value);
    }
}

/// A `PARAM_VALUE` payload at full length as plain values.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Repr {
    /// Its value; PX4 puts the bits of an integer here, ArduPilot its number.
    pub param_value: f32,
    /// How many parameters there are.
    pub param_count: u16,
    /// Which of them this is.
    pub param_index: u16,
    /// Its name, ended by a zero where it is shorter: [`param_name`](super::param_name).
    pub param_id: [u8; 16],
    /// `MAV_PARAM_TYPE`: [`INT32`], [`REAL32`].
    pub param_type: u8,
}

impl Repr {
    /// Reads every field of a view.
    pub fn parse<T: AsRef<[u8]>>(payload: &Payload<T>) -> Self {
        Self {
            param_value: payload.param_value(),
            param_count: payload.param_count(),
            param_index: payload.param_index(),
            param_id: payload.param_id(),
            param_type: payload.param_type(),
        }
    }

    /// Bytes that [`emit`](Self::emit) writes.
    pub const fn buffer_len(&self) -> usize {
        LEN
    }

    /// Writes every field into a view.
    pub fn emit<T: AsRef<[u8]> + AsMut<[u8]>>(&self, payload: &mut Payload<T>) {
        payload.set_param_value(self.param_value);
        payload.set_param_count(self.param_count);
        payload.set_param_index(self.param_index);
        payload.set_param_id(self.param_id);
        payload.set_param_type(self.param_type);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOLDEN: [u8; LEN] = [
        0xb0, 0x04, 0x00, 0x00, 0xf5, 0x03, 0x03, 0x02, 0x4d, 0x41, 0x56, 0x5f, 0x30, 0x5f, 0x52, 0x41, 0x54,
        0x45, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x06,
    ];

    fn repr() -> Repr {
        Repr {
            param_value: f32::from_bits(1200),
            param_count: 1013,
            param_index: 515,
            param_id: *b"MAV_0_RATE\0\0\0\0\0\0",
            param_type: 6,
        }
    }

    #[test]
    fn deconstruct() {
        let payload = Payload::new_checked(&GOLDEN).unwrap();
        assert_eq!(payload.param_value(), f32::from_bits(1200));
        assert_eq!(payload.param_count(), 1013);
        assert_eq!(payload.param_index(), 515);
        assert_eq!(payload.param_id(), *b"MAV_0_RATE\0\0\0\0\0\0");
        assert_eq!(payload.param_type(), 6);
        assert!(Payload::new_checked(&GOLDEN[1..]).is_err());
    }

    #[test]
    fn construct() {
        let mut bytes = [0xff; LEN];
        let mut payload = Payload::new_checked(&mut bytes).unwrap();
        payload.set_param_value(f32::from_bits(1200));
        payload.set_param_count(1013);
        payload.set_param_index(515);
        payload.set_param_id(*b"MAV_0_RATE\0\0\0\0\0\0");
        payload.set_param_type(6);
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
