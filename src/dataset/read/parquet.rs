//! Apache Parquet back: the columns asked for, row group by row group.

use super::super::DatasetError;
use super::rows::{Rows, What, places, refuse};
use ::parquet::column::reader::ColumnReader;
use ::parquet::errors::ParquetError;
use ::parquet::file::reader::{FileReader, RowGroupReader, SerializedFileReader};
use std::fs::File;
use std::path::Path;

pub(super) fn read(file: &Path, _: What, names: &[&str]) -> Result<Rows, DatasetError> {
    let opened = File::open(file).map_err(DatasetError::io("read", file))?;
    let failed = |error: ParquetError| refuse(file, format!("cannot be read: {error}"));
    let reader = SerializedFileReader::new(opened).map_err(failed)?;
    let schema = reader.metadata().file_metadata().schema_descr();
    let has: Vec<String> = schema.columns().iter().map(|column| column.name().to_string()).collect();
    let (time, indices) = (places(file, &has, &["t_ns"])?, places(file, &has, names)?);
    let mut read = Rows { times: Vec::new(), columns: vec![Vec::new(); names.len()] };
    for group in 0..reader.num_row_groups() {
        let group = reader.get_row_group(group).map_err(failed)?;
        let ColumnReader::Int64ColumnReader(mut times) = group.get_column_reader(time[0]).map_err(failed)?
        else {
            return Err(refuse(file, "its column t_ns is not of 64-bit whole numbers"));
        };
        times.read_records(rows(&*group), None, None, &mut read.times).map_err(failed)?;
        for ((at, column), name) in indices.iter().zip(&mut read.columns).zip(names) {
            let ColumnReader::DoubleColumnReader(mut values) =
                group.get_column_reader(*at).map_err(failed)?
            else {
                return Err(refuse(file, format!("its column {name} is not of doubles")));
            };
            values.read_records(rows(&*group), None, None, column).map_err(failed)?;
        }
    }
    Ok(read)
}

fn rows(group: &dyn RowGroupReader) -> usize {
    usize::try_from(group.metadata().num_rows()).unwrap_or(0)
}
