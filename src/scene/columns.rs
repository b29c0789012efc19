//! Names of columns: `["qw", "qx", "qy", "qz"]`, or with a unit `{ columns = ["x", "y", "z"], unit = "deg/s" }`.

use super::document::{Node, Value};
use super::section::Section;
use crate::keys::{self, Columns};
use crate::quantity::Kind;

impl Section<'_> {
    /// The names of some columns, and how many inside units one of theirs is.
    pub(super) fn columns(&self, key: &'static str, columns: &Columns) -> Option<keys::Value> {
        let node = &self.entry(key)?.node;
        let (names, unit) = match (&node.value, columns.kind) {
            (Value::Table(table), _) => {
                let inner = Section::new(self.reader, format!("{}.{key}", self.path), table.clone());
                inner.call(format!("`{key}`"));
                let list = if columns.count == 1 { "column" } else { "columns" };
                let names = inner.names(list, inner.entry(list).map(|entry| &entry.node), columns);
                let unit = match columns.kind {
                    Some(kind) => inner.unit("unit", kind),
                    None => Some(1.0),
                };
                for lacking in [list, "unit"].into_iter().filter(|key| !inner.has(key)) {
                    if lacking == list || columns.kind.is_some() {
                        inner.lacks(format!("`{key}` needs a `{lacking}`: {}", columns.example()));
                    }
                }
                self.resolve(key, inner.finish());
                (names?, unit?)
            }
            (_, Some(_)) => {
                let is = node.value.what();
                self.mistake(key, format!("is {is}, but columns need their unit: {}", columns.example()));
                return None;
            }
            (_, None) => {
                let names = self.names(key, Some(node), columns)?;
                self.resolve(key, names.clone());
                (names, 1.0)
            }
        };
        Some(keys::Value::Columns(names, unit))
    }

    /// How many inside units a unit is.
    fn unit(&self, key: &'static str, kind: Kind) -> Option<f64> {
        let unit = kind.unit(&self.text(key, None)?);
        unit.map(|unit| unit.to_f64()).map_err(|error| self.mistake(key, error.to_string())).ok()
    }

    /// As many strings as there are columns.
    fn names(&self, key: &'static str, node: Option<&Node>, columns: &Columns) -> Option<Vec<String>> {
        let text = |node: &Node| match &node.value {
            Value::Text(text) => Some(text.clone()),
            _ => None,
        };
        let names: Option<Vec<_>> = match &node?.value {
            Value::Array(nodes) => nodes.iter().map(text).collect(),
            _ => text(node?).map(|name| vec![name]),
        };
        let names = names.filter(|names| names.len() == columns.count);
        match &names {
            Some(names) if columns.count == 1 => self.resolve(key, names[0].clone()),
            Some(names) => self.resolve(key, names.clone()),
            None => {
                let count = columns.count;
                let what = if count == 1 { "one name".into() } else { format!("{count} names") };
                self.mistake(key, format!("takes {what} of columns, such as {}", columns.example()));
            }
        }
        names
    }
}
