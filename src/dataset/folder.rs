//! The output folder: filled out of sight, shown when it is complete.
//!
//! A new folder is made beside its name and renamed, which is atomic. Where the folder exists already (empty, or
//! a dataset to be replaced) the files are made in a folder inside it, so that a mount point or a folder that
//! others look into serves as well, and moved one by one at the end, `manifest.json` last: a folder with a
//! manifest is whole. Files that belong to no dataset are left alone.

use super::error::DatasetError;
use super::manifest;
use std::ffi::OsString;
use std::fs::{self, File};
use std::io::{self, BufWriter, ErrorKind, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// Bytes a file gathers before they go to the system.
const BUFFER: usize = 1 << 18;
/// Marks a folder that is still being filled, or was when its process was killed.
pub(super) const INCOMPLETE: &str = ".incomplete-";

/// A dataset's folder while it is being written; dropped before it is complete, it leaves nothing behind.
pub struct Folder {
    target: PathBuf,
    workshop: PathBuf,
    /// Whether the target was there before.
    inside: bool,
}

impl Folder {
    /// Begins the folder `target`.
    ///
    /// # Errors
    /// It holds something and `force` is off, it is no folder, or the system refuses.
    pub fn open(target: &Path, force: bool) -> Result<Folder, DatasetError> {
        let inside = may_write(target, force)?;
        let workshop = workshop(target, inside);
        fs::create_dir_all(&workshop).map_err(DatasetError::io("create", target))?;
        Ok(Folder { target: target.into(), workshop, inside })
    }

    /// A new file of this folder.
    ///
    /// # Errors
    /// The system's reason and the path.
    pub fn file(&self, name: &str) -> Result<Sink, DatasetError> {
        let path = self.target.join(name);
        let file = File::create(self.workshop.join(name)).map_err(DatasetError::io("create", &path))?;
        Ok(Sink { out: BufWriter::with_capacity(BUFFER, file), path })
    }

    /// A file without a name, for what has to be put in another order: gone with its last handle.
    pub(super) fn scratch(&self, name: &str, buffer: usize) -> Result<Sink, DatasetError> {
        let path = self.workshop.join(name);
        let create = || {
            let file = File::options().read(true).write(true).create_new(true).open(&path)?;
            fs::remove_file(&path).map(|()| file)
        };
        let file = create().map_err(DatasetError::io("create", &path))?;
        Ok(Sink { out: BufWriter::with_capacity(buffer, file), path })
    }

    /// A new file with these contents.
    ///
    /// # Errors
    /// The system's reason and the path.
    pub fn put(&self, name: &str, contents: &[u8]) -> Result<(), DatasetError> {
        let mut sink = self.file(name)?;
        sink.put(contents)?;
        sink.close()
    }

    /// Where a file of the folder is until it is complete.
    pub(super) fn path(&self, name: &str) -> PathBuf {
        self.workshop.join(name)
    }

    /// Shows the folder under its name.
    ///
    /// # Errors
    /// The system's reason and the path.
    pub fn commit(self) -> Result<(), DatasetError> {
        let at_target = DatasetError::io("write", &self.target);
        if !self.inside {
            return fs::rename(&self.workshop, &self.target).map_err(at_target);
        }
        let before = manifest::files_of(&self.target);
        for name in ["manifest.json"].into_iter().chain(before.iter().map(String::as_str)) {
            // What is already gone needs no removing; what stays is replaced or reported below.
            let _ = fs::remove_file(self.target.join(name));
        }
        let mut names = entries(&self.workshop)?;
        names.sort_by_key(|name| name == "manifest.json");
        for name in names {
            let path = self.target.join(&name);
            fs::rename(self.workshop.join(&name), &path).map_err(DatasetError::io("write", &path))?;
        }
        Ok(())
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        // Gone after a commit; after an error there is nothing better to do with it.
        let _ = fs::remove_dir_all(&self.workshop);
    }
}

/// A file being written, whose errors name it.
pub struct Sink {
    out: BufWriter<File>,
    path: PathBuf,
}

impl Sink {
    /// Adds bytes.
    ///
    /// # Errors
    /// The system's reason, such as a full disk, and the path.
    #[inline]
    pub fn put(&mut self, bytes: &[u8]) -> Result<(), DatasetError> {
        self.out.write_all(bytes).map_err(|source| self.failed(source))
    }

    /// Puts these bytes in place of as many at the beginning, and goes on at the end.
    pub(super) fn put_at_start(&mut self, bytes: &[u8]) -> Result<(), DatasetError> {
        let mut put = || {
            self.out.seek(SeekFrom::Start(0))?;
            self.out.write_all(bytes)?;
            self.out.seek(SeekFrom::End(0))
        };
        put().map(drop).map_err(|source| self.failed(source))
    }

    /// The file, to be read from its beginning, and what messages call it.
    pub(super) fn reopen(mut self) -> Result<(File, PathBuf), DatasetError> {
        self.out.rewind().map_err(|source| self.failed(source))?;
        let Sink { out, path } = self;
        let file = out.into_inner().map_err(|error| DatasetError::io("write", &path)(error.into_error()))?;
        Ok((file, path))
    }

    /// Hands everything to the system.
    ///
    /// # Errors
    /// The system's reason and the path.
    pub fn close(mut self) -> Result<(), DatasetError> {
        self.out.flush().map_err(|source| self.failed(source))
    }

    #[cold]
    fn failed(&self, source: io::Error) -> DatasetError {
        DatasetError::io("write", &self.path)(source)
    }
}

// For the crates that write to a stream of their own accord.
impl Write for Sink {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.out.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

impl Seek for Sink {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.out.seek(to)
    }
}

/// Whether the folder is there already, unless it is one that may not be written.
pub(super) fn may_write(target: &Path, force: bool) -> Result<bool, DatasetError> {
    match fs::metadata(target) {
        Ok(found) if !found.is_dir() => Err(DatasetError::NotAFolder { path: target.into() }),
        Ok(_) if !force && !is_empty(target)? => Err(DatasetError::Exists { path: target.into() }),
        Ok(_) => Ok(true),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(false),
        Err(error) => Err(DatasetError::io("look at", target)(error)),
    }
}

/// `.NAME.incomplete-PID` beside a new folder, `.incomplete-PID` inside one that is there.
fn workshop(target: &Path, inside: bool) -> PathBuf {
    let mark = format!("{INCOMPLETE}{}", std::process::id());
    match target.file_name() {
        Some(name) if !inside => {
            let mut hidden = OsString::from(".");
            hidden.push(name);
            hidden.push(mark);
            target.with_file_name(hidden)
        }
        _ => target.join(mark),
    }
}

/// Whether a folder holds nothing but what killed runs may have left.
fn is_empty(folder: &Path) -> Result<bool, DatasetError> {
    let names = entries(folder)?;
    Ok(names.iter().all(|name| name.as_encoded_bytes().starts_with(INCOMPLETE.as_bytes())))
}

pub(super) fn entries(folder: &Path) -> Result<Vec<OsString>, DatasetError> {
    let list = || fs::read_dir(folder)?.map(|entry| Ok(entry?.file_name())).collect::<Result<_, _>>();
    list().map_err(DatasetError::io("list", folder))
}
