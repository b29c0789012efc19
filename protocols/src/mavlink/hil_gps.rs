//! `HIL_GPS` (113): the position fix of an emulated vehicle (WGS 84, NED).

use core::ops::Range;

use crate::bytes;
use crate::error::Error;

/// The message id.
pub const ID: u32 = 113;

/// What the checksum is seeded with after the bytes: guards against a different field list.
pub const CRC_EXTRA: u8 = 124;

/// Bytes without extension fields: the payload in MAVLink 1.
pub const BASE_LEN: usize = 36;

/// Bytes with extension fields: the payload in MAVLink 2 before trailing zeros are cut.
pub const LEN: usize = 39;

/// `eph`, `epv`, `vel` or `cog` that is not known.
pub const UNKNOWN: u16 = u16::MAX;

/// `satellites_visible` that is not known.
pub const SATELLITES_UNKNOWN: u8 = u8::MAX;

mod field {
    use super::Range;

    pub(super) const TIME_USEC: Range<usize> = 0..8;
    pub(super) const LAT: Range<usize> = 8..12;
    pub(super) const LON: Range<usize> = 12..16;
    pub(super) const ALT: Range<usize> = 16..20;
    pub(super) const EPH: Range<usize> = 20..22;
    pub(super) const EPV: Range<usize> = 22..24;
    pub(super) const VEL: Range<usize> = 24..26;
    pub(super) const VELOCITY: Range<usize> = 26..32;
    pub(super) const COG: Range<usize> = 32..34;
    pub(super) const FIX_TYPE: Range<usize> = 34..35;
    pub(super) const SATELLITES_VISIBLE: Range<usize> = 35..36;
    pub(super) const ID: Range<usize> = 36..37;
    pub(super) const YAW: Range<usize> = 37..39;
}

/// A view of the payload's bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Payload<T>(T);

impl<T: AsRef<[u8]>> Payload<T> {
    /// Takes `bytes` as a `HIL_GPS` payload at full length.
    ///
    /// # Errors
    /// [`Error::Length`] unless there are exactly [`LEN`] bytes.
    pub fn new_checked(bytes: T) -> Result<Self, Error> {
        Error::check_length(LEN, bytes.as_ref().len())?;
        Ok(Self(bytes))
    }

    /// Time of the fix, µs.
    pub fn time_usec(&self) -> u64 {
        bytes::le(self.0.as_ref(), field::TIME_USEC)
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

    /// Horizontal dilution of precision × 100.
    pub fn eph(&self) -> u16 {
        bytes::le(self.0.as_ref(), field::EPH)
    }

    /// Vertical dilution of precision × 100.
    pub fn epv(&self) -> u16 {
        bytes::le(self.0.as_ref(), field::EPV)
    }

    /// Speed over ground, cm/s.
    pub fn vel(&self) -> u16 {
        bytes::le(self.0.as_ref(), field::VEL)
    }

    /// Velocity north, east and down, cm/s.
    pub fn velocity(&self) -> [i16; 3] {
        bytes::les(self.0.as_ref(), field::VELOCITY)
    }

    /// Course over ground, 0.01 °, 0 to 359.99 °.
    pub fn cog(&self) -> u16 {
        bytes::le(self.0.as_ref(), field::COG)
    }

    /// 0 or 1 no fix, 2 two-dimensional, 3 three-dimensional.
    pub fn fix_type(&self) -> u8 {
        bytes::le(self.0.as_ref(), field::FIX_TYPE)
    }

    /// Satellites in view.
    pub fn satellites_visible(&self) -> u8 {
        bytes::le(self.0.as_ref(), field::SATELLITES_VISIBLE)
    }

    /// Extension: which of several receivers, from 0.
    pub fn id(&self) -> u8 {
        bytes::le(self.0.as_ref(), field::ID)
    }

    /// Extension: heading, 0.01 °; 0 where there is none, 36000 for north.
    pub fn yaw(&self) -> u16 {
        bytes::le(self.0.as_ref(), field::YAW)
    }
}

impl<T: AsRef<[u8]> + AsMut<[u8]>> Payload<T> {
    /// Sets [`time_usec`](Self::time_usec).
    pub fn set_time_usec(&mut self, value: u64) {
        bytes::put_le(self.0.as_mut(), field::TIME_USEC, value);
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

    /// Sets [`eph`](Self::eph).
    pub fn set_eph(&mut self, value: u16) {
        bytes::put_le(self.0.as_mut(), field::EPH, value);
    }

    /// Sets [`epv`](Self::epv).
    pub fn set_epv(&mut self, value: u16) {
        bytes::put_le(self.0.as_mut(), field::EPV, value);
    }

    /// Sets [`vel`](Self::vel).
    pub fn set_vel(&mut self, value: u16) {
        bytes::put_le(self.0.as_mut(), field::VEL, value);
    }

    /// Sets [`velocity`](Self::velocity).
    pub fn set_velocity(&mut self, value: [i16; 3]) {
        bytes::put_les(self.0.as_mut(), field::VELOCITY, value);
    }

    /// Sets [`cog`](Self::cog).
    pub fn set_cog(&mut self, value: u16) {
        bytes::put_le(self.0.as_mut(), field::COG, value);
    }

    /// Sets [`fix_type`](Self::fix_type).
    pub fn set_fix_type(&mut self, value: u8) {
        bytes::put_le(self.0.as_mut(), field::FIX_TYPE, value);
    }

    /// Sets [`satellites_visible`](Self::satellites_visible).
    pub fn set_satellites_visible(&mut self, value: u8) {
        bytes::put_le(self.0.as_mut(), field::SATELLITES_VISIBLE, value);
    }

    /// Sets [`id`](Self::id).
    pub fn set_id(&mut self, value: u8) {
        bytes::put_le(self.0.as_mut(), field::ID, value);
    }

    /// Sets [`yaw`](Self::yaw).
    pub fn set_yaw(&mut self, value: u16) {
        bytes::put_le(self.0.as_mut(), field::YAW, value);
    }
}

/// A `HIL_GPS` payload at full length as plain values.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Repr {
    /// Time of the fix, µs.
    pub time_usec: u64,
    /// Latitude, 10⁻⁷ °.
    pub lat: i32,
    /// Longitude, 10⁻⁷ °.
    pub lon: i32,
    /// Altitude above mean sea level, mm.
    pub alt: i32,
    /// Horizontal dilution of precision × 100.
    pub eph: u16,
    /// Vertical dilution of precision × 100.
    pub epv: u16,
    /// Speed over ground, cm/s.
    pub vel: u16,
    /// Velocity north, east and down, cm/s.
    pub velocity: [i16; 3],
    /// Course over ground, 0.01 °, 0 to 359.99 °.
    pub cog: u16,
    /// 0 or 1 no fix, 2 two-dimensional, 3 three-dimensional.
    pub fix_type: u8,
    /// Satellites in view.
    pub satellites_visible: u8,
    /// Extension: which of several receivers, from 0.
    pub id: u8,
    /// Extension: heading, 0.01 °; 0 where there is none, 36000 for north.
    pub yaw: u16,
}

impl Repr {
    /// Reads every field of a view.
    pub fn parse<T: AsRef<[u8]>>(payload: &Payload<T>) -> Self {
        Self {
            time_usec: payload.time_usec(),
            lat: payload.lat(),
            lon: payload.lon(),
            alt: payload.alt(),
            eph: payload.eph(),
            epv: payload.epv(),
            vel: payload.vel(),
            velocity: payload.velocity(),
            cog: payload.cog(),
            fix_type: payload.fix_type(),
            satellites_visible: payload.satellites_visible(),
            id: payload.id(),
            yaw: payload.yaw(),
        }
    }

