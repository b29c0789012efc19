//! Many runs of one scene: a folder each, `run-000000` and so on, and a table of them all, `runs.csv`.
//!
//! A run depends on the scene and its index alone, so a share of the runs can be made anywhere: the folders of all
//! shares together are those of the whole, byte for byte. A folder appears when its run is complete, and one that is
//! there already and came of the same scene is kept: making the same runs again makes what an interruption left out.

use super::error::DatasetError;
use super::format::Format;
use super::listed::{self, entries};
use super::run::Run;
use super::{Draw, Options, folder, reference, write};
use crate::parallel;
use crate::scene::{Plan, Runs};
use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::sync::atomic::{AtomicBool, Ordering};

/// The table of runs.
const TABLE: &str = "runs.csv";

/// Which of the runs are made: those whose index has this remainder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    index: u64,
    of: u64,
}

impl Shard {
    /// All of them.
    pub const WHOLE: Shard = Shard { index: 0, of: 1 };

    /// How many of the first `runs` are its.
    pub fn count(self, runs: u64) -> u64 {
        runs.saturating_sub(self.index).div_ceil(self.of)
    }

    /// Its runs among the first `runs`.
    pub fn indices(self, runs: u64) -> impl Iterator<Item = u64> {
        (self.index..runs).step_by(usize::try_from(self.of).unwrap_or(usize::MAX))
    }
}

impl FromStr for Shard {
    type Err = String;

    /// `I/N`: the runs whose index leaves the remainder I when divided by N; `N/N` is `0/N`, so that shards may be
    /// counted from 0 or from 1.
    fn from_str(text: &str) -> Result<Shard, String> {
        let whole = |text: &str| text.parse::<u64>().ok();
        let parts = text.split_once('/').and_then(|(index, of)| Some((whole(index)?, whole(of)?)));
        match parts {
            Some((index, of)) if of > 0 && index <= of => Ok(Shard { index: index % of, of }),
            _ => Err(format!(
                "`{text}` is not a share: write I/N with I from 0 to N-1, or from 1 to N, such as 3/8"
            )),
        }
    }
}

/// How runs are made.
pub struct RunOptions<'a> {
    /// How many there are in all.
    pub runs: u64,
    /// Which of them.
    pub shard: Shard,
    /// Replace runs that are there already.
    pub force: bool,
    /// In which formats.
    pub formats: Vec<&'static Format>,
    /// Makes files of a run's figures, if requested.
    pub draw: Option<Draw<'a>>,
    /// How many at a time.
    pub threads: usize,
    /// Told how many of how many are done.
    pub progress: parallel::Progress<'a>,
    /// Once true, the runs that are not complete are given up, and nothing of them is left.
    pub stop: &'a AtomicBool,
}

/// The outcome of the requested runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Made {
    /// Made now.
    pub written: u64,
    /// There already.
    pub kept: u64,
}

/// Makes a share of the runs of a scene in `dir`, then the table of all runs that stand there.
///
/// # Errors
/// `dir` holds something else, or a run of another scene, and `force` is off; or as of [`write()`]. Runs that were
/// complete before stay.
pub fn write_runs(scene: &Runs, dir: &Path, options: &RunOptions<'_>) -> Result<Made, DatasetError> {
    prepare(dir, options)?;
    let indices: Vec<u64> = options.shard.indices(options.runs).collect();
    let failed = AtomicBool::new(false);
    let one = |job: usize| {
        let made = match failed.load(Ordering::Relaxed) || options.stop.load(Ordering::Relaxed) {
            true => Err(DatasetError::Stopped),
            false => write_run(scene, indices[job], dir, options),
        };
        failed.fetch_or(made.is_err(), Ordering::Relaxed);
        made
    };
    let results = parallel::map(options.threads, indices.len(), options.progress, one);
    tabulate(scene, dir, options)?;
    let mut made = Made { written: 0, kept: 0 };
    let mut stopped = None;
    for result in results {
        match result {
            Ok(true) => made.written += 1,
            Ok(false) => made.kept += 1,
            // What stopped the others says more than that they were stopped.
            Err(error @ DatasetError::Stopped) => stopped = stopped.or(Some(error)),
            Err(error) => return Err(error),
        }
    }
    stopped.map_or(Ok(made), |_| {
        Err(DatasetError::RunsStopped { complete: made.written + made.kept, of: indices.len() as u64 })
    })
}

fn folder_of(dir: &Path, index: u64) -> PathBuf {
    dir.join(format!("run-{index:06}"))
}

/// The index of a folder of a run.
fn index_of(name: &OsStr) -> Option<u64> {
    name.to_str()?.strip_prefix("run-")?.parse().ok()
}

/// Makes the folder if there is none, and refuses one that holds something else than runs.
fn prepare(dir: &Path, options: &RunOptions<'_>) -> Result<(), DatasetError> {
    if fs::metadata(dir).is_ok_and(|found| !found.is_dir()) {
        return Err(DatasetError::NotAFolder { path: dir.into() });
    }
    fs::create_dir_all(dir).map_err(DatasetError::io("create", dir))?;
    if !is_table_ours(dir) {
        return Err(DatasetError::NotOurs { path: dir.into(), names: vec![TABLE.into()] });
    }
    for name in entries(dir)? {
        let text = name.to_string_lossy();
        let ours = index_of(&name).is_some() || text == TABLE || text.starts_with('.');
        if !ours && !options.force {
            return Err(DatasetError::Exists { path: dir.into() });
        }
        // What a run of this share left when its process was killed.
        let hidden = text.strip_prefix('.').and_then(|text| text.split_once(folder::INCOMPLETE));
        let left = hidden.and_then(|(run, _)| index_of(OsStr::new(run)));
        if left.is_some_and(|index| index % options.shard.of == options.shard.index) {
            if folder::is_being_filled(&dir.join(&name)) {
                return Err(DatasetError::Busy { path: dir.into() });
            }
            fs::remove_dir_all(dir.join(&name)).map_err(DatasetError::io("remove", &dir.join(&name)))?;
        }
    }
    Ok(())
}

