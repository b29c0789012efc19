//! Formats of a dataset: of this build, and behind a feature that it was built without.

use super::List;
use crate::dataset::{FEATURES, FORMATS, Format};

/// A row a format.
pub fn list() -> List {
    let mut rows: Vec<Vec<String>> =
        FORMATS.iter().map(|format| vec![format.name.into(), "yes".into(), format.about.into()]).collect();
    rows.extend(lacking().map(|name| {
        vec![
            name.into(),
            "no".into(),
            format!("needs large dependencies: cargo install --path . --features {name}"),
        ]
    }));
    List::of_rows(&["format", "in this build", "about"], rows)
}

/// The formats that this build lacks.
fn lacking() -> impl Iterator<Item = &'static str> {
    FEATURES.into_iter().filter(|name| Format::from_name(name).is_none())
}

/// `csv, npy, mat, tum, resd; not in this build: parquet and mcap`.
pub fn named() -> String {
    let names: Vec<_> = FORMATS.iter().map(|format| format.name).collect();
    let lacking: Vec<_> = lacking().collect();
    match lacking.as_slice() {
        [] => names.join(", "),
        lacking => format!("{}; not in this build: {}", names.join(", "), lacking.join(" and ")),
    }
}
