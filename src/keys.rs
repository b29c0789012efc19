//! What a table of a scene may hold, declared as data by whatever it configures.
//!
//! Each kind of motion and each error term lists its keys beside its code; the scene reads any such list, checks
//! names, units and defaults, and hands back [`Values`] in SI units and in the program's own axes. `ratetable
//! list` and the docs print the same lists, so a key cannot be accepted and left undocumented. A key is declared and
//! read through one constant, its [`Name`], so it cannot be read as another kind than it was declared.

mod name;

pub use name::Name;

use crate::double::Double;
use crate::geometry::Attitude;
use crate::quantity::{Kind, Resolution};
use crate::time::SimTime;
use glam::DMat3;
use std::collections::BTreeMap;
use std::fmt;

/// One key of a table; its [`Name`] makes it.
#[derive(Clone, Copy, Debug)]
pub struct Key {
    /// As written in the scene.
    pub name: &'static str,
    takes: Takes,
    /// What it is when absent; `None` = nothing, which the builder may refuse.
    pub default: Option<&'static str>,
    /// One line for `list` and the docs.
    pub about: &'static str,
}

impl Key {
    /// The same with this default.
    pub const fn or(self, default: &'static str) -> Key {
        Key { default: Some(default), ..self }
    }

    /// What it accepts.
    pub fn takes(&self) -> Takes {
        self.takes
    }

    /// The same for a sensor of one component; a key without axes stays as it is.
    pub fn of_one_axis(self) -> Key {
        self.along(Takes::OneAxis)
    }

    /// The same for a sensor along nav axes; a key without axes stays as it is.
    pub fn along_nav(self) -> Key {
        self.along(Takes::NavVector)
    }

    fn along(self, axes: fn(Kind) -> Takes) -> Key {
        match self.takes {
            Takes::PerAxis(kind) | Takes::BodyVector(kind) => Key { takes: axes(kind), ..self },
            _ => self,
        }
    }
}

/// What a key accepts.
#[derive(Clone, Copy, Debug)]
pub enum Takes {
    /// A number with a unit.
    Scalar(Kind),
    /// One number an axis, or one for all three; a magnitude, so its sign does not depend on the axes.
    PerAxis(Kind),
    /// A vector in body axes, turned from the scene's axes to Forward-Right-Down.
    BodyVector(Kind),
    /// A vector in nav axes, turned from the scene's axes to North-East-Down; or one number for all three.
    NavVector(Kind),
    /// One number, of a sensor that has no more: it is x, and y and z are 0.
    OneAxis(Kind),
    /// The size of a count, counts a unit, or bits.
    Resolution(Kind),
    /// A time of at least zero, exact in nanoseconds.
    Duration,
    /// One of these words.
    Word(&'static [&'static str]),
    /// An array of attitudes, each with its time.
    Keyframes,
    /// The path of a text file, relative to the scene's folder; the scene reads it.
    File,
    /// The names of columns of that file.
    Columns(Columns),
    /// A linear map of body vectors: three rows, the three on the diagonal, or one number for these.
    Matrix(Kind),
    /// `true` or `false`.
    Flag,
    /// A whole number from the first to the second.
    Whole(u64, u64),
    /// Keys that belong together, in a table of their own.
    Table(Nested),
}

/// A table within a table: `filter = { low_pass = "92 Hz", order = 2 }`.
#[derive(Clone, Copy, Debug)]
pub struct Nested {
    /// Its keys.
    pub keys: &'static [Key],
    /// The key that a value sets if it is not a table: `filter = "92 Hz"`.
    pub alone: Option<&'static str>,
    /// Whether there may be an array of them.
    pub many: bool,
    /// One as a scene writes it.
    pub example: &'static str,
}

/// Columns that belong together, such as the three of a vector.
#[derive(Clone, Copy, Debug)]
pub struct Columns {
    /// How many.
    pub count: usize,
    /// What they measure; `None` = numbers without a unit.
    pub kind: Option<Kind>,
}

