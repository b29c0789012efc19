//! What a folder of ours holds, as its manifest lists it.

use super::error::DatasetError;
use serde::Serialize;
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::ffi::OsString;
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

/// What lists the files that are ours.
pub(super) const MANIFEST: &str = "manifest.json";

/// What a folder holds, as its manifest says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Holds {
    /// A scene played: of `generate` and `run`.
    Dataset,
    /// Estimates judged.
    Score,
    /// What was studied; a later study adds to it.
    Study,
    /// A stream that was listened to.
    Listen,
    /// The timing of a stream.
    Timing,
    /// Manual pages.
    Manual,
}

impl Holds {
    /// As the manifest spells it.
    pub const fn name(self) -> &'static str {
        ["dataset", "score", "study", "listen", "timing", "manual"][self as usize]
    }
}

#[derive(Serialize)]
pub(super) struct OtherEntry<'a> {
    pub name: &'a str,
    pub sha256: String,
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

/// Whether a folder of ours holds a stream that was listened to: its attitudes are body to north-east-down.
pub fn is_recording(folder: &Path) -> bool {
    holds(folder).as_deref() == Some(Holds::Listen.name())
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
    serde_json::from_str(&fs::read_to_string(folder.join(MANIFEST)).ok()?).ok()
}

/// The names in a folder.
pub(super) fn entries(folder: &Path) -> Result<Vec<OsString>, DatasetError> {
    let list = || fs::read_dir(folder)?.map(|entry| Ok(entry?.file_name())).collect::<Result<_, _>>();
    list().map_err(DatasetError::io("list", folder))
}
