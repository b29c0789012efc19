//! NumPy's own file back: the structured arrays that the dataset writes.

use super::super::DatasetError;
use super::rows::{Rows, What, open, places, refuse};
use std::io::Read;
use std::path::Path;

/// Magic and version 1.0.
const MAGIC: &[u8] = b"\x93NUMPY\x01\x00";

pub(super) fn read(file: &Path, _: What, names: &[&str]) -> Result<Rows, DatasetError> {
    let (mut input, len) = open(file)?;
    let mut start = [0; 10];
    input.read_exact(&mut start).map_err(DatasetError::io("read", file))?;
    if &start[..8] != MAGIC {
        return Err(refuse(file, "is not a NumPy file of version 1.0"));
    }
    let mut text = vec![0; usize::from(u16::from_le_bytes([start[8], start[9]]))];
    input.read_exact(&mut text).map_err(DatasetError::io("read", file))?;
    let header = String::from_utf8_lossy(&text);
    let (columns, rows) = described(&header).ok_or_else(|| {
        refuse(
            file,
            "is not a one-dimensional structured array with columns of `<i8` and `<f8`, as datasets have",
        )
    })?;
    let (time, indices) = (places(file, &columns, &["t_ns"])?, places(file, &columns, names)?);
    let width = 8 * columns.len() as u64;
    let holds = len.saturating_sub(10 + text.len() as u64);
    if rows.checked_mul(width) != Some(holds) {
        return Err(refuse(file, format!("declares {rows} rows of {width} bytes but holds {holds} bytes")));
    }
    let mut row = vec![0; width as usize];
    let mut read = Rows { times: Vec::new(), columns: vec![Vec::new(); names.len()] };
    for _ in 0..rows {
        input.read_exact(&mut row).map_err(DatasetError::io("read", file))?;
        let cell = |at: usize| -> [u8; 8] { std::array::from_fn(|i| row[8 * at + i]) };
        read.times.push(i64::from_le_bytes(cell(time[0])));
        for (column, at) in read.columns.iter_mut().zip(&indices) {
            column.push(f64::from_le_bytes(cell(*at)));
        }
    }
    Ok(read)
}

/// The names of the columns and the number of rows.
fn described(header: &str) -> Option<(Vec<String>, u64)> {
    let (_, descr) = header.split_once("'descr': [")?;
    let (descr, rest) = descr.split_once(']')?;
    let field = |field: &str| {
        let parts: Vec<&str> = field.split('\'').collect();
        let &[_, name, _, kind, ..] = &parts[..] else { return None };
        let expected = if name == "t_ns" { "<i8" } else { "<f8" };
        (kind == expected).then(|| name.to_string())
    };
    let columns = descr.split('(').skip(1).map(field).collect::<Option<Vec<_>>>()?;
    let (_, shape) = rest.split_once("'shape': (")?;
    let (rows, after) = shape.split_once(',')?;
    let one_dimension = after.trim_start().starts_with(')') && rest.contains("'fortran_order': False");
    (one_dimension && !columns.is_empty()).then_some((columns, rows.trim().parse().ok()?))
}
