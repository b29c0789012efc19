//! Estimates against the truth, side by side.

use crate::score::Figures;
use crate::table::Rows;
use serde::Serialize;

/// What `score` found, one JSON object.
#[derive(Clone, Debug, Serialize)]
pub struct ScoreReport {
    /// The program's version.
    pub version: String,
    /// Whether every estimate could be judged and every limit held.
    pub ok: bool,
    /// What did not hold: `estimates.vqf.rms_deg = 1.3 >= 1`.
    pub failed: Vec<String>,
    /// What the estimates were set against.
    pub truth: String,
    /// The unit of its times.
    pub truth_time_unit: &'static str,
    /// What the user should know of how it was read.
    pub truth_remarks: Vec<String>,
    /// What was taken out of each: `none`, its constant `heading`, or constant rotations of the `world` or of both
    /// `frames`.
    pub align: String,
    /// For how long from the truth's start on nothing was judged, s.
    pub settle_s: f64,
    /// Each estimate, in the order given.
    pub estimates: Vec<Scored>,
}

/// One estimate.
#[derive(Clone, Debug, Serialize)]
pub struct Scored {
    /// The filter's name, or that of the file without its ending.
    pub name: String,
    /// The filter, or the file's path.
    pub source: String,
    /// How far off it is, where that can be known.
    #[serde(flatten)]
    pub figures: Option<Figures>,
    /// Why it cannot.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unknown: Option<String>,
    /// The unit of its times.
    pub time_unit: &'static str,
    /// How many rows of a file were read, and how many are left out and why.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rows: Option<Rows>,
    /// What the user should know of how it was read.
    pub remarks: Vec<String>,
    /// What explains its error, or would help.
    pub hints: Vec<String>,
}
