//! NumPy's own file, one a table: a structured array, so that `t_ns` stays a whole number beside the doubles and a
//! column is asked for by its name, as of a table that `genfromtxt` has read.
//!
//! Format: NumPy Enhancement Proposal 1, version 1.0; little-endian, packed, no pickle.

use super::error::DatasetError;
use super::folder::{Folder, Sink};
use super::format::{Format, Writer, Written, plain, with_seconds};
use super::table::{Column, Table};
use crate::scene::Plan;
use crate::time::SimTime;

pub(super) static FORMAT: Format = Format {
    name: "npy",
    about: "one NumPy structured array per table: `np.load(\"gyro.npy\")[\"x_rad_s\"]`",
    open,
};

const MAGIC: &[u8] = b"\x93NUMPY\x01\x00";
/// The array begins at a multiple of this.
const ALIGN: usize = 64;

fn open(_: &Plan, tables: &[Table], folder: &Folder) -> Result<Box<dyn Writer>, DatasetError> {
    let mut files = Vec::with_capacity(tables.len());
    for table in tables {
        let (name, columns) = (format!("{}.npy", table.name), with_seconds(table));
        let mut sink = folder.file(&name)?;
        // Room for the number of rows, which is known at the end.
        sink.put(&header(&columns, u64::MAX))?;
        files.push(File { name, columns, sink });
    }
    Ok(Box::new(Npy { files, row: Vec::with_capacity(256) }))
}

struct Npy {
    files: Vec<File>,
    row: Vec<u8>,
}

struct File {
    name: String,
    columns: Vec<Column>,
    sink: Sink,
}

impl Writer for Npy {
    fn row(&mut self, table: usize, t: SimTime, values: &[f64]) -> Result<(), DatasetError> {
        self.row.clear();
        self.row.extend_from_slice(&t.0.to_le_bytes());
        self.row.extend_from_slice(&t.seconds().to_le_bytes());
        for value in values {
            self.row.extend_from_slice(&plain(*value).to_le_bytes());
        }
        self.files[table].sink.put(&self.row)
    }

    fn finish(self: Box<Self>, rows: &[u64]) -> Result<Vec<Written>, DatasetError> {
        let close = |(mut file, &rows): (File, &u64)| {
            file.sink.put_at_start(&header(&file.columns, rows))?;
            file.sink.close()?;
            Ok(Written { name: file.name, rows, columns: file.columns })
        };
        self.files.into_iter().zip(rows).map(close).collect()
    }
}

/// Magic, version, length and a Python dictionary, filled up with spaces: of the same length for any number of rows.
fn header(columns: &[Column], rows: u64) -> Vec<u8> {
    let field = |column: &Column| {
        let kind = if column.name == "t_ns" { "<i8" } else { "<f8" };
        format!("('{}', '{kind}')", column.name)
    };
    let fields = columns.iter().map(field).collect::<Vec<_>>().join(", ");
    let rows = format!("({rows},),");
    let mut text = format!("{{'descr': [{fields}], 'fortran_order': False, 'shape': {rows:<24} }}");
    let bare = MAGIC.len() + 2 + text.len() + 1;
    text.extend(std::iter::repeat_n(' ', bare.next_multiple_of(ALIGN) - bare));
    text.push('\n');
    let length = u16::try_from(text.len()).expect("a table has a few dozen columns");
    [MAGIC, &length.to_le_bytes(), text.as_bytes()].concat()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_header_is_as_long_for_any_number_of_rows_and_ends_at_a_multiple_of_64() {
        for count in 1..40 {
            let column = |i| Column { name: format!("true_{i}_rad_s"), unit: "rad/s" };
            let columns: Vec<_> = (0..count).map(column).collect();
            let full = header(&columns, u64::MAX);
            assert_eq!(full.len() % ALIGN, 0);
            assert_eq!(header(&columns, 0).len(), full.len());
            assert_eq!(usize::from(u16::from_le_bytes([full[8], full[9]])) + 10, full.len());
        }
    }
}
