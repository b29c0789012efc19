//! What reading a whole scene collects: its mistakes, and the values drawn on the way.

use super::document::{Mistake, Place};
use super::draw::Drawn;
use crate::geometry::Axes;
use std::cell::{Cell, RefCell};

/// What reading a whole scene collects.
pub struct Reader {
    /// The scene's seed, for values drawn once a run.
    pub seed: Cell<u64>,
    /// The axes it is written in.
    pub axes: Cell<Axes>,
    mistakes: RefCell<Vec<Mistake>>,
    pub(super) draws: RefCell<Vec<Drawn>>,
}

impl Reader {
    /// With nothing read yet.
    pub fn new() -> Reader {
        Reader {
            seed: Cell::new(0),
            axes: Cell::new(Axes::default()),
            mistakes: RefCell::default(),
            draws: RefCell::default(),
        }
    }

    /// Notes a mistake.
    pub fn mistake(&self, place: &Place, message: impl Into<String>) {
        let mistake = Mistake { place: place.clone(), message: message.into() };
        let mut mistakes = self.mistakes.borrow_mut();
        if !mistakes.contains(&mistake) {
            mistakes.push(mistake);
        }
    }

    /// Whether no mistake has been found so far.
    pub fn clean(&self) -> bool {
        self.mistakes.borrow().is_empty()
    }

    /// What was drawn, or every mistake in the order written.
    pub fn finish(self) -> Result<Vec<Drawn>, Vec<Mistake>> {
        let mut mistakes = self.mistakes.into_inner();
        mistakes.sort_by_key(|mistake| mistake.place.position());
        if mistakes.is_empty() { Ok(self.draws.into_inner()) } else { Err(mistakes) }
    }
}
