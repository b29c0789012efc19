//! Inputs of a score (estimates, truth and options), and one row of its output.

use super::AttitudeError;
use super::align::Align;
use crate::geometry::{Attitude, Axes};
use crate::time::SimTime;

/// The truth as a function of time; `None` where it is unknown.
pub type Truth<'a> = &'a dyn Fn(SimTime) -> Option<Attitude>;

/// What is known of the time at which an estimate held.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum HeldAt {
    /// The scene time of its newest sample, as echoed: exact.
    Sample(SimTime),
    /// Time of the other side's own clock, ns since an unknown epoch.
    Own(i64),
    /// Only its arrival time.
    Arrival,
}

/// An estimate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timed {
    /// Its arrival in scene time; for an estimate in a file, its recorded time.
    pub arrival: SimTime,
    /// When it held, as far as known.
    pub stamp: HeldAt,
    /// Its attitude: body to nav, of about unit length.
    pub attitude: Attitude,
}

/// How to treat a delay on the truth's clock.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Delay {
    /// Remove it if it is found; also report the errors as the estimates arrived.
    #[default]
    TakeOut,
    /// Keep it; also report the errors without it.
    Keep,
    /// Like [`Delay::Keep`], but rows and charts are without the delay: if it is not found, nothing is judged.
    Fit,
    /// Like [`Delay::Fit`], with this delay in ns.
    Given(i64),
}

/// The clock of the times of estimates.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Clock {
    /// The truth's clock; an estimate is late by its delay, from half a second early to two seconds late.
    #[default]
    Truth,
    /// The truth's clock, exactly: each time is that of the estimate's newest sample.
    Sample,
    /// An unknown clock, such as a log's time since some boot. [`Options::until`](super::Options) must be finite.
    Other,
    /// Whichever of the two the motion, or the times themselves, show without doubt.
    Auto,
}

/// How to judge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Options {
    /// The rotations to remove.
    pub align: Align,
    /// The clock of the estimates.
    pub clock: Clock,
    /// How to treat a delay.
    pub delay: Delay,
    /// Start of the known truth.
    pub from: SimTime,
    /// End of the known truth.
    pub until: SimTime,
    /// How long before `from` the vehicle was held still in its initial attitude.
    pub rest: SimTime,
    /// How long after `from` estimates do not count.
    pub settle: SimTime,
    /// The original axes of the estimates, in which mistakes were made.
    pub axes: Axes,
}

impl Default for Options {
    fn default() -> Options {
        Options {
            align: Align::None,
            clock: Clock::Truth,
            delay: Delay::TakeOut,
            from: SimTime::ZERO,
            until: SimTime::FOREVER,
            rest: SimTime::ZERO,
            settle: SimTime::ZERO,
            axes: Axes::NedFrd,
        }
    }
}

/// One judged estimate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// When it held, in scene time.
    pub t: SimTime,
    /// Its attitude, without the removed rotations.
    pub attitude: Attitude,
    /// The truth at that time.
    pub truth: Attitude,
    /// The difference between the two.
    pub error: AttitudeError,
}
