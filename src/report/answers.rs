//! What came back on a link while the scene was played.

use super::Spread;
use serde::Serialize;

/// The answers of the other side of one link during the scene: its estimates, or in lockstep its acknowledgements.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct AnswersReport {
    /// How many to expect: one for each packet where every packet is answered, otherwise as many as the usual gap gives
    /// over the whole scene. Absent where the gap is not known.
    pub expected: Option<u64>,
    /// Where that number comes from: `packets` or `usual gap`.
    pub expected_by: &'static str,
    /// How many came.
    pub received: u64,
    /// Between two answers, µs of wall time; silences do not count.
    pub gap_us: Option<Spread>,
    /// How often it was silent for longer than ten usual gaps and half a second.
    pub silences: u64,
    /// How long these silences were in all, s of wall time.
    pub silent_s: f64,
    /// The longest time without an answer, s of wall time.
    pub silent_longest_s: f64,
    /// How often the other side restarted.
    pub restarts: u64,
    /// Scene time of its last answer, s, where it was silent from then to the end of the run.
    pub stopped_at_s: Option<f64>,
}

impl AnswersReport {
    /// With every field that a run can have, so that limits can be checked against it.
    pub fn shape() -> AnswersReport {
        AnswersReport { gap_us: Some(Spread::default()), ..AnswersReport::default() }
    }

    /// How many of how many: `499 of 5000 answers`.
    pub fn count(&self) -> String {
        match self.expected {
            Some(expected) => format!("{} of {expected} answers", self.received),
            None => super::count(self.received, "answer"),
        }
    }
}
