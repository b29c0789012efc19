//! `ATTITUDE_QUATERNION` (31): attitude and angular rate of body (FRD) relative to nav (NED).

use core::ops::Range;

use crate::bytes;
use crate::error::Error;

/// The message id.
pub const ID: u32 = 31;

/// What the checksum is seeded with after the bytes: guards against a different field list.
pub const CRC_EXTRA: u8 = 246;

/// Bytes without extension fields: the payload in MAVLink 1.
pub const BASE_LEN: usize = 32;

/// Bytes with extension fields: the payload in MAVLink 2 before trailing zeros are cut.
pub const LEN: usize = 48;

mod field {
    use super::Range;

    pub(super) const TIME_BOOT_MS: Range<usize> = 0..4;
    pub(super) const Q: Range<usize> = 4..20;
    pub(super) const ANGULAR_RATE: Range<usize> = 20..32;
    pub(super) const REPR_OFFSET_Q: Range<usize> = 32..48;
}

/// A view of the payload's bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Payload<T>(T);

impl<T: AsRef<[u8]>> Payload<T> {
    /// Takes `bytes` as a `ATTITUDE_QUATERNION` payload at full length.
    ///
    /// # Errors
    /// [`Error::Length`] unless there are exactly [`LEN`] bytes.
    pub fn new_checked(bytes: T) -> Result<Self, Error> {
        Error::check_length(LEN, bytes.as_ref().len())?;
        Ok(Self(bytes))
    }

    /// Time since boot, ms.
    pub fn time_boot_ms(&self) -> u32 {
        bytes::le(self.0.as_ref(), field::TIME_BOOT_MS)
    }

    /// Attitude `w, x, y, z`: takes vectors in body axes (FRD) to nav (NED), unit norm.
    pub fn q(&self) -> [f32; 4] {
        bytes::les(self.0.as_ref(), field::Q)
    }

    /// Angular rate about body x, y and z, rad/s.
    pub fn angular_rate(&self) -> [f32; 3] {
        bytes::les(self.0.as_ref(), field::ANGULAR_RATE)
    }

    /// Extension: rotation to apply before showing the attitude; all 0 means none.
    pub fn repr_offset_q(&self) -> [f32; 4] {
        bytes::les(self.0.as_ref(), field::REPR_OFFSET_Q)
    }
}

impl<T: AsRef<[u8]> + AsMut<[u8]>> Payload<T> {
    /// Sets [`time_boot_ms`](Self::time_boot_ms).
    pub fn set_time_boot_ms(&mut self, value: u32) {
        bytes::put_le(self.0.as_mut(), field::TIME_BOOT_MS, value);
    }

    /// Sets [`q`](Self::q).
    pub fn set_q(&mut self, value: [f32; 4]) {
        bytes::put_les(self.0.as_mut(), field::Q, value);
    }

    /// Sets [`angular_rate`](Self::angular_rate).
    pub fn set_angular_rate(&mut self, value: [f32; 3]) {
        bytes::put_les(self.0.as_mut(), field::ANGULAR_RATE, value);
    }

    /// Sets [`repr_offset_q`](Self::repr_offset_q).
    pub fn set_repr_offset_q(&mut self, value: [f32; 4]) {
        bytes::put_les(self.0.as_mut(), field::REPR_OFFSET_Q, value);
    }
}

/// A `ATTITUDE_QUATERNION` payload at full length as plain values.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Repr {
    /// Time since boot, ms.
    pub time_boot_ms: u32,
    /// Attitude `w, x, y, z`: takes vectors in body axes (FRD) to nav (NED), unit norm.
    pub q: [f32; 4],
    /// Angular rate about body x, y and z, rad/s.
    pub angular_rate: [f32; 3],
    /// Extension: rotation to apply before showing the attitude; all 0 means none.
    pub repr_offset_q: [f32; 4],
}

impl Repr {
    /// Reads every field of a view.
    pub fn parse<T: AsRef<[u8]>>(payload: &Payload<T>) -> Self {
        Self {
            time_boot_ms: payload.time_boot_ms(),
            q: payload.q(),
            angular_rate: payload.angular_rate(),
            repr_offset_q: payload.repr_offset_q(),
        }
    }

    /// Bytes that [`emit`](Self::emit) writes.
    pub const fn buffer_len(&self) -> usize {
        LEN
    }

    /// Writes every field into a view.
    pub fn emit<T: AsRef<[u8]> + AsMut<[u8]>>(&self, payload: &mut Payload<T>) {
        payload.set_time_boot_ms(self.time_boot_ms);
        payload.set_q(self.q);
        payload.set_angular_rate(self.angular_rate);
        payload.set_repr_offset_q(self.repr_offset_q);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOLDEN: [u8; LEN] = [
        0xc4, 0x09, 0x00, 0x00, 0x00, 0x00, 0x00, 0x3f, 0x00, 0x00, 0x00, 0xbf, 0x00, 0x00, 0x00, 0x3f, 0x00,
        0x00, 0x00, 0x3f, 0x00, 0x00, 0x00, 0x3e, 0x00, 0x00, 0x80, 0xbf, 0x00, 0x00, 0x00, 0x40, 0x00, 0x00,
        0x80, 0x3f, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,
    ];

    fn repr() -> Repr {
        Repr {
            time_boot_ms: 2500,
            q: [0.5, -0.5, 0.5, 0.5],
            angular_rate: [0.125, -1.0, 2.0],
            repr_offset_q: [1.0, 0.0, 0.0, 0.0],
        }
    }

    #[test]
    fn deconstruct() {
        let payload = Payload::new_checked(&GOLDEN).unwrap();
        assert_eq!(payload.time_boot_ms(), 2500);
        assert_eq!(payload.q(), [0.5, -0.5, 0.5, 0.5]);
        assert_eq!(payload.angular_rate(), [0.125, -1.0, 2.0]);
        assert_eq!(payload.repr_offset_q(), [1.0, 0.0, 0.0, 0.0]);
        assert!(Payload::new_checked(&GOLDEN[1..]).is_err());
    }

    #[test]
    fn construct() {
        let mut bytes = [0xff; LEN];
        let mut payload = Payload::new_checked(&mut bytes).unwrap();
        payload.set_time_boot_ms(2500);
        payload.set_q([0.5, -0.5, 0.5, 0.5]);
        payload.set_angular_rate([0.125, -1.0, 2.0]);
        payload.set_repr_offset_q([1.0, 0.0, 0.0, 0.0]);
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
