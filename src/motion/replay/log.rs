//! The rows of a log as numbers: times exact in nanoseconds from the first row, values in inside units.

use super::columns::{Group, Header};
use super::grid::Grid;
use crate::keys::KeyError;
use crate::time::{NANOS, SimTime};
use csv::{ByteRecord, ReaderBuilder};
use std::borrow::Cow;

/// A log of N values a row.
pub(super) struct Log<const N: usize> {
    /// What messages call it.
    file: String,
    /// When each row is.
    pub grid: Grid,
    /// The values of each row.
    pub rows: Vec<[f64; N]>,
    /// The line each row stands on.
    lines: Vec<u32>,
}

impl<const N: usize> Log<N> {
    /// Reads the column of `time` and those of `group`.
    pub(super) fn read(header: &Header<'_>, time: &Group, group: &Group) -> Result<Log<N>, KeyError> {
        // Every unit of time from the nanosecond on is a whole number of them.
        let unit = (time.unit * NANOS as f64).round();
        if unit < 1.0 {
            return Err(KeyError::new("time", "takes a unit of a nanosecond or more, such as \"ns\""));
        }
        let mut rows = Rows { header, time, group, unit: unit as i128, last: None };
        let (mut times, mut values, mut lines) = (Vec::new(), Vec::new(), Vec::new());
        let (mut mistakes, mut origin) = (Vec::new(), None);
        let text = separated(header);
        let delimiter = if header.delimiter == b' ' { b'\t' } else { header.delimiter };
        let mut reader = ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .delimiter(delimiter)
            .comment(Some(b'#'))
            .from_reader(text.as_bytes());
        let mut record = ByteRecord::new();
        // What is in memory can always be read.
        while reader.read_byte_record(&mut record).unwrap_or(false) {
            // A record's own position is before the comments and empty lines above it.
            let end = reader.position();
            let ended = text.as_bytes().get(end.byte() as usize - 1) == Some(&b'\n');
            let line = header.lines + end.line() - u64::from(ended);
            match rows.row::<N>(&record) {
                Ok((t, row)) => {
                    times.push(t - *origin.get_or_insert(t));
                    values.push(row);
                    lines.push(u32::try_from(line).unwrap_or(u32::MAX));
                }
                Err(problem) => mistakes.push(format!("{}:{line}: {problem}", header.file)),
            }
        }
        if let Some(message) = first_of(mistakes) {
            return Err(KeyError::new("file", message));
        }
        if values.len() < 2 {
            let count = if values.is_empty() { "no row" } else { "one row" };
            return Err(KeyError::new(
                "file",
                format!("{} has {count}, but a motion needs two", header.file),
            ));
        }
        let within = |t: i128| i64::try_from(t).ok().map(SimTime);
        let Some(times) = times.into_iter().map(within).collect::<Option<Vec<_>>>() else {
            return Err(KeyError::new("time", format!("{} lasts longer than 292 years", header.file)));
        };
        Ok(Log { file: header.file.to_string(), grid: Grid::new(times), rows: values, lines })
    }

    /// File and line of a row.
    pub(super) fn place(&self, row: usize) -> String {
        format!("{}:{}", self.file, self.lines[row])
    }
}

/// The rows with one separator between two values.
fn separated<'a>(header: &Header<'a>) -> Cow<'a, str> {
    if header.delimiter != b' ' {
        return header.rows.into();
    }
    let line = |line: &str| line.split_whitespace().collect::<Vec<_>>().join("\t") + "\n";
    header.rows.lines().map(line).collect::<String>().into()
}

struct Rows<'a> {
    header: &'a Header<'a>,
    time: &'a Group,
    group: &'a Group,
    /// Nanoseconds in a unit of time.
    unit: i128,
    last: Option<i128>,
}

