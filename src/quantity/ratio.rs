//! Exact fractions.

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
