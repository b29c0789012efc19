//! Rates and durations, which are exact fractions and never pass through a float.

use super::kind::Kind;
use super::{Quantity, QuantityError, Values};
use crate::double::Double;

/// A fraction in lowest terms, with a positive denominator.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Ratio {
    numerator: i128,
    denominator: i128,
}

impl Ratio {
    /// One.
    pub const ONE: Ratio = Ratio { numerator: 1, denominator: 1 };

    /// `numerator / denominator`, unless the latter is 0 or one of them is `i128::MIN`.
    pub fn new(numerator: i128, denominator: i128) -> Option<Self> {
        let (mut a, mut b) = (numerator.checked_abs()?, denominator.checked_abs()?);
        if b == 0 {
            return None;
        }
        while b != 0 {
            (a, b) = (b, a % b);
        }
        let divisor = a * denominator.signum();
        Some(Self { numerator: numerator / divisor, denominator: denominator / divisor })
    }

    /// A decimal literal with ASCII signs; `None` where its terms would be too long.
    pub fn from_decimal(text: &str) -> Option<Self> {
        let (mantissa, power) = match text.find(['e', 'E']) {
            Some(at) => (&text[..at], text[at + 1..].parse::<i32>().ok()?),
            None => (text, 0),
        };
        let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
        let fraction = fraction.trim_end_matches('0');
        let digits: i128 = match format!("{whole}{fraction}").as_str() {
            "" | "+" | "-" => 0,
            digits => digits.parse().ok()?,
        };
        if digits == 0 {
            return Self::new(0, 1);
        }
        let power = power.checked_sub(i32::try_from(fraction.len()).ok()?)?;
        let tens = 10_i128.checked_pow(power.unsigned_abs())?;
        if power < 0 { Self::new(digits, tens) } else { Self::new(digits.checked_mul(tens)?, 1) }
    }

    /// The product, unless its terms are too long.
    pub fn times(self, other: Self) -> Option<Self> {
        // Cancelling crosswise first keeps the terms as short as they can be.
        let left = Self::new(self.numerator, other.denominator)?;
        let right = Self::new(other.numerator, self.denominator)?;
        Some(Self {
            numerator: left.numerator.checked_mul(right.numerator)?,
            denominator: left.denominator.checked_mul(right.denominator)?,
        })
    }

    /// The inverse, unless this is 0.
    pub fn inverse(self) -> Option<Self> {
        Self::new(self.denominator, self.numerator)
    }

    /// The terms.
    pub fn terms(self) -> (i128, i128) {
        (self.numerator, self.denominator)
    }

    /// To about 10⁻³¹.
    pub fn to_double(self) -> Double {
        if self.denominator == 1 {
            whole(self.numerator)
        } else {
            whole(self.numerator) / whole(self.denominator)
        }
    }
}

/// A whole number to 106 bits.
pub(super) fn whole(value: i128) -> Double {
    let hi = value as f64;
    Double::new(hi, value.wrapping_sub(hi as i128) as f64)
}

/// Which signs a value may have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sign {
    /// Any.
    Any,
    /// Zero or above.
    NonNegative,
    /// Above zero.
    Positive,
}

/// The highest rate that a sensor may have, in Hz.
const HIGHEST: i128 = 1_000_000;
/// The largest denominator of a rate: nine decimals.
const FINEST: i128 = 1_000_000_000;

/// A sensor's output rate in Hz, as an exact fraction in lowest terms: `"1 kHz"` is (1000, 1),
/// `"400/3 Hz"` is (400, 3), `"133.333 Hz"` is (133333, 1000).
///
/// The numerator is at most 10¹⁵ and the denominator at most 10⁹.
///
/// # Errors
/// Anything but a rate above 0 and at most 1 MHz; a period (the hint says which rate it is); more
/// than nine decimals.
pub fn rate(text: &str) -> Result<(u64, u64), QuantityError> {
    let kind = Kind::RATE;
    let quantity = kind.quantity_or(text, |quantity| {
        let period = quantity.notes.exact.filter(|_| quantity.dimension == Kind::TIME.dimensions()[0]);
        let (numerator, denominator) = period.and_then(Ratio::inverse)?.terms();
        Some(if denominator == 1 {
            format!("is a time, but a rate is needed: write \"{numerator} Hz\"")
        } else {
            format!("is a time, but a rate is needed: write \"{numerator}/{denominator} Hz\"")
        })
    })?;
    let value = kind.one_of(&quantity)?;
    let refuse = |why: &str| {
        let message = format!("`{}` {why}", quantity.text);
        Err(QuantityError::new(message, quantity.notes.number.clone()))
    };
    let too_fine = "has too many digits for a rate (nine decimals at most): write a fraction, \
                    such as \"400/3 Hz\"";
    if value > whole(HIGHEST) {
        return refuse("is above 1 MHz, the highest rate there is");
    }
    match quantity.notes.exact.map(Ratio::terms) {
        Some((numerator, denominator)) if denominator <= FINEST => Ok((numerator as u64, denominator as u64)),
        _ => refuse(too_fine),
    }
}

/// A duration or instant in nanoseconds, exact for every decimal: `"0.1 s"` is 100 000 000.
/// Parts of a nanosecond are rounded to the nearest, halves away from zero.
///
/// # Errors
/// Anything but a time of the given sign that fits into an `i64` (292 years).
pub fn duration_ns(text: &str, sign: Sign) -> Result<i64, QuantityError> {
    let kind = Kind::TIME.signed(sign);
    let quantity = kind.quantity(text)?;
    let seconds = kind.one_of(&quantity)?;
    let exact = quantity.notes.exact.and_then(|ratio| {
        let (numerator, denominator) = ratio.times(Ratio::new(1_000_000_000, 1)?)?.terms();
        let (quotient, rest) = (numerator / denominator, numerator % denominator);
        let away = rest.checked_abs()? >= denominator - rest.checked_abs()?;
        Some(quotient + if away { numerator.signum() } else { 0 })
    });
    let nanoseconds = match exact {
        Some(exact) => i64::try_from(exact).ok(),
        None => (seconds * 1e9).round_to_i64(),
    };
    nanoseconds.ok_or_else(|| {
        let message = format!("`{}` is too long: 292 years are the most", quantity.text);
        QuantityError::new(message, quantity.notes.number.clone())
    })
}

impl Kind {
    /// The only value of a quantity already known to be of this kind.
    fn one_of(&self, quantity: &Quantity) -> Result<Double, QuantityError> {
        match quantity.values {
            Values::Scalar(value) => Ok(value),
            Values::Vector(_) => Err(self.one_needed(quantity)),
        }
    }
}
