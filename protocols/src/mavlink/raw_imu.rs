//! `RAW_IMU` (27): an autopilot's first inertial sensor in counts, whose unit the message does not say.

use core::ops::Range;

use crate::bytes;
use crate::error::Error;

/// The message id.
pub const ID: u32 = 27;

/// What the checksum is seeded with after the bytes: guards against a different field list.
pub const CRC_EXTRA: u8 = 144;

/// Bytes without extension fields: the payload in MAVLink 1.
pub const BASE_LEN: usize = 26;

/// Bytes with extension fields: the payload in MAVLink 2 before trailing zeros are cut.
pub const LEN: usize = 29;

mod field {
    use super::Range;

    pub(super) const TIME_USEC: Range<usize> = 0..8;
    pub(super) const ACCEL: Range<usize> = 8..14;
    pub(super) const GYRO: Range<usize> = 14..20;
    pub(super) const MAG: Range<usize> = 20..26;
    pub(super) const ID: Range<usize> = 26..27;
    pub(super) const TEMPERATURE: Range<usize> = 27..29;
}

/// A view of the payload's bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Payload<T>(T);

impl<T: AsRef<[u8]>> Payload<T> {
    /// Takes `bytes` as a `RAW_IMU` payload at full length.
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

    /// Specific force, raw counts.
    pub fn accel(&self) -> [i16; 3] {
        bytes::les(self.0.as_ref(), field::ACCEL)
    }

    /// Angular rate, raw counts.
    pub fn gyro(&self) -> [i16; 3] {
        bytes::les(self.0.as_ref(), field::GYRO)
    }

    /// Magnetic field, raw counts.
    pub fn mag(&self) -> [i16; 3] {
        bytes::les(self.0.as_ref(), field::MAG)
    }

    /// Extension: which of several sensors, from 0.
    pub fn id(&self) -> u8 {
        bytes::le(self.0.as_ref(), field::ID)
    }

    /// Extension: temperature, 0.01 °C; 0 where it is not known.
    pub fn temperature(&self) -> i16 {
        bytes::le(self.0.as_ref(), field::TEMPERATURE)
    }
}

impl<T: AsRef<[u8]> + AsMut<[u8]>> Payload<T> {
    /// Sets [`time_usec`](Self::time_usec).
    pub fn set_time_usec(&mut self, value: u64) {
        bytes::put_le(self.0.as_mut(), field::TIME_USEC, value);
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

    /// Sets [`id`](Self::id).
    pub fn set_id(&mut self, value: u8) {
        bytes::put_le(self.0.as_mut(), field::ID, value);
    }

    /// Sets [`temperature`](Self::temperature).
    pub fn set_temperature(&mut self, value: i16) {
        bytes::put_le(self.0.as_mut(), field::TEMPERATURE, value);
    }
}

/// A `RAW_IMU` payload at full length as plain values.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Repr {
    /// Time of the sample, µs since boot or since 1970.
    pub time_usec: u64,
    /// Specific force, raw counts.
    pub accel: [i16; 3],
    /// Angular rate, raw counts.
    pub gyro: [i16; 3],
    /// Magnetic field, raw counts.
    pub mag: [i16; 3],
    /// Extension: which of several sensors, from 0.
    pub id: u8,
    /// Extension: temperature, 0.01 °C; 0 where it is not known.
    pub temperature: i16,
}

impl Repr {
    /// Reads every field of a view.
    pub fn parse<T: AsRef<[u8]>>(payload: &Payload<T>) -> Self {
        Self {
            time_usec: payload.time_usec(),
            accel: payload.accel(),
            gyro: payload.gyro(),
            mag: payload.mag(),
            id: payload.id(),
            temperature: payload.temperature(),
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
        payload.set_id(self.id);
        payload.set_temperature(self.temperature);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOLDEN: [u8; LEN] = [
        0xd2, 0x02, 0x96, 0x49, 0x00, 0x00, 0x00, 0x00, 0x01, 0x00, 0xfe, 0xff, 0x18, 0xfc, 0x2c, 0x01, 0x70,
        0xfe, 0x05, 0x00, 0xfa, 0x00, 0xc2, 0xff, 0xf4, 0x01, 0x01, 0xd0, 0x09,
    ];

    fn repr() -> Repr {
        Repr {
            time_usec: 1234567890,
            accel: [1, -2, -1000],
            gyro: [300, -400, 5],
            mag: [250, -62, 500],
            id: 1,
            temperature: 2512,
        }
    }

    #[test]
    fn deconstruct() {
        let payload = Payload::new_checked(&GOLDEN).unwrap();
        assert_eq!(payload.time_usec(), 1234567890);
        assert_eq!(payload.accel(), [1, -2, -1000]);
        assert_eq!(payload.gyro(), [300, -400, 5]);
        assert_eq!(payload.mag(), [250, -62, 500]);
        assert_eq!(payload.id(), 1);
        assert_eq!(payload.temperature(), 2512);
        assert!(Payload::new_checked(&GOLDEN[1..]).is_err());
    }

    #[test]
    fn construct() {
        let mut bytes = [0xff; LEN];
        let mut payload = Payload::new_checked(&mut bytes).unwrap();
        payload.set_time_usec(1234567890);
        payload.set_accel([1, -2, -1000]);
        payload.set_gyro([300, -400, 5]);
        payload.set_mag([250, -62, 500]);
        payload.set_id(1);
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
