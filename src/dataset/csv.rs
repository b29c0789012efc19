//! Comma-separated values: a header, then numbers in the shortest form that reads back to the same bits.

use super::error::DatasetError;
use super::folder::{Folder, Sink};
use super::format::{Format, Writer, Written, plain};
use super::table::{Column, Table};
use crate::scene::Plan;
use crate::time::SimTime;
use std::io::Write;

pub(super) static FORMAT: Format = Format { name: "csv", about: "one text file per table", open };

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
            self.line.extend_from_slice(shortest(*value, &mut self.digits));
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

/// Formats numbers, and remembers the latest: a table repeats many of another's (a sensor's truth is that of the
/// moment) and of its own row before (a constant rate, a bias), and finding one is a tenth of formatting it.
pub(super) struct Digits {
    buffer: zmij::Buffer,
    recent: Vec<Recent>,
}

/// A number and its text; none of length 0.
#[derive(Clone, Copy)]
struct Recent {
    bits: u64,
    text: [u8; LONGEST],
    length: u8,
}

/// Bytes of the longest number: `-2.2250738585072014e-308`.
const LONGEST: usize = 24;

/// Numbers remembered: 2⁹, so that the highest 9 bits of a product say which. 20 kB.
const RECENT_BITS: u32 = 9;

impl Digits {
    pub(super) fn new() -> Digits {
        let none = Recent { bits: 0, text: [0; LONGEST], length: 0 };
        Digits { buffer: zmij::Buffer::new(), recent: vec![none; 1 << RECENT_BITS] }
    }
}

/// The shortest decimal of these bits; a whole number has no point, and −0 is 0.
pub(super) fn shortest(value: f64, digits: &mut Digits) -> &[u8] {
    /// 2⁶⁴ over the golden ratio (Knuth, *The Art of Computer Programming* 3, sec. 6.4): neighbours land far apart.
    const SPREAD: u64 = 0x9e37_79b9_7f4a_7c15;
    let value = plain(value);
    let bits = value.to_bits();
    let Digits { buffer, recent } = digits;
    let recent = &mut recent[(bits.wrapping_mul(SPREAD) >> (64 - RECENT_BITS)) as usize];
    if recent.bits != bits || recent.length == 0 {
        let text = buffer.format(value);
        let text = text.strip_suffix(".0").unwrap_or(text).as_bytes();
        recent.text[..text.len()].copy_from_slice(text);
        (recent.bits, recent.length) = (bits, text.len() as u8);
    }
    &recent.text[..usize::from(recent.length)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn text(value: f64, digits: &mut Digits) -> &str {
        std::str::from_utf8(shortest(value, digits)).unwrap()
    }

    proptest! {
        #[test]
        fn any_number_reads_back_to_the_same_bits(value in any::<f64>().prop_filter("-0 is 0", |x| *x != 0.0)) {
            let mut digits = Digits::new();
            let text = text(value, &mut digits);
            prop_assert_eq!(text.parse::<f64>().unwrap().to_bits(), value.to_bits());
            let figures = |text: &str| text.split('e').next().unwrap_or_default().replace(['-', '.'], "").trim_matches('0').len();
            prop_assert_eq!(figures(text), figures(&format!("{value:e}")), "{}", text);
        }

        /// However many were formatted before, of which some are remembered and others pushed out.
        #[test]
        fn a_number_is_the_same_text_again(values in prop::collection::vec((any::<f64>(), 0..3usize), 1..300)) {
            let mut digits = Digits::new();
            for (i, (value, back)) in values.iter().enumerate() {
                for value in [*value, values[i.saturating_sub(*back)].0] {
                    let afresh = text(value, &mut Digits::new()).to_string();
                    prop_assert_eq!(text(value, &mut digits), afresh);
                }
            }
        }
    }

    #[test]
    fn whole_numbers_have_no_point_and_no_zero_has_a_sign() {
        let mut digits = Digits::new();
        for (value, text) in [
            (0.0, "0"),
            (-0.0, "0"),
            (-3.0, "-3"),
            (0.1, "0.1"),
            (1e-9, "1e-9"),
            (2.5e20, "2.5e+20"),
            (0.0, "0"),
            (-2.2250738585072014e-308, "-2.2250738585072014e-308"),
        ] {
            assert_eq!(self::text(value, &mut digits), text);
        }
    }
}
