//! Type 05: the registers that say how to read the others.
//!
//! Sent first on a link and once a second after that, so that a receiver that arrives late learns
//! the scales. A part without a magnetometer has 0 in the last five fields.

use core::ops::Range;

use crate::bytes;
use crate::error::Error;

/// The packet type on the wire.
pub const TYPE: u8 = 0x05;

/// Bytes of payload.
pub const LEN: usize = 10;

mod field {
    use super::Range;

    pub(super) const WHO_AM_I: Range<usize> = 0..1;
    pub(super) const SMPLRT_DIV: Range<usize> = 1..2;
    pub(super) const CONFIG: Range<usize> = 2..3;
    pub(super) const GYRO_CONFIG: Range<usize> = 3..4;
    pub(super) const ACCEL_CONFIG: Range<usize> = 4..5;
    pub(super) const MAG_WHO: Range<usize> = 5..6;
    pub(super) const CNTL1: Range<usize> = 6..7;
    pub(super) const ASA: Range<usize> = 7..10;
}

/// A view of the payload's bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Payload<T>(T);

impl<T: AsRef<[u8]>> Payload<T> {
    /// Takes `bytes` as the payload of a `config` packet.
    ///
    /// # Errors
    /// [`Error::Length`] unless there are exactly [`LEN`] bytes.
    pub fn new_checked(bytes: T) -> Result<Self, Error> {
        Error::check_length(LEN, bytes.as_ref().len())?;
        Ok(Self(bytes))
    }

    /// Register 0x75: which chip this is.
    pub fn who_am_i(&self) -> u8 {
        bytes::le(self.0.as_ref(), field::WHO_AM_I)
    }

    /// Register 0x19: sample rate divider; the rate is [`Chip::sample_rate_hz`](super::registers::Chip::sample_rate_hz).
    pub fn smplrt_div(&self) -> u8 {
        bytes::le(self.0.as_ref(), field::SMPLRT_DIV)
    }

    /// Register 0x1A: low-pass filter.
    pub fn config(&self) -> u8 {
        bytes::le(self.0.as_ref(), field::CONFIG)
    }

    /// Register 0x1B: full scale of the gyro in bits 4:3.
    pub fn gyro_config(&self) -> u8 {
        bytes::le(self.0.as_ref(), field::GYRO_CONFIG)
    }

    /// Register 0x1C: full scale of the accelerometer in bits 4:3.
    pub fn accel_config(&self) -> u8 {
        bytes::le(self.0.as_ref(), field::ACCEL_CONFIG)
    }

    /// AK8963 register 0x00: which magnetometer, 0 for none.
    pub fn mag_who(&self) -> u8 {
        bytes::le(self.0.as_ref(), field::MAG_WHO)
    }

    /// AK8963 register 0x0A: mode in bits 3:0, 16-bit output in bit 4.
    pub fn cntl1(&self) -> u8 {
        bytes::le(self.0.as_ref(), field::CNTL1)
    }

    /// AK8963 registers 0x10 to 0x12: sensitivity adjustment of its x, y and z.
    pub fn asa(&self) -> [u8; 3] {
        bytes::les(self.0.as_ref(), field::ASA)
    }
}

impl<T: AsRef<[u8]> + AsMut<[u8]>> Payload<T> {
    /// Sets [`who_am_i`](Self::who_am_i).
    pub fn set_who_am_i(&mut self, value: u8) {
        bytes::put_le(self.0.as_mut(), field::WHO_AM_I, value);
    }

    /// Sets [`smplrt_div`](Self::smplrt_div).
    pub fn set_smplrt_div(&mut self, value: u8) {
        bytes::put_le(self.0.as_mut(), field::SMPLRT_DIV, value);
    }

    /// Sets [`config`](Self::config).
    pub fn set_config(&mut self, value: u8) {
        bytes::put_le(self.0.as_mut(), field::CONFIG, value);
    }

    /// Sets [`gyro_config`](Self::gyro_config).
    pub fn set_gyro_config(&mut self, value: u8) {
        bytes::put_le(self.0.as_mut(), field::GYRO_CONFIG, value);
    }

    /// Sets [`accel_config`](Self::accel_config).
    pub fn set_accel_config(&mut self, value: u8) {
        bytes::put_le(self.0.as_mut(), field::ACCEL_CONFIG, value);
    }

