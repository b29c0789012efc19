//! Reading a text as a kind of quantity.

use super::kind::{Kind, Sign};
use super::unit::{BITS, Dimension};
use super::{Quantity, QuantityError, Values, parse};
use crate::double::Double;

impl Kind {
    /// Reads one value, in inside units.
    ///
    /// # Errors
    /// No quantity, one of another dimension or sign, or a vector.
    pub fn scalar(&self, text: &str) -> Result<Double, QuantityError> {
        let quantity = self.quantity(text)?;
        match quantity.values {
            Values::Scalar(value) => Ok(value),
            Values::Vector(_) => Err(self.one_needed(&quantity)),
        }
    }

    /// Reads a vector, in inside units; one value fills all three axes.
    ///
    /// # Errors
    /// No quantity, or one of another dimension or sign.
    pub fn vector(&self, text: &str) -> Result<[Double; 3], QuantityError> {
        Ok(match self.quantity(text)?.values {
            Values::Scalar(value) => [value; 3],
            Values::Vector(values) => values,
        })
    }

    /// Reads a value or vector of this kind, with an absolute temperature brought to °C.
    ///
    /// # Errors
    /// No quantity, or one of another dimension or sign.
    pub fn quantity(&self, text: &str) -> Result<Quantity, QuantityError> {
        self.quantity_or(text, |_| None)
    }

    /// The same, with a better reason for some wrong dimensions: what to say after the text.
    pub(super) fn quantity_or(
        &self,
        text: &str,
        reason: impl Fn(&Quantity) -> Option<String>,
    ) -> Result<Quantity, QuantityError> {
        let mut quantity = parse::quantity(text, Some(self))?;
        let notes = &quantity.notes;
        if !self.dimensions.contains(&quantity.dimension) {
            if notes.unit.is_empty() {
                let message = self.unit_missing(&text[notes.number.clone()]);
                return Err(QuantityError::new(message, notes.number.clone()));
            }
            let reason = reason(&quantity).unwrap_or_else(|| {
                let (is, needed) = (describe(quantity.dimension), self.with_article());
                format!("{is}, but {needed} is required, such as \"{}\"", self.example)
            });
            let message = format!("`{}` {reason}", quantity.text);
            return Err(QuantityError::new(message, notes.unit.clone()));
        }
        if notes.kelvin && self.name == Self::TEMPERATURE.name {
            let zero = Double::from(27_315_i64) / Double::from(100_i64);
            match &mut quantity.values {
                Values::Scalar(value) => *value = *value - zero,
                Values::Vector(values) => *values = values.map(|value| value - zero),
            }
        }
        self.check_sign(&quantity)?;
        Ok(quantity)
    }

    /// Reads a unit alone, such as a column's: how many inside units one of it is.
    ///
    /// # Errors
    /// No unit, or one of another dimension.
    pub fn unit(&self, text: &str) -> Result<Double, QuantityError> {
        let scale = parse::unit(text, Some(self))?;
        if self.dimensions.contains(&scale.dimension) {
            return Ok(scale.factor);
        }
        let (name, is, needed) = (text.trim(), describe(scale.dimension), self.with_article());
        let units = self.units.join("` or `");
        let message = format!("`{name}` {is}, but {needed} is required, such as `{units}`");
        Err(QuantityError::new(message, 0..text.len()))
    }

    /// Reads a step of a converter: per count, counts per unit, the step alone, or bits.
    ///
    /// For the three kinds called resolution; others have no counts.
    ///
    /// # Errors
    /// No quantity of this kind, 0 or below, or bits that are no whole number from 1 to 64.
    pub fn resolution(&self, text: &str) -> Result<Resolution, QuantityError> {
        let quantity = self.quantity(text)?;
        let Values::Scalar(value) = quantity.values else {
            return Err(self.one_needed(&quantity));
        };
        if quantity.dimension == BITS {
            let whole = value.hi.fract() == 0.0 && value.lo == 0.0;
            if whole && (1.0..=64.0).contains(&value.hi) {
                return Ok(Resolution::Bits(value.hi as u32));
            }
            let message = format!("`{}` is not a whole number of bits from 1 to 64", quantity.text);
            return Err(QuantityError::new(message, quantity.notes.number));
        }
        let inverse = self.dimensions.get(1) == Some(&quantity.dimension);
        let step = if inverse { Double::ONE / value } else { value };
        if !step.is_finite() || step.hi == 0.0 {
            let message = format!("`{}` is too small or too large a step for a number", quantity.text);
            return Err(QuantityError::new(message, quantity.notes.number));
        }
        Ok(Resolution::Step(step))
    }

    /// A vector stands where one value is needed.
    pub(super) fn one_needed(&self, quantity: &Quantity) -> QuantityError {
        let (text, name) = (&quantity.text, self.with_article());
        let message = format!(
            "`{text}` is a vector, but {name} with one value is required, such as \"{}\"",
            self.example
        );
        QuantityError::new(message, quantity.notes.number.clone())
    }

    fn unit_missing(&self, number: &str) -> String {
        let offers: Vec<_> = self.units.iter().map(|unit| format!("\"{number} {unit}\"")).collect();
        format!("`{number}` has no unit: write {}", offers.join(" or "))
    }

    fn check_sign(&self, quantity: &Quantity) -> Result<(), QuantityError> {
        let allowed = |value: &Double| match self.sign {
            Sign::Any => true,
            Sign::NonNegative => value.hi >= 0.0,
            Sign::Positive => value.hi > 0.0,
        };
        let all = match &quantity.values {
            Values::Scalar(value) => allowed(value),
            Values::Vector(values) => values.iter().all(allowed),
        };
        if all {
            return Ok(());
        }
        let (text, name) = (&quantity.text, self.with_article());
        let message = match self.sign {
            Sign::Positive => format!("`{text}` is not above zero: {name} here must be"),
            _ => format!("`{text}` is negative, but {name} here must be 0 or above"),
        };
        Err(QuantityError::new(message, quantity.notes.number.clone()))
    }
}

/// `is an angle`, or `is in rad/s^5`.
fn describe(dimension: Dimension) -> String {
    match Kind::ALL.iter().find(|kind| kind.dimensions.contains(&dimension)) {
        Some(kind) => format!("is {}", kind.with_article()),
        None => format!("is in {dimension}"),
    }
}

/// The step of a converter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Resolution {
    /// Inside units (rad/s, m/s² or µT) in one count; above 0.
    Step(Double),
    /// Bits over the whole range, from 1 to 64.
    Bits(u32),
}
