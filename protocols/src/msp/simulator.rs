//! Command 0x201F, to the firmware: what the emulated vehicle's sensors read.
//!
//! INAV takes it in place of its own sensors while bit 0 of `flags` is set, and has no time-out: what
//! comes last stays. Axes are forward, left, up.

use core::ops::Range;

use crate::bytes;
use crate::error::Error;
use crate::msp::Direction;

/// The command on the wire.
pub const COMMAND: u16 = 0x201f;

/// Which way it goes.
pub const DIRECTION: Direction = Direction::Request;

/// The layout that this file describes.
pub const VERSION: u8 = 2;

/// Bit of `flags`: take these readings in place of the sensors' own.
pub const ENABLE: u8 = 1 << 0;

/// Bit of `flags`: pretend a full battery.
pub const BATTERY: u8 = 1 << 1;

/// Bit of `flags`: keep the beeper quiet.
pub const MUTE: u8 = 1 << 2;

/// Bit of `flags`: estimate the attitude from these readings; without it `attitude` is taken.
pub const OWN_ESTIMATE: u8 = 1 << 3;

/// Bit of `flags`: the position is new.
pub const NEW_POSITION: u8 = 1 << 4;

/// `pressure` where there is no barometer: the standard atmosphere at sea level, Pa.
pub const SEA_LEVEL: i32 = 101_325;

/// Bytes of payload.
pub const LEN: usize = 54;

mod field {
    use super::Range;

    pub(super) const VERSION: Range<usize> = 0..1;
    pub(super) const FLAGS: Range<usize> = 1..2;
    pub(super) const FIX: Range<usize> = 2..3;
    pub(super) const SATELLITES: Range<usize> = 3..4;
    pub(super) const LATITUDE: Range<usize> = 4..8;
    pub(super) const LONGITUDE: Range<usize> = 8..12;
    pub(super) const ALTITUDE: Range<usize> = 12..16;
    pub(super) const GROUND_SPEED: Range<usize> = 16..18;
    pub(super) const COURSE: Range<usize> = 18..20;
    pub(super) const VELOCITY: Range<usize> = 20..26;
    pub(super) const ATTITUDE: Range<usize> = 26..32;
    pub(super) const ACCEL: Range<usize> = 32..38;
    pub(super) const GYRO: Range<usize> = 38..44;
    pub(super) const PRESSURE: Range<usize> = 44..48;
    pub(super) const MAG: Range<usize> = 48..54;
}

/// A view of the payload's bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Payload<T>(T);

impl<T: AsRef<[u8]>> Payload<T> {
    /// Takes `bytes` as the payload of a `simulator` request.
    ///
    /// # Errors
    /// [`Error::Length`] unless there are exactly [`LEN`] bytes.
    pub fn new_checked(bytes: T) -> Result<Self, Error> {
        Error::check_length(LEN, bytes.as_ref().len())?;
        Ok(Self(bytes))
    }

    /// Of the layout: [`VERSION`].
    pub fn version(&self) -> u8 {
        bytes::le(self.0.as_ref(), field::VERSION)
    }

    /// What the firmware is to do, [`ENABLE`] and so on.
    pub fn flags(&self) -> u8 {
        bytes::le(self.0.as_ref(), field::FLAGS)
    }

    /// Of the satellite receiver: 0 none, 1 in the plane, 2 in space.
    pub fn fix(&self) -> u8 {
        bytes::le(self.0.as_ref(), field::FIX)
    }

    /// Satellites in use.
    pub fn satellites(&self) -> u8 {
        bytes::le(self.0.as_ref(), field::SATELLITES)
    }

    /// Latitude, 10⁻⁷ degrees, north positive.
    pub fn latitude(&self) -> i32 {
        bytes::le(self.0.as_ref(), field::LATITUDE)
    }

    /// Longitude, 10⁻⁷ degrees, east positive.
    pub fn longitude(&self) -> i32 {
        bytes::le(self.0.as_ref(), field::LONGITUDE)
    }

    /// Altitude above the sea, cm.
    pub fn altitude(&self) -> i32 {
        bytes::le(self.0.as_ref(), field::ALTITUDE)
    }

    /// Speed over ground, cm/s.
    pub fn ground_speed(&self) -> u16 {
        bytes::le(self.0.as_ref(), field::GROUND_SPEED)
    }

    /// Course over ground, 0.1 degrees, clockwise from true north.
    pub fn course(&self) -> u16 {
        bytes::le(self.0.as_ref(), field::COURSE)
    }

    /// Velocity north, east and down, cm/s.
    pub fn velocity(&self) -> [i16; 3] {
        bytes::les(self.0.as_ref(), field::VELOCITY)
    }

    /// Roll, pitch (nose down positive) and yaw, 0.1 degrees; used only without [`OWN_ESTIMATE`].
    pub fn attitude(&self) -> [i16; 3] {
        bytes::les(self.0.as_ref(), field::ATTITUDE)
    }