    /// Sets [`mag_who`](Self::mag_who).
    pub fn set_mag_who(&mut self, value: u8) {
        bytes::put_le(self.0.as_mut(), field::MAG_WHO, value);
    }

    /// Sets [`cntl1`](Self::cntl1).
    pub fn set_cntl1(&mut self, value: u8) {
        bytes::put_le(self.0.as_mut(), field::CNTL1, value);
    }

    /// Sets [`asa`](Self::asa).
    pub fn set_asa(&mut self, value: [u8; 3]) {
        bytes::put_les(self.0.as_mut(), field::ASA, value);
    }
}

/// The payload of a `config` packet as plain values.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Repr {
    /// Register 0x75: which chip this is.
    pub who_am_i: u8,
    /// Register 0x19: sample rate divider; the rate is [`Chip::sample_rate_hz`](super::registers::Chip::sample_rate_hz).
    pub smplrt_div: u8,
    /// Register 0x1A: low-pass filter.
    pub config: u8,
    /// Register 0x1B: full scale of the gyro in bits 4:3.
    pub gyro_config: u8,
    /// Register 0x1C: full scale of the accelerometer in bits 4:3.
    pub accel_config: u8,
    /// AK8963 register 0x00: which magnetometer, 0 for none.
    pub mag_who: u8,
    /// AK8963 register 0x0A: mode in bits 3:0, 16-bit output in bit 4.
    pub cntl1: u8,
    /// AK8963 registers 0x10 to 0x12: sensitivity adjustment of its x, y and z.
    pub asa: [u8; 3],
}

impl Repr {
    /// Reads every field of a view.
    pub fn parse<T: AsRef<[u8]>>(payload: &Payload<T>) -> Self {
        Self {
            who_am_i: payload.who_am_i(),
            smplrt_div: payload.smplrt_div(),
            config: payload.config(),
            gyro_config: payload.gyro_config(),
            accel_config: payload.accel_config(),
            mag_who: payload.mag_who(),
            cntl1: payload.cntl1(),
            asa: payload.asa(),
        }
    }

    /// Bytes that [`emit`](Self::emit) writes.
    pub const fn buffer_len(&self) -> usize {
        LEN
    }

    /// Writes every field into a view.
    pub fn emit<T: AsRef<[u8]> + AsMut<[u8]>>(&self, payload: &mut Payload<T>) {
        payload.set_who_am_i(self.who_am_i);
        payload.set_smplrt_div(self.smplrt_div);
        payload.set_config(self.config);
        payload.set_gyro_config(self.gyro_config);
        payload.set_accel_config(self.accel_config);
        payload.set_mag_who(self.mag_who);
        payload.set_cntl1(self.cntl1);
        payload.set_asa(self.asa);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOLDEN: [u8; LEN] = [0x71, 0x00, 0x01, 0x18, 0x08, 0x48, 0x16, 0xb0, 0xb2, 0xa8];

    fn repr() -> Repr {
        Repr {
            who_am_i: 113,
            smplrt_div: 0,
            config: 1,
            gyro_config: 24,
            accel_config: 8,
            mag_who: 72,
            cntl1: 22,
            asa: [176, 178, 168],
        }
    }

    #[test]
    fn deconstruct() {
        let payload = Payload::new_checked(&GOLDEN).unwrap();
        assert_eq!(payload.who_am_i(), 113);
        assert_eq!(payload.smplrt_div(), 0);
        assert_eq!(payload.config(), 1);
        assert_eq!(payload.gyro_config(), 24);
        assert_eq!(payload.accel_config(), 8);
        assert_eq!(payload.mag_who(), 72);
        assert_eq!(payload.cntl1(), 22);
        assert_eq!(payload.asa(), [176, 178, 168]);
        assert!(Payload::new_checked(&GOLDEN[1..]).is_err());
    }

    #[test]
    fn construct() {
        let mut bytes = [0xff; LEN];
        let mut payload = Payload::new_checked(&mut bytes).unwrap();
        payload.set_who_am_i(113);
        payload.set_smplrt_div(0);
        payload.set_config(1);
        payload.set_gyro_config(24);
        payload.set_accel_config(8);
        payload.set_mag_who(72);
        payload.set_cntl1(22);
        payload.set_asa([176, 178, 168]);
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
