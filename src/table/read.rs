//! A table, from its header on, and its rows as they stand there, one at a time.

use super::cells::{self, Cell};
use super::choice::{Attitudes, Choice, Clock, Columns};
use super::error::{Mistake, TableError};
use super::head;
use super::kinds::Kind;
use super::lines::{Lines, Numbered};
use super::names::{self, Set, TimeColumn};
use super::times::{TICKS, decimal};
use std::collections::VecDeque;
use std::io::{self, BufRead};
use std::ops::Range;

/// As many lines are looked at for a header.
const LOOK: usize = 256;
/// The widest table that is looked at.
const WIDE: usize = 1024;
/// As many comments above the header are kept.
const COMMENTS: usize = 64;

/// A table whose header is read and whose rows are not.
#[derive(Debug)]
pub struct Table<R> {
    pub(super) columns: Columns,
    delimiter: u8,
    /// Whether a comma is the decimal point.
    pub(super) comma: bool,
    /// Rows that were read to find the header.
    held: VecDeque<Numbered>,
    lines: Lines<R>,
    pub(super) line: Numbered,
    cells: Vec<Range<usize>>,
}

/// What is wanted of each row.
#[derive(Clone, Debug, PartialEq)]
pub struct Wanted<const N: usize> {
    /// When it is.
    pub clock: Clock,
    /// The columns of its values.
    pub columns: [usize; N],
    /// Columns that are not used, of which it is told whether anything changes in them.
    pub watched: Vec<usize>,
}

impl<const N: usize> Wanted<N> {
    /// Time and values alone.
    pub fn new(clock: Clock, columns: [usize; N]) -> Wanted<N> {
        Wanted { clock, columns, watched: Vec::new() }
    }
}

/// A row as it stands there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row<const N: usize> {
    /// The line it stands on.
    pub line: u64,
    /// Its time in 1e-9 of the column's unit; `None` where the cell has none, and of a clock that is a rate.
    pub ticks: Option<i128>,
    /// Its values, NaN where a cell has none.
    pub values: [f64; N],
}

/// What comes next in a table.
#[derive(Clone, Debug, PartialEq)]
pub enum Next<const N: usize> {
    /// A row.
    Row(Row<N>),
    /// A line that is none.
    Mistake(Mistake),
    /// The end.
    End,
}

impl<R: BufRead> Table<R> {
    /// Reads the header; `name` is what messages call the file.
    ///
    /// # Errors
    /// The system's, or a file that is empty.
    pub fn open(name: &str, reader: R) -> Result<Table<R>, TableError> {
        let mut lines = Lines::new(reader);
        let (mut held, mut comments) = (Vec::new(), 0);
        loop {
            let mut line = Numbered::default();
            if !lines.next(&mut line).map_err(|source| io_error(name, source))? {
                break;
            }
            comments += usize::from(line.is_comment());
            held.push(line);
            if comments > COMMENTS
                && let Some(first) = held.iter().position(Numbered::is_comment)
            {
                held.remove(first);
                comments -= 1;
            }
            if held.len() - comments >= LOOK || head::is_enough(&held) {
                break;
            }
        }
        if held.iter().all(Numbered::is_comment) {
            return Err(TableError::Content(format!(
                "{name} is empty: it needs a header and rows of numbers"
            )));
        }
        let count = |line: &Numbered| cells::count(&line.text, cells::delimiter(&line.text));
        if let Some(line) = held.iter().find(|line| !line.is_comment() && count(line) > WIDE) {
            return Err(TableError::Content(format!(
                "{name}:{} has {} columns, above the limit of {WIDE}",
                line.number,
                count(line)
            )));
        }
        held.retain(|line| count(line) <= WIDE);
        let head = head::find(&held);
        let held: VecDeque<_> = held.drain(head.rows_from..).collect();
        let row = held.front().map(|line| (line.number, line.text.as_str()));
        let columns = Columns::new(name, &head, row);
        let comma = matches!(head.delimiter, b';' | b'\t');
        let (line, cells) = (Numbered::default(), Vec::new());
        Ok(Table { columns, delimiter: head.delimiter, comma, held, lines, line, cells })
    }

    /// Which column is called so, or has this number from 1.
    pub fn pick(&self, wanted: &str) -> Option<usize> {
        self.columns.pick(wanted)
    }

    /// Whether a column is called so, in letters of either case.
    pub fn has(&self, wanted: &str) -> bool {
        self.columns.has(wanted)
    }

    /// Which columns are called so, or have these numbers from 1.
    ///
    /// # Errors
    /// There are none: all of these that are missing, and what there is.
    pub fn picks<const N: usize>(&self, wanted: &[String; N]) -> Result<[usize; N], TableError> {
        self.columns.picks(wanted)
    }

    /// When its rows are: as chosen, else by the column of time that is known by its name; `None` where there is none.
    ///
    /// # Errors
    /// The column that is chosen is not there.
    pub fn clock(&self, choice: &Choice) -> Result<Option<Clock>, TableError> {
        self.columns.clock(choice)
    }

