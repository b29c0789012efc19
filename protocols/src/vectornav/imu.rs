//! Binary output 1: what the inertial sensors read.
//!
//! Common group with TimeStartup, AngularRate, Accel, Imu and MagPres. Axes are forward, right, down.

use core::ops::Range;

use crate::bytes;
use crate::error::Error;

/// What follows the synchronisation byte: which groups of outputs there are, and which outputs of each.
pub const GROUPS: &[u8] = &[0x01, 0x21, 0x07];

/// Bytes of payload.
pub const LEN: usize = 76;

mod field {
    use super::Range;

    pub(super) const TIME_NS: Range<usize> = 0..8;
    pub(super) const GYRO: Range<usize> = 8..20;
    pub(super) const ACCEL: Range<usize> = 20..32;
    pub(super) const RAW_ACCEL: Range<usize> = 32..44;
    pub(super) const RAW_GYRO: Range<usize> = 44..56;
    pub(super) const MAG: Range<usize> = 56..68;
    pub(super) const TEMPERATURE: Range<usize> = 68..72;
    pub(super) const PRESSURE: Range<usize> = 72..76;
}

/// A view of the payload's bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Payload<T>(T);

impl<T: AsRef<[u8]>> Payload<T> {
    /// Takes `bytes` as the payload of an `imu` packet.
    ///
    /// # Errors
    /// [`Error::Length`] unless there are exactly [`LEN`] bytes.
    pub fn new_checked(bytes: T) -> Result<Self, Error> {
        Error::check_length(LEN, bytes.as_ref().len())?;
        Ok(Self(bytes))
    }

    /// Time since the unit started, ns.
    pub fn time_ns(&self) -> u64 {
        bytes::le(self.0.as_ref(), field::TIME_NS)
    }

    /// Angular rate, rad/s.
    pub fn gyro(&self) -> [f32; 3] {
        bytes::les(self.0.as_ref(), field::GYRO)
    }

    /// Specific force, m/s²: level at rest is 0, 0, -9.8.
    pub fn accel(&self) -> [f32; 3] {
        bytes::les(self.0.as_ref(), field::ACCEL)
    }

    /// Specific force before the unit's own compensation, m/s².
    pub fn raw_accel(&self) -> [f32; 3] {
        bytes::les(self.0.as_ref(), field::RAW_ACCEL)
    }

    /// Angular rate before the unit's own compensation, rad/s.
    pub fn raw_gyro(&self) -> [f32; 3] {
        bytes::les(self.0.as_ref(), field::RAW_GYRO)
    }

    /// Magnetic field, gauss.
    pub fn mag(&self) -> [f32; 3] {
        bytes::les(self.0.as_ref(), field::MAG)
    }

    /// Temperature, °C.
    pub fn temperature(&self) -> f32 {
        bytes::le(self.0.as_ref(), field::TEMPERATURE)
    }

    /// Pressure, kPa.
    pub fn pressure(&self) -> f32 {
        bytes::le(self.0.as_ref(), field::PRESSURE)
    }
}

impl<T: AsRef<[u8]> + AsMut<[u8]>> Payload<T> {
    /// Sets [`time_ns`](Self::time_ns).
    pub fn set_time_ns(&mut self, value: u64) {
        bytes::put_le(self.0.as_mut(), field::TIME_NS, value);
    }

    /// Sets [`gyro`](Self::gyro).
    pub fn set_gyro(&mut self, value: [f32; 3]) {
        bytes::put_les(self.0.as_mut(), field::GYRO, value);
    }

    /// Sets [`accel`](Self::accel).
    pub fn set_accel(&mut self, value: [f32; 3]) {
        bytes::put_les(self.0.as_mut(), field::ACCEL, value);
    }

    /// Sets [`raw_accel`](Self::raw_accel).
    pub fn set_raw_accel(&mut self, value: [f32; 3]) {
        bytes::put_les(self.0.as_mut(), field::RAW_ACCEL, value);
    }

    /// Sets [`raw_gyro`](Self::raw_gyro).
    pub fn set_raw_gyro(&mut self, value: [f32; 3]) {
        bytes::put_les(self.0.as_mut(), field::RAW_GYRO, value);
    }

    /// Sets [`mag`](Self::mag).
    pub fn set_mag(&mut self, value: [f32; 3]) {
        bytes::put_les(self.0.as_mut(), field::MAG, value);
    }

    /// Sets [`temperature`](Self::temperature).
    pub fn set_temperature(&mut self, value: f32) {
        bytes::put_le(self.0.as_mut(), field::TEMPERATURE, value);
    }

    /// Sets [`pressure`](Self::pressure).
    pub fn set_pressure(&mut self, value: f32) {
        bytes::put_le(self.0.as_mut(), field::PRESSURE, value);
    }
}

