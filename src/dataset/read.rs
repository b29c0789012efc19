//! Reading a dataset back: columns by name, in the program's own axes, every mistake with file, line and column.

mod mat;
#[cfg(feature = "mcap")]
mod mcap;
mod npy;
mod other;
#[cfg(feature = "parquet")]
mod parquet;
mod rows;
mod tum;

use super::error::DatasetError;
use super::listed;
use crate::geometry::{Attitude, Axes, Body, Vector};
use crate::sensor::SensorKind;
use crate::table::{Clock, Next, TICKS, Table, TableError, TimeColumn, TimeUnit, Wanted};
use crate::time::SimTime;
use glam::{DQuat, DVec3};
use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};

/// The attitudes of a dataset.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordedTruth {
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
pub fn truth(path: &Path) -> Result<RecordedTruth, DatasetError> {
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
            let problem =
                format!("[{w}, {x}, {y}, {z}] has length {}, but a rotation has length 1", q.length());
            return Err(columns.wrong("qw..qz", problem));
        }
        attitudes.push((t, axes.attitude_in(q)));
    }
    Ok(RecordedTruth { axes, attitudes })
}

/// For how long a run held the vehicle still before the scene, where the folder has its report.
pub fn rest(folder: &Path) -> Option<SimTime> {
    let report = std::fs::read(folder.join("report.json")).ok()?;
    let report: serde_json::Value = serde_json::from_slice(&report).ok()?;
    let seconds = report.get("rest_s")?.as_f64().filter(|rest| (0.0..1e6).contains(rest))?;
    Some(SimTime((seconds * 1e9) as i64))
}

/// Whether a dataset's folder has a sensor's readings, in any format, or should have.
pub fn has(folder: &Path, kind: SensorKind) -> bool {
    folder.join(format!("{kind}.csv")).exists() || other::lists(folder, kind)
}

/// One sensor's readings as they are read; after a mistake nothing more comes.
pub type AsRead = Box<dyn Iterator<Item = Result<(SimTime, Vector<Body>), DatasetError>>>;

/// Reads one sensor's readings of a dataset's folder, in whatever format it has them: time and value in body axes
/// (Forward-Right-Down), in the sensor's unit.
///
/// # Errors
/// As of [`truth`].
pub fn readings(folder: &Path, kind: SensorKind) -> Result<Vec<(SimTime, Vector<Body>)>, DatasetError> {
    as_read(folder, kind)?.collect()
}

/// [`readings`] one by one, so that those of a CSV file are never in memory together.
///
/// # Errors
/// As of [`truth`], of what can be told before the first row.
pub fn as_read(folder: &Path, kind: SensorKind) -> Result<AsRead, DatasetError> {
    let file = folder.join(format!("{kind}.csv"));
    if !file.exists()
        && let Some(readings) = other::readings(folder, kind)?
    {
        return Ok(Box::new(readings.into_iter().map(Ok)));
    }
    let names = ["x", "y", "z"].map(|axis| format!("{axis}_{}", kind.column_unit()));
    let mut columns = Columns::open(&file, names.each_ref().map(String::as_str))?;
    let axes = axes(&file)?;
    let mut over = false;
    Ok(Box::new(std::iter::from_fn(move || {
        if over {
            return None;
        }
        let row = columns.next().map(|row| row.map(|(t, value)| (t, axes.body_in(DVec3::from_array(value)))));
        over = !matches!(row, Ok(Some(_)));
        row.transpose()
    })))
}

/// The axes that the manifest beside a file names.
fn axes(file: &Path) -> Result<Axes, DatasetError> {
    let folder = match file.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    let manifest = folder.join("manifest.json");
    std::fs::metadata(&manifest).map_err(DatasetError::io("find the dataset's axes in", &manifest))?;
    let json = listed::read_json(folder).unwrap_or_default();
    json.get("axes").and_then(|axes| Axes::from_name(axes.as_str()?)).ok_or_else(|| DatasetError::Content {
        place: manifest.display().to_string(),
        problem: format!("names no axes: `axes` should be {}", Axes::NAMES.join(" or ")),
    })
}

/// `t_ns` and `N` columns of doubles of a CSV file, found by name, row by row. A dataset is ours: what a stranger's table
/// is forgiven is a mistake here.
struct Columns<const N: usize> {
    file: PathBuf,
    table: Table<BufReader<File>>,
    wanted: Wanted<N>,
    line: u64,
    last: Option<SimTime>,
}

impl<const N: usize> Columns<N> {
    fn open(file: &Path, names: [&str; N]) -> Result<Columns<N>, DatasetError> {
        let opened = File::open(file).map_err(DatasetError::io("read", file))?;
        let reader = BufReader::with_capacity(1 << 18, opened);
        let table =
            Table::open(&file.display().to_string(), reader).map_err(|error| unreadable(file, error))?;
        let find = |name: &str| {
            table.pick(name).filter(|_| table.has(name)).ok_or_else(|| DatasetError::Content {
                place: table.place(),
                problem: format!("has no column `{name}`; {}", table.told()),
            })
        };
        let time = TimeColumn { column: find("t_ns")?, fine: None, unit: Some(TimeUnit::Ns) };
        let mut columns = [0; N];
        for (column, name) in columns.iter_mut().zip(names) {
            *column = find(name)?;
        }
        let wanted = Wanted::new(Clock::Column { time, assumed: None }, columns);
        Ok(Columns { file: file.to_path_buf(), table, wanted, line: 0, last: None })
    }

    fn next(&mut self) -> Result<Option<(SimTime, [f64; N])>, DatasetError> {
        let row = match self.table.next(&self.wanted).map_err(|error| unreadable(&self.file, error))? {
            Next::End => return Ok(None),
            Next::Row(row) => row,
            Next::Mistake(mistake) => {
                let column = mistake.column.map_or(String::new(), |column| format!(", column {column}"));
                return Err(DatasetError::Content {
                    place: format!("{}:{}{column}", self.file.display(), mistake.line),
                    problem: mistake.what,
                });
            }
        };
        self.line = row.line;
        let whole =
            row.ticks.filter(|ticks| ticks % TICKS == 0).and_then(|ticks| i64::try_from(ticks / TICKS).ok());
        let t = whole.map(SimTime).ok_or_else(|| {
            let text = self.table.cell(self.time());
            self.wrong("t_ns", format!("`{text}` is not a whole number of nanoseconds"))
        })?;
        if let Some(last) = self.last.filter(|&last| t <= last) {
            return Err(
                self.wrong("t_ns", format!("{} is not after {}, the time of the previous row", t.0, last.0))
            );
        }
        self.last = Some(t);
        if let Some(place) = row.values.iter().position(|value| value.is_nan()) {
            let column = self.wanted.columns[place];
            let (name, text) = (self.table.called(column), self.table.cell(column));
            return Err(self.wrong(&name, format!("`{text}` is not a number")));
        }
        Ok(Some((t, row.values)))
    }

    fn time(&self) -> usize {
        match self.wanted.clock {
            Clock::Column { time, .. } => time.column,
            Clock::Rate(_) => 0,
        }
    }

    /// A mistake in the row just read.
    fn wrong(&self, column: &str, problem: String) -> DatasetError {
        DatasetError::Content {
            place: format!("{}:{}, column {column}", self.file.display(), self.line),
            problem,
        }
    }
}

fn unreadable(file: &Path, error: TableError) -> DatasetError {
    match error {
        TableError::Io { source, .. } => DatasetError::io("read", file)(source),
        other => DatasetError::Content { place: file.display().to_string(), problem: other.in_short() },
    }
}