/// Whether the table of runs may be replaced: there is none, or it begins as ours do.
fn is_table_ours(dir: &Path) -> bool {
    let begins = |text: String| text.starts_with("run,seed");
    fs::read_to_string(dir.join(TABLE)).map_or_else(|error| error.kind() == ErrorKind::NotFound, begins)
}

/// Whether the run had to be made.
fn write_run(scene: &Runs, index: u64, dir: &Path, options: &RunOptions<'_>) -> Result<bool, DatasetError> {
    let folder = folder_of(dir, index);
    let plan = scene.plan(index).map_err(|error| DatasetError::Content {
        place: format!("run {index}"),
        problem: error.to_string(),
    })?;
    let run = Run { index, swept: scene.settings(index).1 };
    if !options.force && folder.exists() {
        return match is_same(&plan, &run, &folder, options)? {
            true => Ok(false),
            false => Err(DatasetError::OtherRun { path: folder }),
        };
    }
    let mut progress = |_| {};
    let dataset = Options {
        force: options.force,
        formats: options.formats.clone(),
        draw: options.draw,
        stop: Some(options.stop),
        run: Some(&run),
        ..Options::new(&mut progress)
    };
    write(&plan, plan.duration, &folder, dataset).map(|_| true)
}

/// Whether the dataset that is there is complete and what this run would give.
fn is_same(plan: &Plan, run: &Run, folder: &Path, options: &RunOptions<'_>) -> Result<bool, DatasetError> {
    let Some(manifest) = listed::read_json(folder) else { return Ok(false) };
    let settled = reference::settled(plan, plan.duration)?;
    let scene = plan.resolved_until(plan.duration, settled.as_ref().map(|settled| &settled.reference));
    let has = |format: &&'static Format| {
        manifest["files"]
            .as_array()
            .is_some_and(|files| files.iter().any(|file| file["format"] == format.name))
    };
    Ok(manifest["version"] == env!("CARGO_PKG_VERSION")
        && manifest["run"] == serde_json::json!(run)
        && options.formats.iter().all(has)
        && fs::read_to_string(folder.join("scene.toml")).is_ok_and(|text| text == scene))
}

/// Writes the table of the runs that stand in `dir`; once more if one came in meanwhile, for shares may be made at the
/// same time and whichever ends last leaves the table of all.
fn tabulate(scene: &Runs, dir: &Path, options: &RunOptions<'_>) -> Result<(), DatasetError> {
    let failed = DatasetError::io("write", dir);
    let mut rows = BTreeMap::new();
    loop {
        let indices = complete(dir)?;
        let mut table = csv::Writer::from_writer(Vec::new());
        let keys: Vec<_> = scene.keys().collect();
        let header = ["run", "seed"].into_iter().chain(keys.iter().copied());
        let header = header.chain(["samples", "clipped", "reference_rms_deg"]);
        table.write_record(header).map_err(|error| failed(error.into()))?;
        for &index in &indices {
            let read = || row(index, &listed::read_json(&folder_of(dir, index)).unwrap_or_default(), &keys);
            table
                .write_record(rows.entry(index).or_insert_with(read))
                .map_err(|error| failed(error.into()))?;
        }
        let bytes = table.into_inner().map_err(|error| failed(error.into_error()))?;
        let Shard { index, of } = options.shard;
        let hidden = dir.join(format!(".{TABLE}.{index}-of-{of}-{}", std::process::id()));
        fs::write(&hidden, bytes).and_then(|()| fs::rename(&hidden, dir.join(TABLE))).map_err(&failed)?;
        if complete(dir)? == indices {
            return Ok(());
        }
    }
}

/// The indices of the runs that are there, in order.
fn complete(dir: &Path) -> Result<Vec<u64>, DatasetError> {
    let mut indices: Vec<_> = entries(dir)?.iter().filter_map(|name| index_of(name)).collect();
    indices.sort_unstable();
    Ok(indices)
}

fn row(index: u64, manifest: &serde_json::Value, keys: &[&str]) -> Vec<String> {
    let sum = |field: &str| {
        let sensors = manifest["sensors"].as_array().into_iter().flatten();
        sensors.filter_map(|sensor| sensor[field].as_u64()).sum::<u64>().to_string()
    };
    let swept = |key: &&str| {
        let mut all = manifest["run"]["swept"].as_array().into_iter().flatten();
        let found = all.find(|swept| swept["key"] == **key);
        found.and_then(|swept| swept["value"].as_str()).unwrap_or_default().to_string()
    };
    let error = manifest["reference"]["error_deg"]["rms"].as_f64().map_or(String::new(), |x| x.to_string());
    let first = [index.to_string(), manifest["seed"].to_string()];
    first.into_iter().chain(keys.iter().map(swept)).chain([sum("samples"), sum("clipped"), error]).collect()
}

#[cfg(test)]
#[path = "runs_tests.rs"]
mod tests;
