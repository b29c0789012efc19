//! `SYSTEM_TIME` (2): the sender's date and its time since boot.

use core::ops::Range;

use crate::bytes;
use crate::error::Error;

/// The message id.
pub const ID: u32 = 2;

/// What the checksum is seeded with after the bytes: guards against a different field list.
pub const CRC_EXTRA: u8 = 137;

/// Bytes without extension fields: the payload in MAVLink 1.
pub const BASE_LEN: usize = 12;

/// Bytes with extension fields: the payload in MAVLink 2 before trailing zeros are cut.
pub const LEN: usize = 12;

mod field {
    use super::Range;

    pub(super) const TIME_UNIX_USEC: Range<usize> = 0..8;
    pub(super) const TIME_BOOT_MS: Range<usize> = 8..12;
}

/// A view of the payload's bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Payload<T>(T);

impl<T: AsRef<[u8]>> Payload<T> {
    /// Takes `bytes` as a `SYSTEM_TIME` payload at full length.
    ///
    /// # Errors
    /// [`Error::Length`] unless there are exactly [`LEN`] bytes.
    pub fn new_checked(bytes: T) -> Result<Self, Error> {
        Error::check_length(LEN, bytes.as_ref().len())?;
        Ok(Self(bytes))
    }

    /// Time since 1970-01-01 UTC, µs; 0 where no date is known.
    pub fn time_unix_usec(&self) -> u64 {
        bytes::le(self.0.as_ref(), field::TIME_UNIX_USEC)
    }

    /// Time since boot, ms.
    pub fn time_boot_ms(&self) -> u32 {
        bytes::le(self.0.as_ref(), field::TIME_BOOT_MS)
    }
}

impl<T: AsRef<[u8]> + AsMut<[u8]>> Payload<T> {
    /// Sets [`time_unix_usec`](Self::time_unix_usec).
    pub fn set_time_unix_usec(&mut self, value: u64) {
        bytes::put_le(self.0.as_mut(), field::TIME_UNIX_USEC, value);
    }

    /// Sets [`time_boot_ms`](Self::time_boot_ms).
    pub fn set_time_boot_ms(&mut self, value: u32) {
        bytes::put_le(self.0.as_mut(), field::TIME_BOOT_MS, value);
    }
}

/// A `SYSTEM_TIME` payload at full length as plain values.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Repr {
    /// Time since 1970-01-01 UTC, µs; 0 where no date is known.
    pub time_unix_usec: u64,
    /// Time since boot, ms.
    pub time_boot_ms: u32,
}

impl Repr {
    /// Reads every field of a view.
    pub fn parse<T: AsRef<[u8]>>(payload: &Payload<T>) -> Self {
        Self { time_unix_usec: payload.time_unix_usec(), time_boot_ms: payload.time_boot_ms() }
    }

    /// Bytes that [`emit`](Self::emit) writes.
    pub const fn buffer_len(&self) -> usize {
        LEN
    }

    /// Writes every field into a view.
    pub fn emit<T: AsRef<[u8]> + AsMut<[u8]>>(&self, payload: &mut Payload<T>) {
        payload.set_time_unix_usec(self.time_unix_usec);
        payload.set_time_boot_ms(self.time_boot_ms);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOLDEN: [u8; LEN] = [0x40, 0x22, 0x20, 0x18, 0x24, 0x0a, 0x06, 0x00, 0xcd, 0x81, 0x01, 0x00];

    fn repr() -> Repr {
        Repr { time_unix_usec: 1700000000123456, time_boot_ms: 98765 }
    }

    #[test]
    fn deconstruct() {
        let payload = Payload::new_checked(&GOLDEN).unwrap();
        assert_eq!(payload.time_unix_usec(), 1700000000123456);
        assert_eq!(payload.time_boot_ms(), 98765);
        assert!(Payload::new_checked(&GOLDEN[1..]).is_err());
    }

    #[test]
    fn construct() {
        let mut bytes = [0xff; LEN];
        let mut payload = Payload::new_checked(&mut bytes).unwrap();
        payload.set_time_unix_usec(1700000000123456);
        payload.set_time_boot_ms(98765);
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
