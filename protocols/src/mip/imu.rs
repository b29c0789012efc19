//! Descriptor 80: what the inertial sensors read, in as many fields as there are sensors.
//!
//! Axes are forward, right, down. Fields that are not known here are stepped over. Of several that tell the time the
//! one is read that a unit's clock steps least in: its own nanoseconds, then those of an outer clock. The ticks of field 0E are
//! stepped over: no packet says how long one is.
//!
//! ```
//! use ratetable_protocols::mip::imu::{Payload, Repr};
//!
//! let repr = Repr { accel: Some([0.0, 0.0, -1.0]), ..Default::default() };
//! let mut bytes = [0; 14];
//! assert_eq!(repr.buffer_len(), bytes.len());
//! repr.emit(&mut bytes);
//! assert_eq!(Repr::parse(&Payload::new_checked(&bytes)?), repr);
//! # Ok::<(), ratetable_protocols::Error>(())
//! ```

use core::ops::Range;

use crate::bytes;
use crate::error::Error;

/// The packet's descriptor on the wire.
pub const DESCRIPTOR: u8 = 0x80;

/// Bytes of all fields together.
pub const MAX_LEN: usize = 6 + 3 * 14 + 14;

mod descriptor {
    pub(super) const ACCEL: u8 = 0x04;
    pub(super) const GYRO: u8 = 0x05;
    pub(super) const MAG: u8 = 0x06;
    pub(super) const PRESSURE: u8 = 0x17;
    pub(super) const GPS: u8 = 0x12;
    // Of every set of fields.
    pub(super) const SHARED_GPS: u8 = 0xd3;
    pub(super) const REFERENCE: u8 = 0xd5;
    pub(super) const EXTERNAL: u8 = 0xd7;
}

mod field {
    use super::Range;

    pub(super) const LEN: usize = 0;
    pub(super) const DESCRIPTOR: usize = 1;
    pub(super) const SCALAR: Range<usize> = 2..6;
    pub(super) const VECTOR: Range<usize> = 2..14;
    pub(super) const NS: Range<usize> = 2..10;
    pub(super) const NS_VALID: Range<usize> = 10..12;
    pub(super) const TIME_OF_WEEK: Range<usize> = 2..10;
    pub(super) const WEEK: Range<usize> = 10..12;
    pub(super) const GPS_VALID: Range<usize> = 12..14;
}

/// When a packet's data were sampled.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Time {
    /// By the unit's own clock, which never steps, since it was started, ns.
    Reference(u64),
    /// By an outer clock, ns, and whether that is one (bit 0).
    External(u64, u16),
    /// Of GPS, or by the unit's own clock before it knows that one: seconds of the week, the week since 1980, and what
    /// of it is sure, in every set of fields.
    SharedGps(f64, u16, u16),
    /// The same in the field of the inertial set.
    Gps(f64, u16, u16),
}

impl Time {
    /// Since the clock's own beginning, ns; `None` for seconds of the week that are none.
    pub fn ns(&self) -> Option<u64> {
        const WEEK_NS: u64 = 7 * 86_400 * 1_000_000_000;
        match *self {
            Self::Reference(ns) | Self::External(ns, _) => Some(ns),
            Self::Gps(of_week, week, _) | Self::SharedGps(of_week, week, _) => (0.0..1e6)
                .contains(&of_week)
                .then(|| u64::from(week) * WEEK_NS + (of_week * 1e9 + 0.5) as u64),
        }
    }

    const fn len(&self) -> usize {
        match self {
            Self::Reference(_) => field::NS.end,
            Self::External(..) => field::NS_VALID.end,
            Self::SharedGps(..) | Self::Gps(..) => field::GPS_VALID.end,
        }
    }

    fn emit(&self, out: &mut [u8]) {
        bytes::put_be(out, field::LEN..field::LEN + 1, self.len() as u8);
        let mut kind =
            |descriptor: u8| bytes::put_be(out, field::DESCRIPTOR..field::DESCRIPTOR + 1, descriptor);
        match *self {
            Self::Reference(ns) => {
                kind(descriptor::REFERENCE);
                bytes::put_be(out, field::NS, ns);
            }
            Self::External(ns, valid) => {
                kind(descriptor::EXTERNAL);
                bytes::put_be(out, field::NS, ns);
                bytes::put_be(out, field::NS_VALID, valid);
            }
            Self::SharedGps(of_week, week, valid) | Self::Gps(of_week, week, valid) => {
                let shared = matches!(self, Self::SharedGps(..));
                kind(if shared { descriptor::SHARED_GPS } else { descriptor::GPS });
                bytes::put_be(out, field::TIME_OF_WEEK, of_week);
                bytes::put_be(out, field::WEEK, week);
                bytes::put_be(out, field::GPS_VALID, valid);
            }
        }
    }
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
                descriptor::GPS | descriptor::SHARED_GPS => field::GPS_VALID.end,
                descriptor::REFERENCE => field::NS.end,
                descriptor::EXTERNAL => field::NS_VALID.end,
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