/// The payload of an `imu` packet as plain values.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Repr {
    /// Time since the unit started, ns.
    pub time_ns: u64,
    /// Angular rate, rad/s.
    pub gyro: [f32; 3],
    /// Specific force, m/s²: level at rest is 0, 0, -9.8.
    pub accel: [f32; 3],
    /// Specific force before the unit's own compensation, m/s².
    pub raw_accel: [f32; 3],
    /// Angular rate before the unit's own compensation, rad/s.
    pub raw_gyro: [f32; 3],
    /// Magnetic field, gauss.
    pub mag: [f32; 3],
    /// Temperature, °C.
    pub temperature: f32,
    /// Pressure, kPa.
    pub pressure: f32,
}

impl Repr {
    /// Reads every field of a view.
    pub fn parse<T: AsRef<[u8]>>(payload: &Payload<T>) -> Self {
        Self {
            time_ns: payload.time_ns(),
            gyro: payload.gyro(),
            accel: payload.accel(),
            raw_accel: payload.raw_accel(),
            raw_gyro: payload.raw_gyro(),
            mag: payload.mag(),
            temperature: payload.temperature(),
            pressure: payload.pressure(),
        }
    }

    /// Bytes that [`emit`](Self::emit) writes.
    pub const fn buffer_len(&self) -> usize {
        LEN
    }

    /// Writes every field into a view.
    pub fn emit<T: AsRef<[u8]> + AsMut<[u8]>>(&self, payload: &mut Payload<T>) {
        payload.set_time_ns(self.time_ns);
        payload.set_gyro(self.gyro);
        payload.set_accel(self.accel);
        payload.set_raw_accel(self.raw_accel);
        payload.set_raw_gyro(self.raw_gyro);
        payload.set_mag(self.mag);
        payload.set_temperature(self.temperature);
        payload.set_pressure(self.pressure);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOLDEN: [u8; LEN] = [
        0x00, 0xca, 0x9a, 0x3b, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x3e, 0x00, 0x00, 0x80, 0xbe, 0x00,
        0x00, 0x00, 0x3f, 0x00, 0x00, 0x00, 0x3f, 0x00, 0x00, 0x80, 0xbe, 0x00, 0x00, 0x1c, 0xc1, 0x00, 0x00,
        0x00, 0x3f, 0x00, 0x00, 0x80, 0xbe, 0x00, 0x00, 0x1c, 0xc1, 0x00, 0x00, 0x00, 0x3e, 0x00, 0x00, 0x80,
        0xbe, 0x00, 0x00, 0x00, 0x3f, 0x00, 0x00, 0x80, 0x3e, 0x00, 0x00, 0x80, 0x3d, 0x00, 0x00, 0x00, 0xbf,
        0x00, 0x00, 0xc8, 0x41, 0x00, 0x00, 0xbd, 0x42,
    ];

    fn repr() -> Repr {
        Repr {
            time_ns: 1000000000,
            gyro: [0.125, -0.25, 0.5],
            accel: [0.5, -0.25, -9.75],
            raw_accel: [0.5, -0.25, -9.75],
            raw_gyro: [0.125, -0.25, 0.5],
            mag: [0.25, 0.0625, -0.5],
            temperature: 25.0,
            pressure: 94.5,
        }
    }

    #[test]
    fn deconstruct() {
        let payload = Payload::new_checked(&GOLDEN).unwrap();
        assert_eq!(payload.time_ns(), 1000000000);
        assert_eq!(payload.gyro(), [0.125, -0.25, 0.5]);
        assert_eq!(payload.accel(), [0.5, -0.25, -9.75]);
        assert_eq!(payload.raw_accel(), [0.5, -0.25, -9.75]);
        assert_eq!(payload.raw_gyro(), [0.125, -0.25, 0.5]);
        assert_eq!(payload.mag(), [0.25, 0.0625, -0.5]);
        assert_eq!(payload.temperature(), 25.0);
        assert_eq!(payload.pressure(), 94.5);
        assert!(Payload::new_checked(&GOLDEN[1..]).is_err());
    }

    #[test]
    fn construct() {
        let mut bytes = [0xff; LEN];
        let mut payload = Payload::new_checked(&mut bytes).unwrap();
        payload.set_time_ns(1000000000);
        payload.set_gyro([0.125, -0.25, 0.5]);
        payload.set_accel([0.5, -0.25, -9.75]);
        payload.set_raw_accel([0.5, -0.25, -9.75]);
        payload.set_raw_gyro([0.125, -0.25, 0.5]);
        payload.set_mag([0.25, 0.0625, -0.5]);
        payload.set_temperature(25.0);
        payload.set_pressure(94.5);
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
