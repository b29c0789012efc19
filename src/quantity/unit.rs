//! Units and the dimensions they measure.

use super::ratio::Ratio;
use crate::double::Double;
use std::fmt;

/// What everything else is made of; its unit inside is in [`Dimension`]'s `Display`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Base {
    /// Plane angle (rad): a dimension of its own here.
    Angle,
    /// Length (m).
    Length,
    /// Mass (kg): only inside of pressure.
    Mass,
    /// Magnetic flux density (µT).
    Field,
    /// Temperature (K, or °C where absolute).
    Temperature,
    /// Steps of a converter (LSB).
    Count,
    /// Bits of a converter.
    Bit,
    /// Time (s).
    Time,
}

const BASES: [(Base, &str); 8] = [
    (Base::Angle, "rad"),
    (Base::Length, "m"),
    (Base::Mass, "kg"),
    (Base::Field, "uT"),
    (Base::Temperature, "K"),
    (Base::Count, "LSB"),
    (Base::Bit, "bit"),
    (Base::Time, "s"),
];

/// A product of powers of base quantities; square roots are counted, so √Hz is one too.
///
/// Shown in inside units, in a form that can be read back (except for mass): `rad/s/√s`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Dimension {
    /// Twice the exponent of each of [`BASES`].
    half_powers: [i8; 8],
}

impl Dimension {
    /// Plain numbers.
    pub const NONE: Dimension = Dimension { half_powers: [0; 8] };

    /// This dimension with the exponent of `base` set to `half_powers`/2.
    pub const fn with(mut self, base: Base, half_powers: i8) -> Self {
        self.half_powers[base as usize] = half_powers;
        self
    }

    /// The product of this and `other` to the power ±1; `None` for exponents beyond any use.
    pub(super) fn combined(self, other: Self, power: i8) -> Option<Self> {
        let mut half_powers = self.half_powers;
        for (ours, theirs) in half_powers.iter_mut().zip(other.half_powers) {
            *ours = ours.checked_add(theirs.checked_mul(power)?)?;
        }
        Some(Self { half_powers })
    }

    /// This to the power `halves`/2; `None` if that is no whole number of half powers.
    fn raised(self, halves: i8) -> Option<Self> {
        let mut half_powers = self.half_powers;
        for power in &mut half_powers {
            let product = power.checked_mul(halves)?;
            *power = (product % 2 == 0).then_some(product / 2)?;
        }
        Some(Self { half_powers })
    }
}

impl fmt::Display for Dimension {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let powers = || BASES.map(|(base, unit)| (unit, self.half_powers[base as usize]));
        let mut first = true;
        for (unit, power) in powers().into_iter().filter(|(_, power)| *power > 0) {
            let dot = if first { "" } else { "*" };
            first = false;
            write!(f, "{dot}{}", factors(unit, power.unsigned_abs(), "*"))?;
        }
        for (unit, power) in powers().into_iter().filter(|(_, power)| *power < 0) {
            let size = power.unsigned_abs();
            match (first, unit, size % 2) {
                (true, "s", _) => write!(f, "{}", factors("Hz", size, "*"))?,
                (true, _, 0) => write!(f, "{unit}^-{}", size / 2)?,
                (true, _, _) => write!(f, "√{unit}^-{size}")?,
                (false, _, _) => write!(f, "/{}", factors(unit, size, "/"))?,
            }
            first = false;
        }
        Ok(())
    }
}

/// `s`, `s^2`, `√s` or `s/√s`.
fn factors(unit: &str, halves: u8, joint: &str) -> String {
    let whole = match halves / 2 {
        0 => String::new(),
        1 => unit.to_owned(),
        power => format!("{unit}^{power}"),
    };
    match (halves % 2, whole.is_empty()) {
        (0, _) => whole,
        (_, true) => format!("√{unit}"),
        (_, false) => format!("{whole}{joint}√{unit}"),
    }
}

/// How much of the inside unit one of a unit is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Scale {
    /// Inside units in one of this.
    pub factor: Double,
    /// The same as a fraction, where it is one (no π in it) and its terms are not too long.
    pub exact: Option<Ratio>,
    /// What is measured.
    pub dimension: Dimension,
    /// Whether kelvin were named, so that an absolute temperature counts from 0 K.
    pub kelvin: bool,
}

impl Scale {
    /// No unit at all.
    pub const ONE: Scale =
        Scale { factor: Double::ONE, exact: Some(Ratio::ONE), dimension: Dimension::NONE, kelvin: false };

    /// The product; `None` for exponents beyond any use.
    pub fn times(self, other: Self) -> Option<Self> {
        Some(Self {
            factor: self.factor * other.factor,
            exact: self.exact.zip(other.exact).and_then(|(a, b)| a.times(b)),
            dimension: self.dimension.combined(other.dimension, 1)?,
            kelvin: self.kelvin || other.kelvin,
        })
    }

