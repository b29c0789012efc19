//! The comparison as files, written while estimates are judged: errors row by row, charts from a few of them.

use super::charts::{self, Drawn};
use super::page;
use super::sources::Truth;
use crate::cli::show::PAGE;
use crate::dataset::{DatasetError, Folder, Holds, Sink};
use crate::report::ScoreReport;
use crate::score::{self, Judged};
use std::fmt::Write;
use std::path::Path;

/// The files of the folder.
pub(super) const FILES: [&str; 5] = ["report.json", "errors.csv", "attitude.svg", "error.svg", PAGE];

/// The folder being written.
pub(super) struct Book {
    folder: Folder,
    errors: Sink,
    drawn: Vec<Drawn>,
}

impl Book {
    /// Begins a folder.
    pub fn open(dir: &Path, force: bool) -> Result<Book, DatasetError> {
        let folder = Folder::open(dir, force, Holds::Score)?;
        let mut errors = folder.file(FILES[1])?;
        errors.put(b"estimate,t_ns,error_deg,inclination_deg,heading_deg\n")?;
        Ok(Book { folder, errors, drawn: Vec::new() })
    }

    /// Adds every error of an estimate.
    pub fn add(&mut self, name: &str, judged: &Judged, truth: score::Truth<'_>) -> Result<(), DatasetError> {
        let mut drawn = Drawn::new(name, judged.figures.samples);
        let (mut line, mut failed) = (String::new(), None);
        judged.rows(truth, |row| {
            drawn.add(&row);
            let [error, inclination, heading] =
                [row.error.total, row.error.inclination, row.error.heading].map(f64::to_degrees);
            line.clear();
            // Writing to a string cannot fail.
            let _ = writeln!(line, "{name},{},{error},{inclination},{heading}", row.t.0);
            if failed.is_none() {
                failed = self.errors.put(line.as_bytes()).err();
            }
        });
        self.drawn.push(drawn);
        failed.map_or(Ok(()), Err)
    }

    /// Adds report and charts and shows the folder.
    pub fn close(mut self, report: &ScoreReport, truth: &Truth, json: &str) -> Result<(), DatasetError> {
        self.errors.close()?;
        self.drawn.sort_by(|a, b| b.restless().total_cmp(&a.restless()));
        let [json_name, _, attitude, error, page] = FILES;
        self.folder.put(json_name, json.as_bytes())?;
        self.folder.put(attitude, charts::attitude(report, &self.drawn, truth).as_bytes())?;
        self.folder.put(error, charts::error(report, &self.drawn).as_bytes())?;
        self.folder.put(page, page::of(report, &self.drawn, truth).as_bytes())?;
        self.folder.commit_with_manifest()
    }
}
