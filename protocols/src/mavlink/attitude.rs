//! `ATTITUDE` (30): Euler angles and angular rate of body (FRD) relative to nav (NED).

use core::ops::Range;

use crate::bytes;
use crate::error::Error;

/// The message id.
pub const ID: u32 = 30;

/// What the checksum is seeded with after the bytes: guards against a different field list.
pub const CRC_EXTRA: u8 = 39;

/// Bytes without extension fields: the payload in MAVLink 1.
pub const BASE_LEN: usize = 28;

/// Bytes with extension fields: the payload in MAVLink 2 before trailing zeros are cut.
pub const LEN: usize = 28;

mod field {
    use super::Range;

    pub(super) const TIME_BOOT_MS: Range<usize> = 0..4;
    pub(super) const ROLL: Range<usize> = 4..8;
    pub(super) const PITCH: Range<usize> = 8..12;
    pub(super) const YAW: Range<usize> = 12..16;
    pub(super) const ANGULAR_RATE: Range<usize> = 16..28;
}

/// A view of the payload's bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Payload<T>(T);

impl<T: AsRef<[u8]>> Payload<T> {
    /// Takes `bytes` as a `ATTITUDE` payload at full length.
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

    /// Roll, rad.
    pub fn roll(&self) -> f32 {
        bytes::le(self.0.as_ref(), field::ROLL)
    }

    /// Pitch, rad.
    pub fn pitch(&self) -> f32 {
        bytes::le(self.0.as_ref(), field::PITCH)
    }

    /// Yaw, rad.
    pub fn yaw(&self) -> f32 {
        bytes::le(self.0.as_ref(), field::YAW)
    }

    /// Angular rate about body x, y and z, rad/s.
    pub fn angular_rate(&self) -> [f32; 3] {
        bytes::les(self.0.as_ref(), field::ANGULAR_RATE)
    }
}

impl<T: AsRef<[u8]> + AsMut<[u8]>> Payload<T> {
    /// Sets [`time_boot_ms`](Self::time_boot_ms).
    pub fn set_time_boot_ms(&mut self, value: u32) {
        bytes::put_le(self.0.as_mut(), field::TIME_BOOT_MS, value);
    }

    /// Sets [`roll`](Self::roll).
    pub fn set_roll(&mut self, value: f32) {
        bytes::put_le(self.0.as_mut(), field::ROLL, value);
    }

    /// Sets [`pitch`](Self::pitch).
    pub fn set_pitch(&mut self, value: f32) {
        bytes::put_le(self.0.as_mut(), field::PITCH, value);
    }

    /// Sets [`yaw`](Self::yaw).
    pub fn set_yaw(&mut self, value: f32) {
        bytes::put_le(self.0.as_mut(), field::YAW, value);
    }

    /// Sets [`angular_rate`](Self::angular_rate).
    pub fn set_angular_rate(&mut self, value: [f32; 3]) {
        bytes::put_les(self.0.as_mut(), field::ANGULAR_RATE, value);
    }
}

/// A `ATTITUDE` payload at full length as plain values.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Repr {
    /// Time since boot, ms.
    pub time_boot_ms: u32,
    /// Roll, rad.
    pub roll: f32,
    /// Pitch, rad.
    pub pitch: f32,
    /// Yaw, rad.
    pub yaw: f32,
    /// Angular rate about body x, y and z, rad/s.
    pub angular_rate: [f32; 3],
}

impl Repr {
    /// Reads every field of a view.
    pub fn parse<T: AsRef<[u8]>>(payload: &Payload<T>) -> Self {
        Self {
            time_boot_ms: payload.time_boot_ms(),
            roll: payload.roll(),
            pitch: payload.pitch(),
            yaw: payload.yaw(),
            angular_rate: payload.angular_rate(),
        }
    }

    /// Bytes that [`emit`](Self::emit) writes.
    pub const fn buffer_len(&self) -> usize {
        LEN
    }

    /// Writes every field into a view.
    pub fn emit<T: AsRef<[u8]> + AsMut<[u8]>>(&self, payload: &mut Payload<T>) {
        payload.set_time_boot_ms(self.time_boot_ms);
        payload.set_roll(self.roll);
        payload.set_pitch(self.pitch);
        payload.set_yaw(self.yaw);
        payload.set_angular_rate(self.angular_rate);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOLDEN: [u8; LEN] = [
        0xe8, 0x03, 0x00, 0x00, 0x00, 0x00, 0x00, 0x3f, 0x00, 0x00, 0x80, 0xbe, 0x00, 0x00, 0x40, 0x40, 0x00,
        0x00, 0x00, 0x3e, 0x00, 0x00, 0x80, 0xbf, 0x00, 0x00, 0x00, 0x00,
    ];

    fn repr() -> Repr {
        Repr { time_boot_ms: 1000, roll: 0.5, pitch: -0.25, yaw: 3.0, angular_rate: [0.125, -1.0, 0.0] }
    }

    #[test]
    fn deconstruct() {
        let payload = Payload::new_checked(&GOLDEN).unwrap();
        assert_eq!(payload.time_boot_ms(), 1000);
        assert_eq!(payload.roll(), 0.5);
        assert_eq!(payload.pitch(), -0.25);
        assert_eq!(payload.yaw(), 3.0);
        assert_eq!(payload.angular_rate(), [0.125, -1.0, 0.0]);
        assert!(Payload::new_checked(&GOLDEN[1..]).is_err());
    }

    #[test]
    fn construct() {
        let mut bytes = [0xff; LEN];
        let mut payload = Payload::new_checked(&mut bytes).unwrap();
        payload.set_time_boot_ms(1000);
        payload.set_roll(0.5);
        payload.set_pitch(-0.25);
        payload.set_yaw(3.0);
        payload.set_angular_rate([0.125, -1.0, 0.0]);
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
