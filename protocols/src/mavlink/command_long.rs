//! `COMMAND_LONG` (76): asks somebody to do something.

use core::ops::Range;

use crate::bytes;
use crate::error::Error;

/// The message id.
pub const ID: u32 = 76;

/// What the checksum is seeded with after the bytes: guards against a different field list.
pub const CRC_EXTRA: u8 = 152;

/// Bytes without extension fields: the payload in MAVLink 1.
pub const BASE_LEN: usize = 33;

/// Bytes with extension fields: the payload in MAVLink 2 before trailing zeros are cut.
pub const LEN: usize = 33;

/// `command`: send message `params[0]` every `params[1]` µs.
pub const SET_MESSAGE_INTERVAL: u16 = 511;

mod field {
    use super::Range;

    pub(super) const PARAMS: Range<usize> = 0..28;
    pub(super) const COMMAND: Range<usize> = 28..30;
    pub(super) const TARGET_SYSTEM: Range<usize> = 30..31;
    pub(super) const TARGET_COMPONENT: Range<usize> = 31..32;
    pub(super) const CONFIRMATION: Range<usize> = 32..33;
}

/// A view of the payload's bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Payload<T>(T);

impl<T: AsRef<[u8]>> Payload<T> {
    /// Takes `bytes` as a `COMMAND_LONG` payload at full length.
    ///
    /// # Errors
    /// [`Error::Length`] unless there are exactly [`LEN`] bytes.
    pub fn new_checked(bytes: T) -> Result<Self, Error> {
        Error::check_length(LEN, bytes.as_ref().len())?;
        Ok(Self(bytes))
    }

    /// What the parameters of the command say.
    pub fn params(&self) -> [f32; 7] {
        bytes::les(self.0.as_ref(), field::PARAMS)
    }

    /// `MAV_CMD`.
    pub fn command(&self) -> u16 {
        bytes::le(self.0.as_ref(), field::COMMAND)
    }

    /// Whom it is for: the system id, 0 for any.
    pub fn target_system(&self) -> u8 {
        bytes::le(self.0.as_ref(), field::TARGET_SYSTEM)
    }

    /// Whom it is for: the component id, 0 for any.
    pub fn target_component(&self) -> u8 {
        bytes::le(self.0.as_ref(), field::TARGET_COMPONENT)
    }

    /// 0 the first time, then counted up.
    pub fn confirmation(&self) -> u8 {
        bytes::le(self.0.as_ref(), field::CONFIRMATION)
    }
}

impl<T: AsRef<[u8]> + AsMut<[u8]>> Payload<T> {
    /// Sets [`params`](Self::params).
    pub fn set_params(&mut self, value: [f32; 7]) {
        bytes::put_les(self.0.as_mut(), field::PARAMS, value);
    }

    /// Sets [`command`](Self::command).
    pub fn set_command(&mut self, value: u16) {
        bytes::put_le(self.0.as_mut(), field::COMMAND, value);
    }

    /// Sets [`target_system`](Self::target_system).
    pub fn set_target_system(&mut self, value: u8) {
        bytes::put_le(self.0.as_mut(), field::TARGET_SYSTEM, value);
    }

    /// Sets [`target_component`](Self::target_component).
    pub fn set_target_component(&mut self, value: u8) {
        bytes::put_le(self.0.as_mut(), field::TARGET_COMPONENT, value);
    }

    /// Sets [`confirmation`](Self::confirmation).
    pub fn set_confirmation(&mut self, value: u8) {
        bytes::put_le(self.0.as_mut(), field::CONFIRMATION, value);
    }
}

/// A `COMMAND_LONG` payload at full length as plain values.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Repr {
    /// What the parameters of the command say.
    pub params: [f32; 7],
    /// `MAV_CMD`.
    pub command: u16,
    /// Whom it is for: the system id, 0 for any.
    pub target_system: u8,
    /// Whom it is for: the component id, 0 for any.
    pub target_component: u8,
    /// 0 the first time, then counted up.
    pub confirmation: u8,
}

impl Repr {
    /// Reads every field of a view.
    pub fn parse<T: AsRef<[u8]>>(payload: &Payload<T>) -> Self {
        Self {
            params: payload.params(),
            command: payload.command(),
            target_system: payload.target_system(),
            target_component: payload.target_component(),
            confirmation: payload.confirmation(),
        }
    }

    /// Bytes that [`emit`](Self::emit) writes.
    pub const fn buffer_len(&self) -> usize {
        LEN
    }

    /// Writes every field into a view.
    pub fn emit<T: AsRef<[u8]> + AsMut<[u8]>>(&self, payload: &mut Payload<T>) {
        payload.set_params(self.params);
        payload.set_command(self.command);
        payload.set_target_system(self.target_system);
        payload.set_target_component(self.target_component);
        payload.set_confirmation(self.confirmation);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOLDEN: [u8; LEN] = [
        0x00, 0x00, 0xf8, 0x41, 0x00, 0x40, 0x9c, 0x46, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0xbf, 0x00,
        0x00, 0x80, 0x3e, 0x00, 0x00, 0x00, 0x40, 0x00, 0x00, 0x80, 0x3f, 0xff, 0x01, 0x2a, 0x01, 0x03,
    ];

    fn repr() -> Repr {
        Repr {
            params: [31.0, 20000.0, 0.0, -0.5, 0.25, 2.0, 1.0],
            command: 511,
            target_system: 42,
            target_component: 1,
            confirmation: 3,
        }
    }

    #[test]
    fn deconstruct() {
        let payload = Payload::new_checked(&GOLDEN).unwrap();
        assert_eq!(payload.params(), [31.0, 20000.0, 0.0, -0.5, 0.25, 2.0, 1.0]);
        assert_eq!(payload.command(), 511);
        assert_eq!(payload.target_system(), 42);
        assert_eq!(payload.target_component(), 1);
        assert_eq!(payload.confirmation(), 3);
        assert!(Payload::new_checked(&GOLDEN[1..]).is_err());
    }

    #[test]
    fn construct() {
        let mut bytes = [0xff; LEN];
        let mut payload = Payload::new_checked(&mut bytes).unwrap();
        payload.set_params([31.0, 20000.0, 0.0, -0.5, 0.25, 2.0, 1.0]);
        payload.set_command(511);
        payload.set_target_system(42);
        payload.set_target_component(1);
        payload.set_confirmation(3);
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
