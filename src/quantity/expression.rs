//! The grammar of units: names, prefixes, powers, roots, parentheses, joined by `*` and `/`.

use super::QuantityError;
use super::parse::{Reader, starts_unit, starts_unit_name};
use super::unit::{self, Scale};

/// How deep parentheses may nest.
const DEEPEST: usize = 8;

const SUPERSCRIPTS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];

impl<'a> Reader<'a> {
    /// Reads a unit expression that nothing follows.
    pub(super) fn unit_to_the_end(&mut self) -> Result<Scale, QuantityError> {
        let scale = self.expression(0)?;
        match self.peek() {
            None => Ok(scale),
            Some(_) => self.unexpected(""),
        }
    }

    /// Units joined by `*` and `/`, left to right; ends before `)` or at the end.
    fn expression(&mut self, depth: usize) -> Result<Scale, QuantityError> {
        let start = self.at;
        let mut total = match self.peek() {
            Some('/') => Scale::ONE,
            _ => self.factor(depth)?,
        };
        loop {
            self.skip_space();
            let divide = match self.peek() {
                None | Some(')') => return Ok(total),
                Some('/' | '∕') => true,
                Some('*' | '·' | '⋅' | '∙' | '×') => false,
                Some('-' | '−') => return self.unexpected(": a power is written as in `s^-1`"),
                Some(',') => return self.unexpected(": write decimals with a point"),
                Some(letter) if starts_unit(letter) || letter == '(' => {
                    return self.unexpected(": units are joined by `*` or `/`");
                }
                Some(_) => return self.unexpected(""),
            };
            self.take(|_| true);
            self.skip_space();
            let factor = self.factor(depth)?;
            let next = if divide { total.over(factor) } else { total.times(factor) };
            total = self.bearable(next, start)?;
        }
    }

    fn bearable(&self, scale: Option<Scale>, start: usize) -> Result<Scale, QuantityError> {
        let usable = |scale: &Scale| scale.factor.is_finite() && scale.factor.hi > 0.0;
        match scale.filter(usable) {
            Some(scale) => Ok(scale),
            None => self.error(
                format!("`{}` has a power that no unit has", &self.text[start..self.at]),
                start..self.at,
            ),
        }
    }

    /// A unit, a root or a parenthesis, with its power.
    fn factor(&mut self, depth: usize) -> Result<Scale, QuantityError> {
        let start = self.at;
        let root = self.take(|c| c == '√').is_some();
        self.skip_space();
        let scale = self.atom(depth)?;
        let scale = if root { scale.raised(1) } else { Some(scale) };
        let mut scale = self.bearable(scale, start)?;
        if let Some(halves) = self.power()? {
            scale = self.bearable(scale.raised(halves), start)?;
        }
        Ok(scale)
    }

    fn atom(&mut self, depth: usize) -> Result<Scale, QuantityError> {
        let start = self.at;
        if self.peek() == Some('(') {
            return self.parenthesis(depth);
        }
        let name = self.name();
        if matches!(name, "sqrt" | "rt") {
            self.skip_space();
            if self.peek() == Some('(') {
                let scale = self.parenthesis(depth)?.raised(1);
                return self.bearable(scale, start);
            }
        }
        if name.is_empty() {
            return match self.peek() {
                Some(',') => self.unexpected(": write decimals with a point"),
                _ => self.unexpected(&format!(": a unit is required, as in \"{}\"", self.example())),
            };
        }
        match unit::find(name) {
            Some(scale) => Ok(scale),
            None => self.error(self.unknown(name), start..start + name.len()),
        }
    }

    fn unknown(&self, name: &str) -> String {
        match (unit::suggest(name), self.kind) {
            (Some(near), _) => format!("unknown unit `{name}`: did you mean `{near}`?"),
            (None, Some(kind)) => format!(
                "unknown unit `{name}`: {} is required, such as \"{}\"",
                kind.with_article(),
                kind.example()
            ),
            (None, None) => format!("unknown unit `{name}`"),
        }
    }

    fn parenthesis(&mut self, depth: usize) -> Result<Scale, QuantityError> {
        let start = self.at;
        if depth == DEEPEST {
            return self.error("too many parentheses", start..start + 1);
        }
        self.at += 1;
        self.skip_space();
        let scale = self.expression(depth + 1)?;
        if self.take(|c| c == ')').is_none() {
            return self.error("this parenthesis is not closed", start..start + 1);
        }
        Ok(scale)
    }

    /// The name of a unit: letters, then perhaps digits; or `°` alone or with a letter; or `%`.
    fn name(&mut self) -> &'a str {
        let start = self.at;
        if let Some('%' | '℃') = self.take(starts_unit_name) {
            return &self.text[start..self.at];
        }
        self.take_while(|c| c.is_alphabetic() || c == '°' || c.is_ascii_digit());
        &self.text[start..self.at]
    }

    /// A power after a unit, in halves.
    fn power(&mut self) -> Result<Option<i8>, QuantityError> {
        let start = self.at;
        let bad = |reader: &Self| {
            let end = reader.at + reader.peek().map_or(0, char::len_utf8);
            reader.error("a power is a small whole number, or `0.5`", start..end)
        };
        if self.take(|c| c == '^').is_none() {
            let negative = self.take(|c| c == '⁻').is_some();
            let mut digits = Vec::new();
            while let Some(digit) = self.peek().and_then(|c| SUPERSCRIPTS.iter().position(|s| *s == c)) {
                self.take(|_| true);
                digits.push(digit as i8);
            }
            return match (digits.as_slice(), negative) {
                ([], false) => Ok(None),
                ([digit], false) => Ok(Some(2 * digit)),
                ([digit], true) => Ok(Some(-2 * digit)),
                _ => bad(self),
            };
        }
        let open = self.take(|c| c == '(').is_some();
        let sign = match self.take(|c| matches!(c, '-' | '−' | '+')) {
            Some('-' | '−') => -1,
            _ => 1,
        };
        let rest = self.take_while(|c| c.is_ascii_digit() || c == '.' || (open && c == '/'));
        if open && self.take(|c| c == ')').is_none() {
            return bad(self);
        }
        let halves = match rest.as_bytes() {
            [digit @ b'0'..=b'9'] => 2 * (digit - b'0'),
            [digit @ b'0'..=b'9', b'.', b'5'] => 2 * (digit - b'0') + 1,
            [digit @ b'0'..=b'9', b'/', b'2'] => digit - b'0',
            _ => return bad(self),
        };
        Ok(Some(sign * halves as i8))
    }
}
