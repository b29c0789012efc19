//! Errors in the spelling of an address.

/// What is wrong with a spelling, and what would be right.
#[derive(Debug)]
pub(super) struct Problem {
    pub what: String,
    pub right: String,
}

impl Problem {
    pub(super) fn new(what: impl Into<String>, right: impl Into<String>) -> Self {
        Self { what: what.into(), right: right.into() }
    }
}

/// A path that must not be empty.
pub(super) fn path(rest: &str, example: &str) -> Result<std::path::PathBuf, Problem> {
    if rest.is_empty() {
        Err(Problem::new("the path is missing", format!("add it: {example}")))
    } else {
        Ok(rest.into())
    }
}
