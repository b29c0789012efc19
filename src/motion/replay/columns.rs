//! The header of a log, and which of its columns are meant.

use super::log;
use crate::keys::{KeyError, Text, Values, did_you_mean};

/// A header: the names of the columns and where the rows begin.
pub(super) struct Header<'a> {
    /// What messages call the log.
    pub file: &'a str,
    /// Its columns.
    pub names: Vec<String>,
    /// What separates them; a space stands for any white space.
    pub delimiter: u8,
    /// Everything after the header.
    pub rows: &'a str,
    /// The lines before `rows`.
    pub lines: u64,
}

/// Columns that are recognised by their names, the first set that a log has; each with how many inside units one of
/// theirs is.
pub(super) struct Known {
    pub key: &'static str,
    pub sets: &'static [(&'static [&'static str], f64)],
}

/// Columns to be read: the key to blame, their names, their places in a row, and their unit.
#[derive(Clone, Debug)]
pub(super) struct Group {
    pub key: &'static str,
    pub names: Vec<String>,
    pub indices: Vec<usize>,
    pub unit: f64,
}

/// The header of a log: its first line that is no comment, or the comment before its first row of numbers.
pub(super) fn header(text: &Text) -> Result<Header<'_>, KeyError> {
    let contents = text.contents.strip_prefix('\u{feff}').unwrap_or(&text.contents);
    let (mut offset, mut comment) = (0, None);
    for (line, whole) in (0..).zip(contents.split_inclusive('\n')) {
        let trimmed = whole.trim();
        let of = |names: &str, offset: usize, lines| Header {
            file: &text.name,
            delimiter: delimiter(names),
            names: split(names, delimiter(names)),
            rows: &contents[offset..],
            lines,
        };
        match trimmed.strip_prefix('#') {
            Some(rest) => comment = Some(rest.trim()),
            None if trimmed.is_empty() => {}
            None if split(trimmed, delimiter(trimmed)).iter().any(|field| log::is_number(field)) => {
                let header = comment.filter(|names| !names.is_empty()).map(|names| of(names, offset, line));
                let lacking = || {
                    let message = format!(
                        "{}:{} holds numbers, but the line before the first row names the columns, such as t_ns,qw,qx,qy,qz",
                        text.name,
                        line + 1
                    );
                    KeyError::new("file", message)
                };
                return header.ok_or_else(lacking);
            }
            None => return Ok(of(trimmed, offset + whole.len(), line + 1)),
        }
        offset += whole.len();
    }
    Err(KeyError::new("file", format!("{} is empty: a header and rows of numbers are needed", text.name)))
}

/// The likeliest of comma, semicolon and tab; else white space.
fn delimiter(line: &str) -> u8 {
    let count = |delimiter: u8| line.bytes().filter(|byte| *byte == delimiter).count();
    let most = [b',', b';', b'\t'].into_iter().max_by_key(|&delimiter| count(delimiter));
    most.filter(|&delimiter| count(delimiter) > 0).unwrap_or(b' ')
}

fn split(line: &str, delimiter: u8) -> Vec<String> {
    let plain = |field: &str| field.trim().trim_matches('"').trim().to_string();
    match delimiter {
        b' ' => line.split_whitespace().map(plain).collect(),
        other => line.split(char::from(other)).map(plain).collect(),
    }
}

impl Header<'_> {
    /// The column of time.
    pub(super) fn time(&self, values: &Values, known: &Known) -> Result<Group, KeyError> {
        let found = self.given(values, known).or_else(|| self.known(known).map(Ok));
        let lacking = format!(
            "{} has no column of time that is recognised (t_ns, t_s): add time = {{ column = \"…\", unit = \"s\" }}; {}",
            self.file,
            self.columns()
        );
        found.unwrap_or_else(|| Err(KeyError::new("file", lacking)))
    }

    /// The columns that the scene names, or the first of these that the log has.
    pub(super) fn one_of(&self, values: &Values, known: &[&Known]) -> Result<Group, KeyError> {
        let given: Vec<_> = known.iter().filter(|known| values.has(known.key)).collect();
        if let [first, second, ..] = given[..] {
            let message = format!("is given beside `{}`: keep one of the two", first.key);
            return Err(KeyError::new(second.key, message));
        }
        let found = given.first().and_then(|known| self.given(values, known));
        let found = found.or_else(|| known.iter().find_map(|known| self.known(known)).map(Ok));
        let lacking = format!(
            "{} has no attitude or angular rate that is recognised (qw, qx, qy, qz, …): name its columns, such as euler = {{ columns = [\"roll\", \"pitch\", \"yaw\"], unit = \"deg\" }}; {}",
            self.file,
            self.columns()
        );
        found.unwrap_or_else(|| Err(KeyError::new("file", lacking)))
    }

    fn given(&self, values: &Values, known: &Known) -> Option<Result<Group, KeyError>> {
        let (names, unit) = values.columns(known.key)?;
        let missing: Vec<_> = names.iter().filter(|name| !self.names.contains(name)).collect();
        if let [first, ..] = missing[..] {
            let hint = did_you_mean(first, self.names.iter().map(String::as_str));
            let missing: Vec<_> = missing.iter().map(|name| format!("`{name}`")).collect();
            let (file, missing) = (self.file, missing.join(", "));
            let message = format!("{file} has no column {missing}{hint}; {}", self.columns());
            return Some(Err(KeyError::new(known.key, message)));
        }
        self.group(known.key, names.iter().map(String::as_str), unit).map(Ok)
    }

    fn known(&self, known: &Known) -> Option<Group> {
        known.sets.iter().find_map(|(names, unit)| self.group(known.key, names.iter().copied(), *unit))
    }

    fn group<'n>(&self, key: &'static str, names: impl Iterator<Item = &'n str>, unit: f64) -> Option<Group> {
        let names: Vec<_> = names.map(String::from).collect();
        let find = |name: &String| self.names.iter().position(|column| column == name);
        let indices = names.iter().map(find).collect::<Option<_>>()?;
        Some(Group { key, names, indices, unit })
    }

    fn columns(&self) -> String {
        format!("its columns are {}", self.names.join(", "))
    }
}