impl Columns {
    /// As a scene writes them.
    pub fn example(&self) -> String {
        let names = ["\"x\"", "\"y\"", "\"z\""];
        match (self.kind, self.count) {
            (Some(kind), 1) => format!("{{ column = \"t\", unit = \"{}\" }}", kind.units()[0]),
            (Some(kind), count) => {
                let names = names[..count.min(3)].join(", ");
                format!("{{ columns = [{names}], unit = \"{}\" }}", kind.units()[0])
            }
            (None, _) => "[\"w\", \"x\", \"y\", \"z\"]".into(),
        }
    }
}

/// A text file that was read.
#[derive(Clone)]
pub struct Text {
    /// What messages call it: its path.
    pub name: String,
    /// What stands in it.
    pub contents: String,
}

impl fmt::Debug for Text {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} ({} bytes)", self.name, self.contents.len())
    }
}

/// A value as read: SI units (µT for a field), the program's own axes.
#[derive(Clone, Debug)]
pub enum Value {
    /// Of [`Takes::Scalar`].
    Scalar(Double),
    /// Of [`Takes::PerAxis`], [`Takes::BodyVector`], [`Takes::NavVector`] and [`Takes::OneAxis`].
    Triple([Double; 3]),
    /// Of [`Takes::Resolution`].
    Resolution(Resolution),
    /// Of [`Takes::Duration`].
    Time(SimTime),
    /// Of [`Takes::Word`].
    Word(&'static str),
    /// Of [`Takes::Keyframes`], in the order written.
    Keyframes(Vec<(SimTime, Attitude)>),
    /// Of [`Takes::File`].
    File(Text),
    /// Of [`Takes::Columns`]: their names, and how many inside units one of theirs is.
    Columns(Vec<String>, f64),
    /// Of [`Takes::Matrix`].
    Matrix(DMat3),
    /// Of [`Takes::Flag`].
    Flag(bool),
    /// Of [`Takes::Whole`].
    Whole(u64),
    /// Of [`Takes::Table`], in the order written.
    Tables(Vec<Values>),
}

/// The values of one table, by key, each read through the [`Name`] that declares its key.
#[derive(Clone, Debug, Default)]
pub struct Values(BTreeMap<&'static str, Value>);

impl Values {
    /// Sets what `key` holds, of the kind that it takes.
    pub fn insert(&mut self, key: &'static str, value: Value) {
        self.0.insert(key, value);
    }

    /// Takes over every value that `newer` has.
    pub fn take_over(&mut self, newer: &Values) {
        self.0.extend(newer.0.iter().map(|(key, value)| (*key, value.clone())));
    }

    /// Whether the key has a value.
    pub fn has(&self, key: impl Into<&'static str>) -> bool {
        self.0.contains_key(key.into())
    }

    /// What a key holds, whatever its kind; `None` where it is absent and has no default.
    pub fn held(&self, key: &Key) -> Option<&Value> {
        self.0.get(key.name)
    }
}

/// A value that is well formed but cannot be: the key, and what would be right.
#[derive(Clone, Debug, PartialEq)]
pub struct KeyError {
    /// The key to point at.
    pub key: &'static str,
    /// The bad value and what would be right.
    pub message: String,
}

impl KeyError {
    /// At `key`, saying `message`.
    pub fn new(key: impl Into<&'static str>, message: impl Into<String>) -> KeyError {
        KeyError { key: key.into(), message: message.into() }
    }
}

/// The known name nearest to `given`, if it is near.
pub fn nearest<'a>(given: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let lower = given.to_lowercase();
    known
        .into_iter()
        .map(|name| (name, strsim::jaro_winkler(&lower, &name.to_lowercase())))
        .filter(|&(_, likeness)| likeness > 0.75)
        .max_by(|a, b| a.1.total_cmp(&b.1))
        .map(|(name, _)| name)
}

/// The question to end a refusal with: whether the nearest name was meant, if one is near.
pub fn did_you_mean<'a>(given: &str, known: impl IntoIterator<Item = &'a str>) -> String {
    nearest(given, known).map_or(String::new(), |near| format!("; did you mean `{near}`?"))
}
