//! Command 1, from the firmware: which version of MSP it speaks.

use core::ops::Range;

use crate::bytes;
use crate::error::Error;
use crate::msp::Direction;

/// The command on the wire.
pub const COMMAND: u16 = 1;

/// Which way it goes.
pub const DIRECTION: Direction = Direction::Reply;

/// Bytes of payload.
pub const LEN: usize = 3;

mod field {
    use super::Range;

    pub(super) const PROTOCOL: Range<usize> = 0..1;
    pub(super) const MAJOR: Range<usize> = 1..2;
    pub(super) const MINOR: Range<usize> = 2..3;
}

/// A view of the payload's bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Payload<T>(T);

impl<T: AsRef<[u8]>> Payload<T> {
    /// Takes `bytes` as the payload of an `api_version` reply.
    ///
    /// # Errors
    /// [`Error::Length`] unless there are exactly [`LEN`] bytes.
    pub fn new_checked(bytes: T) -> Result<Self, Error> {
        Error::check_length(LEN, bytes.as_ref().len())?;
        Ok(Self(bytes))
    }

    /// Version of the protocol.
    pub fn protocol(&self) -> u8 {
        bytes::le(self.0.as_ref(), field::PROTOCOL)
    }

    /// Major version of the commands.
    pub fn major(&self) -> u8 {
        bytes::le(self.0.as_ref(), field::MAJOR)
    }

    /// Minor version of the commands.
    pub fn minor(&self) -> u8 {
        bytes::le(self.0.as_ref(), field::MINOR)
    }
}

impl<T: AsRef<[u8]> + AsMut<[u8]>> Payload<T> {
    /// Sets [`protocol`](Self::protocol).
    pub fn set_protocol(&mut self, value: u8) {
        bytes::put_le(self.0.as_mut(), field::PROTOCOL, value);
    }

    /// Sets [`major`](Self::major).
    pub fn set_major(&mut self, value: u8) {
        bytes::put_le(self.0.as_mut(), field::MAJOR, value);
    }

    /// Sets [`minor`](Self::minor).
    pub fn set_minor(&mut self, value: u8) {
        bytes::put_le(self.0.as_mut(), field::MINOR, value);
    }
}

/// The payload of an `api_version` reply as plain values.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Repr {
    /// Version of the protocol.
    pub protocol: u8,
    /// Major version of the commands.
    pub major: u8,
    /// Minor version of the commands.
    pub minor: u8,
}

impl Repr {
    /// Reads every field of a view.
    pub fn parse<T: AsRef<[u8]>>(payload: &Payload<T>) -> Self {
        Self { protocol: payload.protocol(), major: payload.major(), minor: payload.minor() }
    }

    /// Bytes that [`emit`](Self::emit) writes.
    pub const fn buffer_len(&self) -> usize {
        LEN
    }

    /// Writes every field into a view.
    pub fn emit<T: AsRef<[u8]> + AsMut<[u8]>>(&self, payload: &mut Payload<T>) {
        payload.set_protocol(self.protocol);
        payload.set_major(self.major);
        payload.set_minor(self.minor);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOLDEN: [u8; LEN] = [0x00, 0x02, 0x05];

    fn repr() -> Repr {
        Repr { protocol: 0, major: 2, minor: 5 }
    }

    #[test]
    fn deconstruct() {
        let payload = Payload::new_checked(&GOLDEN).unwrap();
        assert_eq!(payload.protocol(), 0);
        assert_eq!(payload.major(), 2);
        assert_eq!(payload.minor(), 5);
        assert!(Payload::new_checked(&GOLDEN[1..]).is_err());
    }

    #[test]
    fn construct() {
        let mut bytes = [0xff; LEN];
        let mut payload = Payload::new_checked(&mut bytes).unwrap();
        payload.set_protocol(0);
        payload.set_major(2);
        payload.set_minor(5);
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