    /// Bytes that [`emit`](Self::emit) writes.
    pub const fn buffer_len(&self) -> usize {
        LEN
    }

    /// Writes every field into a view.
    pub fn emit<T: AsRef<[u8]> + AsMut<[u8]>>(&self, payload: &mut Payload<T>) {
        payload.set_time_usec(self.time_usec);
        payload.set_lat(self.lat);
        payload.set_lon(self.lon);
        payload.set_alt(self.alt);
        payload.set_eph(self.eph);
        payload.set_epv(self.epv);
        payload.set_vel(self.vel);
        payload.set_velocity(self.velocity);
        payload.set_cog(self.cog);
        payload.set_fix_type(self.fix_type);
        payload.set_satellites_visible(self.satellites_visible);
        payload.set_id(self.id);
        payload.set_yaw(self.yaw);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOLDEN: [u8; LEN] = [
        0xd2, 0x02, 0x96, 0x49, 0x00, 0x00, 0x00, 0x00, 0x98, 0x3f, 0xb9, 0x23, 0x28, 0x3b, 0xeb, 0xed, 0xd4,
        0x30, 0x00, 0x00, 0x46, 0x00, 0x78, 0x00, 0xdc, 0x05, 0xb0, 0x04, 0x7c, 0xfc, 0xce, 0xff, 0x39, 0x7e,
        0x03, 0x0e, 0x01, 0xa0, 0x8c,
    ];

    fn repr() -> Repr {
        Repr {
            time_usec: 1234567890,
            lat: 599343000,
            lon: -303351000,
            alt: 12500,
            eph: 70,
            epv: 120,
            vel: 1500,
            velocity: [1200, -900, -50],
            cog: 32313,
            fix_type: 3,
            satellites_visible: 14,
            id: 1,
            yaw: 36000,
        }
    }

    #[test]
    fn deconstruct() {
        let payload = Payload::new_checked(&GOLDEN).unwrap();
        assert_eq!(payload.time_usec(), 1234567890);
        assert_eq!(payload.lat(), 599343000);
        assert_eq!(payload.lon(), -303351000);
        assert_eq!(payload.alt(), 12500);
        assert_eq!(payload.eph(), 70);
        assert_eq!(payload.epv(), 120);
        assert_eq!(payload.vel(), 1500);
        assert_eq!(payload.velocity(), [1200, -900, -50]);
        assert_eq!(payload.cog(), 32313);
        assert_eq!(payload.fix_type(), 3);
        assert_eq!(payload.satellites_visible(), 14);
        assert_eq!(payload.id(), 1);
        assert_eq!(payload.yaw(), 36000);
        assert!(Payload::new_checked(&GOLDEN[1..]).is_err());
    }

    #[test]
    fn construct() {
        let mut bytes = [0xff; LEN];
        let mut payload = Payload::new_checked(&mut bytes).unwrap();
        payload.set_time_usec(1234567890);
        payload.set_lat(599343000);
        payload.set_lon(-303351000);
        payload.set_alt(12500);
        payload.set_eph(70);
        payload.set_epv(120);
        payload.set_vel(1500);
        payload.set_velocity([1200, -900, -50]);
        payload.set_cog(32313);
        payload.set_fix_type(3);
        payload.set_satellites_visible(14);
        payload.set_id(1);
        payload.set_yaw(36000);
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
