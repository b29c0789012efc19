//! The file formats as a table.

use super::format::Format;
use super::{csv, mat, npy, resd, tum};

/// Every format of this build.
pub static FORMATS: &[&Format] = &[
    &csv::FORMAT,
    &npy::FORMAT,
    &mat::FORMAT,
    &tum::FORMAT,
    &resd::FORMAT,
    #[cfg(feature = "parquet")]
    &super::parquet::FORMAT,
    #[cfg(feature = "mcap")]
    &super::mcap::FORMAT,
];

/// The formats behind a cargo feature of the same name.
pub const FEATURES: [&str; 2] = ["parquet", "mcap"];

impl Format {
    /// The format of that name.
    pub fn from_name(name: &str) -> Option<&'static Format> {
        FORMATS.iter().copied().find(|format| format.name == name)
    }
}
