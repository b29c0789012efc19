//! TOML as written: a tree in which every key and value knows its place, so that each mistake can be pointed at.

use std::fmt;
use std::ops::Range;
use std::sync::Arc;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Where something was written: file, line and column (from 1), or an option of the command line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Location {
    source: Arc<str>,
    position: Option<(usize, usize)>,
}

impl Location {
    /// A source as a whole, such as `--set gyro.rate=fast`.
    pub fn whole(source: &str) -> Location {
        Location { source: source.into(), position: None }
    }

    /// Line and column, where it has them.
    pub(super) fn position(&self) -> Option<(usize, usize)> {
        self.position
    }

    /// This place, `characters` further right.
    fn right(&self, characters: usize) -> Location {
        let position = self.position.map(|(line, column)| (line, column + characters));
        Location { position, ..self.clone() }
    }
}

impl fmt::Display for Location {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.position {
            Some((line, column)) => write!(f, "{}:{line}:{column}", self.source),
            None => f.write_str(&self.source),
        }
    }
}

/// One mistake and its place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mistake {
    /// Where.
    pub place: Location,
    /// The bad value and what would be right.
    pub message: String,
}

impl fmt::Display for Mistake {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.place, self.message)
    }
}

/// A value.
#[derive(Clone, Debug)]
pub enum Value {
    /// A string.
    Text(String),
    /// A whole number.
    Integer(i128),
    /// Any other number, as written.
    Float(String),
    /// `true` or `false`.
    Boolean(bool),
    /// A date or time, as written.
    Date(String),
    /// `[...]`.
    Array(Vec<Node>),
    /// `{...}` or `[...]` on a line of its own.
    Table(Table),
}

impl Value {
    /// What it is, for messages.
    pub fn what(&self) -> &'static str {
        match self {
            Value::Text(_) => "a string",
            Value::Integer(_) | Value::Float(_) => "a bare number",
            Value::Boolean(_) => "true or false",
            Value::Date(_) => "a date",
            Value::Array(_) => "an array",
            Value::Table(_) => "a table",
        }
    }
}

/// A value and its place.
#[derive(Clone, Debug)]
pub struct Node {
    /// The value.
    pub value: Value,
    /// Where it begins.
    pub place: Location,
    /// Whether a text stands in the source letter for letter, after one quotation mark.
    plain: bool,
}

impl Node {
    /// A value whose text does not stand in the source letter for letter.
    pub(super) fn new(value: Value, place: Location) -> Node {
        Node { value, place, plain: false }
    }

    /// Where the letter at byte `offset` of this node's text stands.
    pub fn place_in_text(&self, offset: usize) -> Location {
        match &self.value {
            Value::Text(text) if self.plain => {
                self.place.right(1 + text.get(..offset).map_or(0, |before| before.chars().count()))
            }
            _ => self.place.clone(),
        }
    }
}

/// A key and its value.
#[derive(Clone, Debug)]
pub struct Entry {
    /// The key.
    pub key: String,
    /// Where the key stands.
    pub place: Location,
    /// Its value.
    pub node: Node,
}

/// A table: its entries in the order written.
#[derive(Clone, Debug)]
pub struct Table {
    /// Where it begins.
    pub place: Location,
    /// Its entries.
    pub entries: Vec<Entry>,
}

impl Table {
    /// An empty table at a place.
    pub fn empty(place: Location) -> Table {
        Table { place, entries: Vec::new() }
    }

    /// The entry of a key.
    pub fn get(&self, key: &str) -> Option<&Entry> {
        self.entries.iter().find(|entry| entry.key == key)
    }

    /// Reads a whole document; `name` is what messages call it.
    ///
    /// # Errors
    /// The first place that is not TOML.
    pub fn parse(text: &str, name: &str) -> Result<Table, Mistake> {
        let source = Source::new(text, name);
        match DeTable::parse(text) {
            Ok(table) => Ok(source.table(table.get_ref(), 0)),
            Err(error) => {
                let span = error.span().unwrap_or_default();
                Err(Mistake {
                    place: source.place(span.start),
                    message: source.not_toml(error.message(), span),
                })
            }
        }
    }

