//! Command 108, from the firmware: its attitude, the heading in whole degrees.

use core::ops::Range;

use crate::bytes;
use crate::error::Error;
use crate::msp::Direction;

/// The command on the wire.
pub const COMMAND: u16 = 108;

/// Which way it goes.
pub const DIRECTION: Direction = Direction::Reply;

/// Bytes of payload.
pub const LEN: usize = 6;

mod field {
    use super::Range;

    pub(super) const ROLL: Range<usize> = 0..2;
    pub(super) const PITCH: Range<usize> = 2..4;
    pub(super) const YAW: Range<usize> = 4..6;
}

/// A view of the payload's bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Payload<T>(T);

impl<T: AsRef<[u8]>> Payload<T> {
    /// Takes `bytes` as the payload of an `attitude` reply.
    ///
    /// # Errors
    /// [`Error::Length`] unless there are exactly [`LEN`] bytes.
    pub fn new_checked(bytes: T) -> Result<Self, Error> {
        Error::check_length(LEN, bytes.as_ref().len())?;
        Ok(Self(bytes))
    }

    /// Roll, 0.1 degrees.
    pub fn roll(&self) -> i16 {
        bytes::le(self.0.as_ref(), field::ROLL)
    }

    /// Pitch, nose down positive, 0.1 degrees.
    pub fn pitch(&self) -> i16 {
        bytes::le(self.0.as_ref(), field::PITCH)
    }

    /// Heading, 0 to 360 degrees.
    pub fn yaw(&self) -> i16 {
        bytes::le(self.0.as_ref(), field::YAW)
    }
}

impl<T: AsRef<[u8]> + AsMut<[u8]>> Payload<T> {
    /// Sets [`roll`](Self::roll).
    pub fn set_roll(&mut self, value: i16) {
        bytes::put_le(self.0.as_mut(), field::ROLL, value);
    }

    /// Sets [`pitch`](Self::pitch).
    pub fn set_pitch(&mut self, value: i16) {
        bytes::put_le(self.0.as_mut(), field::PITCH, value);
    }

    /// Sets [`yaw`](Self::yaw).
    pub fn set_yaw(&mut self, value: i16) {
        bytes::put_le(self.0.as_mut(), field::YAW, value);
    }
}

/// The payload of an `attitude` reply as plain values.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Repr {
    /// Roll, 0.1 degrees.
    pub roll: i16,
    /// Pitch, nose down positive, 0.1 degrees.
    pub pitch: i16,
    /// Heading, 0 to 360 degrees.
    pub yaw: i16,
}

impl Repr {
    /// Reads every field of a view.
    pub fn parse<T: AsRef<[u8]>>(payload: &Payload<T>) -> Self {
        Self { roll: payload.roll(), pitch: payload.pitch(), yaw: payload.yaw() }
    }

    /// Bytes that [`emit`](Self::emit) writes.
    pub const fn buffer_len(&self) -> usize {
        LEN
    }

    /// Writes every field into a view.
    pub fn emit<T: AsRef<[u8]> + AsMut<[u8]>>(&self, payload: &mut Payload<T>) {
        payload.set_roll(self.roll);
        payload.set_pitch(self.pitch);
        payload.set_yaw(self.yaw);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOLDEN: [u8; LEN] = [0x2e, 0xfb, 0x37, 0x02, 0x67, 0x01];

    fn repr() -> Repr {
        Repr { roll: -1234, pitch: 567, yaw: 359 }
    }

    #[test]
    fn deconstruct() {
        let payload = Payload::new_checked(&GOLDEN).unwrap();
        assert_eq!(payload.roll(), -1234);
        assert_eq!(payload.pitch(), 567);
        assert_eq!(payload.yaw(), 359);
        assert!(Payload::new_checked(&GOLDEN[1..]).is_err());
    }

    #[test]
    fn construct() {
        let mut bytes = [0xff; LEN];
        let mut payload = Payload::new_checked(&mut bytes).unwrap();
        payload.set_roll(-1234);
        payload.set_pitch(567);
        payload.set_yaw(359);
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