    /// Specific force forward, left and up, mg: level at rest is 0, 0, 1000.
    pub fn accel(&self) -> [i16; 3] {
        bytes::les(self.0.as_ref(), field::ACCEL)
    }

    /// Angular rate about forward, left and up, 1/16 deg/s.
    pub fn gyro(&self) -> [i16; 3] {
        bytes::les(self.0.as_ref(), field::GYRO)
    }

    /// Barometer, Pa.
    pub fn pressure(&self) -> i32 {
        bytes::le(self.0.as_ref(), field::PRESSURE)
    }

    /// Magnetic field forward, left and up. Only its direction counts: INAV wants a length near 20480, and
    /// no declination.
    pub fn mag(&self) -> [i16; 3] {
        bytes::les(self.0.as_ref(), field::MAG)
    }
}

impl<T: AsRef<[u8]> + AsMut<[u8]>> Payload<T> {
    /// Sets [`version`](Self::version).
    pub fn set_version(&mut self, value: u8) {
        bytes::put_le(self.0.as_mut(), field::VERSION, value);
    }

    /// Sets [`flags`](Self::flags).
    pub fn set_flags(&mut self, value: u8) {
        bytes::put_le(self.0.as_mut(), field::FLAGS, value);
    }

    /// Sets [`fix`](Self::fix).
    pub fn set_fix(&mut self, value: u8) {
        bytes::put_le(self.0.as_mut(), field::FIX, value);
    }

    /// Sets [`satellites`](Self::satellites).
    pub fn set_satellites(&mut self, value: u8) {
        bytes::put_le(self.0.as_mut(), field::SATELLITES, value);
    }

    /// Sets [`latitude`](Self::latitude).
    pub fn set_latitude(&mut self, value: i32) {
        bytes::put_le(self.0.as_mut(), field::LATITUDE, value);
    }

    /// Sets [`longitude`](Self::longitude).
    pub fn set_longitude(&mut self, value: i32) {
        bytes::put_le(self.0.as_mut(), field::LONGITUDE, value);
    }

    /// Sets [`altitude`](Self::altitude).
    pub fn set_altitude(&mut self, value: i32) {
        bytes::put_le(self.0.as_mut(), field::ALTITUDE, value);
    }

    /// Sets [`ground_speed`](Self::ground_speed).
    pub fn set_ground_speed(&mut self, value: u16) {
        bytes::put_le(self.0.as_mut(), field::GROUND_SPEED, value);
    }

    /// Sets [`course`](Self::course).
    pub fn set_course(&mut self, value: u16) {
        bytes::put_le(self.0.as_mut(), field::COURSE, value);
    }

    /// Sets [`velocity`](Self::velocity).
    pub fn set_velocity(&mut self, value: [i16; 3]) {
        bytes::put_les(self.0.as_mut(), field::VELOCITY, value);
    }

    /// Sets [`attitude`](Self::attitude).
    pub fn set_attitude(&mut self, value: [i16; 3]) {
        bytes::put_les(self.0.as_mut(), field::ATTITUDE, value);
    }

    /// Sets [`accel`](Self::accel).
    pub fn set_accel(&mut self, value: [i16; 3]) {
        bytes::put_les(self.0.as_mut(), field::ACCEL, value);
    }

    /// Sets [`gyro`](Self::gyro).
    pub fn set_gyro(&mut self, value: [i16; 3]) {
        bytes::put_les(self.0.as_mut(), field::GYRO, value);
    }

    /// Sets [`pressure`](Self::pressure).
    pub fn set_pressure(&mut self, value: i32) {
        bytes::put_le(self.0.as_mut(), field::PRESSURE, value);
    }

    /// Sets [`mag`](Self::mag).
    pub fn set_mag(&mut self, value: [i16; 3]) {
        bytes::put_les(self.0.as_mut(), field::MAG, value);
    }
}

/// The payload of a `simulator` request as plain values.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Repr {
    /// Of the layout: [`VERSION`].
    pub version: u8,
    /// What the firmware is to do, [`ENABLE`] and so on.
    pub flags: u8,
    /// Of the satellite receiver: 0 none, 1 in the plane, 2 in space.
    pub fix: u8,
    /// Satellites in use.
    pub satellites: u8,
    /// Latitude, 10⁻⁷ degrees, north positive.
    pub latitude: i32,
    /// Longitude, 10⁻⁷ degrees, east positive.
    pub longitude: i32,
    /// Altitude above the sea, cm.
    pub altitude: i32,
    /// Speed over ground, cm/s.
    pub ground_speed: u16,
    /// Course over ground, 0.1 degrees, clockwise from true north.
    pub course: u16,
    /// Velocity north, east and down, cm/s.
    pub velocity: [i16; 3],
    /// Roll, pitch (nose down positive) and yaw, 0.1 degrees; used only without [`OWN_ESTIMATE`].
    pub attitude: [i16; 3],
    /// Specific force forward, left and up, mg: level at rest is 0, 0, 1000.
    pub accel: [i16; 3],
    /// Angular rate about forward, left and up, 1/16 deg/s.
    pub gyro: [i16; 3],
    /// Barometer, Pa.
    pub pressure: i32,
    /// Magnetic field forward, left and up. Only its direction counts: INAV wants a length near 20480, and
    /// no declination.
    pub mag: [i16; 3],
}

