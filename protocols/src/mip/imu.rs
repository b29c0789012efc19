//! Descriptor 80: what the inertial sensors read, in as many fields as there are sensors.
//!
//! Axes are forward, right, down. Fields that are not known here are stepped over.

use core::ops::Range;

use crate::bytes;
use crate::error::Error;

/// The packet's descriptor on the wire.
pub const DESCRIPTOR: u8 = 0x80;

/// Bytes of all fields together.
pub const MAX_LEN: usize = 6 + 3 * 14;

mod descriptor {
    pub(super) const ACCEL: u8 = 0x04;
    pub(super) const GYRO: u8 = 0x05;
    pub(super) const MAG: u8 = 0x06;
    pub(super) const PRESSURE: u8 = 0x17;
}

mod field {
    use super::Range;

    pub(super) const LEN: usize = 0;
    pub(super) const DESCRIPTOR: usize = 1;
    pub(super) const SCALAR: Range<usize> = 2..6;
    pub(super) const VECTOR: Range<usize> = 2..14;
}

/// A view of the fields' bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Payload<T>(T);

impl<T: AsRef<[u8]>> Payload<T> {
    /// Takes `bytes` as the fields of a packet.
    ///
    /// # Errors
    /// [`Error::Malformed`] if a field's length is under 2 or beyond the end, [`Error::Length`]
    /// if a field that is known here has another length than it should.
    pub fn new_checked(bytes: T) -> Result<Self, Error> {
        let mut rest = bytes.as_ref();
        while let Some(&len) = rest.first() {
            let len = usize::from(len);
            if len < 2 || len > rest.len() {
                return Err(Error::Malformed);
            }
            let expected = match rest[field::DESCRIPTOR] {
                descriptor::PRESSURE => field::SCALAR.end,
                descriptor::ACCEL | descriptor::GYRO | descriptor::MAG => field::VECTOR.end,
                _ => len,
            };
            Error::check_length(expected, len)?;
            rest = &rest[len..];
        }
        Ok(Self(bytes))
    }

    /// The first field with this descriptor.
    fn find(&self, descriptor: u8) -> Option<&[u8]> {
        let mut rest = self.0.as_ref();
        while rest.len() > field::DESCRIPTOR {
            let (found, after) = rest.split_at_checked(usize::from(rest[field::LEN]).max(2))?;
            if found[field::DESCRIPTOR] == descriptor {
                return Some(found);
            }
            rest = after;
        }
        None
    }

    fn vector(&self, descriptor: u8) -> Option<[f32; 3]> {
        self.find(descriptor).map(|found| bytes::bes(found, field::VECTOR))
    }

    /// Pressure, mbar.
    pub fn pressure(&self) -> Option<f32> {
        self.find(descriptor::PRESSURE).map(|found| bytes::be(found, field::SCALAR))
    }

    /// Magnetic field, gauss.
    pub fn mag(&self) -> Option<[f32; 3]> {
        self.vector(descriptor::MAG)
    }

    /// Specific force, g (9.80665 m/s²): level at rest is 0, 0, -1.
    pub fn accel(&self) -> Option<[f32; 3]> {
        self.vector(descriptor::ACCEL)
    }

    /// Angular rate, rad/s.
    pub fn gyro(&self) -> Option<[f32; 3]> {
        self.vector(descriptor::GYRO)
    }
}

/// The fields of a packet as plain values; `None` is not sent.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Repr {
    /// Pressure, mbar.
    pub pressure: Option<f32>,
    /// Magnetic field, gauss.
    pub mag: Option<[f32; 3]>,
    /// Specific force, g (9.80665 m/s²): level at rest is 0, 0, -1.
    pub accel: Option<[f32; 3]>,
    /// Angular rate, rad/s.
    pub gyro: Option<[f32; 3]>,
}

impl Repr {
    /// Reads every field of a view.
    pub fn parse<T: AsRef<[u8]>>(payload: &Payload<T>) -> Self {
        Self {
            pressure: payload.pressure(),
            mag: payload.mag(),
            accel: payload.accel(),
            gyro: payload.gyro(),
        }
    }

