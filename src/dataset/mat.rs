//! MATLAB's level 4 file, one a table: a column vector for each column of the table, under its name.
//!
//! Level 4 is a header of five numbers and a name before each matrix, and everything reads it: MATLAB, Octave, scipy.
//! It knows doubles alone, so `t_ns` is exact up to 2⁵³ ns, 104 days. Format: MathWorks, "MAT-File Format", chapter
//! "Level 4 MAT-File Format".

use super::error::DatasetError;
use super::folder::{Folder, Sink};
use super::format::{Format, Writer, Written, plain, with_seconds};
use super::table::{Column, Table};
use crate::scene::Plan;
use crate::time::SimTime;
use std::io::{self, Read};
use std::path::Path;

pub(super) static FORMAT: Format = Format {
    name: "mat",
    about: "one MATLAB level 4 file per table, one vector per column: `load('gyro.mat').x_rad_s`",
    open,
};

/// The most elements that MATLAB reads of a level 4 matrix.
const MOST_ROWS: u64 = 100_000_000;
/// The largest whole number up to which every one is a double.
const LARGEST_NS: i64 = 1 << 53;
/// Little-endian IEEE doubles, a full numeric matrix: the type MOPT = 0000.
const FULL_DOUBLES: u32 = 0;
/// Bytes that a column gathers before they go to the system.
const BUFFER: usize = 1 << 16;

fn open(_: &Plan, tables: &[Table], folder: &Folder) -> Result<Box<dyn Writer>, DatasetError> {
    let tables = tables.iter().map(|table| File::open(table, folder)).collect::<Result<_, _>>()?;
    Ok(Box::new(Mat { tables }))
}

struct Mat {
    tables: Vec<File>,
}

/// A level 4 matrix lies column by column, but rows come: each column gathers in a scratch file of its own.
struct File {
    name: String,
    columns: Vec<Column>,
    scratch: Vec<Sink>,
    sink: Sink,
}

impl File {
    fn open(table: &Table, folder: &Folder) -> Result<File, DatasetError> {
        let (name, columns) = (format!("{}.mat", table.name), with_seconds(table));
        let scratch = |column: &Column| folder.scratch(&format!("{name}.{}", column.name), BUFFER);
        let scratch = columns.iter().map(scratch).collect::<Result<_, _>>()?;
        let sink = folder.file(&name)?;
        Ok(File { name, columns, scratch, sink })
    }

    fn finish(mut self, rows: u64) -> Result<Written, DatasetError> {
        if rows > MOST_ROWS {
            return Err(self.refuse(format!("{rows} rows exceed the {MOST_ROWS} that MATLAB reads at level 4: use parquet or npy, or a shorter scene")));
        }
        for (column, scratch) in self.columns.iter().zip(self.scratch) {
            self.sink.put(&header(&column.name, rows))?;
            let (mut file, path) = scratch.reopen()?;
            copy(&mut file, &path, &mut self.sink)?;
        }
        self.sink.close()?;
        Ok(Written { name: self.name, rows, columns: self.columns })
    }

    fn refuse(&self, problem: String) -> DatasetError {
        DatasetError::Content { place: self.name.clone(), problem }
    }
}

impl Writer for Mat {
    fn row(&mut self, table: usize, t: SimTime, values: &[f64]) -> Result<(), DatasetError> {
        let file = &mut self.tables[table];
        if t.0 > LARGEST_NS {
            return Err(file.refuse(format!(
                "t_ns = {} is beyond 2^53, and level 4 has only doubles: use parquet or npy",
                t.0
            )));
        }
        let values = [t.0 as f64, t.seconds()].into_iter().chain(values.iter().copied());
        file.scratch
            .iter_mut()
            .zip(values)
            .try_for_each(|(sink, value)| sink.put(&plain(value).to_le_bytes()))
    }

    fn finish(self: Box<Self>, rows: &[u64]) -> Result<Vec<Written>, DatasetError> {
        self.tables.into_iter().zip(rows).map(|(file, rows)| file.finish(*rows)).collect()
    }
}

/// Type, rows, columns, whether there is an imaginary part, length of the name; then the name, closed by a zero.
fn header(name: &str, rows: u64) -> Vec<u8> {
    let numbers = [FULL_DOUBLES, rows as u32, 1, 0, name.len() as u32 + 1];
    let mut header: Vec<u8> = numbers.into_iter().flat_map(u32::to_le_bytes).collect();
    header.extend_from_slice(name.as_bytes());
    header.push(0);
    header
}

fn copy(from: &mut std::fs::File, path: &Path, to: &mut Sink) -> Result<(), DatasetError> {
    let mut chunk = vec![0; 1 << 18];
    loop {
        match from.read(&mut chunk) {
            Ok(0) => return Ok(()),
            Ok(length) => to.put(&chunk[..length])?,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => return Err(DatasetError::io("read back", path)(error)),
        }
    }
}
