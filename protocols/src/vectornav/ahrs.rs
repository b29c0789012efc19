//! Binary output 2: the attitude.
//!
//! Common group with TimeStartup, attitude group with Ypr, Quaternion and YprU. From body (forward,
//! right, down) to nav (north, east, down).

use core::ops::Range;

use crate::bytes;
use crate::error::Error;

/// What follows the synchronisation byte: which groups of outputs there are, and which outputs of each.
pub const GROUPS: &[u8] = &[0x11, 0x01, 0x00, 0x06, 0x01];

/// Bytes of payload.
pub const LEN: usize = 48;

mod field {
    use super::Range;

    pub(super) const TIME_NS: Range<usize> = 0..8;
    pub(super) const YAW_PITCH_ROLL: Range<usize> = 8..20;
    pub(super) const XYZW: Range<usize> = 20..36;
    pub(super) const UNCERTAINTY: Range<usize> = 36..48;
}

/// A view of the payload's bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Payload<T>(T);

impl<T: AsRef<[u8]>> Payload<T> {
    /// Takes `bytes` as the payload of an `ahrs` packet.
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

    /// Yaw, pitch and roll, degrees.
    pub fn yaw_pitch_roll(&self) -> [f32; 3] {
        bytes::les(self.0.as_ref(), field::YAW_PITCH_ROLL)
    }

    /// The quaternion, its scalar last.
    pub fn xyzw(&self) -> [f32; 4] {
        bytes::les(self.0.as_ref(), field::XYZW)
    }

    /// Standard deviation of yaw, pitch and roll, degrees.
    pub fn uncertainty(&self) -> [f32; 3] {
        bytes::les(self.0.as_ref(), field::UNCERTAINTY)
    }
}

impl<T: AsRef<[u8]> + AsMut<[u8]>> Payload<T> {
    /// Sets [`time_ns`](Self::time_ns).
    pub fn set_time_ns(&mut self, value: u64) {
        bytes::put_le(self.0.as_mut(), field::TIME_NS, value);
    }

    /// Sets [`yaw_pitch_roll`](Self::yaw_pitch_roll).
    pub fn set_yaw_pitch_roll(&mut self, value: [f32; 3]) {
        bytes::put_les(self.0.as_mut(), field::YAW_PITCH_ROLL, value);
    }

    /// Sets [`xyzw`](Self::xyzw).
    pub fn set_xyzw(&mut self, value: [f32; 4]) {
        bytes::put_les(self.0.as_mut(), field::XYZW, value);
    }

    /// Sets [`uncertainty`](Self::uncertainty).
    pub fn set_uncertainty(&mut self, value: [f32; 3]) {
        bytes::put_les(self.0.as_mut(), field::UNCERTAINTY, value);
    }
}

/// The payload of an `ahrs` packet as plain values.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Repr {
    /// Time since the unit started, ns.
    pub time_ns: u64,
    /// Yaw, pitch and roll, degrees.
    pub yaw_pitch_roll: [f32; 3],
    /// The quaternion, its scalar last.
    pub xyzw: [f32; 4],
    /// Standard deviation of yaw, pitch and roll, degrees.
    pub uncertainty: [f32; 3],
}

impl Repr {
    /// Reads every field of a view.
    pub fn parse<T: AsRef<[u8]>>(payload: &Payload<T>) -> Self {
        Self {
            time_ns: payload.time_ns(),
            yaw_pitch_roll: payload.yaw_pitch_roll(),
            xyzw: payload.xyzw(),
            uncertainty: payload.uncertainty(),
        }
    }

    /// Bytes that [`emit`](Self::emit) writes.
    pub const fn buffer_len(&self) -> usize {
        LEN
    }

    /// Writes every field into a view.
    pub fn emit<T: AsRef<[u8]> + AsMut<[u8]>>(&self, payload: &mut Payload<T>) {
        payload.set_time_ns(self.time_ns);
        payload.set_yaw_pitch_roll(self.yaw_pitch_roll);
        payload.set_xyzw(self.xyzw);
        payload.set_uncertainty(self.uncertainty);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOLDEN: [u8; LEN] = [
        0x00, 0xca, 0x9a, 0x3b, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0xb4, 0x42, 0x00, 0x00, 0x00, 0x00, 0x00,
        0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x3f, 0x00, 0x00, 0x00, 0xbf, 0x00, 0x00, 0x00, 0x3f, 0x00, 0x00,
        0x00, 0x3f, 0x00, 0x00, 0x00, 0x3e, 0x00, 0x00, 0x00, 0x3e, 0x00, 0x00, 0x00, 0x3f,
    ];

    fn repr() -> Repr {
        Repr {
            time_ns: 1000000000,
            yaw_pitch_roll: [90.0, 0.0, 0.0],
            xyzw: [0.5, -0.5, 0.5, 0.5],
            uncertainty: [0.125, 0.125, 0.5],
        }
    }

    #[test]
    fn deconstruct() {
        let payload = Payload::new_checked(&GOLDEN).unwrap();
        assert_eq!(payload.time_ns(), 1000000000);
        assert_eq!(payload.yaw_pitch_roll(), [90.0, 0.0, 0.0]);
        assert_eq!(payload.xyzw(), [0.5, -0.5, 0.5, 0.5]);
        assert_eq!(payload.uncertainty(), [0.125, 0.125, 0.5]);
        assert!(Payload::new_checked(&GOLDEN[1..]).is_err());
    }

    #[test]
    fn construct() {
        let mut bytes = [0xff; LEN];
        let mut payload = Payload::new_checked(&mut bytes).unwrap();
        payload.set_time_ns(1000000000);
        payload.set_yaw_pitch_roll([90.0, 0.0, 0.0]);
        payload.set_xyzw([0.5, -0.5, 0.5, 0.5]);
        payload.set_uncertainty([0.125, 0.125, 0.5]);
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
