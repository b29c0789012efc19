//! A set of kinds of sensor.

use super::SensorKind;
use std::fmt;
use std::ops::{BitAnd, BitAndAssign, BitOr, BitOrAssign};

/// A set of kinds of sensor.
///
/// ```
/// use ratetable::sensor::{Kinds, SensorKind};
///
/// let carried = Kinds::TRIADS | Kinds::of(&[SensorKind::Baro]);
/// assert!(carried.contains(SensorKind::Baro) && !carried.contains(SensorKind::Gps));
/// ```
#[derive(Clone, Copy, Default, PartialEq, Eq)]
pub struct Kinds(u8);

impl Kinds {
    /// No kind.
    pub const NONE: Kinds = Kinds(0);

    /// Every kind.
    pub const ALL: Kinds = Kinds::of(&SensorKind::ALL);

    /// Gyroscope, accelerometer and magnetometer.
    pub const TRIADS: Kinds = Kinds::of(&SensorKind::TRIADS);

    /// Those whose readings are components of one quantity: all but a receiver.
    pub const BY_COMPONENT: Kinds =
        Kinds(Kinds::TRIADS.0 | Kinds::of(&[SensorKind::Baro, SensorKind::Airspeed]).0);

    /// These kinds.
    pub const fn of(kinds: &[SensorKind]) -> Kinds {
        let (mut set, mut i) = (0, 0);
        while i < kinds.len() {
            set |= 1 << kinds[i] as u8;
            i += 1;
        }
        Kinds(set)
    }

    /// Whether this kind is among them.
    pub const fn contains(self, kind: SensorKind) -> bool {
        self.0 >> kind as u8 & 1 == 1
    }

    /// Whether there is none.
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// How many there are.
    pub const fn len(self) -> usize {
        self.0.count_ones() as usize
    }

    /// Adds a kind.
    pub const fn insert(&mut self, kind: SensorKind) {
        self.0 |= 1 << kind as u8;
    }

    /// Takes these kinds out.
    pub const fn remove(&mut self, kinds: Kinds) {
        self.0 &= !kinds.0;
    }

    /// The kinds, in order.
    pub fn iter(self) -> impl Iterator<Item = SensorKind> {
        SensorKind::ALL.into_iter().filter(move |kind| self.contains(*kind))
    }
}

impl From<SensorKind> for Kinds {
    fn from(kind: SensorKind) -> Kinds {
        Kinds::of(&[kind])
    }
}

impl BitOr for Kinds {
    type Output = Kinds;

    fn bitor(self, other: Kinds) -> Kinds {
        Kinds(self.0 | other.0)
    }
}

impl BitOrAssign for Kinds {
    fn bitor_assign(&mut self, other: Kinds) {
        *self = *self | other;
    }
}

impl BitAnd for Kinds {
    type Output = Kinds;

    fn bitand(self, other: Kinds) -> Kinds {
        Kinds(self.0 & other.0)
    }
}

impl BitAndAssign for Kinds {
    fn bitand_assign(&mut self, other: Kinds) {
        *self = *self & other;
    }
}

impl FromIterator<SensorKind> for Kinds {
    fn from_iter<T: IntoIterator<Item = SensorKind>>(kinds: T) -> Kinds {
        let mut set = Kinds::NONE;
        kinds.into_iter().for_each(|kind| set.insert(kind));
        set
    }
}

impl fmt::Debug for Kinds {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_set().entries(self.iter().map(SensorKind::name)).finish()
    }
}
