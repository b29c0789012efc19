//! The rows of a log as numbers: times exact in nanoseconds from the first row, values in our units.

use super::columns::{When, at};
use super::grid::Grid;
use super::{FILE, TIME};
use crate::keys::KeyError;
use crate::table::{Clock, Flaw, Series, Table, TimeUnit, Wanted};
use crate::time::SimTime;
use std::io::BufRead;

/// A log with N values in each row.
pub(super) struct Log<const N: usize> {
    /// The file's name in messages.
    file: String,
    /// The time of each row.
    pub grid: Grid,
    /// The values of each row.
    pub rows: Vec<[f64; N]>,
    /// The line number of each row.
    lines: Vec<u32>,
    /// What the user should know about how it was read.
    pub warnings: Vec<String>,
}

impl<const N: usize> Log<N> {
    /// Reads these columns and multiplies their values by `unit`; `is_nothing` says which row contains no data.
    pub(super) fn read<R: BufRead>(
        table: Table<R>,
        when: &When,
        (columns, unit): ([usize; N], f64),
        is_nothing: fn(&[f64; N]) -> bool,
    ) -> Result<Log<N>, KeyError> {
        let file = table.place();
        let file = file.rsplit_once(':').map_or(file.as_str(), |(file, _)| file).to_string();
        let column = match when.clock {
            Clock::Column { time, .. } => Some((time.column, table.called(time.column))),
            Clock::Rate(_) => None,
        };
        let is_used =
            |other: &usize| columns.contains(other) || column.as_ref().is_some_and(|(time, _)| time == other);
        let watched = table.position().filter(|columns| !columns.iter().any(is_used));
        let watched_names = watched.map(|columns| columns.map(|column| table.called(column)));
        let watched = watched.map_or(Vec::new(), |columns| columns.to_vec());
        let wanted = Wanted { clock: when.clock, columns, watched };
        let make = |row: &[f64; N]| if is_nothing(row) { Err(Flaw::Zero) } else { Ok(row.map(|x| x * unit)) };
        let series = table.read(&wanted, make).map_err(at(FILE))?;
        let times = times(&file, &series, when, column.map(|(_, name)| name))?;
        let mut warnings: Vec<_> = series.rows.told().into_iter().chain(series.remarks).collect();
        warnings.iter_mut().for_each(|warning| *warning = format!("{file}: {warning}"));
        warnings.extend(times.warning);
        if let Some(names) = watched_names.filter(|_| series.changes.contains(&true)) {
            warnings.push(format!(
                "{file}: {} are not used: a log turns the vehicle and does not move it, so the accelerometer does not feel this motion and neither barometer nor GPS tell it",
                names.join(", ")
            ));
        }
        let grid = Grid::new(times.from_first);
        Ok(Log { file, grid, rows: series.values, lines: series.lines, warnings })
    }

    /// File and line of a row.
    pub(super) fn place(&self, row: usize) -> String {
        format!("{}:{}", self.file, self.lines[row])
    }
}

/// The times of the rows.
struct Within {
    from_first: Vec<SimTime>,
    warning: Option<String>,
}

fn times<T>(file: &str, series: &Series<T>, when: &When, column: Option<String>) -> Result<Within, KeyError> {
    let wrong = |message: String| Err(KeyError::new(FILE, message));
    let times = &series.times;
    if times.ticks.len() < 2 {
        let count = if times.ticks.is_empty() { "no row" } else { "one row" };
        let told = series.rows.told().map_or(String::new(), |told| format!(" ({told})"));
        return wrong(format!("{file} has {count}, but a motion needs two{told}"));
    }
    if let Some(row) = times.breaks.first() {
        return wrong(format!(
            "{file}:{}: its clock steps back from the previous row and continues from there: cut the log there",
            series.lines[*row]
        ));
    }
    let (ns, warning) = match (when.ns, times.unit, column) {
        (Some(ns), ..) => (ns, None),
        (None, Some(unit), _) => (unit.ns(), None),
        (None, None, column) => {
            let column = column.unwrap_or_default();
            let unit = guessed(file, series, &column)?;
            let how = format!("{file}: its column `{column}` has no unit and is read as {unit}");
            (unit.ns(), Some(how))
        }
    };
    // A large count of a fine unit overflows ns; relative to the first row it does not.
    let first = times.ticks[0];
    let from_first = crate::table::Times {
        ticks: times.ticks.iter().map(|t| t.saturating_sub(first)).collect(),
        ..crate::table::Times::default()
    };
    let Some(ns) = from_first.scaled(ns) else {
        return Err(KeyError::new(TIME, format!("{file} lasts longer than 292 years")));
    };
    if let Some(row) = ns.windows(2).position(|pair| pair[1] <= pair[0]) {
        return wrong(format!(
            "{file}:{}: is less than a nanosecond after the previous row",
            series.lines[row + 1]
        ));
    }
    Ok(Within { from_first: ns.into_iter().map(SimTime).collect(), warning })
}

/// The unit of times that do not name one, if only one is plausible.
fn guessed<T>(file: &str, series: &Series<T>, column: &str) -> Result<TimeUnit, KeyError> {
    let (unit, is_sure) = series.times.guess();
    if is_sure {
        return Ok(unit);
    }
    let plausible: Vec<_> = series.times.plausible().iter().map(|unit| format!("\"{unit}\"")).collect();
    let why = match plausible.is_empty() {
        true => "no unit gives a plausible rate".to_string(),
        false => format!("{} fit its rows", plausible.join(" and ")),
    };
    Err(KeyError::new(
        FILE,
        format!(
            "{file}: its column `{column}` has no unit, and {why}: add time = {{ column = \"{column}\", unit = \"{unit}\" }} or the right unit"
        ),
    ))
}

/// The first of several similar mistakes, and the number of others.
pub(super) fn first_of(mistakes: Vec<String>) -> Option<String> {
    let more = mistakes.len().saturating_sub(1);
    let first = mistakes.into_iter().next()?;
    Some(match more {
        0 => first,
        1 => format!("{first} (and another row like it)"),
        more => format!("{first} (and {more} more rows like it)"),
    })
}
