//! A scene played into a folder: readings, exact truth, and all that is needed to read them without asking.
//!
//! ```text
//! README.md       axes, conventions, how to load it
//! scene.toml      the scene as resolved: playing it gives the same bytes
//! manifest.json   version, seed, columns with units, counts, checksums
//! truth.csv       at every distinct tick of any sensor
//! gyro.csv accel.csv mag.csv baro.csv gps.csv     one for each sensor that the scene has
//! reference.csv   attitude as a method computes it, where the scene asks for it
//! estimate.csv    what the other side answered, where it did
//! imu.yaml        white noise and bias walk as Kalibr takes them, of a scene with gyro and accelerometer
//! motion-0.csv    a log that a motion replays, as it was
//! ```
//!
//! Everything is in the scene's axes. The folder appears under its name only when it is complete. A format is a
//! [`Format`]: to add one, write one file beside this one and one line in [`FORMATS`]. Of many runs of one scene each
//! has such a folder: [`write_runs`].

mod bounds;
mod conventions;
mod csv;
mod error;
mod figures;
mod folder;
mod format;
mod formats;
mod kalibr;
mod listed;
mod manifest;
mod mat;
#[cfg(feature = "mcap")]
mod mcap;
mod npy;
#[cfg(feature = "parquet")]
mod parquet;
pub mod read;
mod readme;
mod reference;
mod resd;
mod run;
mod runs;
mod table;
mod tum;

pub use bounds::Bounds;
pub use error::DatasetError;
pub use figures::{Figure, Figures, Series};
pub use folder::{Folder, Sink};
pub use format::{Format, Open, Writer, Written};
pub use formats::{FEATURES, FORMATS};
pub use listed::{Holds, is_recording};
pub use manifest::FileEntry;
pub use reference::{Errors, Quality};
pub use run::Run;
pub use runs::{Made, RunOptions, Shard, write_runs};
pub use table::{Column, Table};

use crate::geometry::{Attitude, Axes};
use crate::player::{self, Player};
use crate::scene::{Attached, Plan};
use crate::sensor::Reading;
use crate::time::SimTime;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

/// Makes files of figures: a plain name and the contents of each.
pub type Draw<'a> = &'a (dyn Fn(&Plan, &[Figure]) -> Vec<(String, Vec<u8>)> + Sync);

/// How a dataset is written.
pub struct Options<'a> {
    /// Replace the dataset that is already there.
    pub force: bool,
    /// In which formats, each holding the same tables.
    pub formats: Vec<&'static Format>,
    /// Attitudes that the other side answered, in order of time; none = no `estimate.csv`.
    pub estimates: &'a [(SimTime, Attitude)],
    /// The faults of outputs that acted in the run that this is of, for the manifest.
    pub link_faults: &'a [String],
    /// Further files that the caller made, such as figures: a plain name and the contents.
    pub extra: &'a [(String, Vec<u8>)],
    /// Makes further files of the figures of what is played; none = no figures are gathered.
    pub draw: Option<Draw<'a>>,
    /// Called now and then with the scene time that has been written.
    pub progress: &'a mut dyn FnMut(SimTime),
    /// Once true, writing stops with [`DatasetError::Stopped`] and leaves nothing behind.
    pub stop: Option<&'a AtomicBool>,
    /// Which of the scene's runs it is, where there are several; the manifest says so.
    pub run: Option<&'a Run>,
}

