//! The output folder: filled out of sight, shown when it is complete.
//!
//! A new folder is made beside its name and renamed, which is atomic. Where the folder exists already (empty, or
//! one to be replaced) the files are made in a folder inside it, so that a mount point or a folder that others look
//! into serves as well, and moved one by one at the end, `manifest.json` last: a folder with a manifest is whole.
//!
//! What is ours in a folder is what its manifest lists, and nothing else is replaced: a file in our way that no manifest
//! of ours lists is somebody's, and so is a folder that holds something of another kind. The folder out of sight is
//! locked while it is filled, so that of two processes one is refused.

use super::error::DatasetError;
use super::listed::{self, Holds, MANIFEST, entries};
use rustix::fs::{FlockOperation, flock};
use std::ffi::OsString;
use std::fs::{self, File};
use std::io::{self, BufWriter, ErrorKind, Seek, SeekFrom, Write};
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};

/// Bytes a file gathers before they go to the system.
const BUFFER: usize = 1 << 18;
/// Marks a folder that is still being filled, or was when its process was killed.
pub(super) const INCOMPLETE: &str = ".incomplete";

/// A folder while it is being written; dropped before it is complete, it leaves nothing behind.
pub struct Folder {
    target: PathBuf,
    workshop: PathBuf,
    holds: Holds,
    /// Whether the target was there before.
    inside: bool,
    /// Whether the workshop has been handed over.
    done: bool,
    /// The workshop, locked; none where the file system has no locks.
    _lock: Option<File>,
}

