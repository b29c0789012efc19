//! `SCALED_IMU` (26): an autopilot's first inertial sensor in thousandths of g, rad/s and gauss (body axes, FRD).

use core::ops::Range;

use crate::bytes;
use crate::error::Error;

/// The message id.
pub const ID: u32 = 26;

/// What the checksum is seeded with after the bytes: guards against a different field list.
pub const CRC_EXTRA: u8 = 170;

/// Bytes without extension fields: the payload in MAVLink 1.
pub const BASE_LEN: usize = 22;

/// Bytes with extension fields: the payload in MAVLink 2 before trailing zeros are cut.
pub const LEN: usize = 24;

mod field {
    use super::Range;

    pub(super) const TIME_BOOT_MS: Range<usize> = 0..4;
    pub(super) const ACCEL: Range<usize> = 4..10;
    pub(super) const GYRO: Range<usize> = 10..16;
    pub(super) const MAG: Range<usize> = 16..22;
    pub(super) const TEMPERATURE: Range<usize> = 22..24;
}

/// A view of the payload's bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Payload<T>(T);

impl<T: AsRef<[u8]>> Payload<T> {
    /// Takes `bytes` as the payload of `SCALED_IMU`, 2 or 3 at full length.
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

    /// Specific force along body x, y and z, mg (9.80665 mm/s²).
    pub fn accel(&self) -> [i16; 3] {
        bytes::les(self.0.as_ref(), field::ACCEL)
    }

    /// Angular rate about body x, y and z, mrad/s.
    pub fn gyro(&self) -> [i16; 3] {
        bytes::les(self.0.as_ref(), field::GYRO)
    }

    /// Magnetic field along body x, y and z, mgauss (0.1 µT).
    pub fn mag(&self) -> [i16; 3] {
        bytes::les(self.0.as_ref(), field::MAG)
    }

    /// Extension: temperature, 0.01 °C; 0 where it is not known.
    pub fn temperature(&self) -> i16 {
        bytes::le(self.0.as_ref(), field::TEMPERATURE)
    }
}

impl<T: AsRef<[u8]> + AsMut<[u8]>> Payload<T> {
    /// Sets [`time_boot_ms`](Self::time_boot_ms).
    pub fn set_time_boot_ms(&mut self, value: u32) {
        bytes::put_le(self.0.as_mut(), field::TIME_BOOT_MS, value);
    }

    /// Sets [`accel`](Self::accel).
    pub fn set_accel(&mut self, value: [i16; 3]) {
        bytes::put_les(self.0.as_mut(), field::ACCEL, value);
    }

    /// Sets [`gyro`](Self::gyro).
    pub fn set_gyro(&mut self, value: [i16; 3]) {
        bytes::put_les(self.0.as_mut(), field::GYRO, value);
    }

    /// Sets [`mag`](Self::mag).
    pub fn set_mag(&mut self, value: [i16; 3]) {
        bytes::put_les(self.0.as_mut(), field::MAG, value);
    }

    /// Sets [`temperature`](Self::temperature).
    pub fn set_temperature(&mut self, value: i16) {
        bytes::put_le(self.0.as_mut(), field::TEMPERATURE, value);
    }
}

/// The payload of `SCALED_IMU`, 2 or 3 at full length as plain values.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Repr {
    /// Time since boot, ms.
    pub time_boot_ms: u32,
    /// Specific force along body x, y and z, mg (9.80665 mm/s²).
    pub accel: [i16; 3],
    /// Angular rate about body x, y and z, mrad/s.
    pub gyro: [i16; 3],
    /// Magnetic field along body x, y and z, mgauss (0.1 µT).
    pub mag: [i16; 3],
    /// Extension: temperature, 0.01 °C; 0 where it is not known.
    pub temperature: i16,
}

impl Repr {
    /// Reads every field of a view.
    pub fn parse<T: AsRef<[u8]>>(payload: &Payload<T>) -> Self {
        Self {
            time_boot_ms: payload.time_boot_ms(),
            accel: payload.accel(),
            gyro: payload.gyro(),
            mag: payload.mag(),
            temperature: payload.temperature(),
        }
    }

    /// Bytes that [`emit`](Self::emit) writes.
    pub const fn buffer_len(&self) -> usize {
        LEN
    }

    /// Writes every field into a view.
    pub fn emit<T: AsRef<[u8]> + AsMut<[u8]>>(&self, payload: &mut Payload<T>) {
        payload.set_time_boot_ms(self.time_boot_ms);
        payload.set_accel(self.accel);
        payload.set_gyro(self.gyro);
        payload.set_mag(self.mag);
        payload.set_temperature(self.temperature);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOLDEN: [u8; LEN] = [
        0xcd, 0x81, 0x01, 0x00, 0x01, 0x00, 0xfe, 0xff, 0x18, 0xfc, 0x2c, 0x01, 0x70, 0xfe, 0x05, 0x00, 0xfa,
        0x00, 0xc2, 0xff, 0xf4, 0x01, 0xd0, 0x09,
    ];

    fn repr() -> Repr {
        Repr {
            time_boot_ms: 98765,
            accel: [1, -2, -1000],
            gyro: [300, -400, 5],
            mag: [250, -62, 500],
            temperature: 2512,
        }
    }

    #[test]
    fn deconstruct() {
        let payload = Payload::new_checked(&GOLDEN).unwrap();
        assert_eq!(payload.time_boot_ms(), 98765);
        assert_eq!(payload.accel(), [1, -2, -1000]);
        assert_eq!(payload.gyro(), [300, -400, 5]);
        assert_eq!(payload.mag(), [250, -62, 500]);
        assert_eq!(payload.temperature(), 2512);
        assert!(Payload::new_checked(&GOLDEN[1..]).is_err());
    }

    #[test]
    fn construct() {
        let mut bytes = [0xff; LEN];
        let mut payload = Payload::new_checked(&mut bytes).unwrap();
        payload.set_time_boot_ms(98765);
        payload.set_accel([1, -2, -1000]);
        payload.set_gyro([300, -400, 5]);
        payload.set_mag([250, -62, 500]);
        payload.set_temperature(2512);
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
