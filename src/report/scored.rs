//! Estimates against the truth, side by side.

use crate::score::Figures;
use crate::table::Rows;
use serde::Serialize;

/// The result of `score`, one JSON object.
#[derive(Clone, Debug, Serialize)]
pub struct ScoreReport {
    /// The program's version.
    pub version: String,
    /// Whether every estimate could be judged and every limit held.
    pub ok: bool,
    /// The limits and conditions that failed: `estimates.vqf.rms_deg = 1.3 >= 1`.
    pub failed: Vec<String>,
    /// The source of the truth.
    pub truth: String,
    /// The unit of its times.
    pub truth_time_unit: &'static str,
    /// What the user should know about how it was read.
    pub truth_remarks: Vec<String>,
    /// What was removed from each: `none`, its constant `heading`, or constant rotations of the `world` or of both
    /// `frames`.
    pub align: String,
    /// How long from the truth's start nothing was judged, s.
    pub settle_s: f64,
    /// Each estimate, in the order given.
    pub estimates: Vec<Scored>,
}

/// One estimate.
#[derive(Clone, Debug, Serialize)]
pub struct Scored {
    /// The filter's name, or the file's name without its extension.
    pub name: String,
    /// The filter, or the file's path.
    pub source: String,
    /// Its error, if known.
    #[serde(flatten)]
    pub figures: Option<Figures>,
    /// Why it is unknown.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unknown: Option<String>,
    /// The unit of its times.
    pub time_unit: &'static str,
    /// The number of rows read from a file, and of those left out, with reasons.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rows: Option<Rows>,
    /// What the user should know about how it was read.
    pub remarks: Vec<String>,
    /// Explanations of its error, or what would help.
    pub hints: Vec<String>,
}
