//! `HIL_STATE_QUATERNION` (115): the true state of an emulated vehicle (body FRD, nav NED).

use core::ops::Range;

use crate::bytes;
use crate::error::Error;

/// The message id.
pub const ID: u32 = 115;

/// What the checksum is seeded with after the bytes: guards against a different field list.
pub const CRC_EXTRA: u8 = 4;

/// Bytes without extension fields: the payload in MAVLink 1.
pub const BASE_LEN: usize = 64;

/// Bytes with extension fields: the payload in MAVLink 2 before trailing zeros are cut.
pub const LEN: usize = 64;

mod field {
    use super::Range;

    pub(super) const TIME_USEC: Range<usize> = 0..8;
    pub(super) const Q: Range<usize> = 8..24;
    pub(super) const ANGULAR_RATE: Range<usize> = 24..36;
    pub(super) const LAT: Range<usize> = 36..40;
    pub(super) const LON: Range<usize> = 40..44;
    pub(super) const ALT: Range<usize> = 44..48;
    pub(super) const VELOCITY: Range<usize> = 48..54;
    pub(super) const IND_AIRSPEED: Range<usize> = 54..56;
    pub(super) const TRUE_AIRSPEED: Range<usize> = 56..58;
    pub(super) const ACCEL: Range<usize> = 58..64;
}

/// A view of the payload's bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Payload<T>(T);

impl<T: AsRef<[u8]>> Payload<T> {
    /// Takes `bytes` as a `HIL_STATE_QUATERNION` payload at full length.
    ///
    /// # Errors
    /// [`Error::Length`] unless there are exactly [`LEN`] bytes.
    pub fn new_checked(bytes: T) -> Result<Self, Error> {
        Error::check_length(LEN, bytes.as_ref().len())?;
        Ok(Self(bytes))
    }

    /// Time of the state, µs.
    pub fn time_usec(&self) -> u64 {
        bytes::le(self.0.as_ref(), field::TIME_USEC)
    }

    /// Attitude `w, x, y, z`: takes vectors in body axes (FRD) to nav (NED), unit norm.
    pub fn q(&self) -> [f32; 4] {
        bytes::les(self.0.as_ref(), field::Q)
    }

    /// Angular rate about body x, y and z, rad/s.
    pub fn angular_rate(&self) -> [f32; 3] {
        bytes::les(self.0.as_ref(), field::ANGULAR_RATE)
    }

    /// Latitude, 10⁻⁷ °.
    pub fn lat(&self) -> i32 {
        bytes::le(self.0.as_ref(), field::LAT)
    }

    /// Longitude, 10⁻⁷ °.
    pub fn lon(&self) -> i32 {
        bytes::le(self.0.as_ref(), field::LON)
    }

    /// Altitude above mean sea level, mm.
    pub fn alt(&self) -> i32 {
        bytes::le(self.0.as_ref(), field::ALT)
    }

    /// Velocity north, east and down, cm/s.
    pub fn velocity(&self) -> [i16; 3] {
        bytes::les(self.0.as_ref(), field::VELOCITY)
    }

    /// Indicated airspeed, cm/s.
    pub fn ind_airspeed(&self) -> u16 {
        bytes::le(self.0.as_ref(), field::IND_AIRSPEED)
    }

    /// True airspeed, cm/s.
    pub fn true_airspeed(&self) -> u16 {
        bytes::le(self.0.as_ref(), field::TRUE_AIRSPEED)
    }

    /// Specific force along body x, y and z, mg (9.80665 mm/s²).
    pub fn accel(&self) -> [i16; 3] {
        bytes::les(self.0.as_ref(), field::ACCEL)
    }
}

impl<T: AsRef<[u8]> + AsMut<[u8]>> Payload<T> {
    /// Sets [`time_usec`](Self::time_usec).
    pub fn set_time_usec(&mut self, value: u64) {
        bytes::put_le(self.0.as_mut(), field::TIME_USEC, value);
    }

    /// Sets [`q`](Self::q).
    pub fn set_q(&mut self, value: [f32; 4]) {
        bytes::put_les(self.0.as_mut(), field::Q, value);
    }

    /// Sets [`angular_rate`](Self::angular_rate).
    pub fn set_angular_rate(&mut self, value: [f32; 3]) {
        bytes::put_les(self.0.as_mut(), field::ANGULAR_RATE, value);
    }

    /// Sets [`lat`](Self::lat).
    pub fn set_lat(&mut self, value: i32) {
        bytes::put_le(self.0.as_mut(), field::LAT, value);
    }

    /// Sets [`lon`](Self::lon).
    pub fn set_lon(&mut self, value: i32) {
        bytes::put_le(self.0.as_mut(), field::LON, value);
    }

    /// Sets [`alt`](Self::alt).
    pub fn set_alt(&mut self, value: i32) {
        bytes::put_le(self.0.as_mut(), field::ALT, value);
    }

    /// Sets [`velocity`](Self::velocity).
    pub fn set_velocity(&mut self, value: [i16; 3]) {
        bytes::put_les(self.0.as_mut(), field::VELOCITY, value);
    }

    /// Sets [`ind_airspeed`](Self::ind_airspeed).
    pub fn set_ind_airspeed(&mut self, value: u16) {
        bytes::put_le(self.0.as_mut(), field::IND_AIRSPEED, value);
    }

