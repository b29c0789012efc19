//! MATLAB's level 4 file back: a column vector of doubles for each column.

use super::super::DatasetError;
use super::rows::{Rows, What, open, places, refuse};
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;

/// Type, rows, columns, imaginary part, length of the name.
const HEADER: u64 = 20;

pub(super) fn read(file: &Path, _: What, names: &[&str]) -> Result<Rows, DatasetError> {
    let (mut input, len) = open(file)?;
    let failed = |error| DatasetError::io("read", file)(error);
    let (mut has, mut columns): (Vec<String>, Vec<Vec<f64>>) = (Vec::new(), Vec::new());
    let mut at = 0;
    while at < len {
        let mut header = [0; HEADER as usize];
        input.read_exact(&mut header).map_err(failed)?;
        let number = |i: usize| u32::from_le_bytes(std::array::from_fn(|byte| header[4 * i + byte]));
        let [kind, rows, width, imaginary, name_len] = [0, 1, 2, 3, 4].map(number);
        if (kind, width, imaginary) != (0, 1, 0) || name_len > 256 {
            return Err(refuse(file, "is not a level 4 file of column vectors, as datasets have"));
        }
        let mut name = vec![0; name_len as usize];
        input.read_exact(&mut name).map_err(failed)?;
        let bytes = 8 * u64::from(rows);
        at += HEADER + u64::from(name_len) + bytes;
        let name = String::from_utf8_lossy(&name).trim_end_matches('\0').to_string();
        if at > len {
            return Err(refuse(file, format!("ends inside column {name}")));
        }
        let mut column = Vec::new();
        if name == "t_ns" || names.contains(&name.as_str()) {
            let mut raw = vec![0; bytes as usize];
            input.read_exact(&mut raw).map_err(failed)?;
            let cells = raw.chunks_exact(8);
            column.extend(cells.map(|cell| f64::from_le_bytes(std::array::from_fn(|i| cell[i]))));
        } else {
            input.seek(SeekFrom::Current(bytes as i64)).map_err(failed)?;
        }
        has.push(name);
        columns.push(column);
    }
    let (time, indices) = (places(file, &has, &["t_ns"])?, places(file, &has, names)?);
    let times = columns[time[0]].iter().map(|t| *t as i64).collect();
    Ok(Rows { times, columns: indices.into_iter().map(|at| std::mem::take(&mut columns[at])).collect() })
}
