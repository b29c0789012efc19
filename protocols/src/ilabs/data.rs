//! What a frame tells: a list of ids, then the data of each in that order.
//!
//! Vectors are right, forward, up. Values are the counts on the wire.
//!
//! ```
//! use ratetable_protocols::ilabs::data::{Payload, Repr};
//!
//! let repr = Repr { mag: Some([-1100, 1905, -4300]), status: Some(0), ..Default::default() };
//! let mut bytes = [0; 11];
//! assert_eq!(repr.buffer_len(), bytes.len());
//! repr.emit(&mut bytes);
//! assert_eq!(Repr::parse(&Payload::new_checked(&bytes)?), repr);
//! # Ok::<(), ratetable_protocols::Error>(())
//! ```

use crate::bytes;
use crate::error::Error;

/// Metres a second squared in the g that the specific force is told in.
pub const G: f64 = 9.8106;

/// Bytes of the longest data that [`Repr::emit`] writes: every id once.
pub const MAX_LEN: usize = 1 + IDS.len() + 4 + 12 + 12 + 6 + 6 + 6 + 2 + 2 + 2;

mod id {
    pub(super) const TIME: u8 = 0x01;
    pub(super) const ATTITUDE: u8 = 0x07;
    pub(super) const GYRO: u8 = 0x21;
    pub(super) const ACCEL: u8 = 0x23;
    pub(super) const MAG: u8 = 0x24;
    pub(super) const PRESSURE: u8 = 0x25;
    pub(super) const TEMPERATURE: u8 = 0x52;
    pub(super) const STATUS: u8 = 0x53;
    pub(super) const STATUS_2: u8 = 0x5a;
}

/// Every id that is known here, in the order in which [`Repr::emit`] writes them, and the bytes of its data.
const IDS: [(u8, usize); 9] = [
    (id::TIME, 4),
    (id::ACCEL, 12),
    (id::GYRO, 12),
    (id::PRESSURE, 6),
    (id::MAG, 6),
    (id::ATTITUDE, 6),
    (id::STATUS, 2),
    (id::STATUS_2, 2),
    (id::TEMPERATURE, 2),
];

/// A barometer's reading.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Pressure {
    /// Static pressure, 2 Pa.
    pub half_pascals: u16,
    /// Altitude by that pressure, cm.
    pub altitude: i32,
}

/// An attitude as Euler angles, from body (forward, right, down) to nav (north, east, down).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Angles {
    /// From north to the right, 0 to 359.99°, 0.01°.
    pub yaw: u16,
    /// Nose up, 0.01°.
    pub pitch: i16,
    /// Right side down, 0.01°.
    pub roll: i16,
}

/// A view of the bytes: the number of ids, the ids, the data.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Payload<T>(T);

impl<T: AsRef<[u8]>> Payload<T> {
    /// Takes `bytes` as what a frame tells.
    ///
    /// # Errors
    /// [`Error::Malformed`] if there is no id or one is cut off, [`Error::UnknownType`] with the first id whose data
    /// have a length that is not known here, [`Error::Length`] if the data are not as long as their ids say.
    pub fn new_checked(bytes: T) -> Result<Self, Error> {
        let whole = bytes.as_ref();
        let ids = ids(whole).filter(|ids| !ids.is_empty()).ok_or(Error::Malformed)?;
        let mut expected = 1 + ids.len();
        for &id in ids {
            expected += len(id).ok_or(Error::UnknownType(id))?;
        }
        Error::check_length(expected, whole.len())?;
        Ok(Self(bytes))
    }

    /// The ids, in order.
    pub fn ids(&self) -> &[u8] {
        ids(self.0.as_ref()).unwrap_or_default()
    }

    /// Every id with its data, in order.
    fn data(&self) -> impl Iterator<Item = (u8, &[u8])> {
        let ids = self.ids();
        let mut rest = self.0.as_ref().get(1 + ids.len()..).unwrap_or_default();
        ids.iter().map(move |&id| {
            let (data, behind) = rest.split_at(len(id).unwrap_or(0).min(rest.len()));
            rest = behind;
            (id, data)
        })
    }
}

/// The ids in front of the data; `None` if not all are there.
fn ids(bytes: &[u8]) -> Option<&[u8]> {
    let (&count, rest) = bytes.split_first()?;
    rest.get(..usize::from(count))
}

/// Bytes of an id's data.
fn len(id: u8) -> Option<usize> {
    IDS.iter().find(|(known, _)| *known == id).map(|&(_, len)| len)
}

