//! `HIGHRES_IMU` (105): what an autopilot's own sensors read, in SI units and gauss (body axes, FRD).

use core::ops::Range;

use crate::bytes;
use crate::error::Error;

/// The message id.
pub const ID: u32 = 105;

/// What the checksum is seeded with after the bytes: guards against a different field list.
pub const CRC_EXTRA: u8 = 93;

/// Bytes without extension fields: the payload in MAVLink 1.
pub const BASE_LEN: usize = 62;

/// Bytes with extension fields: the payload in MAVLink 2 before trailing zeros are cut.
pub const LEN: usize = 63;

/// Bits of [`fields_updated`](Payload::fields_updated) for the accelerometer.
pub const ACCEL: u16 = 0x0007;

/// Bits of [`fields_updated`](Payload::fields_updated) for the gyro.
pub const GYRO: u16 = 0x0038;

/// Bits of [`fields_updated`](Payload::fields_updated) for the magnetometer.
pub const MAG: u16 = 0x01c0;

/// Bit of `fields_updated` for the absolute pressure.
pub const ABS_PRESSURE: u16 = 0x0200;

mod field {
    use super::Range;

    pub(super) const TIME_USEC: Range<usize> = 0..8;
    pub(super) const ACCEL: Range<usize> = 8..20;
    pub(super) const GYRO: Range<usize> = 20..32;
    pub(super) const MAG: Range<usize> = 32..44;
    pub(super) const ABS_PRESSURE: Range<usize> = 44..48;
    pub(super) const DIFF_PRESSURE: Range<usize> = 48..52;
    pub(super) const PRESSURE_ALT: Range<usize> = 52..56;
    pub(super) const TEMPERATURE: Range<usize> = 56..60;
    pub(super) const FIELDS_UPDATED: Range<usize> = 60..62;
    pub(super) const ID: Range<usize> = 62..63;
}

/// A view of the payload's bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Payload<T>(T);

impl<T: AsRef<[u8]>> Payload<T> {
    /// Takes `bytes` as a `HIGHRES_IMU` payload at full length.
    ///
    /// # Errors
    /// [`Error::Length`] unless there are exactly [`LEN`] bytes.
    pub fn new_checked(bytes: T) -> Result<Self, Error> {
        Error::check_length(LEN, bytes.as_ref().len())?;
        Ok(Self(bytes))
    }

    /// Time of the sample, µs since boot or since 1970.
    pub fn time_usec(&self) -> u64 {
        bytes::le(self.0.as_ref(), field::TIME_USEC)
    }

    /// Specific force along body x, y and z, m/s²; level at rest is `[0, 0, -9.8]`.
    pub fn accel(&self) -> [f32; 3] {
        bytes::les(self.0.as_ref(), field::ACCEL)
    }

    /// Angular rate about body x, y and z, rad/s.
    pub fn gyro(&self) -> [f32; 3] {
        bytes::les(self.0.as_ref(), field::GYRO)
    }

    /// Magnetic field along body x, y and z, gauss (1 gauss = 100 µT).
    pub fn mag(&self) -> [f32; 3] {
        bytes::les(self.0.as_ref(), field::MAG)
    }

    /// Static pressure, hPa.
    pub fn abs_pressure(&self) -> f32 {
        bytes::le(self.0.as_ref(), field::ABS_PRESSURE)
    }

    /// Dynamic pressure, hPa.
    pub fn diff_pressure(&self) -> f32 {
        bytes::le(self.0.as_ref(), field::DIFF_PRESSURE)
    }

    /// Pressure altitude, m.
    pub fn pressure_alt(&self) -> f32 {
        bytes::le(self.0.as_ref(), field::PRESSURE_ALT)
    }

    /// Temperature, °C.
    pub fn temperature(&self) -> f32 {
        bytes::le(self.0.as_ref(), field::TEMPERATURE)
    }

    /// Which fields are new: an or of [`ACCEL`], [`GYRO`] and [`MAG`], and bits of the others.
    pub fn fields_updated(&self) -> u16 {
        bytes::le(self.0.as_ref(), field::FIELDS_UPDATED)
    }

    /// Extension: which of several sensors, from 0.
    pub fn id(&self) -> u8 {
        bytes::le(self.0.as_ref(), field::ID)
    }
}

impl<T: AsRef<[u8]> + AsMut<[u8]>> Payload<T> {
    /// Sets [`time_usec`](Self::time_usec).
    pub fn set_time_usec(&mut self, value: u64) {
        bytes::put_le(self.0.as_mut(), field::TIME_USEC, value);
    }

    /// Sets [`accel`](Self::accel).
    pub fn set_accel(&mut self, value: [f32; 3]) {
        bytes::put_les(self.0.as_mut(), field::ACCEL, value);
    }

    /// Sets [`gyro`](Self::gyro).
    pub fn set_gyro(&mut self, value: [f32; 3]) {
        bytes::put_les(self.0.as_mut(), field::GYRO, value);
    }

    /// Sets [`mag`](Self::mag).
    pub fn set_mag(&mut self, value: [f32; 3]) {
        bytes::put_les(self.0.as_mut(), field::MAG, value);
    }

    /// Sets [`abs_pressure`](Self::abs_pressure).
    pub fn set_abs_pressure(&mut self, value: f32) {
        bytes::put_le(self.0.as_mut(), field::ABS_PRESSURE, value);
    }

    /// Sets [`diff_pressure`](Self::diff_pressure).
    pub fn set_diff_pressure(&mut self, value: f32) {
        bytes::put_le(self.0.as_mut(), field::DIFF_PRESSURE, value);
    }

    /// Sets [`pressure_alt`](Self::pressure_alt).
    pub fn set_pressure_alt(&mut self, value: f32) {
        bytes::put_le(self.0.as_mut(), field::PRESSURE_ALT, value);
    }

