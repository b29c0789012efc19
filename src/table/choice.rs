//! Which columns are read: those that the user names, else those whose names are known.

use super::cells;
use super::error::TableError;
use super::head::Head;
use super::names::{self, Heading, Set, TimeColumn};
use super::times::TimeUnit;
use crate::keys::did_you_mean;
use crate::time::Rate;

/// The columns that a user names, each by its name or by its number from 1.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Choice {
    /// That of time.
    pub time: Option<String>,
    /// The unit of time.
    pub time_unit: Option<TimeUnit>,
    /// How often a row comes, of a table without a time.
    pub rate: Option<Rate>,
    /// Those of a quaternion, w first.
    pub quaternion: Option<[String; 4]>,
    /// Roll, pitch and yaw, and how many rad their unit is.
    pub euler: Option<([String; 3], Option<f64>)>,
}

/// When the rows are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Clock {
    /// By a column.
    Column {
        /// Which.
        time: TimeColumn,
        /// The unit by the kind of the file, if the rate is plausible with it.
        assumed: Option<TimeUnit>,
    },
    /// One after the other, the first at 0.
    Rate(Rate),
}

/// Where an attitude is in a row.
#[derive(Clone, Debug, PartialEq)]
pub enum Attitudes {
    /// Columns of w, x, y, z.
    Quaternion(Set<4>),
    /// Columns of roll, pitch, yaw; their unit is in rad.
    Euler(Set<3>),
}

/// A trajectory's columns, and those of its quaternion and position.
const TUM_COLUMNS: usize = 8;
const TUM: [usize; 4] = [7, 4, 5, 6];
const TUM_POSITION: [usize; 3] = [1, 2, 3];
/// The columns of a matrix of 3 by 4.
const KITTI_COLUMNS: usize = 12;

/// The columns of a table.
#[derive(Debug)]
pub(super) struct Columns {
    /// What messages call the file.
    pub file: String,
    pub names: Option<Vec<Heading>>,
    /// The line of the names, or of the first row.
    pub line: u64,
    /// How many there are.
    pub count: usize,
    is_tum: bool,
    is_kitti: bool,
}

impl Columns {
    /// Of a head; `row` is the first row.
    pub fn new(file: &str, head: &Head, row: Option<(u64, &str)>) -> Columns {
        let mut cells = Vec::new();
        if let Some((_, row)) = row {
            cells::split(row, head.delimiter, &mut cells);
        }
        let all_numbers = row.is_some_and(|(_, row)| {
            let trailing = cells.last().is_some_and(|cell| row[cell.clone()].is_empty());
            let used = cells.len() - usize::from(trailing);
            cells[..used].iter().all(|cell| cells::cell(&row[cell.clone()], false) != cells::Cell::Word)
        });
        let wide = row.map_or(0, |(_, row)| super::head::width(row));
        // A comment that names no attitude does not stand against eight columns of numbers.
        let turns =
            |names: &Vec<Heading>| names::quaternion(names).is_some() || names::euler(names).is_some();
        let is_named = head.names.as_ref().is_some_and(|names| !head.is_comment || turns(names));
        let is_tum = !is_named && wide == TUM_COLUMNS;
        let names = head.names.clone().filter(|_| !is_tum);
        let line = if names.is_some() { head.line } else { row.map_or(head.line, |(line, _)| line) };
        let count = names.as_ref().map_or(wide, Vec::len);
        let is_kitti = names.is_none() && wide == KITTI_COLUMNS && all_numbers;
        Columns { file: file.to_string(), names, line, count, is_tum, is_kitti }
    }

    /// What messages call a column.
    pub fn called(&self, column: usize) -> String {
        match self.names.as_ref().and_then(|names| names.get(column)) {
            Some(name) if !name.text.is_empty() => name.text.clone(),
            _ => (column + 1).to_string(),
        }
    }

    /// What the columns are, to end a refusal with.
    pub fn told(&self) -> String {
        match &self.names {
            Some(names) => {
                let names: Vec<_> = names.iter().map(|name| name.text.as_str()).collect();
                format!("its columns are {}", names.join(", "))
            }
            None => format!("it has {} columns without names", self.count),
        }
    }

