//! Estimated attitude against the truth.
//!
//! [`judge`] takes a whole series of estimates. It finds when each of them held (from the echo of a sample's time,
//! or from the delay at which the motion agrees best) and splits the error into inclination and heading
//! ([`AttitudeError`]). Where the error is large it tries the usual mistakes of axes, order and sign, so that the
//! report can name one.
//!
//! ```
//! use ratetable::geometry::Attitude;
//! use ratetable::score::{HeldAt, Options, Timed, judge};
//! use ratetable::time::SimTime;
//!
//! // A vehicle at rest, and a correct estimate.
//! let truth = |_| Some(Attitude::IDENTITY);
//! let estimates = [1, 2, 3].map(|s| {
//!     let t = SimTime(s * 1_000_000_000);
//!     Timed { arrival: t, stamp: HeldAt::Sample(t), attitude: Attitude::IDENTITY }
//! });
//! let judged = judge(&truth, &estimates, &Options { until: SimTime(4_000_000_000), ..Options::default() })?;
//! assert_eq!(judged.figures.errors.rms_deg, 0.0);
//! # Ok::<(), ratetable::score::Unjudged>(())
//! ```

mod align;
mod bench;
mod clock;
mod correlate;
mod delay;
mod figures;
mod file;
mod given;
mod judge;
mod looks;
mod offset;
mod packed;
mod place;
mod rates;
mod sampled;
mod series;
mod stamped;
mod track;
mod turn;

pub use crate::geometry::AttitudeError;
pub use align::Align;
pub use figures::{Aligned, DelayKnown, Errors, Figures, Fitted};
pub use file::{FileError, Reading, Recorded, read, read_as};
pub use given::{Clock, Delay, HeldAt, Options, Row, Timed, Truth};
pub use judge::{Judged, Readings, Unjudged, judge, judge_series};
pub use packed::Packed;
pub use series::Series;
pub use track::{AttitudeTrack, TrackError};

#[cfg(test)]
mod clock_tests;
#[cfg(test)]
mod tests;
