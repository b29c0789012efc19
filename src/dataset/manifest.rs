//! `manifest.json`: what a program needs to know of a dataset without reading its numbers.

use super::error::DatasetError;
use super::folder::{Folder, Holds, MANIFEST, entries};
use super::format::Written;
use super::readme;
use super::reference::Quality;
use super::runs::Run;
use super::table::Column;
use crate::scene::{Drawn, Plan};
use crate::sensor::{Sampling, SensorPlan};
use crate::time::SimTime;
use serde::Serialize;
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};

/// A file of numbers.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FileEntry {
    /// Its name in the folder.
    pub name: String,
    /// The name of its format.
    pub format: &'static str,
    /// Rows, the header not counted; messages, where it has those.
    pub rows: u64,
    /// Its columns in order; none where the format has something else.
    pub columns: Vec<Column>,
    /// SHA-256 of its bytes, in hexadecimal.
    pub sha256: String,
}

impl FileEntry {
    pub(super) fn of(
        folder: &Folder,
        written: Written,
        format: &'static str,
    ) -> Result<FileEntry, DatasetError> {
        let Written { name, rows, columns } = written;
        let sha256 = checksum(&folder.path(&name))?;
        Ok(FileEntry { name, format, rows, columns, sha256 })
    }
}

#[derive(Serialize)]
struct Manifest<'a> {
    program: &'static str,
    version: &'static str,
    holds: &'static str,
    scene: &'a str,
    seed: u64,
    axes: String,
    duration_ns: i64,
    complete: bool,
    conventions: BTreeMap<&'static str, String>,
    sensors: Vec<SensorEntry>,
    parts: BTreeMap<&'static str, &'static str>,
    drawn: &'a [Drawn],
    faults: Vec<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    run: Option<&'a Run>,
    #[serde(skip_serializing_if = "Option::is_none")]
    reference: Option<&'a Quality>,
    files: &'a [FileEntry],
    other_files: Vec<OtherEntry<'a>>,
}

#[derive(Serialize)]
struct SensorEntry {
    name: &'static str,
    unit: &'static str,
    rate: String,
    rate_hz: f64,
    phase_ns: i64,
    sampling: &'static str,
    mount: Option<String>,
    terms: Vec<&'static str>,
    samples: u64,
    clipped: u64,
}

#[derive(Serialize)]
struct OtherEntry<'a> {
    name: &'a str,
    sha256: String,
}

/// What was made of a scene.
pub(super) struct Made<'a> {
    pub files: &'a [FileEntry],
    /// The names of the files without numbers.
    pub others: &'a [&'a str],
    /// Clipped samples of each sensor.
    pub clipped: &'a [u64],
    pub quality: Option<&'a Quality>,
    pub run: Option<&'a Run>,
    pub link_faults: &'a [String],
}

/// The manifest of a dataset whose other files are written.
pub(super) fn text(
    plan: &Plan,
    end: SimTime,
    made: &Made<'_>,
    folder: &Folder,
) -> Result<String, DatasetError> {
    let &Made { files, others, clipped, quality, run, link_faults } = made;
    let other = |&name| Ok(OtherEntry { name, sha256: checksum(&folder.path(name))? });
    let part = |sensor: &SensorPlan| sensor.part.map(|part| (sensor.kind.name(), part));
    let manifest = Manifest {
        program: env!("CARGO_PKG_NAME"),
        version: env!("CARGO_PKG_VERSION"),
        holds: Holds::Dataset.name(),
        scene: &plan.name,
        seed: plan.seed,
        axes: plan.axes.to_string(),
        duration_ns: end.0,
        complete: true,
        conventions: readme::conventions(plan),
        sensors: sensors(plan, files, clipped),
        parts: plan.sensors.iter().filter_map(part).collect(),
        drawn: &plan.drawn,
        faults: [plan.faults_until(end), link_faults.to_vec()].concat(),
        run,
        reference: quality,
        files,
        other_files: others.iter().map(other).collect::<Result<_, DatasetError>>()?,
    };
    let text = serde_json::to_string_pretty(&manifest).map_err(io::Error::other);
    Ok(text.map_err(DatasetError::io("write", Path::new("manifest.json")))? + "\n")
}

/// Whether a file holds a sensor's samples.
fn is_of(sensor: &SensorPlan, file: &FileEntry) -> bool {
    file.name.split('.').next() == Some(sensor.kind.name())
}