impl Repr {
    /// Reads every field of a view.
    pub fn parse<T: AsRef<[u8]>>(payload: &Payload<T>) -> Self {
        Self {
            version: payload.version(),
            flags: payload.flags(),
            fix: payload.fix(),
            satellites: payload.satellites(),
            latitude: payload.latitude(),
            longitude: payload.longitude(),
            altitude: payload.altitude(),
            ground_speed: payload.ground_speed(),
            course: payload.course(),
            velocity: payload.velocity(),
            attitude: payload.attitude(),
            accel: payload.accel(),
            gyro: payload.gyro(),
            pressure: payload.pressure(),
            mag: payload.mag(),
        }
    }

    /// Bytes that [`emit`](Self::emit) writes.
    pub const fn buffer_len(&self) -> usize {
        LEN
    }

    /// Writes every field into a view.
    pub fn emit<T: AsRef<[u8]> + AsMut<[u8]>>(&self, payload: &mut Payload<T>) {
        payload.set_version(self.version);
        payload.set_flags(self.flags);
        payload.set_fix(self.fix);
        payload.set_satellites(self.satellites);
        payload.set_latitude(self.latitude);
        payload.set_longitude(self.longitude);
        payload.set_altitude(self.altitude);
        payload.set_ground_speed(self.ground_speed);
        payload.set_course(self.course);
        payload.set_velocity(self.velocity);
        payload.set_attitude(self.attitude);
        payload.set_accel(self.accel);
        payload.set_gyro(self.gyro);
        payload.set_pressure(self.pressure);
        payload.set_mag(self.mag);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOLDEN: [u8; LEN] = [
        0x02, 0x1f, 0x02, 0x0c, 0xa0, 0x97, 0xb8, 0x23, 0xa0, 0x0f, 0xef, 0xed, 0x39, 0x30, 0x00, 0x00, 0xdc,
        0x05, 0x8c, 0x0a, 0x00, 0x00, 0x24, 0xfa, 0x19, 0x00, 0x2c, 0x01, 0x9c, 0xff, 0x84, 0x03, 0xae, 0x00,
        0xec, 0x01, 0x55, 0x03, 0x10, 0x00, 0xe0, 0xff, 0xd0, 0xff, 0xcd, 0x8b, 0x01, 0x00, 0xf8, 0xf8, 0xf3,
        0x86, 0xe9, 0xb0,
    ];

    fn repr() -> Repr {
        Repr {
            version: 2,
            flags: 31,
            fix: 2,
            satellites: 12,
            latitude: 599300000,
            longitude: -303100000,
            altitude: 12345,
            ground_speed: 1500,
            course: 2700,
            velocity: [0, -1500, 25],
            attitude: [300, -100, 900],
            accel: [174, 492, 853],
            gyro: [16, -32, -48],
            pressure: 101325,
            mag: [-1800, -30989, -20247],
        }
    }

    #[test]
    fn deconstruct() {
        let payload = Payload::new_checked(&GOLDEN).unwrap();
        assert_eq!(payload.version(), 2);
        assert_eq!(payload.flags(), 31);
        assert_eq!(payload.fix(), 2);
        assert_eq!(payload.satellites(), 12);
        assert_eq!(payload.latitude(), 599300000);
        assert_eq!(payload.longitude(), -303100000);
        assert_eq!(payload.altitude(), 12345);
        assert_eq!(payload.ground_speed(), 1500);
        assert_eq!(payload.course(), 2700);
        assert_eq!(payload.velocity(), [0, -1500, 25]);
        assert_eq!(payload.attitude(), [300, -100, 900]);
        assert_eq!(payload.accel(), [174, 492, 853]);
        assert_eq!(payload.gyro(), [16, -32, -48]);
        assert_eq!(payload.pressure(), 101325);
        assert_eq!(payload.mag(), [-1800, -30989, -20247]);
        assert!(Payload::new_checked(&GOLDEN[1..]).is_err());
    }

    #[test]
    fn construct() {
        let mut bytes = [0xff; LEN];
        let mut payload = Payload::new_checked(&mut bytes).unwrap();
        payload.set_version(2);
        payload.set_flags(31);
        payload.set_fix(2);
        payload.set_satellites(12);
        payload.set_latitude(599300000);
        payload.set_longitude(-303100000);
        payload.set_altitude(12345);
        payload.set_ground_speed(1500);
        payload.set_course(2700);
        payload.set_velocity([0, -1500, 25]);
        payload.set_attitude([300, -100, 900]);
        payload.set_accel([174, 492, 853]);
        payload.set_gyro([16, -32, -48]);
        payload.set_pressure(101325);
        payload.set_mag([-1800, -30989, -20247]);
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
