//! `HEARTBEAT` (0): who is there, once a second.

use core::ops::Range;

use crate::bytes;
use crate::error::Error;

/// The message id.
pub const ID: u32 = 0;

/// What the checksum is seeded with after the bytes: guards against a different field list.
pub const CRC_EXTRA: u8 = 50;

/// Bytes without extension fields: the payload in MAVLink 1.
pub const BASE_LEN: usize = 9;

/// Bytes with extension fields: the payload in MAVLink 2 before trailing zeros are cut.
pub const LEN: usize = 9;

mod field {
    use super::Range;

    pub(super) const CUSTOM_MODE: Range<usize> = 0..4;
    pub(super) const KIND: Range<usize> = 4..5;
    pub(super) const AUTOPILOT: Range<usize> = 5..6;
    pub(super) const BASE_MODE: Range<usize> = 6..7;
    pub(super) const SYSTEM_STATUS: Range<usize> = 7..8;
    pub(super) const MAVLINK_VERSION: Range<usize> = 8..9;
}

/// A view of the payload's bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Payload<T>(T);

impl<T: AsRef<[u8]>> Payload<T> {
    /// Takes `bytes` as a `HEARTBEAT` payload at full length.
    ///
    /// # Errors
    /// [`Error::Length`] unless there are exactly [`LEN`] bytes.
    pub fn new_checked(bytes: T) -> Result<Self, Error> {
        Error::check_length(LEN, bytes.as_ref().len())?;
        Ok(Self(bytes))
    }

    /// Mode bits of the autopilot's own.
    pub fn custom_mode(&self) -> u32 {
        bytes::le(self.0.as_ref(), field::CUSTOM_MODE)
    }

    /// `MAV_TYPE` (the field `type`): 0 generic, 2 quadrotor.
    pub fn kind(&self) -> u8 {
        bytes::le(self.0.as_ref(), field::KIND)
    }

    /// `MAV_AUTOPILOT`: 8 not an autopilot, 12 PX4, 3 ArduPilot.
    pub fn autopilot(&self) -> u8 {
        bytes::le(self.0.as_ref(), field::AUTOPILOT)
    }

    /// `MAV_MODE_FLAG`: bit 5 (0x20) is hardware in the loop.
    pub fn base_mode(&self) -> u8 {
        bytes::le(self.0.as_ref(), field::BASE_MODE)
    }

    /// `MAV_STATE`: 4 is active.
    pub fn system_status(&self) -> u8 {
        bytes::le(self.0.as_ref(), field::SYSTEM_STATUS)
    }

    /// Always 3.
    pub fn mavlink_version(&self) -> u8 {
        bytes::le(self.0.as_ref(), field::MAVLINK_VERSION)
    }
}

impl<T: AsRef<[u8]> + AsMut<[u8]>> Payload<T> {
    /// Sets [`custom_mode`](Self::custom_mode).
    pub fn set_custom_mode(&mut self, value: u32) {
        bytes::put_le(self.0.as_mut(), field::CUSTOM_MODE, value);
    }

    /// Sets [`kind`](Self::kind).
    pub fn set_kind(&mut self, value: u8) {
        bytes::put_le(self.0.as_mut(), field::KIND, value);
    }

    /// Sets [`autopilot`](Self::autopilot).
    pub fn set_autopilot(&mut self, value: u8) {
        bytes::put_le(self.0.as_mut(), field::AUTOPILOT, value);
    }

    /// Sets [`base_mode`](Self::base_mode).
    pub fn set_base_mode(&mut self, value: u8) {
        bytes::put_le(self.0.as_mut(), field::BASE_MODE, value);
    }

    /// Sets [`system_status`](Self::system_status).
    pub fn set_system_status(&mut self, value: u8) {
        bytes::put_le(self.0.as_mut(), field::SYSTEM_STATUS, value);
    }

    /// Sets [`mavlink_version`](Self::mavlink_version).
    pub fn set_mavlink_version(&mut self, value: u8) {
        bytes::put_le(self.0.as_mut(), field::MAVLINK_VERSION, value);
    }
}

/// A `HEARTBEAT` payload at full length as plain values.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Repr {
    /// Mode bits of the autopilot's own.
    pub custom_mode: u32,
    /// `MAV_TYPE` (the field `type`): 0 generic, 2 quadrotor.
    pub kind: u8,
    /// `MAV_AUTOPILOT`: 8 not an autopilot, 12 PX4, 3 ArduPilot.
    pub autopilot: u8,
    /// `MAV_MODE_FLAG`: bit 5 (0x20) is hardware in the loop.
    pub base_mode: u8,
    /// `MAV_STATE`: 4 is active.
    pub system_status: u8,
    /// Always 3.
    pub mavlink_version: u8,
}

impl Repr {
    /// Reads every field of a view.
    pub fn parse<T: AsRef<[u8]>>(payload: &Payload<T>) -> Self {
        Self {
            custom_mode: payload.custom_mode(),
            kind: payload.kind(),
            autopilot: payload.autopilot(),
            base_mode: payload.base_mode(),
            system_status: payload.system_status(),
            mavlink_version: payload.mavlink_version(),
        }
    }

    /// Bytes that [`emit`](Self::emit) writes.
    pub const fn buffer_len(&self) -> usize {
        LEN
    }

    /// Writes every field into a view.
    pub fn emit<T: AsRef<[u8]> + AsMut<[u8]>>(&self, payload: &mut Payload<T>) {
        payload.set_custom_mode(self.custom_mode);
        payload.set_kind(self.kind);
        payload.set_autopilot(self.autopilot);
        payload.set_base_mode(self.base_mode);
        payload.set_system_status(self.system_status);
        payload.set_mavlink_version(self.mavlink_version);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOLDEN: [u8; LEN] = [0x04, 0x03, 0x02, 0x01, 0x02, 0x0c, 0x20, 0x04, 0x03];

    fn repr() -> Repr {
        Repr {
            custom_mode: 16909060,
            kind: 2,
            autopilot: 12,
            base_mode: 32,
            system_status: 4,
            mavlink_version: 3,
        }
    }

    #[test]
    fn deconstruct() {
        let payload = Payload::new_checked(&GOLDEN).unwrap();
        assert_eq!(payload.custom_mode(), 16909060);
        assert_eq!(payload.kind(), 2);
        assert_eq!(payload.autopilot(), 12);
        assert_eq!(payload.base_mode(), 32);
        assert_eq!(payload.system_status(), 4);
        assert_eq!(payload.mavlink_version(), 3);
        assert!(Payload::new_checked(&GOLDEN[1..]).is_err());
    }

    #[test]
    fn construct() {
        let mut bytes = [0xff; LEN];
        let mut payload = Payload::new_checked(&mut bytes).unwrap();
        payload.set_custom_mode(16909060);
        payload.set_kind(2);
        payload.set_autopilot(12);
        payload.set_base_mode(32);
        payload.set_system_status(4);
        payload.set_mavlink_version(3);
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
