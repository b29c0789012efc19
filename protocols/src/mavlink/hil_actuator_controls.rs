//! `HIL_ACTUATOR_CONTROLS` (93): what an autopilot tells a simulated vehicle to do; in lockstep, that it took the readings in.

use core::ops::Range;

use crate::bytes;
use crate::error::Error;

/// The message id.
pub const ID: u32 = 93;

/// What the checksum is seeded with after the bytes: guards against a different field list.
pub const CRC_EXTRA: u8 = 47;

/// Bytes without extension fields: the payload in MAVLink 1.
pub const BASE_LEN: usize = 81;

/// Bytes with extension fields: the payload in MAVLink 2 before trailing zeros are cut.
pub const LEN: usize = 81;

/// Bit of `flags`: simulation in lockstep.
pub const LOCKSTEP: u64 = 1;

mod field {
    use super::Range;

    pub(super) const TIME_USEC: Range<usize> = 0..8;
    pub(super) const FLAGS: Range<usize> = 8..16;
    pub(super) const CONTROLS: Range<usize> = 16..80;
    pub(super) const MODE: Range<usize> = 80..81;
}

/// A view of the payload's bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Payload<T>(T);

impl<T: AsRef<[u8]>> Payload<T> {
    /// Takes `bytes` as a `HIL_ACTUATOR_CONTROLS` payload at full length.
    ///
    /// # Errors
    /// [`Error::Length`] unless there are exactly [`LEN`] bytes.
    pub fn new_checked(bytes: T) -> Result<Self, Error> {
        Error::check_length(LEN, bytes.as_ref().len())?;
        Ok(Self(bytes))
    }

    /// Its own time, µs.
    pub fn time_usec(&self) -> u64 {
        bytes::le(self.0.as_ref(), field::TIME_USEC)
    }

    /// [`LOCKSTEP`].
    pub fn flags(&self) -> u64 {
        bytes::le(self.0.as_ref(), field::FLAGS)
    }

    /// Outputs, −1 to 1.
    pub fn controls(&self) -> [f32; 16] {
        bytes::les(self.0.as_ref(), field::CONTROLS)
    }

    /// `MAV_MODE_FLAG`, as in its heartbeat.
    pub fn mode(&self) -> u8 {
        bytes::le(self.0.as_ref(), field::MODE)
    }
}

impl<T: AsRef<[u8]> + AsMut<[u8]>> Payload<T> {
    /// Sets [`time_usec`](Self::time_usec).
    pub fn set_time_usec(&mut self, value: u64) {
        bytes::put_le(self.0.as_mut(), field::TIME_USEC, value);
    }

    /// Sets [`flags`](Self::flags).
    pub fn set_flags(&mut self, value: u64) {
        bytes::put_le(self.0.as_mut(), field::FLAGS, value);
    }

    /// Sets [`controls`](Self::controls).
    pub fn set_controls(&mut self, value: [f32; 16]) {
        bytes::put_les(self.0.as_mut(), field::CONTROLS, value);
    }

    /// Sets [`mode`](Self::mode).
    pub fn set_mode(&mut self, value: u8) {
        bytes::put_le(self.0.as_mut(), field::MODE, value);
    }
}

/// A `HIL_ACTUATOR_CONTROLS` payload at full length as plain values.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Repr {
    /// Its own time, µs.
    pub time_usec: u64,
    /// [`LOCKSTEP`].
    pub flags: u64,
    /// Outputs, −1 to 1.
    pub controls: [f32; 16],
    /// `MAV_MODE_FLAG`, as in its heartbeat.
    pub mode: u8,
}

impl Repr {
    /// Reads every field of a view.
    pub fn parse<T: AsRef<[u8]>>(payload: &Payload<T>) -> Self {
        Self {
            time_usec: payload.time_usec(),
            flags: payload.flags(),
            controls: payload.controls(),
            mode: payload.mode(),
        }
    }

    /// Bytes that [`emit`](Self::emit) writes.
    pub const fn buffer_len(&self) -> usize {
        LEN
    }

    /// Writes every field into a view.
    pub fn emit<T: AsRef<[u8]> + AsMut<[u8]>>(&self, payload: &mut Payload<T>) {
        payload.set_time_usec(self.time_usec);
        payload.set_flags(self.flags);
        payload.set_controls(self.controls);
        payload.set_mode(self.mode);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOLDEN: [u8; LEN] = [
        0xd2, 0x02, 0x96, 0x49, 0x00, 0x00, 0x00, 0x00, 0x01, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,
        0x00, 0x00, 0x3f, 0x00, 0x00, 0x00, 0xbf, 0x00, 0x00, 0x80, 0x3e, 0x00, 0x00, 0x80, 0x3f, 0x00, 0x00,
        0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,
        0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,
        0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x3e, 0xa1,
    ];

    fn repr() -> Repr {
        Repr {
            time_usec: 1234567890,
            flags: 1,
            controls: [0.5, -0.5, 0.25, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.125],
            mode: 161,
        }
    }

    #[test]
    fn deconstruct() {
        let payload = Payload::new_checked(&GOLDEN).unwrap();
        assert_eq!(payload.time_usec(), 1234567890);
        assert_eq!(payload.flags(), 1);
        assert_eq!(
            payload.controls(),
            [0.5, -0.5, 0.25, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.125]
        );
        assert_eq!(payload.mode(), 161);
        assert!(Payload::new_checked(&GOLDEN[1..]).is_err());
    }

    #[test]
    fn construct() {
        let mut bytes = [0xff; LEN];
        let mut payload = Payload::new_checked(&mut bytes).unwrap();
        payload.set_time_usec(1234567890);
        payload.set_flags(1);
        payload.set_controls([
            0.5, -0.5, 0.25, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.125,
        ]);
        payload.set_mode(161);
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