impl Rows<'_> {
    fn row<const N: usize>(&mut self, record: &ByteRecord) -> Result<(i128, [f64; N]), String> {
        let field = |index: usize| {
            let text = record.get(index).ok_or_else(|| {
                format!("the row has {} columns, the header {}", record.len(), self.header.names.len())
            })?;
            Ok::<_, String>(std::str::from_utf8(text).unwrap_or("?").trim())
        };
        let text = field(self.time.indices[0])?;
        let name = &self.time.names[0];
        let t =
            nanoseconds(text, self.unit).ok_or_else(|| format!("`{text}` in column `{name}` is no time"))?;
        if self.last.is_some_and(|last| t <= last) {
            return Err(format!("`{text}` in column `{name}` is not after the row before: times must grow"));
        }
        self.last = Some(t);
        let mut values = [0.0; N];
        for ((value, &index), name) in values.iter_mut().zip(&self.group.indices).zip(&self.group.names) {
            let text = field(index)?;
            let number = text.parse::<f64>().ok().filter(|number| number.is_finite());
            *value = number.ok_or_else(|| format!("`{text}` in column `{name}` is no finite number"))?
                * self.group.unit;
        }
        Ok((t, values))
    }
}

/// Whether a field is a number, or stands for one that is missing.
pub(super) fn is_number(field: &str) -> bool {
    field.parse::<f64>().is_ok()
}

/// A decimal number of units as nanoseconds, rounded only where it is finer: a count of seconds since 1970 keeps
/// all its digits, which a double does not.
fn nanoseconds(text: &str, unit: i128) -> Option<i128> {
    if let Ok(whole) = text.parse::<i64>() {
        return i128::from(whole).checked_mul(unit);
    }
    let (mantissa, exponent) = match text.split_once(['e', 'E']) {
        Some((mantissa, exponent)) => (mantissa, exponent.parse::<i32>().ok()?),
        None => (text, 0),
    };
    let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    if !fraction.bytes().all(|byte| byte.is_ascii_digit()) || fraction.len() > 30 {
        return None;
    }
    let digits: i128 = format!("{whole}{fraction}").parse().ok()?;
    let scaled = digits.checked_mul(unit)?;
    let power = exponent.checked_sub(fraction.len() as i32)?;
    let ten = 10i128.checked_pow(power.unsigned_abs());
    if power >= 0 {
        return scaled.checked_mul(ten?);
    }
    // So fine that it is nothing.
    let Some(ten) = ten else { return Some(0) };
    Some((2 * (scaled % ten)).signum() * i128::from(2 * (scaled % ten).abs() >= ten) + scaled / ten)
}

/// The first of several like mistakes, and how many more there are.
pub(super) fn first_of(mistakes: Vec<String>) -> Option<String> {
    let more = mistakes.len().saturating_sub(1);
    let first = mistakes.into_iter().next()?;
    Some(match more {
        0 => first,
        1 => format!("{first} (and another row like it)"),
        more => format!("{first} (and {more} more rows like it)"),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_time_keeps_every_digit_down_to_a_nanosecond() {
        for (text, unit, ns) in [
            ("1700000000.123456789", NANOS, 1_700_000_000_123_456_789),
            ("1700000000123456", 1000, 1_700_000_000_123_456_000),
            ("-0.5", NANOS, -500_000_000),
            ("+2", NANOS, 2_000_000_000),
            ("1.5e-3", NANOS, 1_500_000),
            ("1e3", 1, 1000),
            ("0.00000000051", NANOS, 1),
            ("0.00000000049", NANOS, 0),
            ("1.25", 60 * NANOS, 75 * NANOS),
            ("1e-300", 1, 0),
        ] {
            assert_eq!(nanoseconds(text, unit.into()), Some(ns.into()), "{text}");
        }
        for text in ["", ".", "-", "nan", "inf", "1.2.3", "1e", "0x10", "1.-5", "1e300", "12:30:00"] {
            assert_eq!(nanoseconds(text, NANOS.into()), None, "{text}");
        }
    }
}