    /// Sets one value by its dotted path, such as `gyro.rate` or `motion.0.duration`, as `--set` does: the text
    /// is taken as TOML where it is a value of it, else as a string.
    ///
    /// # Errors
    /// A path that leads through something which is no table.
    pub fn set(&mut self, assignment: &str) -> Result<(), Mistake> {
        let place = Location::whole(&format!("--set {assignment}"));
        let wrong = |message: String| Mistake { place: place.clone(), message };
        let Some((path, text)) = assignment.split_once('=') else {
            return Err(wrong("is not KEY=VALUE: write, for example, --set gyro.rate='8 kHz'".into()));
        };
        let value = value_of(text.trim(), &place);
        self.put(path.trim(), Node::new(value, place.clone()))
    }

    /// Sets one value by its dotted path; its place is where mistakes are said to be.
    pub(super) fn put(&mut self, path: &str, node: Node) -> Result<(), Mistake> {
        let place = node.place.clone();
        let wrong = |message: String| Mistake { place: place.clone(), message };
        let mut table = self;
        let mut steps = path.split('.').peekable();
        while let Some(step) = steps.next() {
            if step.is_empty() {
                return Err(wrong(format!("`{path}` is not a key: write, for example, gyro.rate")));
            }
            let found = table.entry(step, &place);
            if steps.peek().is_none() {
                *found = node;
                return Ok(());
            }
            let inner = match &mut found.value {
                Value::Array(items) => {
                    let (index, count) = (steps.next().unwrap_or_default(), items.len());
                    let item = index.parse().ok().and_then(|i: usize| items.get_mut(i));
                    let no_item = match count {
                        0 => format!("`{step}` has no entries"),
                        1 => format!("`{step}` has 1 entry, {step}.0"),
                        _ => format!("`{step}` has {count} entries, {step}.0 to {step}.{}", count - 1),
                    };
                    let item = item.ok_or_else(|| wrong(no_item))?;
                    if steps.peek().is_none() {
                        *item = node;
                        return Ok(());
                    }
                    &mut item.value
                }
                value => value,
            };
            table = match inner {
                Value::Table(table) => table,
                other => return Err(wrong(format!("`{step}` is {}, not a table", other.what()))),
            };
        }
        Ok(())
    }

    fn entry(&mut self, key: &str, place: &Location) -> &mut Node {
        let index = self.entries.iter().position(|entry| entry.key == key).unwrap_or_else(|| {
            let node =
                Node { value: Value::Table(Table::empty(place.clone())), place: place.clone(), plain: false };
            self.entries.push(Entry { key: key.into(), place: place.clone(), node });
            self.entries.len() - 1
        });
        &mut self.entries[index].node
    }
}

/// A value of `--set`.
fn value_of(text: &str, place: &Location) -> Value {
    let document = format!("value = {text}");
    let parsed = Table::parse(&document, "--set").ok();
    let mut value = match parsed.and_then(|table| table.entries.into_iter().next()) {
        Some(entry) if !matches!(entry.node.value, Value::Date(_)) => entry.node.value,
        _ => Value::Text(text.to_string()),
    };
    fn move_to(value: &mut Value, place: &Location) {
        let nodes: Box<dyn Iterator<Item = &mut Node>> = match value {
            Value::Array(nodes) => Box::new(nodes.iter_mut()),
            Value::Table(table) => Box::new(table.entries.iter_mut().map(|entry| &mut entry.node)),
            _ => return,
        };
        for node in nodes {
            node.place = place.clone();
            node.plain = false;
            move_to(&mut node.value, place);
        }
    }
    move_to(&mut value, place);
    value
}

struct Source<'a> {
    text: &'a str,
    name: Arc<str>,
    /// Where each line begins.
    lines: Vec<usize>,
}

