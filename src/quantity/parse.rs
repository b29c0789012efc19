//! The grammar: a number, fraction or vector, then a unit expression (see `expression.rs`).

use super::kind::Kind;
use super::ratio::{Ratio, whole};
use super::unit::Scale;
use super::{Quantity, QuantityError, Values};
use crate::double::Double;
use std::ops::Range;

/// What the reader noticed beside value and dimension.
#[derive(Clone, Debug, PartialEq)]
pub struct Notes {
    /// A scalar in inside units as a fraction, where it is one with terms of bearable length.
    pub(super) exact: Option<Ratio>,
    /// Where the number or vector is, in bytes of the text as given.
    pub(super) number: Range<usize>,
    /// Where the unit is; empty, after the number, if there is none.
    pub(super) unit: Range<usize>,
    /// Whether an absolute temperature counts from 0 K.
    pub(super) kelvin: bool,
}

/// Reads a whole text as a quantity; `kind` is only for better hints.
pub(super) fn quantity(text: &str, kind: Option<&Kind>) -> Result<Quantity, QuantityError> {
    let mut reader = Reader::new(text, kind);
    reader.skip_space();
    let start = reader.at;
    let (numbers, vector) = reader.numbers()?;
    let number = start..reader.at;
    reader.skip_space();
    let first = reader.at;
    let scale = if reader.rest().is_empty() { Scale::ONE } else { reader.unit_to_the_end()? };
    let text = text.trim();
    let unit = if first == reader.text.len() { number.end..number.end } else { first..start + text.len() };
    let too_large = || QuantityError::new(format!("`{text}` is too large"), number.clone());
    let scaled: Vec<Double> = numbers.iter().map(|number| number.scaled(scale)).collect();
    if !scaled.iter().all(|value| value.is_finite()) {
        return Err(too_large());
    }
    let values = match (vector, scaled.as_slice()) {
        (false, [value]) => Values::Scalar(*value),
        (_, [x, y, z]) => Values::Vector([*x, *y, *z]),
        (_, others) => {
            let message = format!("a vector has 3 values, not {}", others.len());
            return Err(QuantityError::new(message, number));
        }
    };
    let exact = numbers[0].exact.zip(scale.exact).filter(|_| !vector);
    Ok(Quantity {
        values,
        dimension: scale.dimension,
        text: text.to_owned(),
        notes: Notes {
            exact: exact.and_then(|(number, unit)| number.times(unit)),
            number,
            unit,
            kelvin: scale.kelvin,
        },
    })
}

/// Reads a whole text as a unit without a number.
pub(super) fn unit(text: &str, kind: Option<&Kind>) -> Result<Scale, QuantityError> {
    let mut reader = Reader::new(text, kind);
    reader.skip_space();
    reader.unit_to_the_end()
}

/// A number as written.
#[derive(Clone, Copy)]
struct Number {
    value: Double,
    exact: Option<Ratio>,
}

impl Number {
    fn scaled(self, scale: Scale) -> Double {
        // A zero keeps its sign; fractions are applied as such, so that 500 ms is 0.5 s exactly.
        match scale.exact.map(Ratio::terms) {
            _ if self.value.hi == 0.0 => self.value,
            Some((1, 1)) => self.value,
            Some((top, bottom)) => {
                let top = self.value * whole(top);
                if bottom == 1 { top } else { top / whole(bottom) }
            }
            None => self.value * scale.factor,
        }
    }
}

/// A text and how far it has been read.
pub(super) struct Reader<'a> {
    pub(super) text: &'a str,
    pub(super) at: usize,
    pub(super) kind: Option<&'a Kind>,
}

impl<'a> Reader<'a> {
    fn new(text: &'a str, kind: Option<&'a Kind>) -> Self {
        Self { text, at: 0, kind }
    }

