//! `TIMESYNC` (111): compares two clocks.

use core::ops::Range;

use crate::bytes;
use crate::error::Error;

/// The message id.
pub const ID: u32 = 111;

/// What the checksum is seeded with after the bytes: guards against a different field list.
pub const CRC_EXTRA: u8 = 34;

/// Bytes without extension fields: the payload in MAVLink 1.
pub const BASE_LEN: usize = 16;

/// Bytes with extension fields: the payload in MAVLink 2 before trailing zeros are cut.
pub const LEN: usize = 16;

mod field {
    use super::Range;

    pub(super) const TC1: Range<usize> = 0..8;
    pub(super) const TS1: Range<usize> = 8..16;
}

/// A view of the payload's bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Payload<T>(T);

impl<T: AsRef<[u8]>> Payload<T> {
    /// Takes `bytes` as a `TIMESYNC` payload at full length.
    ///
    /// # Errors
    /// [`Error::Length`] unless there are exactly [`LEN`] bytes.
    pub fn new_checked(bytes: T) -> Result<Self, Error> {
        Error::check_length(LEN, bytes.as_ref().len())?;
        Ok(Self(bytes))
    }

    /// The answerer's clock, ns; 0 in a question.
    pub fn tc1(&self) -> i64 {
        bytes::le(self.0.as_ref(), field::TC1)
    }

    /// The asker's clock when it asked, ns: an answer repeats it.
    pub fn ts1(&self) -> i64 {
        bytes::le(self.0.as_ref(), field::TS1)
    }
}

impl<T: AsRef<[u8]> + AsMut<[u8]>> Payload<T> {
    /// Sets [`tc1`](Self::tc1).
    pub fn set_tc1(&mut self, value: i64) {
        bytes::put_le(self.0.as_mut(), field::TC1, value);
    }

    /// Sets [`ts1`](Self::ts1).
    pub fn set_ts1(&mut self, value: i64) {
        bytes::put_le(self.0.as_mut(), field::TS1, value);
    }
}

/// A `TIMESYNC` payload at full length as plain values.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Repr {
    /// The answerer's clock, ns; 0 in a question.
    pub tc1: i64,
    /// The asker's clock when it asked, ns: an answer repeats it.
    pub ts1: i64,
}

impl Repr {
    /// Reads every field of a view.
    pub fn parse<T: AsRef<[u8]>>(payload: &Payload<T>) -> Self {
        Self { tc1: payload.tc1(), ts1: payload.ts1() }
    }

    /// Bytes that [`emit`](Self::emit) writes.
    pub const fn buffer_len(&self) -> usize {
        LEN
    }

    /// Writes every field into a view.
    pub fn emit<T: AsRef<[u8]> + AsMut<[u8]>>(&self, payload: &mut Payload<T>) {
        payload.set_tc1(self.tc1);
        payload.set_ts1(self.ts1);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOLDEN: [u8; LEN] =
        [0xcb, 0x04, 0xfb, 0x71, 0x1f, 0x01, 0x00, 0x00, 0x16, 0xe9, 0x4f, 0xb3, 0xfd, 0xff, 0xff, 0xff];

    fn repr() -> Repr {
        Repr { tc1: 1234567890123, ts1: -9876543210 }
    }

    #[test]
    fn deconstruct() {
        let payload = Payload::new_checked(&GOLDEN).unwrap();
        assert_eq!(payload.tc1(), 1234567890123);
        assert_eq!(payload.ts1(), -9876543210);
        assert!(Payload::new_checked(&GOLDEN[1..]).is_err());
    }

    #[test]
    fn construct() {
        let mut bytes = [0xff; LEN];
        let mut payload = Payload::new_checked(&mut bytes).unwrap();
        payload.set_tc1(1234567890123);
        payload.set_ts1(-9876543210);
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
