//! Reading a dataset back: columns by name, in the program's own axes, every mistake with file, line and column.

mod mat;
#[cfg(feature = "mcap")]
mod mcap;
mod npy;
mod other;
#[cfg(feature = "parquet")]
mod parquet;
mod tum;

use super::error::DatasetError;
use super::manifest;
use crate::geometry::{Attitude, Axes, Body, Vector};
use crate::sensor::SensorKind;
use crate::time::SimTime;
use glam::{DQuat, DVec3};
use std::fs::File;
use std::path::{Path, PathBuf};

/// The attitudes of a dataset.
#[derive(Clone, Debug, PartialEq)]
pub struct Recorded {
    /// The axes it is written in.
    pub axes: Axes,
    /// Time and attitude (body to nav, North-East-Down and Forward-Right-Down), in order of time.
    pub attitudes: Vec<(SimTime, Attitude)>,
}

/// Reads the attitudes of a dataset's folder in whatever format it has them, or of its `truth.csv` named itself; the
/// axes are those that the `manifest.json` beside it names.
///
/// # Errors
/// No such file, no manifest, or a column, number or order of times that cannot be.
pub fn truth(path: &Path) -> Result<Recorded, DatasetError> {
    let file = if path.is_dir() { path.join("truth.csv") } else { path.to_path_buf() };
    if path.is_dir()
        && !file.exists()
        && let Some(recorded) = other::truth(path)?
    {
        return Ok(recorded);
    }
    let mut columns = Columns::open(&file, ["qw", "qx", "qy", "qz"])?;
    let axes = axes(&file)?;
    let mut attitudes = Vec::new();
    while let Some((t, [w, x, y, z])) = columns.next()? {
        let q = DQuat::from_xyzw(x, y, z, w);
        if (q.length() - 1.0).abs() > 1e-3 {
            let problem = format!("[{w}, {x}, {y}, {z}] has length {}, but a rotation's is 1", q.length());
            return Err(columns.wrong("qw..qz", problem));
        }
        attitudes.push((t, axes.attitude_in(q)));
    }
    Ok(Recorded { axes, attitudes })
}

/// Whether a dataset's folder has a sensor's readings, in any format, or should have.
pub fn has(folder: &Path, kind: SensorKind) -> bool {
    folder.join(format!("{kind}.csv")).exists() || other::lists(folder, kind)
}

/// Reads one sensor's readings of a dataset's folder, in whatever format it has them: time and value in body axes (Forward-Right-Down), in the
/// sensor's unit.
///
/// # Errors
/// As of [`truth`].
pub fn readings(folder: &Path, kind: SensorKind) -> Result<Vec<(SimTime, Vector<Body>)>, DatasetError> {
    let file = folder.join(format!("{kind}.csv"));
    if !file.exists()
        && let Some(readings) = other::readings(folder, kind)?
    {
        return Ok(readings);
    }
    let names = ["x", "y", "z"].map(|axis| format!("{axis}_{}", kind.column_unit()));
    let mut columns = Columns::open(&file, names.each_ref().map(String::as_str))?;
    let axes = axes(&file)?;
    let mut readings = Vec::new();
    while let Some((t, value)) = columns.next()? {
        readings.push((t, axes.body_in(DVec3::from_array(value))));
    }
    Ok(readings)
}

/// The axes that the manifest beside a file names.
fn axes(file: &Path) -> Result<Axes, DatasetError> {
    let folder = match file.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    let manifest = folder.join("manifest.json");
    std::fs::metadata(&manifest).map_err(DatasetError::io("tell the axes of the dataset from", &manifest))?;
    let json = manifest::read_json(folder).unwrap_or_default();
    json.get("axes").and_then(|axes| Axes::from_name(axes.as_str()?)).ok_or_else(|| DatasetError::Content {
        place: manifest.display().to_string(),
        problem: format!("names no axes: `axes` should be {}", Axes::NAMES.join(" or ")),
    })
}

/// `t_ns` and `N` columns of doubles of a CSV file, found by name, row by row.
struct Columns<const N: usize> {
    file: PathBuf,
    names: [String; N],
    reader: csv::Reader<File>,
    record: csv::StringRecord,
    time: usize,
    indices: [usize; N],
    last: Option<SimTime>,
}

impl<const N: usize> Columns<N> {
    fn open(file: &Path, names: [&str; N]) -> Result<Columns<N>, DatasetError> {
        let opened = File::open(file).map_err(DatasetError::io("read", file))?;
        let mut reader =
            csv::ReaderBuilder::new().trim(csv::Trim::All).buffer_capacity(1 << 18).from_reader(opened);
        let header = reader.headers().map_err(|error| unreadable(file, &error))?.clone();
        let find = |name: &str| {
            header.iter().position(|column| column == name).ok_or_else(|| DatasetError::Content {
                place: format!("{}:1", file.display()),
                problem: format!(
                    "has no column `{name}`; its columns are {}",
                    Vec::from_iter(&header).join(", ")
                ),
            })
        };
        let time = find("t_ns")?;
        let mut indices = [0; N];
        for (index, name) in indices.iter_mut().zip(names) {
            *index = find(name)?;
        }
        let (file, names) = (file.to_path_buf(), names.map(String::from));
        Ok(Columns { file, names, reader, record: csv::StringRecord::new(), time, indices, last: None })
    }

    fn next(&mut self) -> Result<Option<(SimTime, [f64; N])>, DatasetError> {
        if !self.reader.read_record(&mut self.record).map_err(|error| unreadable(&self.file, &error))? {
            return Ok(None);
        }
        let text = &self.record[self.time];
        let t = text
            .parse()
            .map(SimTime)
            .map_err(|_| self.wrong("t_ns", format!("`{text}` is no whole number of nanoseconds")))?;
        if let Some(last) = self.last.filter(|&last| t <= last) {
            return Err(
                self.wrong("t_ns", format!("{} is not after {}, the time of the row before", t.0, last.0))
            );
        }
        self.last = Some(t);
        let mut values = [0.0; N];
        for ((value, &index), name) in values.iter_mut().zip(&self.indices).zip(&self.names) {
            let text = &self.record[index];
            let number = text.parse::<f64>().ok().filter(|number| number.is_finite());
            *value = number.ok_or_else(|| self.wrong(name, format!("`{text}` is no number")))?;
        }
        Ok(Some((t, values)))
    }

    /// A mistake in the row just read.
    fn wrong(&self, column: &str, problem: String) -> DatasetError {
        let line = self.record.position().map_or(0, csv::Position::line);
        DatasetError::Content { place: format!("{}:{line}, column {column}", self.file.display()), problem }
    }
}

fn unreadable(file: &Path, error: &csv::Error) -> DatasetError {
    let line = error.position().map_or(String::new(), |position| format!(":{}", position.line()));
    let problem = match error.kind() {
        csv::ErrorKind::UnequalLengths { expected_len, len, .. } => {
            format!("the row has {len} columns, the header {expected_len}")
        }
        csv::ErrorKind::Utf8 { .. } => "the row is no text".to_string(),
        _ => error.to_string(),
    };
    DatasetError::Content { place: format!("{}{line}", file.display()), problem }
}
