//! Keys that a motion, an error term or a fault declares as data, read by their declarations.

use super::document::Value;
use super::section::Section;
use crate::double::Double;
use crate::geometry::Axes;
use crate::keys::{self, Key, Takes, Values};
use crate::quantity::{Kind, Sign};

impl Section<'_> {
    /// Every declared key of `keys` that has a value or a default.
    pub fn values(&self, keys: &[Key], may_draw: bool) -> Values {
        let mut values = Values::default();
        for key in keys {
            if let Some(value) = self.value(key, may_draw) {
                values.insert(key.name, value);
            }
        }
        values
    }

    /// Whether one of the keys is there but could not be read, which a mistake says already.
    pub fn unread(&self, keys: &[Key], values: &Values) -> bool {
        keys.iter().any(|key| self.has(key.name) && !values.has(key.name))
    }

    fn value(&self, key: &Key, may_draw: bool) -> Option<keys::Value> {
        if let Some(Value::Table(table)) = self.entry(key.name).map(|entry| &entry.node.value)
            && may_draw
            && !matches!(key.takes(), Takes::Table(_))
        {
            return self.draw(key, table);
        }
        // A default of "0" is zero in the kind's own unit.
        let zero = |kind: Kind| {
            key.default.map(|text| if text == "0" { format!("0 {}", kind.units()[0]) } else { text.into() })
        };
        let name = key.name;
        Some(match key.takes() {
            Takes::Scalar(kind) => {
                keys::Value::Scalar(
                    self.measured(name, zero(kind).as_deref(), kind.example(), |text| kind.scalar(text))?,
                )
            }
            Takes::PerAxis(kind) => keys::Value::Triple(self.vector(name, kind, zero(kind).as_deref())?),
            Takes::BodyVector(kind) => {
                let sign = self.reader.axes.get().body_sign();
                let [x, y, z] = self.vector(name, kind, zero(kind).as_deref())?;
                keys::Value::Triple([x, y * sign, z * sign])
            }
            Takes::NavVector(kind) => {
                let given = self.vector(name, kind, zero(kind).as_deref())?;
                keys::Value::Triple(nav_in(self.axes(), kind, given))
            }
            Takes::OneAxis(kind) => {
                let text = zero(kind);
                let x = self.measured(name, text.as_deref(), kind.example(), |text| kind.scalar(text))?;
                keys::Value::Triple([x, Double::ZERO, Double::ZERO])
            }
            Takes::Resolution(kind) => {
                keys::Value::Resolution(
                    self.measured(name, key.default, kind.example(), |text| kind.resolution(text))?,
                )
            }
            Takes::Duration => keys::Value::Time(self.time(name, key.default, Sign::NonNegative)?),
            Takes::Word(words) => keys::Value::Word(self.word(name, words, key.default.unwrap_or(words[0]))),
            Takes::Keyframes => keys::Value::Keyframes(self.keyframes(name)?),
            Takes::File => keys::Value::File(self.file(name)?),
            Takes::Columns(columns) => self.columns(name, &columns)?,
            Takes::Matrix(kind) => keys::Value::Matrix(self.matrix(name, kind)?),
            Takes::Flag => keys::Value::Flag(self.flag(name)?),
            Takes::Whole(least, most) => keys::Value::Whole(self.whole_within(key, least, most)?),
            Takes::Table(nested) => keys::Value::Tables(self.nested(name, &nested, may_draw)?),
        })
    }
}

/// A nav vector as written, taken inside: another order of axes, and down for up where it has a sign.
pub(super) fn nav_in(axes: Axes, kind: Kind, [x, y, z]: [Double; 3]) -> [Double; 3] {
    match axes {
        Axes::NedFrd => [x, y, z],
        Axes::EnuFlu if kind.is_magnitude() => [y, x, z],
        Axes::EnuFlu => [y, x, -z],
    }
}
