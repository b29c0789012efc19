//! What a score is given: estimates, the truth, and how to judge; and one row of what it gives back.

use super::AttitudeError;
use super::align::Align;
use crate::geometry::{Attitude, Axes};
use crate::time::SimTime;

/// The truth as a function of time; `None` where it is not known.
pub type Truth<'a> = &'a dyn Fn(SimTime) -> Option<Attitude>;

/// What is known of the time at which an estimate held.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum HeldAt {
    /// The scene's time of the newest sample it rests on, as echoed: exact.
    Sample(SimTime),
    /// Time of the other side's own clock, ns since whenever.
    Own(i64),
    /// Nothing but its arrival.
    Arrival,
}

/// An estimate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timed {
    /// When it arrived, in scene time; of an estimate in a file, the time that stands beside it.
    pub arrival: SimTime,
    /// When it held, as far as it says.
    pub stamp: HeldAt,
    /// What it says: body to nav, of about unit length.
    pub attitude: Attitude,
}

/// How to treat a delay on the truth's clock.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Delay {
    /// It is taken out where it can be found; what the estimates are as they arrived is told beside.
    #[default]
    TakeOut,
    /// It is left in; what they are without it is told beside.
    Keep,
    /// As [`Delay::Keep`], and rows and charts are without it: where it cannot be found nothing is judged.
    Fit,
    /// As [`Delay::Fit`], and it is so many ns.
    Given(i64),
}

/// What clock the times of estimates are of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Clock {
    /// The truth's: an estimate is late by its delay, from half a second early to two seconds late.
    #[default]
    Truth,
    /// The truth's, exactly: each time is that of the newest sample an estimate rests on.
    Sample,
    /// One of which nothing is known, such as a log's since some boot. [`Options::until`](super::Options) has to be
    /// finite.
    Other,
    /// The one of the two that the motion, or the times themselves, leave no doubt about.
    Auto,
}

/// How to judge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Options {
    /// What is taken out.
    pub align: Align,
    /// Which clock.
    pub clock: Clock,
    /// How to treat a delay.
    pub delay: Delay,
    /// From when on the truth is known.
    pub from: SimTime,
    /// Until when.
    pub until: SimTime,
    /// For how long before that the vehicle was held still as it is then.
    pub rest: SimTime,
    /// For how long from `from` on estimates do not count.
    pub settle: SimTime,
    /// The axes in which the estimates were written before they were read, and in which mistakes were made.
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

/// One estimate that was judged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// When it held, in scene time.
    pub t: SimTime,
    /// What it said, less what was taken out.
    pub attitude: Attitude,
    /// The truth then.
    pub truth: Attitude,
    /// How far the one is from the other.
    pub error: AttitudeError,
}