    /// When the data were sampled.
    pub fn time(&self) -> Option<Time> {
        let gps = |found: &[u8]| {
            let of_week = bytes::be(found, field::TIME_OF_WEEK);
            (of_week, bytes::be(found, field::WEEK), bytes::be(found, field::GPS_VALID))
        };
        let ns = |found: &[u8]| bytes::be(found, field::NS);
        let external = |found: &[u8]| Time::External(ns(found), bytes::be(found, field::NS_VALID));
        let shared = |(of_week, week, valid)| Time::SharedGps(of_week, week, valid);
        let own = |(of_week, week, valid)| Time::Gps(of_week, week, valid);
        let reference = self.find(descriptor::REFERENCE).map(|found| Time::Reference(ns(found)));
        reference
            .or_else(|| self.find(descriptor::EXTERNAL).map(external))
            .or_else(|| self.find(descriptor::SHARED_GPS).map(gps).map(shared))
            .or_else(|| self.find(descriptor::GPS).map(gps).map(own))
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
    /// When they were sampled.
    pub time: Option<Time>,
}

impl Repr {
    /// Reads every field of a view.
    pub fn parse<T: AsRef<[u8]>>(payload: &Payload<T>) -> Self {
        Self {
            pressure: payload.pressure(),
            mag: payload.mag(),
            accel: payload.accel(),
            gyro: payload.gyro(),
            time: payload.time(),
        }
    }

    /// Bytes that [`emit`](Self::emit) writes.
    pub const fn buffer_len(&self) -> usize {
        let vectors =
            self.mag.is_some() as usize + self.accel.is_some() as usize + self.gyro.is_some() as usize;
        let time = match &self.time {
            Some(time) => time.len(),
            None => 0,
        };
        self.pressure.is_some() as usize * field::SCALAR.end + vectors * field::VECTOR.end + time
    }

    /// Writes the fields one after the other: pressure, mag, accel, gyro, time.
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
        if let Some((time, rest)) = self.time.zip(out.get_mut(at..)) {
            time.emit(rest);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOLDEN: [u8; 48] = [
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
            time: None,
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
        assert_eq!(repr().buffer_len(), GOLDEN.len());
        repr().emit(&mut bytes);
        assert_eq!(bytes[..GOLDEN.len()], GOLDEN);
        let alone = Repr { gyro: repr().gyro, ..Repr::default() };
        assert_eq!(alone.buffer_len(), 14);
        alone.emit(&mut bytes);
        assert_eq!(bytes[..14], GOLDEN[34..]);
    }

    /// Each field that tells the time, as its bytes stand, what it says and that in ns.
    const TIMES: [(&[u8], Time, u64); 4] = [
        (&[10, 0xd5, 0, 0, 0, 1, 0, 0, 0, 2], Time::Reference((1 << 32) + 2), (1 << 32) + 2),
        (&[12, 0xd7, 0, 0, 0, 0, 0, 0, 1, 0, 0, 1], Time::External(256, 1), 256),
        // 1.5 s into week 1.
        (
            &[14, 0xd3, 0x3f, 0xf8, 0, 0, 0, 0, 0, 0, 0, 1, 0, 3],
            Time::SharedGps(1.5, 1, 3),
            604_801_500_000_000,
        ),
        (&[14, 0x12, 0x3f, 0xf8, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0], Time::Gps(1.5, 0, 0), 1_500_000_000),
    ];

    #[test]
    fn the_time_is_read_from_whatever_field_has_it_and_the_steadiest_first() {
        let mut all = [0; 50];
        let mut at = all.len();
        // From the least wanted on, so that each that is put in front of the others is asked for first.
        for (field, time, ns) in TIMES.into_iter().rev() {
            let alone = Repr::parse(&Payload::new_checked(field).unwrap());
            assert_eq!((alone, time.ns()), (Repr { time: Some(time), ..Repr::default() }, Some(ns)));
            let mut bytes = [0; MAX_LEN];
            alone.emit(&mut bytes);
            assert_eq!((&bytes[..field.len()], alone.buffer_len()), (field, field.len()));
            at -= field.len();
            all[at..at + field.len()].copy_from_slice(field);
            assert_eq!(Payload::new_checked(&all[at..]).unwrap().time(), Some(time));
            assert!(Payload::new_checked(&field[..field.len() - 1]).is_err(), "cut short");
        }
        let mut backwards = [0; 50];
        let mut at = 0;
        for (field, ..) in TIMES.into_iter().rev() {
            backwards[at..at + field.len()].copy_from_slice(field);
            at += field.len();
        }
        assert_eq!(Payload::new_checked(&backwards[..]).unwrap().time(), Some(TIMES[0].1), "in any order");
        for none in [f64::NAN, -1.0, f64::INFINITY, 1e18] {
            assert_eq!(Time::Gps(none, 7, 0).ns(), None, "{none}");
        }
    }
}