    /// The quotient; `None` for exponents beyond any use.
    pub fn over(self, other: Self) -> Option<Self> {
        let exact = self.exact.zip(other.exact);
        Some(Self {
            factor: self.factor / other.factor,
            exact: exact.and_then(|(a, b)| a.times(b.inverse()?)),
            dimension: self.dimension.combined(other.dimension, -1)?,
            kelvin: self.kelvin || other.kelvin,
        })
    }

    /// This to the power `halves`/2; `None` where the dimension has no such power.
    pub fn raised(self, halves: i8) -> Option<Self> {
        let dimension = self.dimension.raised(halves)?;
        let mut base = self;
        if halves % 2 != 0 && self.factor != Double::ONE {
            base.factor = self.factor.sqrt();
            base.exact = None;
        }
        let times = if halves % 2 == 0 || self.factor == Double::ONE { halves / 2 } else { halves };
        // Only numbers below; the dimension is set at the end.
        base.dimension = Dimension::NONE;
        let mut power = Self::ONE;
        for _ in 0..times.unsigned_abs() {
            power = power.times(base)?;
        }
        if times < 0 {
            power = Self::ONE.over(power)?;
        }
        Some(Self { dimension, kelvin: self.kelvin, ..power })
    }
}

/// One row of the table of units.
struct Unit {
    /// Every spelling; the first is the one to suggest.
    names: &'static [&'static str],
    /// The prefixes it takes (`u` and the Greek mu also mean `µ`).
    prefixes: &'static str,
    /// Inside units in one of these, as a fraction …
    ratio: (u64, u64),
    /// … of degrees rather than radians, if set.
    degrees: bool,
    dimension: Dimension,
}

const ANGLE: Dimension = Dimension::NONE.with(Base::Angle, 2);
const TIME: Dimension = Dimension::NONE.with(Base::Time, 2);
const FREQUENCY: Dimension = Dimension::NONE.with(Base::Time, -2);
const LENGTH: Dimension = Dimension::NONE.with(Base::Length, 2);
const FIELD: Dimension = Dimension::NONE.with(Base::Field, 2);
const TEMPERATURE: Dimension = Dimension::NONE.with(Base::Temperature, 2);
const COUNT: Dimension = Dimension::NONE.with(Base::Count, 2);
const BIT: Dimension = Dimension::NONE.with(Base::Bit, 2);
/// Of a converter.
pub(super) const BITS: Dimension = Dimension::NONE.with(Base::Bit, 2);
const PRESSURE: Dimension = Dimension::NONE.with(Base::Mass, 2).with(Base::Length, -2).with(Base::Time, -4);

const fn unit(
    names: &'static [&'static str],
    prefixes: &'static str,
    ratio: (u64, u64),
    dimension: Dimension,
) -> Unit {
    Unit { names, prefixes, ratio, degrees: false, dimension }
}

const fn in_degrees(
    names: &'static [&'static str],
    prefixes: &'static str,
    ratio: (u64, u64),
    dimension: Dimension,
) -> Unit {
    Unit { degrees: true, ..unit(names, prefixes, ratio, dimension) }
}

const UNITS: &[Unit] = &[
    in_degrees(&["deg", "°", "º", "degree", "degrees"], "mµ", (1, 1), ANGLE),
    unit(&["rad", "radian", "radians"], "mµn", (1, 1), ANGLE),
    in_degrees(&["dps"], "m", (1, 1), ANGLE.with(Base::Time, -2)),
    in_degrees(&["dph"], "", (1, 3600), ANGLE.with(Base::Time, -2)),
    in_degrees(&["rpm"], "", (6, 1), ANGLE.with(Base::Time, -2)),
    in_degrees(&["rev", "turn", "turns"], "", (360, 1), ANGLE),
    in_degrees(&["arcmin"], "", (1, 60), ANGLE),
    in_degrees(&["arcsec"], "m", (1, 3600), ANGLE),
    unit(&["s", "sec", "second", "seconds"], "mµn", (1, 1), TIME),
    unit(&["min", "minute", "minutes"], "", (60, 1), TIME),
    unit(&["h", "hr", "hour", "hours"], "", (3600, 1), TIME),
    unit(&["day", "days", "d"], "", (86_400, 1), TIME),
    unit(&["Hz"], "kMGm", (1, 1), FREQUENCY),
    unit(&["m"], "kmcµn", (1, 1), LENGTH),
    unit(&["ft"], "", (3048, 10_000), LENGTH),
    unit(&["g", "g0", "gn"], "mµn", (980_665, 100_000), LENGTH.with(Base::Time, -4)),
    unit(&["knot", "knots", "kn", "kt"], "", (1852, 3600), LENGTH.with(Base::Time, -2)),
    unit(&["T"], "mµn", (1_000_000, 1), FIELD),
    unit(&["G", "Gs", "gauss", "Gauss"], "mµ", (100, 1), FIELD),
    unit(&["degC", "°C", "ºC", "℃", "K"], "m", (1, 1), TEMPERATURE),
    unit(&["%"], "", (1, 100), Dimension::NONE),
    unit(&["ppm"], "", (1, 1_000_000), Dimension::NONE),
    unit(&["LSB", "LSBs", "lsb", "count", "counts", "digit", "digits"], "", (1, 1), COUNT),
    unit(&["bit", "bits"], "", (1, 1), BIT),
    unit(&["Pa"], "hkM", (1, 1), PRESSURE),
    unit(&["bar"], "m", (100_000, 1), PRESSURE),
];

