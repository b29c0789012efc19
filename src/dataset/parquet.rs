//! Apache Parquet, one file a table, for pandas, polars, DuckDB and every cluster engine: columns compressed by zstd.
//!
//! Bytes of equal weight stand together (BYTE_STREAM_SPLIT) before they are compressed: noise fills a double's last
//! bytes and leaves the first ones to be packed. Format: Apache Parquet, version 2.

use super::error::DatasetError;
use super::folder::{Folder, Sink};
use super::format::{Format, Writer, Written, plain, with_seconds};
use super::table::{Column, Table};
use crate::scene::Plan;
use crate::time::SimTime;
use ::parquet::basic::{Compression, Encoding, Repetition, Type as Kind, ZstdLevel};
use ::parquet::data_type::{DoubleType, Int64Type};
use ::parquet::errors::ParquetError;
use ::parquet::file::properties::WriterProperties;
use ::parquet::file::writer::SerializedFileWriter;
use ::parquet::schema::types::{ColumnPath, Type};
use std::sync::Arc;

pub(super) static FORMAT: Format = Format {
    name: "parquet",
    about: "one compressed Apache Parquet file per table: `pandas.read_parquet(\"gyro.parquet\")`",
    open,
};

/// Rows that are gathered before they are compressed.
const GROUP: usize = 1 << 16;

fn open(_: &Plan, tables: &[Table], folder: &Folder) -> Result<Box<dyn Writer>, DatasetError> {
    let files = tables.iter().map(|table| File::open(table, folder)).collect::<Result<_, _>>()?;
    Ok(Box::new(Parquet { files }))
}

struct Parquet {
    files: Vec<File>,
}

struct File {
    name: String,
    columns: Vec<Column>,
    writer: SerializedFileWriter<Sink>,
    /// `t_ns` of the rows since the last group, and each column behind it.
    times: Vec<i64>,
    values: Vec<Vec<f64>>,
}

impl Writer for Parquet {
    fn row(&mut self, table: usize, t: SimTime, values: &[f64]) -> Result<(), DatasetError> {
        let file = &mut self.files[table];
        file.times.push(t.0);
        for (column, value) in file.values.iter_mut().zip([t.seconds()].iter().chain(values)) {
            column.push(plain(*value));
        }
        if file.times.len() == GROUP { file.group() } else { Ok(()) }
    }

    fn finish(self: Box<Self>, rows: &[u64]) -> Result<Vec<Written>, DatasetError> {
        let finish = |(mut file, &rows): (File, &u64)| {
            if !file.times.is_empty() {
                file.group()?;
            }
            let sink = file.writer.into_inner().map_err(|error| failed(&file.name, error))?;
            sink.close()?;
            Ok(Written { name: file.name, rows, columns: file.columns })
        };
        self.files.into_iter().zip(rows).map(finish).collect()
    }
}

impl File {
    fn open(table: &Table, folder: &Folder) -> Result<File, DatasetError> {
        let (name, columns) = (format!("{}.parquet", table.name), with_seconds(table));
        let sink = folder.file(&name)?;
        let writer = schema(table.name, &columns)
            .and_then(|schema| SerializedFileWriter::new(sink, Arc::new(schema), Arc::new(properties()?)))
            .map_err(|error| failed(&name, error))?;
        let values = vec![Vec::new(); columns.len() - 1];
        Ok(File { name, columns, writer, times: Vec::new(), values })
    }

    /// Writes the rows gathered so far.
    fn group(&mut self) -> Result<(), DatasetError> {
        let mut write = || {
            let mut group = self.writer.next_row_group()?;
            // The first column is `t_ns`.
            if let Some(mut column) = group.next_column()? {
                column.typed::<Int64Type>().write_batch(&self.times, None, None)?;
                column.close()?;
            }
            for values in &mut self.values {
                let Some(mut column) = group.next_column()? else { break };
                column.typed::<DoubleType>().write_batch(values, None, None)?;
                column.close()?;
                values.clear();
            }
            group.close()
        };
        write().map_err(|error| failed(&self.name, error))?;
        self.times.clear();
        Ok(())
    }
}

/// `t_ns` whole numbers, the others doubles, none ever missing.
fn schema(name: &str, columns: &[Column]) -> Result<Type, ParquetError> {
    let field = |column: &Column| {
        let kind = if column.name == "t_ns" { Kind::INT64 } else { Kind::DOUBLE };
        let field = Type::primitive_type_builder(&column.name, kind).with_repetition(Repetition::REQUIRED);
        field.build().map(Arc::new)
    };
    let fields = columns.iter().map(field).collect::<Result<_, _>>()?;
    Type::group_type_builder(name).with_fields(fields).build()
}

fn properties() -> Result<WriterProperties, ParquetError> {
    let by = concat!(env!("CARGO_PKG_NAME"), " ", env!("CARGO_PKG_VERSION"));
    Ok(WriterProperties::builder()
        .set_created_by(by.into())
        .set_compression(Compression::ZSTD(ZstdLevel::try_new(1)?))
        .set_dictionary_enabled(false)
        .set_encoding(Encoding::BYTE_STREAM_SPLIT)
        .set_column_encoding(ColumnPath::from("t_ns"), Encoding::DELTA_BINARY_PACKED)
        .build())
}

fn failed(name: &str, error: ParquetError) -> DatasetError {
    DatasetError::Content { place: name.into(), problem: format!("cannot be written: {error}") }
}