    /// The place of a column that a user names: as the file has it, in other letters, without its unit, or by its
    /// number.
    pub fn pick(&self, wanted: &str) -> Option<usize> {
        let names = self.names.as_deref().unwrap_or_default();
        let place = |is: &dyn Fn(&Heading) -> bool| names.iter().position(is);
        let number =
            || wanted.trim().parse::<usize>().ok().filter(|n| (1..=self.count).contains(n)).map(|n| n - 1);
        let lower = Heading::new(wanted);
        place(&|name| name.text == wanted)
            .or_else(|| place(&|name| name.text.eq_ignore_ascii_case(wanted)))
            .or_else(number)
            .or_else(|| {
                place(&|name| name.base == lower.base && lower.unit.is_none() && !lower.base.is_empty())
            })
    }

    /// Whether a column is called so, whatever its number.
    pub fn has(&self, wanted: &str) -> bool {
        let names = self.names.as_deref().unwrap_or_default();
        names.iter().any(|name| name.text.eq_ignore_ascii_case(wanted))
    }

    /// The places of columns that a user names, or which of them there are not.
    pub fn picks<const N: usize>(&self, wanted: &[String; N]) -> Result<[usize; N], TableError> {
        let missing: Vec<_> = wanted.iter().filter(|name| self.pick(name).is_none()).collect();
        let Some(first) = missing.first() else {
            return Ok(wanted.each_ref().map(|name| self.pick(name).unwrap_or_default()));
        };
        let names = self.names.as_deref().unwrap_or_default();
        let hint = did_you_mean(first, names.iter().map(|name| name.text.as_str()));
        let missing: Vec<_> = missing.iter().map(|name| format!("`{name}`")).collect();
        let message = format!("{} has no column {}{hint}; {}", self.file, missing.join(", "), self.told());
        Err(TableError::Content(message))
    }

    pub fn clock(&self, choice: &Choice) -> Result<Option<Clock>, TableError> {
        if let Some(rate) = choice.rate {
            return Ok(Some(Clock::Rate(rate)));
        }
        let names = self.names.as_deref().unwrap_or_default();
        let given = match &choice.time {
            Some(name) => {
                let [column] = self.picks(std::array::from_ref(name))?;
                Some(column)
            }
            None => None,
        };
        let found = match given {
            Some(column) => {
                let unit = names.get(column).and_then(|name| names::time(std::slice::from_ref(name)));
                Some(TimeColumn { column, fine: None, unit: unit.and_then(|time| time.unit) })
            }
            None if self.is_tum => Some(TimeColumn { column: 0, fine: None, unit: None }),
            None => names::time(names),
        };
        let is_tum = self.is_tum
            || (self.count == TUM_COLUMNS && names::quaternion(names).is_some_and(|set| set.columns == TUM));
        let clock = |mut time: TimeColumn| {
            time.unit = choice.time_unit.or(time.unit);
            let assumed = (is_tum && time.column == 0).then_some(TimeUnit::S);
            Clock::Column { time, assumed }
        };
        Ok(found.map(clock))
    }

    pub fn attitude(&self, choice: &Choice) -> Result<Option<Attitudes>, TableError> {
        let set = |unit| Set { columns: [0; 3], unit, by_kind: None, others: Vec::new() };
        if let Some(names) = &choice.quaternion {
            return Ok(Some(Attitudes::Quaternion(quaternion(self.picks(names)?))));
        }
        let names = self.names.as_deref().unwrap_or_default();
        if let Some((wanted, unit)) = &choice.euler {
            let columns = self.picks(wanted)?;
            let said = columns.iter().find_map(|column| match names.get(*column)?.unit {
                Some(super::Unit::Angle(rad)) => Some(rad),
                _ => None,
            });
            return Ok(Some(Attitudes::Euler(Set { columns, ..set(unit.or(said)) })));
        }
        if self.is_tum {
            return Ok(Some(Attitudes::Quaternion(quaternion(TUM))));
        }
        let by_quaternion = names::quaternion(names).map(Attitudes::Quaternion);
        Ok(by_quaternion.or_else(|| names::euler(names).map(Attitudes::Euler)))
    }

    pub fn position(&self) -> Option<[usize; 3]> {
        if self.is_tum {
            return Some(TUM_POSITION);
        }
        names::position(self.names.as_deref()?).map(|set| set.columns)
    }

    /// Why no column was found, where the rows are of a kind that is known.
    pub fn kind(&self) -> Option<&'static super::kinds::Kind> {
        self.is_kitti.then_some(&super::kinds::KITTI)
    }
}

fn quaternion(columns: [usize; 4]) -> Set<4> {
    Set { columns, unit: Some(1.0), by_kind: None, others: Vec::new() }
}
