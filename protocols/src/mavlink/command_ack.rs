//! `COMMAND_ACK` (77): what became of a command.

use core::ops::Range;

use crate::bytes;
use crate::error::Error;

/// The message id.
pub const ID: u32 = 77;

/// What the checksum is seeded with after the bytes: guards against a different field list.
pub const CRC_EXTRA: u8 = 143;

/// Bytes without extension fields: the payload in MAVLink 1.
pub const BASE_LEN: usize = 3;

/// Bytes with extension fields: the payload in MAVLink 2 before trailing zeros are cut.
pub const LEN: usize = 10;

/// `result`: done.
pub const ACCEPTED: u8 = 0;

/// `result`: not now, ask again.
pub const TEMPORARILY_REJECTED: u8 = 1;

/// `result`: being done.
pub const IN_PROGRESS: u8 = 5;

mod field {
    use super::Range;

    pub(super) const COMMAND: Range<usize> = 0..2;
    pub(super) const RESULT: Range<usize> = 2..3;
    pub(super) const PROGRESS: Range<usize> = 3..4;
    pub(super) const RESULT_PARAM2: Range<usize> = 4..8;
    pub(super) const TARGET_SYSTEM: Range<usize> = 8..9;
    pub(super) const TARGET_COMPONENT: Range<usize> = 9..10;
}

/// A view of the payload's bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Payload<T>(T);

impl<T: AsRef<[u8]>> Payload<T> {
    /// Takes `bytes` as a `COMMAND_ACK` payload at full length.
    ///
    /// # Errors
    /// [`Error::Length`] unless there are exactly [`LEN`] bytes.
    pub fn new_checked(bytes: T) -> Result<Self, Error> {
        Error::check_length(LEN, bytes.as_ref().len())?;
        Ok(Self(bytes))
    }

    /// `MAV_CMD` of the command.
    pub fn command(&self) -> u16 {
        bytes::le(self.0.as_ref(), field::COMMAND)
    }

    /// `MAV_RESULT`: [`ACCEPTED`], [`TEMPORARILY_REJECTED`], 2 denied, 3 unsupported, 4 failed, [`IN_PROGRESS`].
    pub fn result(&self) -> u8 {
        bytes::le(self.0.as_ref(), field::RESULT)
    }

    /// Extension: how far it is, percent.
    pub fn progress(&self) -> u8 {
        bytes::le(self.0.as_ref(), field::PROGRESS)
    }

    /// Extension: more about the result.
    pub fn result_param2(&self) -> i32 {
        bytes::le(self.0.as_ref(), field::RESULT_PARAM2)
    }

    /// Extension: whom it is for: the system id, 0 for any.
    pub fn target_system(&self) -> u8 {
        bytes::le(self.0.as_ref(), field::TARGET_SYSTEM)
    }

    /// Extension: whom it is for: the component id, 0 for any.
    pub fn target_component(&self) -> u8 {
        bytes::le(self.0.as_ref(), field::TARGET_COMPONENT)
    }
}

impl<T: AsRef<[u8]> + AsMut<[u8]>> Payload<T> {
    /// Sets [`command`](Self::command).
    pub fn set_command(&mut self, value: u16) {
        bytes::put_le(self.0.as_mut(), field::COMMAND, value);
    }

    /// Sets [`result`](Self::result).
    pub fn set_result(&mut self, value: u8) {
        bytes::put_le(self.0.as_mut(), field::RESULT, value);
    }

    /// Sets [`progress`](Self::progress).
    pub fn set_progress(&mut self, value: u8) {
        bytes::put_le(self.0.as_mut(), field::PROGRESS, value);
    }

    /// Sets [`result_param2`](Self::result_param2).
    pub fn set_result_param2(&mut self, value: i32) {
        bytes::put_le(self.0.as_mut(), field::RESULT_PARAM2, value);
    }

    /// Sets [`target_system`](Self::target_system).
    pub fn set_target_system(&mut self, value: u8) {
        bytes::put_le(self.0.as_mut(), field::TARGET_SYSTEM, value);
    }

    /// Sets [`target_component`](Self::target_component).
    pub fn set_target_component(&mut self, value: u8) {
        bytes::put_le(self.0.as_mut(), field::TARGET_COMPONENT, value);
    }
}

/// A `COMMAND_ACK` payload at full length as plain values.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Repr {
    /// `MAV_CMD` of the command.
    pub command: u16,
    /// `MAV_RESULT`: [`ACCEPTED`], [`TEMPORARILY_REJECTED`], 2 denied, 3 unsupported, 4 failed, [`IN_PROGRESS`].
    pub result: u8,
    /// Extension: how far it is, percent.
    pub progress: u8,
    /// Extension: more about the result.
    pub result_param2: i32,
    /// Extension: whom it is for: the system id, 0 for any.
    pub target_system: u8,
    /// Extension: whom it is for: the component id, 0 for any.
    pub target_component: u8,
}

impl Repr {
    /// Reads every field of a view.
    pub fn parse<T: AsRef<[u8]>>(payload: &Payload<T>) -> Self {
        Self {
            command: payload.command(),
            result: payload.result(),
            progress: payload.progress(),
            result_param2: payload.result_param2(),
            target_system: payload.target_system(),
            target_component: payload.target_component(),
        }
    }

    /// Bytes that [`emit`](Self::emit) writes.
    pub const fn buffer_len(&self) -> usize {
        LEN
    }

    /// Writes every field into a view.
    pub fn emit<T: AsRef<[u8]> + AsMut<[u8]>>(&self, payload: &mut Payload<T>) {
        payload.set_command(self.command);
        payload.set_result(self.result);
        payload.set_progress(self.progress);
        payload.set_result_param2(self.result_param2);
        payload.set_target_system(self.target_system);
        payload.set_target_component(self.target_component);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOLDEN: [u8; LEN] = [0xff, 0x01, 0x03, 0x4d, 0x90, 0xee, 0xfe, 0xff, 0x2a, 0x01];

    fn repr() -> Repr {
        Repr {
            command: 511,
            result: 3,
            progress: 77,
            result_param2: -70000,
            target_system: 42,
            target_component: 1,
        }
    }

    #[test]
    fn deconstruct() {
        let payload = Payload::new_checked(&GOLDEN).unwrap();
        assert_eq!(payload.command(), 511);
        assert_eq!(payload.result(), 3);
        assert_eq!(payload.progress(), 77);
        assert_eq!(payload.result_param2(), -70000);
        assert_eq!(payload.target_system(), 42);
        assert_eq!(payload.target_component(), 1);
        assert!(Payload::new_checked(&GOLDEN[1..]).is_err());
    }

    #[test]
    fn construct() {
        let mut bytes = [0xff; LEN];
        let mut payload = Payload::new_checked(&mut bytes).unwrap();
        payload.set_command(511);
        payload.set_result(3);
        payload.set_progress(77);
        payload.set_result_param2(-70000);
        payload.set_target_system(42);
        payload.set_target_component(1);
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
