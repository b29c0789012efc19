//! Estimated attitude against the truth.
//!
//! [`judge`] takes a whole series of estimates: it finds when each of them held (by the echo of a sample's time, or by
//! the delay at which the motion agrees best), splits the error into inclination and heading ([`AttitudeError`]), and
//! where the error is large tries the usual mistakes of axes, order and sign, so that the report can name one.

mod clock;
mod delay;
mod error;
mod file;
mod judge;
mod looks;
mod offset;
mod sampled;
mod track;

pub use error::AttitudeError;
pub use file::{FileError, Reading, Recorded, read, read_as};
pub use judge::{
    Align, Clock, DelayKnown, Figures, Judged, Options, Row, Stamp, Timed, Truth, judge, judge_readings,
};
pub use track::{Track, TrackError};

#[cfg(test)]
mod tests;
