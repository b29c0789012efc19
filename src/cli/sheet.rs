//! A table before it is printed: the same one stands on the terminal and in a report's page.

use super::terminal::Stream;
use crate::live::Table;

/// A heading and its rows, as many cells as columns.
#[derive(Clone, Debug, Default)]
pub struct Sheet {
    /// The names of the columns, with their units.
    pub heading: Vec<&'static str>,
    /// Cells as they are printed.
    pub rows: Vec<Vec<String>>,
}

impl Sheet {
    /// As lines of a terminal.
    pub fn text(&self, stream: Stream) -> String {
        stream.table(&self.heading, &self.rows)
    }

    /// As a table of a page; `None` where it has no rows.
    pub fn table(self, title: &str) -> Option<Table> {
        let heading = self.heading.iter().map(ToString::to_string).collect();
        (!self.rows.is_empty()).then(|| Table { title: title.into(), heading, rows: self.rows })
    }
}