/// Plain values; what a frame does not tell is `None`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Repr {
    /// Since the beginning of the GPS week, ms.
    pub time_ms: Option<u32>,
    /// Specific force, 10⁻⁶ of [`G`]; level at rest is 0, 0, +999597.
    pub accel: Option<[i32; 3]>,
    /// Angular rate, 10⁻⁵ °/s.
    pub gyro: Option<[i32; 3]>,
    /// The barometer's reading.
    pub pressure: Option<Pressure>,
    /// Magnetic field, 10 nT.
    pub mag: Option<[i16; 3]>,
    /// The unit's own attitude.
    pub attitude: Option<Angles>,
    /// The unit's status word: 0 is good.
    pub status: Option<u16>,
    /// Its second status word: 0 is good.
    pub status_2: Option<u16>,
    /// Of the unit, 0.1 °C.
    pub temperature: Option<i16>,
}

impl Repr {
    /// Reads every field of a view; of an id that comes twice the last one.
    pub fn parse<T: AsRef<[u8]>>(payload: &Payload<T>) -> Self {
        let mut repr = Self::default();
        payload.data().for_each(|(id, data)| repr.take(id, data));
        repr
    }

    /// Bytes that [`emit`](Self::emit) writes.
    pub fn buffer_len(&self) -> usize {
        1 + self.told().map(|(_, len)| 1 + len).sum::<usize>()
    }

    /// Writes the ids and their data; `out` has as many bytes as [`buffer_len`](Self::buffer_len) says.
    pub fn emit(&self, out: &mut [u8]) {
        let count = self.told().count();
        bytes::put_le(out, 0..1, count as u8);
        let mut at = 1 + count;
        for (i, (id, len)) in self.told().enumerate() {
            bytes::put_le(out, 1 + i..2 + i, id);
            if let Some(place) = out.get_mut(at..at + len) {
                self.put(id, place);
            }
            at += len;
        }
    }

    /// The ids that have a value, and the bytes of their data.
    fn told(&self) -> impl Iterator<Item = (u8, usize)> {
        IDS.into_iter().filter(|&(id, _)| self.tells(id))
    }

    /// Whether an id has a value.
    const fn tells(&self, id: u8) -> bool {
        match id {
            id::TIME => self.time_ms.is_some(),
            id::ACCEL => self.accel.is_some(),
            id::GYRO => self.gyro.is_some(),
            id::PRESSURE => self.pressure.is_some(),
            id::MAG => self.mag.is_some(),
            id::ATTITUDE => self.attitude.is_some(),
            id::STATUS => self.status.is_some(),
            id::STATUS_2 => self.status_2.is_some(),
            id::TEMPERATURE => self.temperature.is_some(),
            _ => false,
        }
    }

    /// Writes an id's data.
    fn put(&self, id: u8, out: &mut [u8]) {
        match id {
            id::TIME => bytes::put_le(out, 0..4, self.time_ms.unwrap_or_default()),
            id::ACCEL => bytes::put_les(out, 0..12, self.accel.unwrap_or_default()),
            id::GYRO => bytes::put_les(out, 0..12, self.gyro.unwrap_or_default()),
            id::PRESSURE => {
                let Pressure { half_pascals, altitude } = self.pressure.unwrap_or_default();
                bytes::put_le(out, 0..2, half_pascals);
                bytes::put_le(out, 2..6, altitude);
            }
            id::MAG => bytes::put_les(out, 0..6, self.mag.unwrap_or_default()),
            id::ATTITUDE => {
                let Angles { yaw, pitch, roll } = self.attitude.unwrap_or_default();
                bytes::put_le(out, 0..2, yaw);
                bytes::put_les(out, 2..6, [pitch, roll]);
            }
            id::STATUS => bytes::put_le(out, 0..2, self.status.unwrap_or_default()),
            id::STATUS_2 => bytes::put_le(out, 0..2, self.status_2.unwrap_or_default()),
            id::TEMPERATURE => bytes::put_le(out, 0..2, self.temperature.unwrap_or_default()),
            _ => {}
        }
    }