    /// Sets [`temperature`](Self::temperature).
    pub fn set_temperature(&mut self, value: f32) {
        bytes::put_le(self.0.as_mut(), field::TEMPERATURE, value);
    }

    /// Sets [`fields_updated`](Self::fields_updated).
    pub fn set_fields_updated(&mut self, value: u16) {
        bytes::put_le(self.0.as_mut(), field::FIELDS_UPDATED, value);
    }

    /// Sets [`id`](Self::id).
    pub fn set_id(&mut self, value: u8) {
        bytes::put_le(self.0.as_mut(), field::ID, value);
    }
}

/// A `HIGHRES_IMU` payload at full length as plain values.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Repr {
    /// Time of the sample, µs since boot or since 1970.
    pub time_usec: u64,
    /// Specific force along body x, y and z, m/s²; level at rest is `[0, 0, -9.8]`.
    pub accel: [f32; 3],
    /// Angular rate about body x, y and z, rad/s.
    pub gyro: [f32; 3],
    /// Magnetic field along body x, y and z, gauss (1 gauss = 100 µT).
    pub mag: [f32; 3],
    /// Static pressure, hPa.
    pub abs_pressure: f32,
    /// Dynamic pressure, hPa.
    pub diff_pressure: f32,
    /// Pressure altitude, m.
    pub pressure_alt: f32,
    /// Temperature, °C.
    pub temperature: f32,
    /// Which fields are new: an or of [`ACCEL`], [`GYRO`] and [`MAG`], and bits of the others.
    pub fields_updated: u16,
    /// Extension: which of several sensors, from 0.
    pub id: u8,
}

impl Repr {
    /// Reads every field of a view.
    pub fn parse<T: AsRef<[u8]>>(payload: &Payload<T>) -> Self {
        Self {
            time_usec: payload.time_usec(),
            accel: payload.accel(),
            gyro: payload.gyro(),
            mag: payload.mag(),
            abs_pressure: payload.abs_pressure(),
            diff_pressure: payload.diff_pressure(),
            pressure_alt: payload.pressure_alt(),
            temperature: payload.temperature(),
            fields_updated: payload.fields_updated(),
            id: payload.id(),
        }
    }

    /// Bytes that [`emit`](Self::emit) writes.
    pub const fn buffer_len(&self) -> usize {
        LEN
    }

    /// Writes every field into a view.
    pub fn emit<T: AsRef<[u8]> + AsMut<[u8]>>(&self, payload: &mut Payload<T>) {
        payload.set_time_usec(self.time_usec);
        payload.set_accel(self.accel);
        payload.set_gyro(self.gyro);
        payload.set_mag(self.mag);
        payload.set_abs_pressure(self.abs_pressure);
        payload.set_diff_pressure(self.diff_pressure);
        payload.set_pressure_alt(self.pressure_alt);
        payload.set_temperature(self.temperature);
        payload.set_fields_updated(self.fields_updated);
        payload.set_id(self.id);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOLDEN: [u8; LEN] = [
        0xd2, 0x02, 0x96, 0x49, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x3e, 0x00, 0x00, 0x80, 0xbe, 0x00,
        0x00, 0x1c, 0xc1, 0x00, 0x00, 0x00, 0x3f, 0x00, 0x00, 0x80, 0xbe, 0x00, 0x00, 0x00, 0x3e, 0x00, 0x00,
        0x80, 0x3e, 0x00, 0x00, 0x80, 0x3d, 0x00, 0x00, 0x00, 0xbf, 0x00, 0x50, 0x7d, 0x44, 0x00, 0x00, 0x00,
        0x3f, 0x00, 0x00, 0x48, 0xc1, 0x00, 0x00, 0xc8, 0x41, 0xff, 0x1b, 0x01,
    ];

    fn repr() -> Repr {
        Repr {
            time_usec: 1234567890,
            accel: [0.125, -0.25, -9.75],
            gyro: [0.5, -0.25, 0.125],
            mag: [0.25, 0.0625, -0.5],
            abs_pressure: 1013.25,
            diff_pressure: 0.5,
            pressure_alt: -12.5,
            temperature: 25.0,
            fields_updated: 7167,
            id: 1,
        }
    }

    #[test]
    fn deconstruct() {
        let payload = Payload::new_checked(&GOLDEN).unwrap();
        assert_eq!(payload.time_usec(), 1234567890);
        assert_eq!(payload.accel(), [0.125, -0.25, -9.75]);
        assert_eq!(payload.gyro(), [0.5, -0.25, 0.125]);
        assert_eq!(payload.mag(), [0.25, 0.0625, -0.5]);
        assert_eq!(payload.abs_pressure(), 1013.25);
        assert_eq!(payload.diff_pressure(), 0.5);
        assert_eq!(payload.pressure_alt(), -12.5);
        assert_eq!(payload.temperature(), 25.0);
        assert_eq!(payload.fields_updated(), 7167);
        assert_eq!(payload.id(), 1);
        assert!(Payload::new_checked(&GOLDEN[1..]).is_err());
    }

    #[test]
    fn construct() {
        let mut bytes = [0xff; LEN];
        let mut payload = Payload::new_checked(&mut bytes).unwrap();
        payload.set_time_usec(1234567890);
        payload.set_accel([0.125, -0.25, -9.75]);
        payload.set_gyro([0.5, -0.25, 0.125]);
        payload.set_mag([0.25, 0.0625, -0.5]);
        payload.set_abs_pressure(1013.25);
        payload.set_diff_pressure(0.5);
        payload.set_pressure_alt(-12.5);
        payload.set_temperature(25.0);
        payload.set_fields_updated(7167);
        payload.set_id(1);
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
