//! Estimated attitude against the truth.
//!
//! [`judge`] takes a whole series of estimates: it finds when each of them held (by the echo of a sample's time, or by
//! the delay at which the motion agrees best), splits the error into inclination and heading ([`AttitudeError`]), and
//! where the error is large tries the usual mistakes of axes, order and sign, so that the report can name one.

mod align;
mod bench;
mod clock;
mod correlate;
mod delay;
mod error;
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

pub use align::Align;
pub use error::AttitudeError;
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
