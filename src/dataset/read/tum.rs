//! TUM trajectories back: attitudes alone, times in seconds.

use super::super::DatasetError;
use super::rows::{Rows, What, open, refuse};
use std::io::BufRead;
use std::path::Path;

pub(super) fn read(file: &Path, _: What, names: &[&str]) -> Result<Rows, DatasetError> {
    let (input, _) = open(file)?;
    let mut read = Rows { times: Vec::new(), columns: vec![Vec::new(); names.len()] };
    for (i, line) in input.lines().enumerate() {
        let line = line.map_err(DatasetError::io("read", file))?;
        if line.starts_with('#') || line.trim().is_empty() {
            continue;
        }
        let numbers: Option<Vec<f64>> = line.split_whitespace().map(|cell| cell.parse().ok()).collect();
        let Some(&[t, _, _, _, x, y, z, w]) = numbers.as_deref() else {
            let problem = "is not a line of a TUM trajectory: `t x y z qx qy qz qw`";
            return Err(refuse(file, format!("line {}: `{line}` {problem}", i + 1)));
        };
        read.times.push((t * 1e9).round() as i64);
        for (column, value) in read.columns.iter_mut().zip([w, x, y, z]) {
            column.push(value);
        }
    }
    Ok(read)
}
