//! What reading a whole scene collects: its mistakes, and what is found on the way.

use super::attached::Attached;
use super::document::{Location, Mistake};
use super::drawn::Drawn;
use crate::geometry::Axes;
use std::cell::{Cell, RefCell};
use std::path::{Path, PathBuf};

/// What reading a whole scene collects.
pub struct Reader {
    /// The scene's seed, for values drawn once a run.
    pub seed: Cell<u64>,
    /// The axes it is written in.
    pub axes: Cell<Axes>,
    /// Where files that it names are.
    pub(super) folder: PathBuf,
    mistakes: RefCell<Vec<Mistake>>,
    pub(super) draws: RefCell<Vec<Drawn>>,
    pub(super) attached: RefCell<Vec<Attached>>,
    /// Files that were read for it.
    pub(super) files: RefCell<Vec<PathBuf>>,
    warnings: RefCell<Vec<String>>,
}

/// What a scene without mistakes brings besides its plan.
pub struct Found {
    /// Values drawn once for this run.
    pub drawn: Vec<Drawn>,
    /// Files that the scene as resolved names.
    pub attached: Vec<Attached>,
    /// Files that were read.
    pub files: Vec<PathBuf>,
    /// What a user should know.
    pub warnings: Vec<String>,
}

impl Reader {
    /// With nothing read yet of a scene whose text stands in `source`.
    pub fn new(source: &str) -> Reader {
        Reader {
            folder: Path::new(source).parent().map(Path::to_path_buf).unwrap_or_default(),
            seed: Cell::new(0),
            axes: Cell::new(Axes::default()),
            mistakes: RefCell::default(),
            draws: RefCell::default(),
            attached: RefCell::default(),
            files: RefCell::default(),
            warnings: RefCell::default(),
        }
    }

    /// Notes a mistake.
    pub fn mistake(&self, place: &Location, message: impl Into<String>) {
        let mistake = Mistake { place: place.clone(), message: message.into() };
        let mut mistakes = self.mistakes.borrow_mut();
        if !mistakes.contains(&mistake) {
            mistakes.push(mistake);
        }
    }

    /// Notes what a user should know.
    pub fn warn(&self, warning: String) {
        self.warnings.borrow_mut().push(warning);
    }

    /// Whether no mistake has been found so far.
    pub fn clean(&self) -> bool {
        self.mistakes.borrow().is_empty()
    }

    /// What was found, or every mistake in the order written.
    pub fn finish(self) -> Result<Found, Vec<Mistake>> {
        let mut mistakes = self.mistakes.into_inner();
        mistakes.sort_by_key(|mistake| mistake.place.position());
        if !mistakes.is_empty() {
            return Err(mistakes);
        }
        Ok(Found {
            drawn: self.draws.into_inner(),
            attached: self.attached.into_inner(),
            files: self.files.into_inner(),
            warnings: self.warnings.into_inner(),
        })
    }
}
