//! Type 01: accelerometer, thermometer and gyro as one burst read of the chip.
//!
//! Registers 0x3B to 0x48 exactly as they lie in the chip: big-endian two's complement, chip axes
//! (z up when the part lies flat). Scales are in the [`config`](super::config) packet.

use core::ops::Range;

use crate::bytes;
use crate::error::Error;

/// The packet type on the wire.
pub const TYPE: u8 = 0x01;

/// Bytes of payload.
pub const LEN: usize = 14;

mod field {
    use super::Range;

    pub(super) const ACCEL: Range<usize> = 0..6;
    pub(super) const TEMPERATURE: Range<usize> = 6..8;
    pub(super) const GYRO: Range<usize> = 8..14;
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

    /// Raw counts along the chip's x, y and z: specific force.
    pub fn accel(&self) -> [i16; 3] {
        bytes::bes(self.0.as_ref(), field::ACCEL)
    }

    /// Raw counts of the die thermometer.
    pub fn temperature(&self) -> i16 {
        bytes::be(self.0.as_ref(), field::TEMPERATURE)
    }

    /// Raw counts about the chip's x, y and z: angular rate.
    pub fn gyro(&self) -> [i16; 3] {
        bytes::bes(self.0.as_ref(), field::GYRO)
    }
}

impl<T: AsRef<[u8]> + AsMut<[u8]>> Payload<T> {
    /// Sets [`accel`](Self::accel).
    pub fn set_accel(&mut self, value: [i16; 3]) {
        bytes::put_bes(self.0.as_mut(), field::ACCEL, value);
    }

    /// Sets [`temperature`](Self::temperature).
    pub fn set_temperature(&mut self, value: i16) {
        bytes::put_be(self.0.as_mut(), field::TEMPERATURE, value);
    }

    /// Sets [`gyro`](Self::gyro).
    pub fn set_gyro(&mut self, value: [i16; 3]) {
        bytes::put_bes(self.0.as_mut(), field::GYRO, value);
    }
}

/// The payload of an `imu` packet as plain values.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Repr {
    /// Raw counts along the chip's x, y and z: specific force.
    pub accel: [i16; 3],
    /// Raw counts of the die thermometer.
    pub temperature: i16,
    /// Raw counts about the chip's x, y and z: angular rate.
    pub gyro: [i16; 3],
}

impl Repr {
    /// Reads every field of a view.
    pub fn parse<T: AsRef<[u8]>>(payload: &Payload<T>) -> Self {
        Self { accel: payload.accel(), temperature: payload.temperature(), gyro: payload.gyro() }
    }

    /// Bytes that [`emit`](Self::emit) writes.
    pub const fn buffer_len(&self) -> usize {
        LEN
    }

    /// Writes every field into a view.
    pub fn emit<T: AsRef<[u8]> + AsMut<[u8]>>(&self, payload: &mut Payload<T>) {
        payload.set_accel(self.accel);
        payload.set_temperature(self.temperature);
        payload.set_gyro(self.gyro);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOLDEN: [u8; LEN] =
        [0xc0, 0x00, 0x04, 0xd2, 0x3f, 0xff, 0xfd, 0xf7, 0x00, 0x83, 0xfe, 0xfa, 0x7f, 0xff];

    fn repr() -> Repr {
        Repr { accel: [-16384, 1234, 16383], temperature: -521, gyro: [131, -262, 32767] }
    }

    #[test]
    fn deconstruct() {
        let payload = Payload::new_checked(&GOLDEN).unwrap();
        assert_eq!(payload.accel(), [-16384, 1234, 16383]);
        assert_eq!(payload.temperature(), -521);
        assert_eq!(payload.gyro(), [131, -262, 32767]);
        assert!(Payload::new_checked(&GOLDEN[1..]).is_err());
    }

    #[test]
    fn construct() {
        let mut bytes = [0xff; LEN];
        let mut payload = Payload::new_checked(&mut bytes).unwrap();
        payload.set_accel([-16384, 1234, 16383]);
        payload.set_temperature(-521);
        payload.set_gyro([131, -262, 32767]);
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