    /// Sets [`true_airspeed`](Self::true_airspeed).
    pub fn set_true_airspeed(&mut self, value: u16) {
        bytes::put_le(self.0.as_mut(), field::TRUE_AIRSPEED, value);
    }

    /// Sets [`accel`](Self::accel).
    pub fn set_accel(&mut self, value: [i16; 3]) {
        bytes::put_les(self.0.as_mut(), field::ACCEL, value);
    }
}

/// A `HIL_STATE_QUATERNION` payload at full length as plain values.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Repr {
    /// Time of the state, µs.
    pub time_usec: u64,
    /// Attitude `w, x, y, z`: takes vectors in body axes (FRD) to nav (NED), unit norm.
    pub q: [f32; 4],
    /// Angular rate about body x, y and z, rad/s.
    pub angular_rate: [f32; 3],
    /// Latitude, 10⁻⁷ °.
    pub lat: i32,
    /// Longitude, 10⁻⁷ °.
    pub lon: i32,
    /// Altitude above mean sea level, mm.
    pub alt: i32,
    /// Velocity north, east and down, cm/s.
    pub velocity: [i16; 3],
    /// Indicated airspeed, cm/s.
    pub ind_airspeed: u16,
    /// True airspeed, cm/s.
    pub true_airspeed: u16,
    /// Specific force along body x, y and z, mg (9.80665 mm/s²).
    pub accel: [i16; 3],
}

impl Repr {
    /// Reads every field of a view.
    pub fn parse<T: AsRef<[u8]>>(payload: &Payload<T>) -> Self {
        Self {
            time_usec: payload.time_usec(),
            q: payload.q(),
            angular_rate: payload.angular_rate(),
            lat: payload.lat(),
            lon: payload.lon(),
            alt: payload.alt(),
            velocity: payload.velocity(),
            ind_airspeed: payload.ind_airspeed(),
            true_airspeed: payload.true_airspeed(),
            accel: payload.accel(),
        }
    }

    /// Bytes that [`emit`](Self::emit) writes.
    pub const fn buffer_len(&self) -> usize {
        LEN
    }

    /// Writes every field into a view.
    pub fn emit<T: AsRef<[u8]> + AsMut<[u8]>>(&self, payload: &mut Payload<T>) {
        payload.set_time_usec(self.time_usec);
        payload.set_q(self.q);
        payload.set_angular_rate(self.angular_rate);
        payload.set_lat(self.lat);
        payload.set_lon(self.lon);
        payload.set_alt(self.alt);
        payload.set_velocity(self.velocity);
        payload.set_ind_airspeed(self.ind_airspeed);
        payload.set_true_airspeed(self.true_airspeed);
        payload.set_accel(self.accel);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOLDEN: [u8; LEN] = [
        0xd2, 0x02, 0x96, 0x49, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x3f, 0x00, 0x00, 0x00, 0xbf, 0x00,
        0x00, 0x00, 0x3f, 0x00, 0x00, 0x00, 0x3f, 0x00, 0x00, 0x00, 0x3e, 0x00, 0x00, 0x80, 0xbf, 0x00, 0x00,
        0x00, 0x40, 0x98, 0x3f, 0xb9, 0x23, 0x28, 0x3b, 0xeb, 0xed, 0xd4, 0x30, 0x00, 0x00, 0xb0, 0x04, 0x7c,
        0xfc, 0xce, 0xff, 0xaa, 0x05, 0xdc, 0x05, 0x01, 0x00, 0xfe, 0xff, 0x18, 0xfc,
    ];

    fn repr() -> Repr {
        Repr {
            time_usec: 1234567890,
            q: [0.5, -0.5, 0.5, 0.5],
            angular_rate: [0.125, -1.0, 2.0],
            lat: 599343000,
            lon: -303351000,
            alt: 12500,
            velocity: [1200, -900, -50],
            ind_airspeed: 1450,
            true_airspeed: 1500,
            accel: [1, -2, -1000],
        }
    }

    #[test]
    fn deconstruct() {
        let payload = Payload::new_checked(&GOLDEN).unwrap();
        assert_eq!(payload.time_usec(), 1234567890);
        assert_eq!(payload.q(), [0.5, -0.5, 0.5, 0.5]);
        assert_eq!(payload.angular_rate(), [0.125, -1.0, 2.0]);
        assert_eq!(payload.lat(), 599343000);
        assert_eq!(payload.lon(), -303351000);
        assert_eq!(payload.alt(), 12500);
        assert_eq!(payload.velocity(), [1200, -900, -50]);
        assert_eq!(payload.ind_airspeed(), 1450);
        assert_eq!(payload.true_airspeed(), 1500);
        assert_eq!(payload.accel(), [1, -2, -1000]);
        assert!(Payload::new_checked(&GOLDEN[1..]).is_err());
    }

    #[test]
    fn construct() {
        let mut bytes = [0xff; LEN];
        let mut payload = Payload::new_checked(&mut bytes).unwrap();
        payload.set_time_usec(1234567890);
        payload.set_q([0.5, -0.5, 0.5, 0.5]);
        payload.set_angular_rate([0.125, -1.0, 2.0]);
        payload.set_lat(599343000);
        payload.set_lon(-303351000);
        payload.set_alt(12500);
        payload.set_velocity([1200, -900, -50]);
        payload.set_ind_airspeed(1450);
        payload.set_true_airspeed(1500);
        payload.set_accel([1, -2, -1000]);
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