/// Prefixes by one letter, as fractions.
const PREFIXES: [(char, (u64, u64)); 8] = [
    ('k', (1000, 1)),
    ('M', (1_000_000, 1)),
    ('G', (1_000_000_000, 1)),
    ('h', (100, 1)),
    ('c', (1, 100)),
    ('m', (1, 1000)),
    ('µ', (1, 1_000_000)),
    ('n', (1, 1_000_000_000)),
];

/// The unit spelled exactly so: by its name, by prefix and name, or as the root of one (`rtHz`).
pub(super) fn find(name: &str) -> Option<Scale> {
    let whole = |name: &str| {
        let same = |unit: &&Unit| unit.names.contains(&name);
        Some(scale(UNITS.iter().find(same)?, (1, 1), name))
    };
    let prefixed = |name: &str| {
        let mut letters = name.chars();
        let letter = match letters.next()? {
            'u' | 'μ' => 'µ',
            letter => letter,
        };
        let rest = letters.as_str();
        let (_, ratio) = PREFIXES.iter().find(|(prefix, _)| *prefix == letter)?;
        let same = |unit: &&Unit| unit.prefixes.contains(letter) && unit.names.contains(&rest);
        Some(scale(UNITS.iter().find(same)?, *ratio, rest))
    };
    let plain = |name: &str| whole(name).or_else(|| prefixed(name));
    let root = |name: &str| {
        let under = name.strip_prefix("sqrt").or_else(|| name.strip_prefix("rt"));
        plain(under?)?.raised(1)
    };
    plain(name).or_else(|| root(name))
}

fn scale(unit: &Unit, prefix: (u64, u64), name: &str) -> Scale {
    let ratio = Ratio::new(
        i128::from(unit.ratio.0) * i128::from(prefix.0),
        i128::from(unit.ratio.1) * i128::from(prefix.1),
    );
    let plain = ratio.map_or(Double::ONE, Ratio::to_double);
    Scale {
        factor: if unit.degrees { plain * Double::PI_OVER_180 } else { plain },
        exact: ratio.filter(|_| !unit.degrees),
        dimension: unit.dimension,
        kelvin: name == "K",
    }
}

/// Compounds worth suggesting, before any single unit as near.
const COMPOUNDS: [&str; 8] = ["deg/s", "rad/s", "m/s", "m/s^2", "deg/h", "km/h", "rad/s^2", "deg/√h"];

/// What is written elsewhere, and how it is written here.
const ALIASES: [(&str, &str); 9] = [
    ("mps", "m/s"),
    ("mps2", "m/s^2"),
    ("mpss", "m/s^2"),
    ("kph", "km/h"),
    ("kmh", "km/h"),
    ("rps", "rad/s` or `rev/s"),
    ("c", "degC"),
    ("celsius", "degC"),
    ("meter", "m"),
];

/// What an unknown unit may have been meant to be.
pub(super) fn suggest(name: &str) -> Option<String> {
    let lower = name.to_lowercase();
    if let Some((_, ours)) = ALIASES.iter().find(|(theirs, _)| *theirs == lower) {
        return Some((*ours).to_owned());
    }
    let letters = name.trim_end_matches(|digit: char| digit.is_ascii_digit());
    if letters.len() < name.len() && find(letters).is_some() {
        return Some(format!("{letters}^{}", &name[letters.len()..]));
    }
    let known = || COMPOUNDS.iter().map(|unit| (*unit).to_owned()).chain(spellings());
    if let Some(unit) = known().find(|unit| unit.to_lowercase() == lower) {
        return Some(unit);
    }
    let length = name.chars().count();
    if !(2..=20).contains(&length) {
        return None;
    }
    let allowed = if length < 5 { 1 } else { 2 };
    let distance = |unit: &String| strsim::damerau_levenshtein(name, unit);
    let nearest = known().min_by_key(distance)?;
    (distance(&nearest) <= allowed).then_some(nearest)
}

/// Every spelling of every unit, with the ASCII prefixes.
fn spellings() -> impl Iterator<Item = String> {
    UNITS.iter().flat_map(|unit| {
        let plain = unit.names.iter().map(|name| (*name).to_owned());
        let ascii = |prefix| if prefix == 'µ' { 'u' } else { prefix };
        let prefixes = unit.prefixes.chars().map(ascii);
        let first = unit.names[0];
        plain.chain(prefixes.map(move |prefix| format!("{prefix}{first}")))
    })
}
