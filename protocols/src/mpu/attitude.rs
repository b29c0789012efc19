//! Type 10: the attitude that a firmware sends back.
//!
//! The packet's header repeats the `t_us` of the newest sample that went into the answer, which is
//! how its delay is known exactly.

use core::ops::Range;

use crate::bytes;
use crate::error::Error;

/// The packet type on the wire.
pub const TYPE: u8 = 0x10;

/// Bytes of payload.
pub const LEN: usize = 20;

mod field {
    use super::Range;

    pub(super) const CLOCK_US: Range<usize> = 0..4;
    pub(super) const Q: Range<usize> = 4..20;
}

/// A view of the payload's bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Payload<T>(T);

impl<T: AsRef<[u8]>> Payload<T> {
    /// Takes `bytes` as the payload of an `attitude` packet.
    ///
    /// # Errors
    /// [`Error::Length`] unless there are exactly [`LEN`] bytes.
    pub fn new_checked(bytes: T) -> Result<Self, Error> {
        Error::check_length(LEN, bytes.as_ref().len())?;
        Ok(Self(bytes))
    }

    /// The receiver's own clock when it answered, µs, wrapping.
    pub fn clock_us(&self) -> u32 {
        bytes::le(self.0.as_ref(), field::CLOCK_US)
    }

    /// Attitude `w, x, y, z`: takes vectors in body axes (FRD) to nav (NED), unit norm.
    pub fn q(&self) -> [f32; 4] {
        bytes::les(self.0.as_ref(), field::Q)
    }
}

impl<T: AsRef<[u8]> + AsMut<[u8]>> Payload<T> {
    /// Sets [`clock_us`](Self::clock_us).
    pub fn set_clock_us(&mut self, value: u32) {
        bytes::put_le(self.0.as_mut(), field::CLOCK_US, value);
    }

    /// Sets [`q`](Self::q).
    pub fn set_q(&mut self, value: [f32; 4]) {
        bytes::put_les(self.0.as_mut(), field::Q, value);
    }
}

/// The payload of an `attitude` packet as plain values.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Repr {
    /// The receiver's own clock when it answered, µs, wrapping.
    pub clock_us: u32,
    /// Attitude `w, x, y, z`: takes vectors in body axes (FRD) to nav (NED), unit norm.
    pub q: [f32; 4],
}

impl Repr {
    /// Reads every field of a view.
    pub fn parse<T: AsRef<[u8]>>(payload: &Payload<T>) -> Self {
        Self { clock_us: payload.clock_us(), q: payload.q() }
    }

    /// Bytes that [`emit`](Self::emit) writes.
    pub const fn buffer_len(&self) -> usize {
        LEN
    }

    /// Writes every field into a view.
    pub fn emit<T: AsRef<[u8]> + AsMut<[u8]>>(&self, payload: &mut Payload<T>) {
        payload.set_clock_us(self.clock_us);
        payload.set_q(self.q);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOLDEN: [u8; LEN] = [
        0x40, 0xe2, 0x01, 0x00, 0x00, 0x00, 0x00, 0x3f, 0x00, 0x00, 0x00, 0xbf, 0x00, 0x00, 0x00, 0x3f, 0x00,
        0x00, 0x00, 0x3f,
    ];

    fn repr() -> Repr {
        Repr { clock_us: 123456, q: [0.5, -0.5, 0.5, 0.5] }
    }

    #[test]
    fn deconstruct() {
        let payload = Payload::new_checked(&GOLDEN).unwrap();
        assert_eq!(payload.clock_us(), 123456);
        assert_eq!(payload.q(), [0.5, -0.5, 0.5, 0.5]);
        assert!(Payload::new_checked(&GOLDEN[1..]).is_err());
    }

    #[test]
    fn construct() {
        let mut bytes = [0xff; LEN];
        let mut payload = Payload::new_checked(&mut bytes).unwrap();
        payload.set_clock_us(123456);
        payload.set_q([0.5, -0.5, 0.5, 0.5]);
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