impl<'a> Source<'a> {
    fn new(text: &'a str, name: &str) -> Source<'a> {
        let lines = std::iter::once(0).chain(text.match_indices('\n').map(|(end, _)| end + 1)).collect();
        Source { text, name: name.into(), lines }
    }

    /// What the TOML reader found, and what its commonest reasons mean here.
    fn not_toml(&self, found: &str, span: Range<usize>) -> String {
        let found = found.replace('\n', "; ");
        let word = self.text.get(span.clone()).unwrap_or_default();
        if found.contains("duplicate key") {
            return format!("`{word}` is given twice");
        }
        let before = self.text.get(..span.start).unwrap_or_default();
        let line =
            self.text[before.rfind('\n').map_or(0, |end| end + 1)..].lines().next().unwrap_or_default();
        let unquoted = |(key, value): (&str, &str)| {
            let value = value.split('#').next().unwrap_or_default().trim();
            let is_quantity = value.starts_with(|c: char| c.is_ascii_digit() || "+-.[".contains(c))
                && value.contains(char::is_alphabetic)
                && !value.contains(['"', '\'', '{']);
            is_quantity.then(|| {
                format!("a value with a unit stands in quotation marks, {} = \"{value}\"", key.trim())
            })
        };
        let why = line.split_once('=').and_then(unquoted).unwrap_or(found);
        format!("this is not TOML: {why}")
    }

    fn place(&self, offset: usize) -> Location {
        let offset = offset.min(self.text.len());
        let line = self.lines.partition_point(|&start| start <= offset);
        let begins = self.lines.get(line.saturating_sub(1)).copied().unwrap_or_default();
        let column = self.text[begins..offset].chars().count() + 1;
        Location { source: self.name.clone(), position: Some((line, column)) }
    }

    fn table(&self, table: &DeTable<'_>, offset: usize) -> Table {
        let entry = |(key, value): (&Spanned<std::borrow::Cow<'_, str>>, &Spanned<DeValue<'_>>)| Entry {
            key: key.get_ref().to_string(),
            place: self.place(key.span().start),
            node: self.node(value),
        };
        Table { place: self.place(offset), entries: table.iter().map(entry).collect() }
    }

    fn node(&self, value: &Spanned<DeValue<'_>>) -> Node {
        let span = value.span();
        let raw = self.text.get(span.clone()).unwrap_or_default();
        let mut plain = false;
        let value = match value.get_ref() {
            DeValue::String(text) => {
                plain = raw.get(1..raw.len().max(2) - 1) == Some(text);
                Value::Text(text.to_string())
            }
            DeValue::Integer(integer) => match i128::from_str_radix(integer.as_str(), integer.radix()) {
                Ok(integer) => Value::Integer(integer),
                Err(_) => Value::Float(integer.to_string()),
            },
            DeValue::Float(float) => Value::Float(float.as_str().to_string()),
            DeValue::Boolean(boolean) => Value::Boolean(*boolean),
            DeValue::Datetime(date) => Value::Date(date.to_string()),
            DeValue::Array(items) => Value::Array(items.iter().map(|item| self.node(item)).collect()),
            DeValue::Table(table) => Value::Table(self.table(table, span.start)),
        };
        Node { value, place: self.place(span.start), plain }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_value_knows_its_line_and_column() {
        let table =
            Table::parse("seed = 1\n[gyro]\n# µT\nrate = \"1 kHz\"\n[[motion]]\nkind = \"hold\"\n", "s.toml")
                .unwrap();
        let Value::Table(gyro) = &table.get("gyro").unwrap().node.value else { panic!() };
        let rate = gyro.get("rate").unwrap();
        assert_eq!(rate.place.to_string(), "s.toml:4:1");
        assert_eq!(rate.node.place.to_string(), "s.toml:4:8");
        assert_eq!(rate.node.place_in_text(2).to_string(), "s.toml:4:11");
    }

    #[test]
    fn what_is_not_toml_is_placed() {
        let mistake = Table::parse("seed = 1\nrate = = 2\n", "s.toml").unwrap_err();
        assert!(mistake.to_string().starts_with("s.toml:2:"), "{mistake}");
    }

    #[test]
    fn set_replaces_adds_and_indexes() {
        let mut table = Table::parse("seed = 1\n[[motion]]\nduration = \"1 s\"\n", "s.toml").unwrap();
        for assignment in
            ["seed=7", "gyro.rate=8 kHz", "motion.0.duration='2 s'", "gyro.bias=[1, 2, 3] deg/s"]
        {
            table.set(assignment).unwrap();
        }
        assert!(matches!(table.get("seed").unwrap().node.value, Value::Integer(7)));
        let Value::Table(gyro) = &table.get("gyro").unwrap().node.value else { panic!() };
        assert!(matches!(&gyro.get("rate").unwrap().node.value, Value::Text(text) if text == "8 kHz"));
        assert!(
            matches!(&gyro.get("bias").unwrap().node.value, Value::Text(text) if text == "[1, 2, 3] deg/s")
        );
        for (bad, says) in [
            ("seed", "KEY=VALUE"),
            ("motion.3.duration=1", "has 1 entry, motion.0"),
            ("seed.x=1", "not a table"),
            ("a..b=1", "not a key"),
        ] {
            let message = table.set(bad).unwrap_err().to_string();
            assert!(message.starts_with(&format!("--set {bad}")) && message.contains(says), "{message}");
        }
    }
}
