//! TUM trajectories, for evo and its kind: `t x y z qx qy qz qw` a line, in seconds, the position always 0.
//!
//! One file for each table that holds attitudes; the sensors' tables have no place in it. Format: J. Sturm et al.,
//! "A benchmark for the evaluation of RGB-D SLAM systems", IROS 2012, and the file formats page of its dataset.

use super::csv::{Digits, shortest};
use super::error::DatasetError;
use super::folder::{Folder, Sink};
use super::format::{Format, Writer, Written};
use super::table::{Column, Table};
use crate::scene::Plan;
use crate::time::SimTime;

pub(super) static FORMAT: Format = Format {
    name: "tum",
    about: "only attitudes, as TUM trajectories with position 0, for evo: `evo_ape tum truth.tum estimate.tum --pose_relation angle_deg`",
    open,
};

/// The columns that a table with an attitude begins with, behind `t_ns`.
const ATTITUDE: [&str; 4] = ["qw", "qx", "qy", "qz"];

fn open(_: &Plan, tables: &[Table], folder: &Folder) -> Result<Box<dyn Writer>, DatasetError> {
    let has_attitude =
        |table: &Table| table.columns.iter().skip(1).map(|column| &column.name[..]).take(4).eq(ATTITUDE);
    let open = |table: &Table| {
        let name = format!("{}.tum", table.name);
        folder.file(&name).map(|sink| (name, sink))
    };
    let files = tables.iter().map(|table| has_attitude(table).then(|| open(table)).transpose());
    let files = files.collect::<Result<_, _>>()?;
    Ok(Box::new(Tum { files, line: Vec::with_capacity(128), digits: Digits::new() }))
}

struct Tum {
    /// Of each table, if it has a file.
    files: Vec<Option<(String, Sink)>>,
    line: Vec<u8>,
    digits: Digits,
}

impl Writer for Tum {
    fn row(&mut self, table: usize, t: SimTime, values: &[f64]) -> Result<(), DatasetError> {
        let Some((_, sink)) = &mut self.files[table] else { return Ok(()) };
        let &[w, x, y, z, ..] = values else { return Ok(()) };
        self.line.clear();
        for (i, value) in [t.seconds(), 0.0, 0.0, 0.0, x, y, z, w].into_iter().enumerate() {
            if i > 0 {
                self.line.push(b' ');
            }
            self.line.extend_from_slice(shortest(value, &mut self.digits));
        }
        self.line.push(b'\n');
        sink.put(&self.line)
    }

    fn finish(self: Box<Self>, rows: &[u64]) -> Result<Vec<Written>, DatasetError> {
        let files = self.files.into_iter().zip(rows).filter_map(|(file, rows)| Some((file?, *rows)));
        files
            .map(|((name, sink), rows)| sink.close().map(|()| Written { name, rows, columns: columns() }))
            .collect()
    }
}

fn columns() -> Vec<Column> {
    let units = [("t_s", "s"), ("x_m", "m"), ("y_m", "m"), ("z_m", "m")];
    let units = units.into_iter().chain(["qx", "qy", "qz", "qw"].map(|name| (name, "1")));
    units.map(|(name, unit)| Column { name: name.into(), unit }).collect()
}