    /// Where its attitude is: as chosen, else by the columns that are known by their names; `None` where there is none.
    ///
    /// # Errors
    /// A column that is chosen is not there.
    pub fn attitude(&self, choice: &Choice) -> Result<Option<Attitudes>, TableError> {
        self.columns.attitude(choice)
    }

    /// Where an angular rate is, by the names of the columns.
    pub fn angular_rate(&self) -> Option<Set<3>> {
        names::angular_rate(self.columns.names.as_deref()?)
    }

    /// Where a position is, by the names of the columns.
    pub fn position(&self) -> Option<[usize; 3]> {
        self.columns.position()
    }

    /// Whether its columns have names.
    pub fn is_headed(&self) -> bool {
        self.columns.names.is_some()
    }

    /// What its rows are, where nothing in them can be read but their kind is known.
    pub fn kind(&self) -> Option<&'static Kind> {
        self.columns.kind()
    }

    /// What messages call a column: its name, or its number from 1.
    pub fn called(&self, column: usize) -> String {
        self.columns.called(column)
    }

    /// What its columns are, as the end of a sentence.
    pub fn told(&self) -> String {
        self.columns.told()
    }

    /// File and line of the header, or of the first row where there is none.
    pub fn place(&self) -> String {
        format!("{}:{}", self.columns.file, self.columns.line)
    }

    /// The next row.
    ///
    /// # Errors
    /// The system's.
    pub fn next<const N: usize>(&mut self, wanted: &Wanted<N>) -> Result<Next<N>, TableError> {
        let more = self.advance().map_err(|source| io_error(&self.columns.file, source))?;
        if !more {
            return Ok(Next::End);
        }
        Ok(match self.row(wanted) {
            Ok(row) => Next::Row(row),
            Err((column, what)) => {
                let column = column.map(|column| self.called(column));
                Next::Mistake(Mistake { line: self.line.number, column, what })
            }
        })
    }

    /// Reads the next line that is no comment into its cells.
    fn advance(&mut self) -> io::Result<bool> {
        loop {
            match self.held.pop_front() {
                Some(line) => self.line = line,
                None if self.lines.next(&mut self.line)? => {}
                None => return Ok(false),
            }
            if !self.line.is_comment() {
                cells::split(&self.line.text, self.delimiter, &mut self.cells);
                return Ok(true);
            }
        }
    }

    /// What stands in a column of the row that was read last.
    pub fn cell(&self, column: usize) -> &str {
        self.text(column)
    }

    /// Whether the line just read is the last and breaks off before the last column.
    pub(super) fn breaks_off(&self) -> bool {
        self.line.is_open && self.cells.len() < self.columns.count
    }

    pub(super) fn text(&self, column: usize) -> &str {
        self.cells.get(column).map_or("", |cell| &self.line.text[cell.clone()])
    }

    /// The row just read, or which column is wrong and why.
    fn row<const N: usize>(&self, wanted: &Wanted<N>) -> Result<Row<N>, (Option<usize>, String)> {
        let count = self.cells.len();
        let is_trailing = count == self.columns.count + 1 && self.text(count - 1).is_empty();
        if count != self.columns.count && !is_trailing {
            let what = if self.is_headed() { "the header" } else { "the first" };
            return Err((None, format!("the row has {count} columns, {what} {}", self.columns.count)));
        }
        let ticks = match wanted.clock {
            Clock::Rate(_) => None,
            Clock::Column { time, .. } => self.ticks(time)?,
        };
        let mut values = [0.0; N];
        for (value, column) in values.iter_mut().zip(wanted.columns) {
            *value = match cells::cell(self.text(column), self.comma) {
                Cell::Number(number) => number,
                Cell::Missing => f64::NAN,
                Cell::Word => return Err((Some(column), format!("`{}` is not a number", self.text(column)))),
            };
        }
        Ok(Row { line: self.line.number, ticks, values })
    }

    fn ticks(&self, time: TimeColumn) -> Result<Option<i128>, (Option<usize>, String)> {
        let of = |column: usize| {
            let text = self.text(column);
            let is_comma = self.comma && text.contains(',');
            let ticks = if is_comma { decimal(&text.replacen(',', ".", 1)) } else { decimal(text) };
            match (ticks, cells::cell(text, self.comma)) {
                (Some(ticks), _) => Ok(Some(ticks)),
                (None, Cell::Missing) => Ok(None),
                _ => {
                    Err((Some(column), format!("`{text}` is not a time: write a number in s, ms, us or ns")))
                }
            }
        };
        let whole = of(time.column)?;
        let Some(fine) = time.fine else { return Ok(whole) };
        Ok(whole.zip(of(fine)?).map(|(whole, fine)| whole.saturating_add(fine / TICKS)))
    }
}

fn io_error(name: &str, source: io::Error) -> TableError {
    TableError::Io { name: name.to_string(), source }
}
