//! Reading one table of a scene: every key known by being asked for, every mistake collected with its place, and every
//! value written down again for the scene as resolved. Numbers with units are read in `numbers`, and whole lists of
//! declared keys in `declared`.

use super::document::{Entry, Location, Node, Table, Value};
use super::reader::Reader;
use super::suggest;
use crate::geometry::Axes;
use std::cell::{Cell, RefCell};

/// One table being read.
pub struct Section<'r> {
    pub(super) reader: &'r Reader,
    /// Such as `gyro` or `motion.2`; empty for the scene itself.
    pub(super) path: String,
    pub(super) table: Table,
    known: RefCell<Vec<&'static str>>,
    resolved: RefCell<toml::Table>,
    /// What messages call it.
    called: RefCell<String>,
    /// Whether any key may stand in it: a mistake already says what is wrong with the table as a whole.
    forgiving: Cell<bool>,
    /// Whether nothing that it lacks is worth a word: no table stands where it should.
    silent: bool,
}

impl<'r> Section<'r> {
    /// Of `table`, called `path` in messages.
    pub fn new(reader: &'r Reader, path: impl Into<String>, table: Table) -> Section<'r> {
        let path = path.into();
        let called = match path.split_once('.') {
            Some((array, _)) => format!("[[{array}]]"),
            None if path.is_empty() => "a scene".into(),
            None => format!("[{path}]"),
        };
        Section {
            reader,
            path,
            table,
            known: RefCell::default(),
            resolved: RefCell::default(),
            called: RefCell::new(called),
            forgiving: Cell::new(false),
            silent: false,
        }
    }

    /// Gives it another name in messages.
    pub fn call(&self, name: String) {
        *self.called.borrow_mut() = name;
    }

    /// The table called `key` in this one, empty if absent.
    pub fn table(&self, key: &'static str) -> Section<'r> {
        match self.entry(key).map(|entry| &entry.node) {
            None => Section::new(self.reader, key, Table::empty(self.table.place.clone())),
            Some(Node { value: Value::Table(table), .. }) => Section::new(self.reader, key, table.clone()),
            Some(node) => {
                self.mistake(key, format!("is {}; write it as one table, [{key}]", node.value.what()));
                let empty = Table::empty(node.place.clone());
                Section { silent: true, ..Section::new(self.reader, key, empty) }
            }
        }
    }

    /// The tables of the array called `key`, such as every `[[motion]]`.
    pub fn tables(&self, key: &'static str) -> Vec<Section<'r>> {
        let Some(entry) = self.entry(key) else { return Vec::new() };
        let Value::Array(nodes) = &entry.node.value else {
            let is = entry.node.value.what();
            self.mistake(
                key,
                format!("is {is}, but a scene can have several: write each as its own table, [[{key}]]"),
            );
            return Vec::new();
        };
        let mut sections = Vec::new();
        for (i, node) in nodes.iter().enumerate() {
            match &node.value {
                Value::Table(table) => {
                    sections.push(Section::new(self.reader, format!("{key}.{i}"), table.clone()))
                }
                other => {
                    let is = other.what();
                    self.note(
                        &node.place,
                        format!("`{key}` holds {is}: write each as its own table, [[{key}]]"),
                    );
                }
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

    /// Puts another value in the place of a key's.
    pub fn replace(&mut self, key: &str, node: &Node) {
        for entry in self.table.entries.iter_mut().filter(|entry| entry.key == key) {
            entry.node = node.clone();
        }
    }

    /// Takes an entry out, whose meaning others have taken over.
    pub fn remove(&mut self, key: &str) {
        self.table.entries.retain(|entry| entry.key != key);
    }

    /// Whether the table has the key, without making it a known one.
    pub fn has_quietly(&self, key: &str) -> bool {
        self.table.get(key).is_some()
    }

    /// Accepts whatever keys there are from now on.
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
    pub fn place(&self, key: &'static str) -> Location {
        self.table.get(key).map_or(&self.table.place, |entry| &entry.node.place).clone()
    }

    /// Notes a mistake at a key's value. A message that begins with a verb goes on from the key, one that begins
    /// with a name stands alone, any other gets the key before it.
    pub fn mistake(&self, key: &'static str, message: impl AsRef<str>) {
        let message = message.as_ref();
        let named = if message.starts_with('`') {
            message.to_string()
        } else if ["is ", "needs ", "takes ", "cannot "].iter().any(|verb| message.starts_with(verb)) {
            format!("`{key}` {message}")
        } else {
            format!("`{key}`: {message}")
        };
        self.note(&self.place(key), named);
    }

    /// Notes that the table lacks something.
    pub fn lacks(&self, message: String) {
        self.note(&self.table.place, message);
    }

    /// Notes a mistake at any place.
    pub(super) fn note(&self, place: &Location, message: String) {
        if !self.silent {
            self.reader.mistake(place, message);
        }
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
                self.mistake(
                    key,
                    format!("is {}; write it as a string, in quotation marks", node.value.what()),
                );
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
            let hint = suggest::did_you_mean(&text, words.iter().copied());
            self.mistake(key, format!("takes {}, not `{text}`{hint}", words.join(" or ")));
            default
        })
    }

    /// True or false, if it is given.
    pub fn flag(&self, key: &'static str) -> Option<bool> {
        match &self.entry(key)?.node.value {
            Value::Boolean(flag) => {
                self.resolve(key, *flag);
                Some(*flag)
            }
            other => {
                self.mistake(
                    key,
                    format!("is {}; write true or false, without quotation marks", other.what()),
                );
                None
            }
        }
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
                self.mistake(key, format!("is {bad}; write a whole number from 0 to 2^63 - 1"));
                default
            }
        };
        self.resolve(key, number as i64);
        number
    }

    /// The strings of an array, each with its place.
    pub fn texts(&self, key: &'static str) -> Vec<(String, Location)> {
        let mut texts = Vec::new();
        match self.entry(key).map(|entry| &entry.node.value) {
            None => {}
            Some(Value::Array(nodes)) => {
                for node in nodes {
                    match &node.value {
                        Value::Text(text) => texts.push((text.clone(), node.place.clone())),
                        other => {
                            self.note(&node.place, format!("`{key}` holds strings, not {}", other.what()))
                        }
                    }
                }
            }
            Some(other) => self.mistake(key, format!("is {}; write an array of strings", other.what())),
        }
        self.resolve(key, texts.iter().map(|(text, _)| text.clone()).collect::<Vec<_>>());
        texts
    }

    /// Complains about every key that nothing asked for, and gives back the table as resolved.
    pub fn finish(self) -> toml::Table {
        let known = self.known.into_inner();
        let unknown = self.table.entries.iter().filter(|entry| !known.contains(&entry.key.as_str()));
        for entry in unknown.filter(|_| !self.forgiving.get()) {
            let (key, inside) = (&entry.key, self.called.borrow());
            let message = if let Some(ours) = suggest::elsewhere(&self.path, key) {
                format!("`{key}` {ours}")
            } else if let Some(near) = suggest::nearest(key, known.iter().copied()) {
                format!("`{key}` is not a key of {inside}: did you mean `{near}`?")
            } else {
                format!("`{key}` is not a key of {inside}, which has {}", known.join(", "))
            };
            self.reader.mistake(&entry.place, message);
        }
        self.resolved.into_inner()
    }
}
