//! Reading one table of a scene: every key by its declaration, every mistake collected with its place, and every
//! value written down again for the scene as resolved.

use super::document::{Entry, Mistake, Node, Place, Table, Value};
use super::suggest;
use crate::geometry::Axes;
use crate::keys::{self, Key, Takes, Values};
use crate::quantity::{self, Kind, QuantityError, Sign};
use crate::random::{self, Stream};
use crate::time::{Rate, SimTime};
use rand::RngExt;
use rand_distr::{Distribution, StandardNormal};
use std::cell::{Cell, RefCell};

/// A value that was drawn once for this run.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Drawn {
    /// Such as `gyro.noise_std`.
    pub key: String,
    /// What was drawn, as a scene would write it.
    pub value: String,
}

/// What reading a whole scene collects.
pub struct Reader {
    /// The scene's seed, for values drawn once a run.
    pub seed: Cell<u64>,
    /// The axes it is written in.
    pub axes: Cell<Axes>,
    mistakes: RefCell<Vec<Mistake>>,
    draws: RefCell<Vec<Drawn>>,
}

impl Reader {
    /// With nothing read yet.
    pub fn new() -> Reader {
        Reader {
            seed: Cell::new(0),
            axes: Cell::new(Axes::default()),
            mistakes: RefCell::default(),
            draws: RefCell::default(),
        }
    }

    /// Notes a mistake.
    pub fn mistake(&self, place: &Place, message: impl Into<String>) {
        let mistake = Mistake { place: place.clone(), message: message.into() };
        let mut mistakes = self.mistakes.borrow_mut();
        if !mistakes.contains(&mistake) {
            mistakes.push(mistake);
        }
    }

    /// What was drawn, or every mistake.
    pub fn finish(self) -> Result<Vec<Drawn>, Vec<Mistake>> {
        let mistakes = self.mistakes.into_inner();
        if mistakes.is_empty() { Ok(self.draws.into_inner()) } else { Err(mistakes) }
    }
}

/// One table being read.
pub struct Section<'r> {
    reader: &'r Reader,
    /// Such as `gyro` or `motion.2`; empty for the scene itself.
    path: String,
    table: Table,
    known: RefCell<Vec<&'static str>>,
    resolved: RefCell<toml::Table>,
    forgiving: Cell<bool>,
}

