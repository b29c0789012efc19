//! What a key accepts, and reading a text as that. The kinds themselves are in `table.rs`.

use super::exact::Sign;
use super::table::BITS;
use super::unit::Dimension;
use super::{Quantity, QuantityError, Values, parse};
use crate::double::Double;

/// What a key of a scene accepts.
///
/// Values come out in inside units, given with each constant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kind {
    pub(super) name: &'static str,
    pub(super) dimensions: &'static [Dimension],
    /// A value as one would write it.
    pub(super) example: &'static str,
    /// Units to offer where one is missing; the first is the inside one.
    pub(super) units: &'static [&'static str],
    pub(super) sign: Sign,
}

impl Kind {
    /// The same kind with these signs allowed.
    pub const fn signed(mut self, sign: Sign) -> Self {
        self.sign = sign;
        self
    }

    /// What it is called: `angular rate`.
    pub const fn name(&self) -> &'static str {
        self.name
    }

    /// Whether it has no sign, as the size of a noise.
    pub const fn is_magnitude(&self) -> bool {
        !matches!(self.sign, Sign::Any)
    }

    /// Which values it takes, to be said behind its name: `, 0 or more`; nothing where it takes any.
    pub const fn bounds(&self) -> &'static str {
        match self.sign {
            Sign::Any => "",
            Sign::NonNegative => ", 0 or more",
            Sign::Positive => ", above 0",
        }
    }

    /// A value as one would write it: `20 deg/s`.
    pub const fn example(&self) -> &'static str {
        self.example
    }

    /// Units worth offering: `rad/s`, `deg/s`.
    pub const fn units(&self) -> &'static [&'static str] {
        self.units
    }

    /// The dimensions accepted.
    pub const fn dimensions(&self) -> &'static [Dimension] {
        self.dimensions
    }

    /// `an angular rate`.
    pub(super) fn with_article(&self) -> String {
        let article = if self.name.starts_with(['a', 'e', 'i', 'o', 'u']) { "an" } else { "a" };
        format!("{article} {}", self.name)
    }

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
                format!("{is}, but {needed} is needed, such as \"{}\"", self.example)
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
        let message = format!("`{name}` {is}, but {needed} is needed, such as `{units}`");
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
            let message = format!("`{}` is no step that a number can hold", quantity.text);
            return Err(QuantityError::new(message, quantity.notes.number));
        }
        Ok(Resolution::Step(step))
    }

    /// A vector stands where one value is needed.
    pub(super) fn one_needed(&self, quantity: &Quantity) -> QuantityError {
        let (text, name) = (&quantity.text, self.with_article());
        let message =
            format!("`{text}` is a vector, but {name} of one value is needed, such as \"{}\"", self.example);
        QuantityError::new(message, quantity.notes.number.clone())
    }

    fn unit_missing(&self, number: &str) -> String {
        let offers: Vec<_> = self.units.iter().map(|unit| format!("\"{number} {unit}\"")).collect();
        format!("a unit is missing in `{number}`: write {}", offers.join(" or "))
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
            Sign::Positive => format!("`{text}` is not above zero, as {name} here must be"),
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