    fn rest(&self) -> &'a str {
        &self.text[self.at..]
    }

    pub(super) fn peek(&self) -> Option<char> {
        self.rest().chars().next()
    }

    pub(super) fn skip_space(&mut self) {
        self.take_while(char::is_whitespace);
    }

    pub(super) fn take_while(&mut self, wanted: impl Fn(char) -> bool) -> &'a str {
        let rest = self.rest();
        let taken = &rest[..rest.find(|c| !wanted(c)).unwrap_or(rest.len())];
        self.at += taken.len();
        taken
    }

    pub(super) fn take(&mut self, wanted: impl Fn(char) -> bool) -> Option<char> {
        let next = self.peek().filter(|next| wanted(*next))?;
        self.at += next.len_utf8();
        Some(next)
    }

    pub(super) fn error<T>(
        &self,
        message: impl Into<String>,
        span: Range<usize>,
    ) -> Result<T, QuantityError> {
        Err(QuantityError::new(message, span))
    }

    /// The next character is no good; `hint` is what to do about it.
    pub(super) fn unexpected<T>(&self, hint: &str) -> Result<T, QuantityError> {
        match self.peek() {
            Some(next) => {
                self.error(format!("`{next}` is unexpected here{hint}"), self.at..self.at + next.len_utf8())
            }
            None => self.error(format!("something is missing at the end{hint}"), self.at..self.at),
        }
    }

    pub(super) fn example(&self) -> &'static str {
        self.kind.map_or("20 deg/s", Kind::example)
    }

    /// A number or a vector of them, and whether it is a vector.
    fn numbers(&mut self) -> Result<(Vec<Number>, bool), QuantityError> {
        if self.take(|c| c == '[').is_none() {
            return Ok((vec![self.number()?], false));
        }
        let mut numbers = Vec::new();
        loop {
            self.skip_space();
            if !numbers.is_empty() && self.take(|c| c == ']').is_some() {
                return Ok((numbers, true));
            }
            numbers.push(self.number()?);
            self.skip_space();
            match self.peek() {
                Some(',') => self.at += 1,
                Some(']') => {}
                Some(letter) if starts_unit(letter) => {
                    return self.unexpected(": one unit follows the bracket, as in \"[1, 2, 3] deg\"");
                }
                _ => return self.unexpected(": a vector is written as in \"[1, 2, 3] deg\""),
            }
        }
    }

    /// A decimal number or a fraction of two.
    fn number(&mut self) -> Result<Number, QuantityError> {
        let start = self.at;
        let number = self.decimal()?;
        let after = self.at;
        self.skip_space();
        let over = self.take(|c| c == '/').is_some() && {
            self.skip_space();
            self.peek().is_some_and(|c| c.is_ascii_digit())
        };
        if !over {
            self.at = after;
            return Ok(number);
        }
        let divisor = self.decimal()?;
        if divisor.value.hi == 0.0 {
            return self.error("a fraction cannot have denominator 0", start..self.at);
        }
        let exact = number.exact.zip(divisor.exact);
        Ok(Number {
            value: number.value / divisor.value,
            exact: exact.and_then(|(a, b)| a.times(b.inverse()?)),
        })
    }

    fn decimal(&mut self) -> Result<Number, QuantityError> {
        let start = self.at;
        let mut literal = String::new();
        let minus = |c| matches!(c, '-' | '−');
        match self.take(|c| minus(c) || c == '+') {
            Some(sign) if minus(sign) => literal.push('-'),
            _ => {}
        }
        let digits = |c: char| c.is_ascii_digit();
        let whole = self.take_while(digits);
        literal.push_str(whole);
        let mut fraction = "";
        if self.take(|c| c == '.').is_some() {
            fraction = self.take_while(digits);
            literal.push('.');
            literal.push_str(fraction);
        }
        if whole.is_empty() && fraction.is_empty() {
            return self.no_number(start);
        }
        // `e` is an exponent only if digits follow: otherwise a unit may begin with it.
        let before = self.at;
        if self.take(|c| matches!(c, 'e' | 'E')).is_some() {
            let sign = self.take(|c| minus(c) || c == '+');
            let power = self.take_while(digits);
            if power.is_empty() {
                self.at = before;
            } else {
                literal.push('e');
                literal.push_str(if sign.is_some_and(minus) { "-" } else { "" });
                literal.push_str(power);
            }
        }
        let Some(value) = Double::from_decimal(&literal) else {
            let message = format!("`{}` is too large", &self.text[start..self.at]);
            return self.error(message, start..self.at);
        };
        Ok(Number { value, exact: Ratio::from_decimal(&literal) })
    }

    /// There should have been digits.
    fn no_number<T>(&mut self, start: usize) -> Result<T, QuantityError> {
        let word = self.take_while(char::is_alphabetic).to_lowercase();
        let shown = &self.text[start..self.at];
        let example = self.example();
        if matches!(word.as_str(), "nan" | "inf" | "infinity" | "infinite") {
            return self.error(format!("`{shown}` is not a finite number"), start..self.at);
        }
        self.at = start;
        match self.peek() {
            None => {
                self.error(format!("a value is missing: write, for example, \"{example}\""), start..start)
            }
            Some('±') => self.unexpected(&format!(": write the number alone, as in \"{example}\"")),
            Some(letter) if starts_unit(letter) => self.error(
                format!("a number is missing before `{}`, as in \"{example}\"", self.rest().trim()),
                start..self.text.trim_end().len(),
            ),
            Some(_) => self.unexpected(&format!(": a number is required, as in \"{example}\"")),
        }
    }
}

/// Whether a unit may begin so.
pub(super) fn starts_unit_name(c: char) -> bool {
    c.is_alphabetic() || matches!(c, '°' | '%' | '℃')
}

/// Whether a unit or the root of one may begin so.
pub(super) fn starts_unit(c: char) -> bool {
    starts_unit_name(c) || c == '√'
}
