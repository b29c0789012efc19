//! All usable rows of a table, in order.

use super::cells::{self, Cell};
use super::choice::Clock;
use super::error::{Mistake, Mistakes, TableError};
use super::left_out::{Reason, Rows};
use super::names::TimeColumn;
use super::order::{self, Fate};
use super::read::{Next, Row, Table, Wanted};
use super::times::{TimeUnit, Times};
use std::io::BufRead;

/// Why the values of a row cannot be used.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Flaw {
    /// They are all zero, as a program writes what it does not have: the row is left out.
    Zero,
    /// A mistake, in words.
    Wrong(String),
}

/// All rows of a table that can be used, in order but for the breaks.
#[derive(Clone, Debug, PartialEq)]
pub struct Series<T> {
    /// Their times.
    pub times: Times,
    /// Their values.
    pub values: Vec<T>,
    /// The lines they stand on.
    pub lines: Vec<u32>,
    /// How many there were, and how many are left out.
    pub rows: Rows,
    /// Of each watched column whether anything changes in it.
    pub changes: Vec<bool>,
    /// What the user should know of how they were read.
    pub remarks: Vec<String>,
}

impl<R: BufRead> Table<R> {
    /// Reads all rows; `make` takes the values of one.
    ///
    /// # Errors
    /// The system's; words where numbers should be, rows of another width, what `make` calls wrong, times in no order.
    pub fn read<const N: usize, T>(
        mut self,
        wanted: &Wanted<N>,
        mut make: impl FnMut(&[f64; N]) -> Result<T, Flaw>,
    ) -> Result<Series<T>, TableError> {
        let mut series = Series::empty();
        let mut mistakes = Mistakes::default();
        let mut watch = Watch::new(&wanted.watched);
        let mut has_comma = false;
        loop {
            let row = match self.next(wanted)? {
                Next::End => break,
                // A log whose writer lost its power.
                Next::Mistake(mistake) if self.breaks_off() => {
                    let what = format!("the last row, line {}, is truncated and is left out", mistake.line);
                    series.remarks.push(what);
                    continue;
                }
                Next::Mistake(mistake) => {
                    mistakes.push(mistake);
                    continue;
                }
                Next::Row(row) => row,
            };
            watch.see(|column| self.text(column), self.comma);
            has_comma |= self.comma && self.line.text.contains(',');
            if let Err(what) = series.take(&row, wanted.clock, &mut make) {
                mistakes.push(Mistake { line: row.line, column: None, what });
            }
        }
        mistakes.end(&self.columns.file)?;
        series.changes = watch.changes;
        if has_comma {
            series.remarks.push("a comma in its numbers is read as a decimal point".into());
        }
        series.order(wanted.clock);
        series.is_in_order(&self.columns.file)?;
        Ok(series)
    }
}

impl<T> Series<T> {
    fn empty() -> Series<T> {
        Series {
            times: Times::default(),
            values: Vec::new(),
            lines: Vec::new(),
            rows: Rows::default(),
            changes: Vec::new(),
            remarks: Vec::new(),
        }
    }

    /// Takes a row in, or leaves it out; an error is a mistake in its values.
    fn take<const N: usize>(
        &mut self,
        row: &Row<N>,
        clock: Clock,
        make: &mut impl FnMut(&[f64; N]) -> Result<T, Flaw>,
    ) -> Result<(), String> {
        let ticks = match clock {
            Clock::Rate(rate) => Some(i128::from(rate.tick(self.rows.read as u64).0)),
            Clock::Column { .. } => row.ticks,
        };
        self.rows.read += 1;
        let Some(ticks) = ticks.filter(|_| row.values.iter().all(|value| value.is_finite())) else {
            self.rows.leave(Reason::NotFinite, row.line);
            return Ok(());
        };
        match make(&row.values) {
            Ok(value) => {
                self.times.ticks.push(ticks);
                self.values.push(value);
                self.lines.push(u32::try_from(row.line).unwrap_or(u32::MAX));
            }
            Err(Flaw::Zero) => self.rows.leave(Reason::Zero, row.line),
            Err(Flaw::Wrong(what)) => return Err(what),
        }
        Ok(())
    }

