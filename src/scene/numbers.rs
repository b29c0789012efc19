//! Numbers of a table: quantities with their units, and bare ones where no unit is.

use super::document::{Node, Value};
use super::section::Section;
use super::suggest;
use crate::double::Double;
use crate::quantity::{self, Kind, QuantityError, Sign};
use crate::time::{Rate, SimTime};

impl Section<'_> {
    /// Four bare numbers.
    pub fn quaternion(&self, key: &'static str) -> Option<[f64; 4]> {
        let node = &self.entry(key)?.node;
        let number = |node: &Node| match &node.value {
            Value::Integer(number) => Some(*number as f64),
            Value::Float(text) => text.replace('_', "").parse::<f64>().ok().filter(|x| x.is_finite()),
            _ => None,
        };
        let numbers: Option<Vec<f64>> = match &node.value {
            Value::Array(nodes) => nodes.iter().map(number).collect(),
            _ => None,
        };
        let Some([w, x, y, z]) = numbers.as_deref() else {
            self.mistake(key, "a quaternion is four numbers without a unit: [w, x, y, z]");
            return None;
        };
        let length = libm::sqrt(w * w + x * x + y * y + z * z);
        if (length - 1.0).abs() > 1e-3 {
            self.mistake(
                key,
                format!("[{w}, {x}, {y}, {z}] has the length {length:.4}, but a rotation has length 1"),
            );
            return None;
        }
        self.resolve(key, vec![*w, *x, *y, *z]);
        Some([w / length, x / length, y / length, z / length])
    }

    /// A text with a unit, read by `read`; a bare number is read too, for what is said of the unit it lacks.
    pub(super) fn measured<T>(
        &self,
        key: &'static str,
        default: Option<&str>,
        example: &str,
        read: impl Fn(&str) -> Result<T, QuantityError>,
    ) -> Option<T> {
        let text = match self.entry(key).map(|entry| &entry.node) {
            None => default?.to_string(),
            Some(node) => self.spelled(key, node, example)?,
        };
        match read(&text) {
            Ok(value) => {
                self.resolve(key, text);
                Some(value)
            }
            Err(error) => {
                let place = self
                    .table
                    .get(key)
                    .map_or(self.table.place.clone(), |entry| entry.node.place_in_text(error.offset()));
                let instead = suggest::instead(key, &text);
                self.note(&place, format!("`{key}`: {error}{instead}"));
                None
            }
        }
    }

    /// The text of a quantity, or of the bare numbers that stand in its place.
    pub(super) fn spelled(&self, key: &'static str, node: &Node, example: &str) -> Option<String> {
        let bare = |node: &Node| match &node.value {
            Value::Integer(number) => Some(number.to_string()),
            Value::Float(number) => Some(number.replace('_', "")),
            _ => None,
        };
        let text = match &node.value {
            Value::Text(text) => Some(text.clone()),
            Value::Array(nodes) => nodes
                .iter()
                .map(bare)
                .collect::<Option<Vec<_>>>()
                .map(|numbers| format!("[{}]", numbers.join(", "))),
            _ => bare(node),
        };
        if text.is_none() {
            let is = node.value.what();
            self.note(
                &node.place,
                format!("`{key}` is {is}; write a string with a unit, such as \"{example}\""),
            );
        }
        text
    }

    /// One number of a kind.
    pub fn scalar(&self, key: &'static str, kind: Kind, default: Option<&str>) -> Option<f64> {
        self.measured(key, default, kind.example(), |text| kind.scalar(text)).map(|value| value.to_f64())
    }

    /// A time, exact in nanoseconds.
    pub fn time(&self, key: &'static str, default: Option<&str>, sign: Sign) -> Option<SimTime> {
        self.measured(key, default, "5 s", |text| quantity::duration_ns(text, sign)).map(SimTime)
    }

    /// A sensor's rate, or the default.
    pub fn rate(&self, key: &'static str, default: Option<&str>) -> Option<Rate> {
        let (numerator, denominator) = self.measured(key, default, "100 Hz", quantity::rate)?;
        Rate::new(numerator, denominator)
    }

    /// A vector of a kind, one number filling all three, to full precision.
    pub fn vector(&self, key: &'static str, kind: Kind, default: Option<&str>) -> Option<[Double; 3]> {
        let example = format!("[1, 2, 3] {}", kind.units()[0]);
        self.measured(key, default, &example, |text| kind.vector(text))
    }
}