fn sensors(plan: &Plan, files: &[FileEntry], clipped: &[u64]) -> Vec<SensorEntry> {
    let entry = |(sensor, &clipped): (&SensorPlan, &u64)| SensorEntry {
        name: sensor.kind.name(),
        unit: sensor.kind.unit(),
        rate: sensor.rate.to_string(),
        rate_hz: sensor.rate.as_hz(),
        phase_ns: sensor.phase.0,
        sampling: sampling_name(sensor.sampling),
        mount: sensor.mount.map(|mount| mount.to_string()),
        terms: plan.build(sensor).terms().to_vec(),
        samples: files.iter().find(|file| is_of(sensor, file)).map_or(0, |file| file.rows),
        clipped,
    };
    plan.sensors.iter().zip(clipped).map(entry).collect()
}

/// As a scene spells it.
pub(super) fn sampling_name(sampling: Sampling) -> &'static str {
    match sampling {
        Sampling::Point => "point",
        Sampling::Average => "average",
    }
}

/// SHA-256 of a file as it stands on the disk.
pub(super) fn checksum(path: &Path) -> Result<String, DatasetError> {
    let digest = || {
        let mut hasher = Sha256::new();
        let mut file = io::BufReader::with_capacity(1 << 18, File::open(path)?);
        loop {
            let chunk = io::BufRead::fill_buf(&mut file)?;
            if chunk.is_empty() {
                return Ok(hasher.finalize());
            }
            hasher.update(chunk);
            let read = chunk.len();
            io::BufRead::consume(&mut file, read);
        }
    };
    let digest = digest().map_err(DatasetError::io("read back", path))?;
    Ok(digest.iter().map(|byte| format!("{byte:02x}")).collect())
}

#[derive(Serialize)]
struct Plain<'a> {
    program: &'static str,
    version: &'static str,
    holds: &'static str,
    other_files: Vec<OtherEntry<'a>>,
}

/// The manifest of a folder without a scene: of the files in `workshop`, and of those that the manifest in `target`
/// lists and that stay there.
pub(super) fn of_files(workshop: &Path, target: &Path, holds: Holds) -> Result<String, DatasetError> {
    let mut files: BTreeMap<String, PathBuf> = BTreeMap::new();
    let there = files_of(target).into_iter().map(|name| (name.clone(), target.join(name)));
    files.extend(there.filter(|(_, path)| path.is_file()));
    for name in entries(workshop)? {
        files.insert(name.to_string_lossy().into_owned(), workshop.join(name));
    }
    let entry = |(name, path): (&'_ String, &PathBuf)| Ok((name.clone(), checksum(path)?));
    let sums: Vec<_> = files.iter().map(entry).collect::<Result<_, DatasetError>>()?;
    let other_files = sums.iter().map(|(name, sha256)| OtherEntry { name, sha256: sha256.clone() }).collect();
    let manifest = Plain {
        program: env!("CARGO_PKG_NAME"),
        version: env!("CARGO_PKG_VERSION"),
        holds: holds.name(),
        other_files,
    };
    let text = serde_json::to_string_pretty(&manifest).map_err(io::Error::other);
    Ok(text.map_err(DatasetError::io("write", Path::new(MANIFEST)))? + "\n")
}

/// What the manifest of a folder of ours says it holds; nothing without a manifest of ours.
pub(super) fn holds(folder: &Path) -> Option<String> {
    let json = read_json(folder).filter(is_ours)?;
    // Manifests of version 0.1.0 may lack it, and are all of datasets.
    Some(json.get("holds").and_then(|name| name.as_str()).unwrap_or(Holds::Dataset.name()).to_string())
}

fn is_ours(json: &serde_json::Value) -> bool {
    json.get("program").and_then(|name| name.as_str()) == Some(env!("CARGO_PKG_NAME"))
}

/// The files that the manifest of a folder of ours lists: plain names in its own folder; none without one.
pub(super) fn files_of(folder: &Path) -> Vec<String> {
    let json = read_json(folder).filter(is_ours).unwrap_or_default();
    let listed = ["files", "other_files"].into_iter().filter_map(|key| json.get(key)?.as_array());
    let names = listed.flatten().filter_map(|file| file.get("name")?.as_str());
    names.filter(|name| Path::new(name).file_name() == Some(name.as_ref())).map(String::from).collect()
}

/// The manifest in a folder, if there is one and it is JSON.
pub(super) fn read_json(folder: &Path) -> Option<serde_json::Value> {
    serde_json::from_str(&std::fs::read_to_string(folder.join(MANIFEST)).ok()?).ok()
}