    /// Bytes that [`emit`](Self::emit) writes.
    pub const fn buffer_len(&self) -> usize {
        let vectors =
            self.mag.is_some() as usize + self.accel.is_some() as usize + self.gyro.is_some() as usize;
        self.pressure.is_some() as usize * field::SCALAR.end + vectors * field::VECTOR.end
    }

    /// Writes the fields one after the other: pressure, mag, accel, gyro.
    pub fn emit(&self, out: &mut [u8]) {
        let mut at = 0;
        let mut put = |descriptor: u8, values: &[f32]| {
            let end = at + 2 + 4 * values.len();
            bytes::put_be(out, at..at + 1, (end - at) as u8);
            bytes::put_be(out, at + 1..at + 2, descriptor);
            for (i, value) in values.iter().enumerate() {
                bytes::put_be(out, at + 2 + 4 * i..at + 6 + 4 * i, *value);
            }
            at = end;
        };
        if let Some(pressure) = self.pressure {
            put(descriptor::PRESSURE, &[pressure]);
        }
        for (descriptor, vector) in
            [(descriptor::MAG, self.mag), (descriptor::ACCEL, self.accel), (descriptor::GYRO, self.gyro)]
        {
            if let Some(vector) = vector {
                put(descriptor, &vector);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOLDEN: [u8; MAX_LEN] = [
        0x06, 0x17, 0x44, 0x6c, 0x40, 0x00, 0x0e, 0x06, 0x3e, 0x80, 0x00, 0x00, 0x3d, 0x80, 0x00, 0x00, 0xbf,
        0x00, 0x00, 0x00, 0x0e, 0x04, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0xbf, 0x80, 0x00, 0x00,
        0x0e, 0x05, 0x3e, 0x00, 0x00, 0x00, 0xbe, 0x80, 0x00, 0x00, 0x3f, 0x00, 0x00, 0x00,
    ];

    fn repr() -> Repr {
        Repr {
            pressure: Some(945.0),
            mag: Some([0.25, 0.0625, -0.5]),
            accel: Some([0.0, 0.0, -1.0]),
            gyro: Some([0.125, -0.25, 0.5]),
        }
    }

    #[test]
    fn deconstruct() {
        let payload = Payload::new_checked(&GOLDEN).unwrap();
        assert_eq!(payload.pressure(), Some(945.0));
        assert_eq!(payload.mag(), Some([0.25, 0.0625, -0.5]));
        assert_eq!(payload.accel(), Some([0.0, 0.0, -1.0]));
        assert_eq!(payload.gyro(), Some([0.125, -0.25, 0.5]));
        assert!(Payload::new_checked(&GOLDEN[1..]).is_err());
        assert_eq!(Payload::new_checked(&[1]), Err(Error::Malformed));
        assert_eq!(Payload::new_checked(&[2, 0x17]), Err(Error::Length { expected: 6, found: 2 }));
    }

    #[test]
    fn parse() {
        assert_eq!(Repr::parse(&Payload::new_checked(&GOLDEN).unwrap()), repr());
        let unknown = [3, 0x99, 7, 6, 0x17, 0x44, 0x6c, 0x40, 0x00];
        let parsed = Repr::parse(&Payload::new_checked(&unknown).unwrap());
        assert_eq!(parsed, Repr { pressure: Some(945.0), ..Repr::default() });
    }

    #[test]
    fn emit() {
        let mut bytes = [0xff; MAX_LEN];
        assert_eq!(repr().buffer_len(), MAX_LEN);
        repr().emit(&mut bytes);
        assert_eq!(bytes, GOLDEN);
        let alone = Repr { gyro: repr().gyro, ..Repr::default() };
        assert_eq!(alone.buffer_len(), 14);
        alone.emit(&mut bytes);
        assert_eq!(bytes[..14], GOLDEN[34..]);
    }
}
