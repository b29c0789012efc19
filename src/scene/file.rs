//! Files that a scene names: read where they are, and what a copy of the scene needs beside it.

use super::attached::{Attached, stamp};
use super::section::Section;
use crate::keys::Text;
use crate::table::{is_text, kind_of};
use std::fs;
use std::path::PathBuf;

impl Section<'_> {
    /// A text file by its path, relative to the scene's folder, or to the current one where `--set` names it. The
    /// scene as resolved calls it after its table, `motion-0.csv`, and expects it in its own folder.
    pub(super) fn file(&self, key: &'static str) -> Option<Text> {
        let path = self.text(key, None)?;
        let in_scene = self.place(key).position().is_some();
        let path = if in_scene { self.reader.folder.join(path) } else { PathBuf::from(path) };
        let name = path.display().to_string();
        let read = stamp(&path).and_then(|stamp| Ok((stamp, fs::read(&path)?)));
        let (stamp, bytes) = match read {
            Ok(read) => read,
            Err(error) => {
                self.mistake(key, format!("cannot read {name}: {error}"));
                return None;
            }
        };
        if let Some(kind) = kind_of(&bytes) {
            self.mistake(
                key,
                kind.refusal(&name, "a scene does not read: it reads text tables, such as CSV with a header"),
            );
            return None;
        }
        let contents = match String::from_utf8(bytes) {
            Ok(contents) => contents,
            // A degree sign of an older code is no reason to refuse a log.
            Err(error) if is_text(error.as_bytes()) => {
                error.as_bytes().iter().map(|byte| char::from(*byte)).collect()
            }
            Err(error) => {
                let valid = &error.as_bytes()[..error.utf8_error().valid_up_to()];
                let line = valid.split(|b| *b == b'\n').count();
                self.mistake(key, format!("{name}:{line} is not UTF-8 text"));
                return None;
            }
        };
        let extension = path.extension().map_or(String::new(), |text| format!(".{}", text.to_string_lossy()));
        let attached = Attached { name: self.path.replace('.', "-") + &extension, path, stamp };
        self.resolve(key, attached.name.clone());
        self.reader.files.borrow_mut().push(attached.path.clone());
        self.reader.attached.borrow_mut().push(attached);
        Some(Text { name, contents })
    }
}
