//! `PARAM_REQUEST_READ` (20): asks for one parameter, answered by [`PARAM_VALUE`](super::param_value).

use core::ops::Range;

use crate::bytes;
use crate::error::Error;

/// The message id.
pub const ID: u32 = 20;

/// What the checksum is seeded with after the bytes: guards against a different field list.
pub const CRC_EXTRA: u8 = 214;

/// Bytes without extension fields: the payload in MAVLink 1.
pub const BASE_LEN: usize = 20;

/// Bytes with extension fields: the payload in MAVLink 2 before trailing zeros are cut.
pub const LEN: usize = 20;

mod field {
    use super::Range;

    pub(super) const PARAM_INDEX: Range<usize> = 0..2;
    pub(super) const TARGET_SYSTEM: Range<usize> = 2..3;
    pub(super) const TARGET_COMPONENT: Range<usize> = 3..4;
    pub(super) const PARAM_ID: Range<usize> = 4..20;
}

/// A view of the payload's bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Payload<T>(T);

impl<T: AsRef<[u8]>> Payload<T> {
    /// Takes `bytes` as a `PARAM_REQUEST_READ` payload at full length.
    ///
    /// # Errors
    /// [`Error::Length`] unless there are exactly [`LEN`] bytes.
    pub fn new_checked(bytes: T) -> Result<Self, Error> {
        Error::check_length(LEN, bytes.as_ref().len())?;
        Ok(Self(bytes))
    }

    /// Which one by its index; −1 to go by `param_id`.
    pub fn param_index(&self) -> i16 {
        bytes::le(self.0.as_ref(), field::PARAM_INDEX)
    }

    /// Whom it is for: the system id, 0 for any.
    pub fn target_system(&self) -> u8 {
        bytes::le(self.0.as_ref(), field::TARGET_SYSTEM)
    }

    /// Whom it is for: the component id, 0 for any.
    pub fn target_component(&self) -> u8 {
        bytes::le(self.0.as_ref(), field::TARGET_COMPONENT)
    }

    /// Its name, ended by a zero where it is shorter: [`param_id`](super::param_id).
    pub fn param_id(&self) -> [u8; 16] {
        bytes::les(self.0.as_ref(), field::PARAM_ID)
    }
}

impl<T: AsRef<[u8]> + AsMut<[u8]>> Payload<T> {
    /// Sets [`param_index`](Self::param_index).
    pub fn set_param_index(&mut self, value: i16) {
        bytes::put_le(self.0.as_mut(), field::PARAM_INDEX, value);
    }

    /// Sets [`target_system`](Self::target_system).
    pub fn set_target_system(&mut self, value: u8) {
        bytes::put_le(self.0.as_mut(), field::TARGET_SYSTEM, value);
    }

    /// Sets [`target_component`](Self::target_component).
    pub fn set_target_component(&mut self, value: u8) {
        bytes::put_le(self.0.as_mut(), field::TARGET_COMPONENT, value);
    }

    /// Sets [`param_id`](Self::param_id).
    pub fn set_param_id(&mut self, value: [u8; 16]) {
        bytes::put_les(self.0.as_mut(), field::PARAM_ID, value);
    }
}

/// A `PARAM_REQUEST_READ` payload at full length as plain values.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Repr {
    /// Which one by its index; −1 to go by `param_id`.
    pub param_index: i16,
    /// Whom it is for: the system id, 0 for any.
    pub target_system: u8,
    /// Whom it is for: the component id, 0 for any.
    pub target_component: u8,
    /// Its name, ended by a zero where it is shorter: [`param_id`](super::param_id).
    pub param_id: [u8; 16],
}

impl Repr {
    /// Reads every field of a view.
    pub fn parse<T: AsRef<[u8]>>(payload: &Payload<T>) -> Self {
        Self {
            param_index: payload.param_index(),
            target_system: payload.target_system(),
            target_component: payload.target_component(),
            param_id: payload.param_id(),
        }
    }

    /// Bytes that [`emit`](Self::emit) writes.
    pub const fn buffer_len(&self) -> usize {
        LEN
    }

    /// Writes every field into a view.
    pub fn emit<T: AsRef<[u8]> + AsMut<[u8]>>(&self, payload: &mut Payload<T>) {
        payload.set_param_index(self.param_index);
        payload.set_target_system(self.target_system);
        payload.set_target_component(self.target_component);
        payload.set_param_id(self.param_id);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOLDEN: [u8; LEN] = [
        0xff, 0xff, 0x2a, 0x01, 0x4d, 0x41, 0x56, 0x5f, 0x30, 0x5f, 0x52, 0x41, 0x54, 0x45, 0x00, 0x00, 0x00,
        0x00, 0x00, 0x00,
    ];

    fn repr() -> Repr {
        Repr { param_index: -1, target_system: 42, target_component: 1, param_id: *b"MAV_0_RATE\0\0\0\0\0\0" }
    }

    #[test]
    fn deconstruct() {
        let payload = Payload::new_checked(&GOLDEN).unwrap();
        assert_eq!(payload.param_index(), -1);
        assert_eq!(payload.target_system(), 42);
        assert_eq!(payload.target_component(), 1);
        assert_eq!(payload.param_id(), *b"MAV_0_RATE\0\0\0\0\0\0");
        assert!(Payload::new_checked(&GOLDEN[1..]).is_err());
    }

    #[test]
    fn construct() {
        let mut bytes = [0xff; LEN];
        let mut payload = Payload::new_checked(&mut bytes).unwrap();
        payload.set_param_index(-1);
        payload.set_target_system(42);
        payload.set_target_component(1);
        payload.set_param_id(*b"MAV_0_RATE\0\0\0\0\0\0");
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
