//! Numbers with units, as datasheets write them: `"0.01 deg/s/√Hz"`, `"[0.7, 0.33, -4.04] mm/s^2"`.
//!
//! A text is a number, a fraction (`400/3 Hz`) or a vector of three, then a unit expression.
//! Whatever spells the same dimension is accepted: `deg/s/√s` and `deg/s^2/rtHz` are one thing,
//! while rad/s and Hz are not, since angle is a dimension here. Inside, everything is in SI, except
//! that magnetic fields are in µT and temperatures in °C; values are kept as double-doubles, so that a
//! decimal in degrees loses nothing on its way to radians.
//!
//! What a key accepts is its [`Kind`]; every refusal is a [`QuantityError`], which knows where in
//! the text the trouble is.
//!
//! ```
//! use ratetable::quantity::{Kind, rate};
//!
//! assert_eq!(rate("400/3 Hz")?, (400, 3));
//! let value = Kind::ANGULAR_RATE.scalar("180 deg/s")?;
//! assert!((value.to_f64() - std::f64::consts::PI).abs() < 1e-15);
//! assert!(Kind::ANGULAR_RATE.scalar("180 m").is_err());
//! # Ok::<(), ratetable::quantity::QuantityError>(())
//! ```

mod exact;
mod expression;
mod kind;
mod matrix;
mod parse;
mod ratio;
mod read;
mod table;
mod text;
mod unit;

pub use exact::{duration_ns, rate};
pub use kind::{Kind, Sign};
pub use read::Resolution;
pub use text::{text_scalar, text_vector};
pub use unit::{Base, Dimension};

use crate::double::Double;
use std::ops::Range;

/// A text that is no quantity, or not one of the kind needed.
///
/// One message and one place are all that a reader of scenes needs: no caller acts on the reason,
/// every caller shows it, next to the file, line and column it works out from [`Self::span`].
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{message}")]
pub struct QuantityError {
    message: String,
    span: Range<usize>,
}

impl QuantityError {
    fn new(message: impl Into<String>, span: Range<usize>) -> Self {
        Self { message: message.into(), span }
    }

    /// Where the offending part begins, in bytes from the start of the text as given.
    pub fn offset(&self) -> usize {
        self.span.start
    }

    /// The offending part, in bytes of the text as given; empty where something is missing.
    pub fn span(&self) -> Range<usize> {
        self.span.clone()
    }
}

/// The number or numbers of a [`Quantity`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Values {
    /// One value.
    Scalar(Double),
    /// Three, one an axis.
    Vector([Double; 3]),
}

/// A number or vector with a unit, brought to the units used inside.
#[derive(Clone, Debug, PartialEq)]
pub struct Quantity {
    /// The values, in inside units (SI; fields in µT; temperatures as differences, in K or °C).
    pub values: Values,
    /// What is measured.
    pub dimension: Dimension,
    /// The text it was read from, without the space around it.
    pub text: String,
    /// What the reader noticed besides.
    notes: parse::Notes,
}

impl Quantity {
    /// Reads any quantity, whatever it measures.
    ///
    /// # Errors
    /// A text that is not a number or vector with a known unit, or a value too large for an `f64`.
    pub fn parse(text: &str) -> Result<Self, QuantityError> {
        parse::quantity(text, None)
    }
}

#[cfg(test)]
mod tests;
