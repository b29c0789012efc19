//! Comma-separated values: a header, then numbers in the shortest form that reads back to the same bits.

use super::error::DatasetError;
use super::folder::{Folder, Sink};
use super::format::{Format, Writer, Written, plain};
use super::table::{Column, Table};
use crate::scene::Plan;
use crate::time::SimTime;
use std::io::Write;

pub(super) static FORMAT: Format = Format { name: "csv", about: "one text file a table", open };

fn open(_: &Plan, tables: &[Table], folder: &Folder) -> Result<Box<dyn Writer>, DatasetError> {
    let mut files = Vec::with_capacity(tables.len());
    for table in tables {
        let name = format!("{}.csv", table.name);
        let mut sink = folder.file(&name)?;
        let header: Vec<_> = table.columns.iter().map(|column| column.name.as_str()).collect();
        sink.put(format!("{}\n", header.join(",")).as_bytes())?;
        files.push((name, sink, table.columns.clone()));
    }
    Ok(Box::new(Csv {
        files,
        line: Vec::with_capacity(512),
        digits: Digits::new(),
        time: Vec::with_capacity(20),
        at: None,
    }))
}

struct Csv {
    files: Vec<(String, Sink, Vec<Column>)>,
    line: Vec<u8>,
    digits: Digits,
    /// The time last written, which every table of a moment shares.
    time: Vec<u8>,
    at: Option<SimTime>,
}

impl Writer for Csv {
    fn row(&mut self, table: usize, t: SimTime, values: &[f64]) -> Result<(), DatasetError> {
        if self.at != Some(t) {
            self.at = Some(t);
            self.time.clear();
            // Writing to a vector cannot fail.
            let _ = write!(self.time, "{}", t.0);
        }
        self.line.clear();
        self.line.extend_from_slice(&self.time);
        for value in values {
            self.line.push(b',');
            self.line.extend_from_slice(shortest(*value, &mut self.digits).as_bytes());
        }
        self.line.push(b'\n');
        self.files[table].1.put(&self.line)
    }

    fn finish(self: Box<Self>, rows: &[u64]) -> Result<Vec<Written>, DatasetError> {
        let files = self.files.into_iter().zip(rows);
        files
            .map(|((name, sink, columns), &rows)| sink.close().map(|()| Written { name, rows, columns }))
            .collect()
    }
}

/// Room for the digits of a number.
pub(super) type Digits = zmij::Buffer;

/// The shortest decimal of these bits; a whole number has no point, and −0 is 0.
pub(super) fn shortest(value: f64, digits: &mut Digits) -> &str {
    let text = digits.format(plain(value));
    text.strip_suffix(".0").unwrap_or(text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
            #[test]
            fn any_number_reads_back_to_the_same_bits(value in any::<f64>().prop_filter("-0 is 0", |x| *x != 0.0)) {
                let mut digits = Digits::new();
                let text = shortest(value, &mut digits);
                prop_assert_eq!(text.parse::<f64>().unwrap().to_bits(), value.to_bits());
    let digits = |text: &str| text.split('e').next().unwrap_or_default().replace(['-', '.'], "").trim_matches('0').len();
                prop_assert_eq!(digits(text), digits(&format!("{value:e}")), "{}", text);
            }
        }

    #[test]
    fn whole_numbers_have_no_point_and_no_zero_has_a_sign() {
        let mut digits = Digits::new();
        for (value, text) in
            [(0.0, "0"), (-0.0, "0"), (-3.0, "-3"), (0.1, "0.1"), (1e-9, "1e-9"), (2.5e20, "2.5e+20")]
        {
            assert_eq!(shortest(value, &mut digits), text);
        }
    }
}
