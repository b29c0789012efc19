//! Command 2, from the firmware: who it is.

use core::ops::Range;

use crate::bytes;
use crate::error::Error;
use crate::msp::Direction;

/// The command on the wire.
pub const COMMAND: u16 = 2;

/// Which way it goes.
pub const DIRECTION: Direction = Direction::Reply;

/// [`Repr::name`] of INAV.
pub const INAV: [u8; 4] = *b"INAV";

/// Bytes of payload.
pub const LEN: usize = 4;

mod field {
    use super::Range;

    pub(super) const NAME: Range<usize> = 0..4;
}

/// A view of the payload's bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Payload<T>(T);

impl<T: AsRef<[u8]>> Payload<T> {
    /// Takes `bytes` as the payload of an `fc_variant` reply.
    ///
    /// # Errors
    /// [`Error::Length`] unless there are exactly [`LEN`] bytes.
    pub fn new_checked(bytes: T) -> Result<Self, Error> {
        Error::check_length(LEN, bytes.as_ref().len())?;
        Ok(Self(bytes))
    }

    /// Four letters: `INAV`, `BTFL`, ….
    pub fn name(&self) -> [u8; 4] {
        bytes::les(self.0.as_ref(), field::NAME)
    }
}

impl<T: AsRef<[u8]> + AsMut<[u8]>> Payload<T> {
    /// Sets [`name`](Self::name).
    pub fn set_name(&mut self, value: [u8; 4]) {
        bytes::put_les(self.0.as_mut(), field::NAME, value);
    }
}

/// The payload of an `fc_variant` reply as plain values.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Repr {
    /// Four letters: `INAV`, `BTFL`, ….
    pub name: [u8; 4],
}

impl Repr {
    /// Reads every field of a view.
    pub fn parse<T: AsRef<[u8]>>(payload: &Payload<T>) -> Self {
        Self { name: payload.name() }
    }

    /// Bytes that [`emit`](Self::emit) writes.
    pub const fn buffer_len(&self) -> usize {
        LEN
    }

    /// Writes every field into a view.
    pub fn emit<T: AsRef<[u8]> + AsMut<[u8]>>(&self, payload: &mut Payload<T>) {
        payload.set_name(self.name);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOLDEN: [u8; LEN] = [0x49, 0x4e, 0x41, 0x56];

    fn repr() -> Repr {
        Repr { name: [73, 78, 65, 86] }
    }

    #[test]
    fn deconstruct() {
        let payload = Payload::new_checked(&GOLDEN).unwrap();
        assert_eq!(payload.name(), [73, 78, 65, 86]);
        assert!(Payload::new_checked(&GOLDEN[1..]).is_err());
    }

    #[test]
    fn construct() {
        let mut bytes = [0xff; LEN];
        let mut payload = Payload::new_checked(&mut bytes).unwrap();
        payload.set_name([73, 78, 65, 86]);
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
