//! Rates and durations, which are exact fractions and never pass through a float.

use super::kind::{Kind, Sign};
use super::ratio::{Ratio, whole};
use super::{Quantity, QuantityError, Values};
use crate::double::Double;

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
            format!("is a time, but a rate is required: write \"{numerator} Hz\"")
        } else {
            format!("is a time, but a rate is required: write \"{numerator}/{denominator} Hz\"")
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
        return refuse("is above 1 MHz, the highest rate");
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
        let message = format!("`{}` is too long: the limit is 292 years", quantity.text);
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