impl Folder {
    /// Begins the folder `target`.
    ///
    /// # Errors
    /// It holds something that may not be replaced, as of `may_write`; it is no folder, another process writes into
    /// it, or the system refuses.
    pub fn open(target: &Path, force: bool, holds: Holds) -> Result<Folder, DatasetError> {
        loop {
            let inside = may_write(target, force, holds, &[])?;
            let (workshop, lock) = claim(&workshop(target, inside), target)?;
            let folder = Folder { target: target.into(), workshop, holds, inside, done: false, _lock: lock };
            // Asked again now that nobody else is at it: who was may have ended meanwhile.
            if may_write(target, force, holds, &[])? == inside {
                return Ok(folder);
            }
        }
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

    /// Writes the manifest of a folder that is no dataset, then shows it; files of ours that were there and have other
    /// names stay and stay listed.
    ///
    /// # Errors
    /// As of [`Folder::commit`].
    pub fn commit_with_manifest(self) -> Result<(), DatasetError> {
        let text = listed::of_files(&self.workshop, &self.target, self.holds)?;
        self.put(MANIFEST, text.as_bytes())?;
        self.commit()
    }

    /// Shows the folder under its name.
    ///
    /// # Errors
    /// A file in the way is not ours, or the system's reason and the path.
    pub fn commit(mut self) -> Result<(), DatasetError> {
        if !self.inside {
            return match fs::rename(&self.workshop, &self.target) {
                Err(error)
                    if [ErrorKind::DirectoryNotEmpty, ErrorKind::AlreadyExists].contains(&error.kind()) =>
                {
                    Err(DatasetError::Appeared { path: self.target.clone() })
                }
                Err(error) => Err(DatasetError::io("write", &self.target)(error)),
                Ok(()) => {
                    self.done = true;
                    Ok(())
                }
            };
        }
        let mut names = entries(&self.workshop)?;
        let plain: Vec<_> = names.iter().map(|name| name.to_string_lossy().into_owned()).collect();
        may_write(&self.target, true, self.holds, &plain)?;
        // What a dataset had before would be taken for this one's.
        let before = match self.holds {
            Holds::Dataset => listed::files_of(&self.target),
            _ => Vec::new(),
        };
        for name in [MANIFEST].into_iter().chain(before.iter().map(String::as_str)) {
            // What is already gone needs no removing; what stays is replaced or reported below.
            let _ = fs::remove_file(self.target.join(name));
        }
        names.sort_by_key(|name| name == MANIFEST);
        for name in names {
            let path = self.target.join(&name);
            fs::rename(self.workshop.join(&name), &path).map_err(DatasetError::io("write", &path))?;
        }
        Ok(())
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        if !self.done {
            // After an error there is nothing better to do with it.
            let _ = fs::remove_dir_all(&self.workshop);
        }
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

/// Whether the folder is there already, unless it is one that may not be written: with `force`, one whose files called
/// `names` are listed by its manifest, if they are there, and which holds what is to be written.
pub(super) fn may_write(
    target: &Path,
    force: bool,
    holds: Holds,
    names: &[String],
) -> Result<bool, DatasetError> {
    match fs::metadata(target) {
        Ok(found) if !found.is_dir() => return Err(DatasetError::NotAFolder { path: target.into() }),
        Ok(_) => {}
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(false),
        Err(error) => return Err(DatasetError::io("look at", target)(error)),
    }
    if is_empty(target)? {
        return Ok(true);
    }
    if !force {
        return Err(DatasetError::Exists { path: target.into() });
    }
    let (there, listed) = (listed::holds(target), listed::files_of(target));
    if let Some(there) = there.as_deref().filter(|there| *there != holds.name()) {
        let (path, there) = (target.into(), there.to_string());
        return Err(DatasetError::OfAnotherKind { path, there, wanted: holds.name() });
    }
    let is_ours =
        |name: &str| if name == MANIFEST { there.is_some() } else { listed.iter().any(|it| it == name) };
    let in_the_way = |name: &&String| fs::symlink_metadata(target.join(name)).is_ok() && !is_ours(name);
    let mut others: Vec<String> = names.iter().filter(in_the_way).cloned().collect();
    others.sort_unstable();
    others.dedup();
    match others.is_empty() {
        true => Ok(true),
        false => Err(DatasetError::NotOurs { path: target.into(), names: others }),
    }
}

/// `.NAME.incomplete` beside a new folder, `.incomplete` inside one that is there.
fn workshop(target: &Path, inside: bool) -> PathBuf {
    match target.file_name() {
        Some(name) if !inside => {
            let mut hidden = OsString::from(".");
            hidden.push(name);
            hidden.push(INCOMPLETE);
            target.with_file_name(hidden)
        }
        _ => target.join(INCOMPLETE),
    }
}

/// Makes a workshop that is this process's alone, and empties it of what a killed one left. On a file system without
/// locks its name has the process's number.
fn claim(workshop: &Path, target: &Path) -> Result<(PathBuf, Option<File>), DatasetError> {
    let failed = DatasetError::io("create", target);
    loop {
        fs::create_dir_all(workshop).map_err(&failed)?;
        match locked(workshop) {
            Ok(Some(lock)) => {
                for name in entries(workshop)? {
                    let path = workshop.join(name);
                    let removed =
                        if path.is_dir() { fs::remove_dir_all(&path) } else { fs::remove_file(&path) };
                    removed.map_err(DatasetError::io("remove", &path))?;
                }
                return Ok((workshop.into(), Some(lock)));
            }
            // It was another's that has just ended.
            Ok(None) => {}
            Err(error) if error.kind() == ErrorKind::NotFound => {}
            Err(error) if error.kind() == ErrorKind::WouldBlock => {
                return Err(DatasetError::Busy { path: target.into() });
            }
            Err(_) => {
                let mut own = workshop.as_os_str().to_os_string();
                own.push(format!("-{}", std::process::id()));
                fs::create_dir_all(&own).map_err(&failed)?;
                return Ok((own.into(), None));
            }
        }
    }
}

/// The folder with a lock on it; nothing if another has its name by now.
fn locked(folder: &Path) -> io::Result<Option<File>> {
    let file = File::open(folder)?;
    flock(&file, FlockOperation::NonBlockingLockExclusive)?;
    let (ours, named) = (file.metadata()?, fs::metadata(folder)?);
    Ok(((ours.dev(), ours.ino()) == (named.dev(), named.ino())).then_some(file))
}

/// Whether another process is filling this folder now.
pub(super) fn is_being_filled(workshop: &Path) -> bool {
    locked(workshop).is_err_and(|error| error.kind() == ErrorKind::WouldBlock)
}

/// Whether a folder holds nothing but what killed runs may have left.
fn is_empty(folder: &Path) -> Result<bool, DatasetError> {
    let names = entries(folder)?;
    Ok(names.iter().all(|name| name.as_encoded_bytes().starts_with(INCOMPLETE.as_bytes())))
}