impl<'r> Section<'r> {
    /// Of `table`, called `path` in messages.
    pub fn new(reader: &'r Reader, path: impl Into<String>, table: Table) -> Section<'r> {
        Section {
            reader,
            path: path.into(),
            table,
            known: RefCell::default(),
            resolved: RefCell::default(),
            forgiving: Cell::new(false),
        }
    }

    /// The table called `key` in this one, empty if absent.
    pub fn table(&self, key: &'static str) -> Section<'r> {
        let table = match self.entry(key).map(|entry| &entry.node) {
            None => Table::empty(self.table.place.clone()),
            Some(Node { value: Value::Table(table), .. }) => table.clone(),
            Some(node) => {
                self.reader.mistake(&node.place, format!("`{key}` is {}; write it as a table, [{key}]", node.value.what()));
                Table::empty(node.place.clone())
            }
        };
        Section::new(self.reader, key, table)
    }

    /// The tables of the array called `key`, such as every `[[motion]]`.
    pub fn tables(&self, key: &'static str) -> Vec<Section<'r>> {
        let Some(entry) = self.entry(key) else { return Vec::new() };
        let nodes = match &entry.node.value {
            Value::Array(nodes) => nodes.as_slice(),
            _ => std::slice::from_ref(&entry.node),
        };
        let mut sections = Vec::new();
        for (i, node) in nodes.iter().enumerate() {
            match (&node.value, &entry.node.value) {
                (Value::Table(table), Value::Array(_)) => {
                    sections.push(Section::new(self.reader, format!("{key}.{i}"), table.clone()));
                }
                _ => self.reader.mistake(&node.place, format!("write each as a table of its own, [[{key}]]")),
            }
        }
        sections
    }

    /// The axes the scene is written in.
    pub fn axes(&self) -> Axes {
        self.reader.axes.get()
    }

    /// The scene's seed.
    pub fn seed(&self) -> u64 {
        self.reader.seed.get()
    }

    /// Adds entries that the table leaves open, such as those of a part.
    pub fn add(&mut self, entries: Vec<Entry>) {
        self.table.entries.extend(entries);
    }

    /// Whether the table has the key, without making it a known one.
    pub fn has_quietly(&self, key: &str) -> bool {
        self.table.get(key).is_some()
    }

    /// Accepts whatever keys there are: a mistake already said what is wrong with the table as a whole.
    pub fn allow_everything(&self) {
        self.forgiving.set(true);
    }

    /// Whether the table has the key.
    pub fn has(&self, key: &'static str) -> bool {
        self.entry(key).is_some()
    }

    /// The entry of a key, which counts as known from now on.
    pub fn entry(&self, key: &'static str) -> Option<&Entry> {
        let mut known = self.known.borrow_mut();
        if !known.contains(&key) {
            known.push(key);
        }
        self.table.get(key)
    }

    /// Where a key's value stands, or the table if it is absent.
    pub fn place(&self, key: &'static str) -> Place {
        self.table.get(key).map_or(&self.table.place, |entry| &entry.node.place).clone()
    }

    /// Notes a mistake at a key's value.
    pub fn mistake(&self, key: &'static str, message: impl AsRef<str>) {
        let message = message.as_ref();
        let named = if message.starts_with('`') { message.to_string() } else { format!("`{key}`: {message}") };
        self.reader.mistake(&self.place(key), named);
    }

    /// Writes a value into the scene as resolved.
    pub fn resolve(&self, key: &str, value: impl Into<toml::Value>) {
        self.resolved.borrow_mut().insert(key.to_string(), value.into());
    }

    /// A string, or the default.
    pub fn text(&self, key: &'static str, default: Option<&str>) -> Option<String> {
        let text = match self.entry(key).map(|entry| &entry.node) {
            None => default?.to_string(),
            Some(Node { value: Value::Text(text), .. }) => text.clone(),
            Some(Node { value: Value::Date(text), .. }) => text.clone(),
            Some(node) => {
                self.mistake(key, format!("is {}; write it as a string, in quotation marks", node.value.what()));
                return None;
            }
        };
        self.resolve(key, text.clone());
        Some(text)
    }

    /// One of some words, or the default.
    pub fn word(&self, key: &'static str, words: &[&'static str], default: &'static str) -> &'static str {
        let Some(text) = self.text(key, Some(default)) else { return default };
        words.iter().copied().find(|word| *word == text).unwrap_or_else(|| {
            let hint = suggest::nearest(&text, words.iter().copied()).map_or(String::new(), |near| format!(", perhaps `{near}`"));
            self.mistake(key, format!("`{text}` is none of {}{hint}", words.join(", ")));
            default
        })
    }

    /// A whole number of at least 0, or the default.
    pub fn whole(&self, key: &'static str, default: u64) -> u64 {
        let number = match self.entry(key).map(|entry| &entry.node.value) {
            None => default,
            Some(Value::Integer(number)) if (0..=i128::from(i64::MAX)).contains(number) => *number as u64,
            Some(other) => {
                let bad = match other {
                    Value::Integer(number) => number.to_string(),
                    other => other.what().to_string(),
                };
                self.mistake(key, format!("is {bad}; write a whole number from 0 to {}", i64::MAX));
                default
            }
        };
        self.resolve(key, number as i64);
        number
    }

    /// True or false, or the default.
    pub fn flag(&self, key: &'static str, default: bool) -> bool {
        let flag = match self.entry(key).map(|entry| &entry.node.value) {
            None => default,
            Some(Value::Boolean(flag)) => *flag,
            Some(other) => {
                self.mistake(key, format!("is {}; write true or false", other.what()));
                default
            }
        };
        self.resolve(key, flag);
        flag
    }

    /// The strings of an array, each with its place.
    pub fn texts(&self, key: &'static str) -> Vec<(String, Place)> {
        let mut texts = Vec::new();
        match self.entry(key).map(|entry| &entry.node.value) {
            None => {}
            Some(Value::Array(nodes)) => {
                for node in nodes {
                    match &node.value {
                        Value::Text(text) => texts.push((text.clone(), node.place.clone())),
                        other => self.reader.mistake(&node.place, format!("`{key}` holds strings, not {}", other.what())),
                    }
                }
            }
            Some(other) => self.mistake(key, format!("is {}; write an array of strings", other.what())),
        }
        self.resolve(key, texts.iter().map(|(text, _)| text.clone()).collect::<Vec<_>>());
        texts
    }

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
            self.mistake(key, "a quaternion is four bare numbers, [w, x, y, z]");
            return None;
        };
        let length = libm::sqrt(w * w + x * x + y * y + z * z);
        if (length - 1.0).abs() > 1e-3 {
            self.mistake(key, format!("its length is {length}, but a rotation's is 1"));
            return None;
        }
        self.resolve(key, vec![*w, *x, *y, *z]);
        Some([w / length, x / length, y / length, z / length])
    }

    /// A text with a unit, read by `read`; `kind` names what is needed where a bare number stands.
    fn measured<T>(
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
                let place = self.table.get(key).map_or(self.table.place.clone(), |entry| entry.node.place_in_text(error.offset()));
                self.reader.mistake(&place, format!("`{key}`: {error}"));
                None
            }
        }
    }

    /// The text of a quantity; a bare number is a mistake that shows how to write it.
    fn spelled(&self, key: &'static str, node: &Node, example: &str) -> Option<String> {
        match &node.value {
            Value::Text(text) => Some(text.clone()),
            Value::Integer(number) => {
                self.mistake(key, format!("`{number}` lacks a unit: write a string with one, such as \"{example}\""));
                None
            }
            Value::Float(number) => {
                self.mistake(key, format!("`{number}` lacks a unit: write a string with one, such as \"{example}\""));
                None
            }
            other => {
                self.mistake(key, format!("is {}; write a string with a unit, such as \"{example}\"", other.what()));
                None
            }
        }
    }

    /// One number of a kind.
    pub fn scalar(&self, key: &'static str, kind: Kind, default: Option<&str>) -> Option<f64> {
        self.measured(key, default, kind.example(), |text| kind.scalar(text)).map(|value| value.to_f64())
    }

    /// A time of at least zero.
    pub fn time(&self, key: &'static str, default: Option<&str>) -> Option<SimTime> {
        self.measured(key, default, "5 s", |text| quantity::duration_ns(text, Sign::NonNegative)).map(SimTime)
    }

    /// A sensor's rate.
    pub fn rate(&self, key: &'static str) -> Option<Rate> {
        let (numerator, denominator) = self.measured(key, None, "100 Hz", quantity::rate)?;
        Rate::new(numerator, denominator)
    }

    /// A vector of a kind, one number filling all three, to full precision.
    pub fn vector(&self, key: &'static str, kind: Kind, default: Option<&str>) -> Option<[crate::double::Double; 3]> {
        self.measured(key, default, kind.example(), |text| kind.vector(text))
    }

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

    fn value(&self, key: &Key, may_draw: bool) -> Option<keys::Value> {
        if let Some(Value::Table(table)) = self.entry(key.name).map(|entry| &entry.node.value) {
            return if may_draw { self.draw(key, table) } else { self.spelled(key.name, &self.entry(key.name)?.node, "").map(|_| None)? };
        }
        // A default of "0" is zero in the kind's own unit.
        let zero = |kind: Kind| key.default.map(|text| if text == "0" { format!("0 {}", kind.units()[0]) } else { text.into() });
        let name = key.name;
        Some(match key.takes {
            Takes::Scalar(kind) => {
                keys::Value::Scalar(self.measured(name, zero(kind).as_deref(), kind.example(), |text| kind.scalar(text))?)
            }
            Takes::PerAxis(kind) => keys::Value::Triple(self.vector(name, kind, zero(kind).as_deref())?),
            Takes::BodyVector(kind) => {
                let sign = self.reader.axes.get().body_sign();
                let [x, y, z] = self.vector(name, kind, zero(kind).as_deref())?;
                keys::Value::Triple([x, y * sign, z * sign])
            }
            Takes::Resolution(kind) => {
                keys::Value::Resolution(self.measured(name, key.default, kind.example(), |text| kind.resolution(text))?)
            }
            Takes::Duration => keys::Value::Time(self.time(name, key.default)?),
            Takes::Word(words) => keys::Value::Word(self.word(name, words, key.default.unwrap_or(words[0]))),
        })
    }

    /// A value drawn once a run: `{ uniform = [low, high] }` or `{ normal = [mean, std] }`, each axis by itself.
    fn draw(&self, key: &Key, table: &Table) -> Option<keys::Value> {
        let (kind, scalar, magnitude) = match key.takes {
            Takes::Scalar(kind) => (kind, true, true),
            Takes::PerAxis(kind) => (kind, false, true),
            Takes::BodyVector(kind) => (kind, false, false),
            _ => {
                self.mistake(key.name, "cannot be drawn from a distribution");
                return None;
            }
        };
        let Some((shape, low, high)) = self.distribution(key.name, kind.signed(Sign::Any), table) else { return None };
        let axes: &[usize] = if scalar { &[0] } else { &[0, 1, 2] };
        let mut drawn = [0.0; 3];
        for &axis in axes {
            let name = format!("draw/{}/{}/{}", self.path, key.name, ["x", "y", "z"][axis]);
            let mut stream = random::stream(self.reader.seed.get(), &name);
            let value = shape.sample(low[axis], high[axis], &mut stream);
            // The size of a noise has no sign; the tail of a normal distribution is folded over.
            drawn[axis] = if magnitude { value.abs() } else { value };
        }
        let unit = kind.units()[0];
        let text = if scalar { quantity::text_scalar(drawn[0], unit) } else { quantity::text_vector(drawn, unit) };
        self.reader.draws.borrow_mut().push(Drawn { key: format!("{}.{}", self.path, key.name), value: text.clone() });
        self.resolve(key.name, text);
        let sign = if magnitude { 1.0 } else { self.reader.axes.get().body_sign() };
        Some(match key.takes {
            Takes::Scalar(_) => keys::Value::Scalar(drawn[0].into()),
            _ => keys::Value::Triple([drawn[0], drawn[1] * sign, drawn[2] * sign].map(Into::into)),
        })
    }

    fn distribution(&self, key: &'static str, kind: Kind, table: &Table) -> Option<(Shape, [f64; 3], [f64; 3])> {
        let entries: Vec<_> = table.entries.iter().filter(|entry| entry.key != "source" && entry.key != "assumed").collect();
        let (shape, entry) = match entries[..] {
            [entry] if entry.key == "uniform" => (Shape::Uniform, entry),
            [entry] if entry.key == "normal" => (Shape::Normal, entry),
            _ => {
                self.mistake(key, format!("a drawn value is {{ uniform = [low, high] }} or {{ normal = [mean, std] }}, such as {{ uniform = [\"{0}\", \"{0}\"] }}", kind.example()));
                return None;
            }
        };
        let Value::Array(nodes) = &entry.node.value else {
            self.reader.mistake(&entry.node.place, format!("`{}` takes an array of two strings", entry.key));
            return None;
        };
        let [low, high] = &nodes[..] else {
            self.reader.mistake(&entry.node.place, format!("`{}` takes two values, not {}", entry.key, nodes.len()));
            return None;
        };
        let end = |node: &Node| {
            let text = self.spelled(key, node, kind.example())?;
            match kind.vector(&text) {
                Ok(value) => Some(value.map(|x| x.to_f64())),
                Err(error) => {
                    self.reader.mistake(&node.place_in_text(error.offset()), format!("`{key}`: {error}"));
                    None
                }
            }
        };
        Some((shape, end(low)?, end(high)?))
    }

    /// Complains about every key that nothing asked for, and gives back the table as resolved.
    pub fn finish(self) -> toml::Table {
        let known = self.known.into_inner();
        let unknown = self.table.entries.iter().filter(|entry| !known.contains(&entry.key.as_str()));
        for entry in unknown.filter(|_| !self.forgiving.get()) {
            let (key, inside) = (&entry.key, if self.path.is_empty() { "a scene".into() } else { format!("[{}]", self.path) });
            let message = if let Some(ours) = suggest::elsewhere(key) {
                format!("`{key}` {ours}")
            } else if let Some(near) = suggest::nearest(key, known.iter().copied()) {
                format!("`{key}` is not a key of {inside}: did you mean `{near}`?")
            } else {
                format!("`{key}` is not a key of {inside}, which knows {}", known.join(", "))
            };
            self.reader.mistake(&entry.place, message);
        }
        self.resolved.into_inner()
    }
}

#[derive(Clone, Copy)]
enum Shape {
    Uniform,
    Normal,
}

impl Shape {
    fn sample(self, a: f64, b: f64, stream: &mut Stream) -> f64 {
        match self {
            Shape::Uniform => a + (b - a) * stream.random::<f64>(),
            Shape::Normal => {
                let n: f64 = StandardNormal.sample(stream);
                a + b * n
            }
        }
    }
}