    /// Reads an id's data.
    fn take(&mut self, id: u8, data: &[u8]) {
        match id {
            id::TIME => self.time_ms = Some(bytes::le(data, 0..4)),
            id::ACCEL => self.accel = Some(bytes::les(data, 0..12)),
            id::GYRO => self.gyro = Some(bytes::les(data, 0..12)),
            id::PRESSURE => {
                let (half_pascals, altitude) = (bytes::le(data, 0..2), bytes::le(data, 2..6));
                self.pressure = Some(Pressure { half_pascals, altitude });
            }
            id::MAG => self.mag = Some(bytes::les(data, 0..6)),
            id::ATTITUDE => {
                let [pitch, roll] = bytes::les(data, 2..6);
                self.attitude = Some(Angles { yaw: bytes::le(data, 0..2), pitch, roll });
            }
            id::STATUS => self.status = Some(bytes::le(data, 0..2)),
            id::STATUS_2 => self.status_2 = Some(bytes::le(data, 0..2)),
            id::TEMPERATURE => self.temperature = Some(bytes::le(data, 0..2)),
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of a frame that ArduPilot's driver took.
    const GOLDEN: [u8; MAX_LEN] = [
        0x09, 0x01, 0x23, 0x21, 0x25, 0x24, 0x07, 0x53, 0x5a, 0x52, 0x3a, 0x42, 0x00, 0x00, 0x10, 0x5e, 0x0d,
        0xff, 0xf0, 0xa1, 0xf2, 0x00, 0xad, 0xe4, 0xe0, 0xff, 0xec, 0xc7, 0x69, 0xf5, 0xeb, 0xca, 0x3e, 0x0a,
        0xac, 0x25, 0x51, 0xff, 0x92, 0xb8, 0x00, 0x00, 0x00, 0x00, 0x00, 0x7d, 0x00, 0x83, 0x4e, 0x00, 0xb8,
        0x0b, 0x00, 0x00, 0x6e, 0xfb, 0x00, 0x00, 0x00, 0x00, 0xfa, 0x00,
    ];

    fn repr() -> Repr {
        Repr {
            time_ms: Some(16_954),
            accel: Some([-15_901_168, 15_901_168, -2_038_611]),
            gyro: Some([-177_616_916, 171_887_339, -11_459_156]),
            pressure: Some(Pressure { half_pascals: 47_250, altitude: 0 }),
            mag: Some([32_000, -32_000, 78]),
            attitude: Some(Angles { yaw: 3000, pitch: 0, roll: -1170 }),
            status: Some(0),
            status_2: Some(0),
            temperature: Some(250),
        }
    }

    #[test]
    fn parse() {
        let payload = Payload::new_checked(GOLDEN).unwrap();
        assert_eq!(Repr::parse(&payload), repr());
        assert_eq!(payload.ids(), &GOLDEN[1..10]);
    }

    #[test]
    fn emit() {
        let mut bytes = [0xff; MAX_LEN];
        assert_eq!(repr().buffer_len(), MAX_LEN);
        repr().emit(&mut bytes);
        assert_eq!(bytes, GOLDEN);
    }

    #[test]
    fn any_subset_of_the_ids_comes_back() {
        for left_out in 0..1_u32 << IDS.len() {
            let mut some = Repr::default();
            for (i, (id, len)) in IDS.into_iter().enumerate().filter(|(i, _)| left_out >> i & 1 == 0) {
                let mut data = [0; 12];
                repr().put(id, &mut data[..len]);
                some.take(id, &data[..len]);
                assert!(some.tells(IDS[i].0));
            }
            let mut bytes = [0xff; MAX_LEN];
            let len = some.buffer_len();
            some.emit(&mut bytes);
            let checked = Payload::new_checked(&bytes[..len]);
            if some == Repr::default() {
                assert_eq!(checked.err(), Some(Error::Malformed), "no id");
            } else {
                assert_eq!(Repr::parse(&checked.unwrap()), some, "{left_out:b}");
            }
        }
    }

    #[test]
    fn what_is_cut_off_left_over_or_not_known_is_refused() {
        let mut longer = [0; MAX_LEN + 1];
        longer[..MAX_LEN].copy_from_slice(&GOLDEN);
        let stray = Error::Length { expected: MAX_LEN, found: MAX_LEN + 1 };
        assert_eq!(Payload::new_checked(longer).err(), Some(stray));
        for len in 0..MAX_LEN {
            assert!(Payload::new_checked(&GOLDEN[..len]).is_err(), "{len}");
        }
        let mut unknown = GOLDEN;
        unknown[3] = 0x26;
        assert_eq!(Payload::new_checked(unknown).err(), Some(Error::UnknownType(0x26)));
    }
}