impl<'a> Options<'a> {
    /// CSV, nothing replaced, no estimates, no further files.
    pub fn new(progress: &'a mut dyn FnMut(SimTime)) -> Options<'a> {
        Options {
            force: false,
            formats: vec![FORMATS[0]],
            estimates: &[],
            link_faults: &[],
            extra: &[],
            draw: None,
            progress,
            stop: None,
            run: None,
        }
    }
}

/// What was written.
#[derive(Clone, Debug, PartialEq)]
pub struct Summary {
    /// The folder.
    pub folder: PathBuf,
    /// Its files of numbers, with rows, columns and checksums.
    pub files: Vec<FileEntry>,
    /// Rows in all tables together, whatever the number of formats.
    pub rows: u64,
    /// Samples beyond their sensor's range, in the plan's order of sensors.
    pub clipped: Vec<u64>,
}

/// Whether a folder that holds this may be written, asked before work that takes its time: `names` are the files that
/// there may be. Nothing is changed.
///
/// # Errors
/// It holds something and `force` is off; with `force`, a file in the way that no manifest of ours lists, or something
/// of ours of another kind; or it is no folder.
pub fn may_write(dir: &Path, force: bool, holds: Holds, names: &[String]) -> Result<(), DatasetError> {
    folder::may_write(dir, force, holds, names).map(|_| ())
}

/// The files in a folder that would be gone or others' after writing these into it with `force`.
pub fn replaced(dir: &Path, names: &[String]) -> Vec<PathBuf> {
    names.iter().cloned().chain(listed::files_of(dir)).map(|name| dir.join(name)).collect()
}

/// Writes files that belong together, such as a study's, into `dir`, with a manifest: all of them or none.
///
/// # Errors
/// As of [`may_write`], or the system's.
pub fn put_all(dir: &Path, force: bool, holds: Holds, files: &[(&str, Vec<u8>)]) -> Result<(), DatasetError> {
    let folder = Folder::open(dir, force, holds)?;
    files.iter().try_for_each(|(name, contents)| folder.put(name, contents))?;
    folder.commit_with_manifest()
}

/// The files that a dataset of a plan may have in these formats, with an estimate; `figures` and `more` beside them.
pub fn names(plan: &Plan, formats: &[&'static Format], figures: bool, more: &[&str]) -> Vec<String> {
    let tables: Vec<_> = table::of(plan, true).iter().map(|table| table.name).collect();
    let mut names = Vec::new();
    for format in formats {
        names.extend(tables.iter().map(|table| format!("{table}.{}", format.name)));
        names.push(format!("dataset.{}", format.name));
    }
    if figures {
        names.extend(tables.iter().chain(&["angles"]).map(|stem| format!("{stem}.svg")));
    }
    names.extend(["README.md", "scene.toml", listed::MANIFEST, kalibr::NAME].map(String::from));
    names.extend(more.iter().map(|name| name.to_string()));
    names.extend(plan.attached.iter().map(|file| file.name.clone()));
    names
}

/// Plays `plan` from 0 up to, not including, `end` and writes the folder `dir`.
///
/// # Errors
/// The folder holds something and `force` is off, a path cannot be written, the disk is full, or it was stopped.
/// Then `dir` is as it was before.
pub fn write(plan: &Plan, end: SimTime, dir: &Path, options: Options<'_>) -> Result<Summary, DatasetError> {
    write_in_blocks(plan, end, dir, options, player::BLOCK)
}

/// The same with the player's block size given, which changes no byte.
fn write_in_blocks(
    plan: &Plan,
    end: SimTime,
    dir: &Path,
    options: Options<'_>,
    block: usize,
) -> Result<Summary, DatasetError> {
    if end == SimTime::FOREVER {
        return Err(DatasetError::Endless);
    }
    let names = names(plan, &options.formats, options.draw.is_some(), &[]);
    may_write(dir, options.force, Holds::Dataset, &names)?;
    let settled = reference::settled(plan, end)?;
    let folder = Folder::open(dir, options.force, Holds::Dataset)?;
    let tables = table::of(plan, !options.estimates.is_empty());
    let mut book = Book::open(plan, &tables, &folder, &options.formats)?;
    let mut figures = options.draw.map(|_| Figures::new(plan, end));
    let playing = Playing { plan, end, block, stop: options.stop };
    let clipped = play(&playing, &mut book, figures.as_mut(), options.progress)?;
    let drawn = options.draw.zip(figures).map_or(Vec::new(), |(draw, figures)| draw(plan, &figures.done()));
    let quality = reference::write(plan, settled.as_ref(), end, |step| {
        book.row(table::TRUTH + 1 + plan.sensors.len(), step.t, &table::reference(plan.axes, step.attitude))
    })?;
    for (t, attitude) in options.estimates {
        book.row(tables.len() - 1, *t, &table::quaternion(plan.axes, *attitude))?;
    }
    let rows = book.rows.iter().sum();
    let samples = book.rows[table::TRUTH + 1..][..plan.sensors.len()].to_vec();
    let files = book.close(&folder)?;

    let readme = readme::text(plan, &files, quality.as_ref());
    let scene = plan.resolved_until(end, settled.as_ref().map(|settled| &settled.reference));
    let attached = attached(plan)?;
    let mut others = vec![("README.md", readme.as_bytes()), ("scene.toml", scene.as_bytes())];
    let kalibr = kalibr::text(plan);
    others.extend(kalibr.iter().map(|text| (kalibr::NAME, text.as_bytes())));
    others.extend(attached.iter().map(|(name, contents)| (*name, contents.as_slice())));
    let extra = options.extra.iter().chain(&drawn);
    others.extend(extra.map(|(name, contents)| (name.as_str(), contents.as_slice())));
    for (name, contents) in &others {
        folder.put(name, contents)?;
    }
    let others: Vec<_> = others.into_iter().map(|(name, _)| name).collect();
    let made = manifest::Made {
        files: &files,
        others: &others,
        samples: &samples,
        clipped: &clipped,
        quality: quality.as_ref(),
        run: options.run,
        link_faults: options.link_faults,
    };
    folder.put(listed::MANIFEST, manifest::text(plan, end, &made, &folder)?.as_bytes())?;
    folder.commit()?;

    Ok(Summary { folder: dir.to_path_buf(), files, rows, clipped })
}

/// The files that the scene as resolved names.
fn attached(plan: &Plan) -> Result<Vec<(&str, Vec<u8>)>, DatasetError> {
    let read = |file: &'_ Attached| file.contents().map_err(DatasetError::io("copy", file.path()));
    plan.attached.iter().map(|file| Ok((file.name.as_str(), read(file)?))).collect()
}

/// What is played into a dataset.
struct Playing<'a> {
    plan: &'a Plan,
    end: SimTime,
    block: usize,
    stop: Option<&'a AtomicBool>,
}

/// Every moment into the book and the figures; gives back each sensor's clipped samples.
fn play(
    playing: &Playing<'_>,
    book: &mut Book,
    mut figures: Option<&mut Figures>,
    progress: &mut dyn FnMut(SimTime),
) -> Result<Vec<u64>, DatasetError> {
    let Playing { plan, end, block, stop } = *playing;
    let mut clipped = vec![0; plan.sensors.len()];
    let mut player = Player::new(plan, end, block);
    let mut now = SimTime::ZERO;
    loop {
        let more = player.play_block(|moment| {
            now = moment.t;
            book.row(table::TRUTH, moment.t, &table::truth(plan.axes, moment.truth))?;
            if let Some(figures) = &mut figures {
                figures.add(&moment);
            }
            for reading in moment.readings {
                clipped[reading.sensor] += u64::from(reading.clipped);
                book.reading(table::TRUTH + 1 + reading.sensor, moment.t, plan.axes, reading)?;
            }
            Ok(())
        })?;
        if stop.is_some_and(|stop| stop.load(Ordering::Relaxed)) {
            return Err(DatasetError::Stopped);
        }
        if !more {
            return Ok(clipped);
        }
        progress(now);
    }
}

/// The tables being written, in every format asked for.
struct Book {
    rows: Vec<u64>,
    writers: Vec<(&'static Format, Box<dyn Writer>)>,
}

impl Book {
    fn open(
        plan: &Plan,
        tables: &[Table],
        folder: &Folder,
        formats: &[&'static Format],
    ) -> Result<Book, DatasetError> {
        let writers = formats.iter().map(|format| Ok((*format, (format.open)(plan, tables, folder)?)));
        Ok(Book { rows: vec![0; tables.len()], writers: writers.collect::<Result<_, _>>()? })
    }

    fn row(&mut self, table: usize, t: SimTime, values: &[f64]) -> Result<(), DatasetError> {
        self.rows[table] += 1;
        self.writers.iter_mut().try_for_each(|(_, writer)| writer.row(table, t, values))
    }

    fn reading(
        &mut self,
        table: usize,
        t: SimTime,
        axes: Axes,
        reading: &Reading,
    ) -> Result<(), DatasetError> {
        self.rows[table] += 1;
        let row = table::reading(axes, reading);
        self.writers.iter_mut().try_for_each(|(_, writer)| writer.reading(table, t, reading, row.values()))
    }

    fn close(self, folder: &Folder) -> Result<Vec<FileEntry>, DatasetError> {
        let mut files = Vec::new();
        for (format, writer) in self.writers {
            for written in writer.finish(&self.rows)? {
                files.push(FileEntry::of(folder, written, format.name)?);
            }
        }
        Ok(files)
    }
}

#[cfg(test)]
mod tests;
