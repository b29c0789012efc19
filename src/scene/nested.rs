//! Values that are more than a number and less than a section: tables within a table, matrices, flags.

use super::document::{Entry, Node, Table, Value};
use super::section::Section;
use crate::keys::{Key, Nested, Values};
use crate::quantity::Kind;
use glam::{DMat3, DVec3};

impl Section<'_> {
    /// A table of its own, or an array of them where there may be several; a bare value sets one of its keys.
    pub(super) fn nested(&self, key: &'static str, nested: &Nested, may_draw: bool) -> Option<Vec<Values>> {
        let entry = self.entry(key)?;
        let nodes = match &entry.node.value {
            Value::Array(nodes) if nested.many => nodes.iter().collect(),
            _ => vec![&entry.node],
        };
        let (mut read, mut resolved, mut whole) = (Vec::new(), Vec::new(), true);
        for node in nodes {
            let table = match (&node.value, nested.alone) {
                (Value::Table(table), _) => table.clone(),
                (Value::Text(_) | Value::Integer(_) | Value::Float(_), Some(alone)) => Table {
                    entries: vec![Entry { key: alone.into(), ..entry.clone() }],
                    ..Table::empty(node.place.clone())
                },
                (other, _) => {
                    self.note(&node.place, format!("`{key}` is {}; write {}", other.what(), nested.example));
                    whole = false;
                    continue;
                }
            };
            let inner = Section::new(self.reader, format!("{}.{key}", self.path), table);
            inner.call(format!("`{key}`"));
            let values = inner.values(nested.keys, may_draw);
            whole &= !inner.unread(nested.keys, &values);
            read.push(values);
            resolved.push(toml::Value::from(inner.finish()));
        }
        match <[toml::Value; 1]>::try_from(resolved) {
            Ok([one]) => self.resolve(key, one),
            Err(several) => self.resolve(key, several),
        }
        whole.then_some(read)
    }

    /// A whole number within limits, or the key's default.
    pub(super) fn whole_within(&self, key: &Key, least: u64, most: u64) -> Option<u64> {
        let default = key.default.and_then(|text| text.parse().ok());
        if !self.has(key.name) && default.is_none() {
            return None;
        }
        let number = self.whole(key.name, default.unwrap_or(least));
        if (least..=most).contains(&number) {
            return Some(number);
        }
        self.mistake(key.name, format!("is {number}; write a whole number from {least} to {most}"));
        None
    }

    /// A linear map of body vectors, turned from the scene's axes to Forward-Right-Down: three rows, as texts with a
    /// unit or (of plain numbers) as numbers, or all in one text; a vector is the diagonal, a number all of it.
    pub(super) fn matrix(&self, key: &'static str, kind: Kind) -> Option<DMat3> {
        let example = format!("[[1, 0, 0], [0, 1, 0], [0, 0, 1]] {}", kind.units()[0]);
        let node = &self.entry(key)?.node;
        let matrix = match &node.value {
            Value::Array(rows) if rows.iter().any(|row| !is_number(row)) => {
                let rows: Option<Vec<_>> =
                    rows.iter().map(|row| self.row(key, kind, row, &example)).collect();
                match rows?[..] {
                    [x, y, z] => {
                        self.resolve(key, self.as_written(key));
                        DMat3::from_cols(x, y, z).transpose()
                    }
                    ref others => {
                        self.mistake(
                            key,
                            format!("has {} rows; a matrix has three: {example}", others.len()),
                        );
                        return None;
                    }
                }
            }
            _ => {
                let rows = self.measured(key, None, &example, |text| kind.matrix(text))?;
                DMat3::from_cols_array_2d(&rows).transpose()
            }
        };
        let flip = DMat3::from_diagonal(DVec3::new(1.0, self.axes().body_sign(), self.axes().body_sign()));
        Some(flip * matrix * flip)
    }

    fn row(&self, key: &'static str, kind: Kind, node: &Node, example: &str) -> Option<DVec3> {
        let text = self.spelled(key, node, example)?;
        kind.vector(&text)
            .map(|row| DVec3::from_array(row.map(|x| x.to_f64())))
            .map_err(|error| self.note(&node.place_in_text(error.offset()), format!("`{key}`: {error}")))
            .ok()
    }

    /// The value of a key that was given as an array of arrays or texts.
    fn as_written(&self, key: &str) -> toml::Value {
        fn plain(node: &Node) -> toml::Value {
            match &node.value {
                Value::Text(text) => text.clone().into(),
                Value::Integer(number) => (*number as i64).into(),
                Value::Float(text) => text.replace('_', "").parse::<f64>().unwrap_or_default().into(),
                Value::Array(nodes) => nodes.iter().map(plain).collect::<Vec<_>>().into(),
                _ => toml::Value::Boolean(false),
            }
        }
        self.table.get(key).map_or(toml::Value::Boolean(false), |entry| plain(&entry.node))
    }
}

fn is_number(node: &Node) -> bool {
    matches!(node.value, Value::Integer(_) | Value::Float(_))
}
