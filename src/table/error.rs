//! Why a table could not be read: every mistake with its place.

use std::fmt;
use std::io;

/// As many mistakes are listed.
const LISTED: usize = 5;

/// A mistake in a row.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mistake {
    /// The line it stands on.
    pub line: u64,
    /// The column, where it is in one.
    pub column: Option<String>,
    /// The bad value and what is wrong with it.
    pub what: String,
}

impl fmt::Display for Mistake {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.column {
            Some(column) => write!(f, "{}: column {column}: {}", self.line, self.what),
            None => write!(f, "{}: {}", self.line, self.what),
        }
    }
}

/// Why a table could not be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TableError {
    /// The system refused.
    #[error("cannot read {name}: {source}")]
    Io {
        /// The file.
        name: String,
        /// The system's reason.
        source: io::Error,
    },
    /// Its header, or it as a whole, cannot be understood.
    #[error("{0}")]
    Content(String),
    /// Rows that cannot be: the first of them, a line each.
    #[error("{}", listed(name, mistakes, *more))]
    Rows {
        /// The file.
        name: String,
        /// The first few.
        mistakes: Vec<Mistake>,
        /// How many more there are.
        more: usize,
    },
}

fn listed(name: &str, mistakes: &[Mistake], more: usize) -> String {
    let mut lines: Vec<_> = mistakes.iter().map(|mistake| format!("{name}:{mistake}")).collect();
    lines.extend((more > 0).then(|| format!("and {more} more rows")));
    lines.join("\n")
}

impl TableError {
    /// In one line: of like rows the first, and how many more there are.
    pub fn in_short(&self) -> String {
        match self {
            TableError::Rows { name, mistakes, more } if !mistakes.is_empty() => {
                let first = format!("{name}:{}", mistakes[0]);
                match mistakes.len() - 1 + more {
                    0 => first,
                    1 => format!("{first} (and another row like it)"),
                    more => format!("{first} (and {more} more rows like it)"),
                }
            }
            other => other.to_string(),
        }
    }
}

/// Mistakes as they are found: the first few, and how many more there are.
#[derive(Debug, Default)]
pub(super) struct Mistakes {
    first: Vec<Mistake>,
    more: usize,
}

impl Mistakes {
    pub fn push(&mut self, mistake: Mistake) {
        if self.first.len() < LISTED { self.first.push(mistake) } else { self.more += 1 }
    }

    /// An error, if there were any.
    pub fn end(self, name: &str) -> Result<(), TableError> {
        if self.first.is_empty() {
            return Ok(());
        }
        Err(TableError::Rows { name: name.to_string(), mistakes: self.first, more: self.more })
    }
}