    /// Refuses times that step back again and again: that is no clock.
    fn is_in_order(&self, file: &str) -> Result<(), TableError> {
        let breaks = &self.times.breaks;
        if breaks.len() < 2 || 8 * breaks.len() <= self.values.len() {
            return Ok(());
        }
        let (line, count, rows) = (self.lines[breaks[0]], breaks.len(), self.rows.read);
        Err(TableError::Content(format!(
            "{file}:{line}: its times are not in order: they step back {count} times in {rows} rows"
        )))
    }

    /// Of records that are no lines of a text, with ticks of `unit`: those out of order are left out of `rows` too.
    pub fn of_records(ticks: Vec<i128>, values: Vec<T>, unit: TimeUnit, rows: Rows) -> Series<T> {
        let time = TimeColumn { column: 0, fine: None, unit: Some(unit) };
        let lines = vec![0; values.len()];
        let times = Times { ticks, ..Times::default() };
        let mut series = Series { times, values, lines, rows, changes: Vec::new(), remarks: Vec::new() };
        series.order(Clock::Column { time, assumed: None });
        series
    }

    /// The same rows with other values, as many as there were.
    pub fn with<U>(self, values: Vec<U>) -> Series<U> {
        let Series { times, lines, rows, changes, remarks, .. } = self;
        Series { times, values, lines, rows, changes, remarks }
    }

    /// Sets the unit, goes on where a counter wraps, leaves out what is out of order and finds the breaks.
    fn order(&mut self, clock: Clock) {
        let Clock::Column { time, assumed } = clock else {
            self.times.unit = Some(TimeUnit::S);
            return;
        };
        self.times.unit = time.unit;
        let wraps = order::unwrap(&mut self.times.ticks, time.unit);
        if let Some(first) = wraps.first() {
            let line = self.lines[*first];
            self.remarks.push(format!("its time wraps at 2^32 at line {line} and is unwrapped"));
        }
        let fates = order::fates(&self.times.ticks);
        let mut kept = 0;
        for (row, fate) in fates.iter().enumerate() {
            let line = u64::from(self.lines[row]);
            match fate {
                Fate::Kept => kept += 1,
                Fate::Break => {
                    self.times.breaks.push(kept);
                    kept += 1;
                }
                Fate::Duplicate => self.rows.leave(Reason::Duplicate, line),
                Fate::Overtaken => self.rows.leave(Reason::Overtaken, line),
                Fate::Ahead => self.rows.leave(Reason::Ahead, line),
            }
        }
        let is_kept = |row: usize| matches!(fates[row], Fate::Kept | Fate::Break);
        if kept < fates.len() {
            retain(&mut self.times.ticks, is_kept);
            retain(&mut self.values, is_kept);
            retain(&mut self.lines, is_kept);
        }
        let is_likely = |unit: &TimeUnit| self.times.plausible().contains(unit);
        if let Some(unit) = assumed.filter(|unit| self.times.unit.is_none() && is_likely(unit)) {
            self.times.unit = Some(unit);
        }
    }
}

/// Keeps the elements at these places.
fn retain<T>(all: &mut Vec<T>, is_kept: impl Fn(usize) -> bool) {
    let mut place = 0;
    all.retain(|_| {
        place += 1;
        is_kept(place - 1)
    });
}

/// Columns that are watched for any change.
struct Watch {
    columns: Vec<usize>,
    first: Vec<Option<f64>>,
    changes: Vec<bool>,
}

impl Watch {
    fn new(columns: &[usize]) -> Watch {
        let count = columns.len();
        Watch { columns: columns.to_vec(), first: vec![None; count], changes: vec![false; count] }
    }

    fn see<'a>(&mut self, text: impl Fn(usize) -> &'a str, comma: bool) {
        for (i, column) in self.columns.iter().enumerate() {
            if !self.changes[i]
                && let Cell::Number(number) = cells::cell(text(*column), comma)
            {
                let first = *self.first[i].get_or_insert(number);
                self.changes[i] = first != number;
            }
        }
    }
}
