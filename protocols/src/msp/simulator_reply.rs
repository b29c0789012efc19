//! Command 0x201F, from the firmware: what it would do to the servos, and its attitude.
//!
//! Behind these fields follows what its display shows, run-length coded, if it has one.

use core::ops::Range;

use crate::bytes;
use crate::error::Error;
use crate::msp::Direction;

/// The command on the wire.
pub const COMMAND: u16 = 0x201f;

/// Which way it goes.
pub const DIRECTION: Direction = Direction::Reply;

/// Bytes of payload, those of the display behind it left out.
pub const LEN: usize = 21;

mod field {
    use super::Range;

    pub(super) const OUTPUTS: Range<usize> = 0..8;
    pub(super) const STATE: Range<usize> = 8..9;
    pub(super) const DEBUG: Range<usize> = 9..13;
    pub(super) const ATTITUDE: Range<usize> = 13..19;
    pub(super) const DISPLAY: Range<usize> = 19..21;
}

/// A view of the payload's bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Payload<T>(T);

impl<T: AsRef<[u8]>> Payload<T> {
    /// Takes `bytes` as the payload of a `simulator` reply.
    ///
    /// # Errors
    /// [`Error::Length`] unless there are at least [`LEN`] bytes.
    pub fn new_checked(bytes: T) -> Result<Self, Error> {
        let found = bytes.as_ref().len();
        Error::check_length(LEN, found.min(LEN))?;
        Ok(Self(bytes))
    }

    /// Stabilised roll, pitch, yaw and throttle, -500 to 500.
    pub fn outputs(&self) -> [i16; 4] {
        bytes::les(self.0.as_ref(), field::OUTPUTS)
    }

    /// Which `debug` value this is in bits 2:0; bit 4 and 5: no display; bit 6: armed; bit 7: an aeroplane.
    pub fn state(&self) -> u8 {
        bytes::le(self.0.as_ref(), field::STATE)
    }

    /// One of the firmware's eight debug values, in turn.
    pub fn debug(&self) -> i32 {
        bytes::le(self.0.as_ref(), field::DEBUG)
    }

    /// Its own roll, pitch (nose down positive) and yaw (0 to 3600), 0.1 degrees.
    pub fn attitude(&self) -> [i16; 3] {
        bytes::les(self.0.as_ref(), field::ATTITUDE)
    }

    /// 255, then the rows of its display: 0 for none.
    pub fn display(&self) -> [u8; 2] {
        bytes::les(self.0.as_ref(), field::DISPLAY)
    }
}

impl<T: AsRef<[u8]> + AsMut<[u8]>> Payload<T> {
    /// Sets [`outputs`](Self::outputs).
    pub fn set_outputs(&mut self, value: [i16; 4]) {
        bytes::put_les(self.0.as_mut(), field::OUTPUTS, value);
    }

    /// Sets [`state`](Self::state).
    pub fn set_state(&mut self, value: u8) {
        bytes::put_le(self.0.as_mut(), field::STATE, value);
    }

    /// Sets [`debug`](Self::debug).
    pub fn set_debug(&mut self, value: i32) {
        bytes::put_le(self.0.as_mut(), field::DEBUG, value);
    }

    /// Sets [`attitude`](Self::attitude).
    pub fn set_attitude(&mut self, value: [i16; 3]) {
        bytes::put_les(self.0.as_mut(), field::ATTITUDE, value);
    }

    /// Sets [`display`](Self::display).
    pub fn set_display(&mut self, value: [u8; 2]) {
        bytes::put_les(self.0.as_mut(), field::DISPLAY, value);
    }
}

/// The payload of a `simulator` reply as plain values.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Repr {
    /// Stabilised roll, pitch, yaw and throttle, -500 to 500.
    pub outputs: [i16; 4],
    /// Which `debug` value this is in bits 2:0; bit 4 and 5: no display; bit 6: armed; bit 7: an aeroplane.
    pub state: u8,
    /// One of the firmware's eight debug values, in turn.
    pub debug: i32,
    /// Its own roll, pitch (nose down positive) and yaw (0 to 3600), 0.1 degrees.
    pub attitude: [i16; 3],
    /// 255, then the rows of its display: 0 for none.
    pub display: [u8; 2],
}

impl Repr {
    /// Reads every field of a view.
    pub fn parse<T: AsRef<[u8]>>(payload: &Payload<T>) -> Self {
        Self {
            outputs: payload.outputs(),
            state: payload.state(),
            debug: payload.debug(),
            attitude: payload.attitude(),
            display: payload.display(),
        }
    }

    /// Bytes that [`emit`](Self::emit) writes.
    pub const fn buffer_len(&self) -> usize {
        LEN
    }

    /// Writes every field into a view.
    pub fn emit<T: AsRef<[u8]> + AsMut<[u8]>>(&self, payload: &mut Payload<T>) {
        payload.set_outputs(self.outputs);
        payload.set_state(self.state);
        payload.set_debug(self.debug);
        payload.set_attitude(self.attitude);
        payload.set_display(self.display);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOLDEN: [u8; LEN] = [
        0xf4, 0xff, 0x22, 0x00, 0xc8, 0xff, 0xf4, 0x01, 0x35, 0xc0, 0x1d, 0xfe, 0xff, 0x2c, 0x01, 0x9c, 0xff,
        0x84, 0x03, 0xff, 0x00,
    ];

    fn repr() -> Repr {
        Repr {
            outputs: [-12, 34, -56, 500],
            state: 53,
            debug: -123456,
            attitude: [300, -100, 900],
            display: [255, 0],
        }
    }

    #[test]
    fn deconstruct() {
        let payload = Payload::new_checked(&GOLDEN).unwrap();
        assert_eq!(payload.outputs(), [-12, 34, -56, 500]);
        assert_eq!(payload.state(), 53);
        assert_eq!(payload.debug(), -123456);
        assert_eq!(payload.attitude(), [300, -100, 900]);
        assert_eq!(payload.display(), [255, 0]);
        assert!(Payload::new_checked(&GOLDEN[1..]).is_err());
        assert_eq!(Repr::parse(&Payload::new_checked([GOLDEN, [7; LEN]].as_flattened()).unwrap()), repr());
    }

    #[test]
    fn construct() {
        let mut bytes = [0xff; LEN];
        let mut payload = Payload::new_checked(&mut bytes).unwrap();
        payload.set_outputs([-12, 34, -56, 500]);
        payload.set_state(53);
        payload.set_debug(-123456);
        payload.set_attitude([300, -100, 900]);
        payload.set_display([255, 0]);
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
