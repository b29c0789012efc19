//! Summary figures of a series of estimates.

use super::AttitudeError;
use serde::Serialize;

/// How the delay is known.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum DelayKnown {
    /// The time of the sample was echoed.
    Echoed,
    /// By where the motion agrees best.
    Estimated,
    /// It was given.
    Given,
    /// It is not.
    #[default]
    Unknown,
}

/// Errors of a series of estimates, degrees: root mean squares and the largest.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Errors {
    /// Root mean square of the whole error.
    pub rms_deg: f64,
    /// The largest whole error.
    pub max_deg: f64,
    /// Root mean square of the tilt.
    pub inclination_rms_deg: f64,
    /// The largest tilt.
    pub inclination_max_deg: f64,
    /// Root mean square of the turn about the vertical.
    pub heading_rms_deg: f64,
    /// The largest turn about the vertical.
    pub heading_max_deg: f64,
    /// Root mean square of the difference of the Euler angles roll, in the estimate's own axes.
    pub roll_rms_deg: f64,
    /// The largest difference of roll.
    pub roll_max_deg: f64,
    /// Root mean square of the difference of pitch.
    pub pitch_rms_deg: f64,
    /// The largest difference of pitch.
    pub pitch_max_deg: f64,
    /// Root mean square of the difference of yaw.
    pub yaw_rms_deg: f64,
    /// The largest difference of yaw.
    pub yaw_max_deg: f64,
}

/// Errors with a delay taken out.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Fitted {
    /// The delay, ms; positive where the estimate is late.
    pub delay_ms: f64,
    /// Its standard error, ms, where it was found and not given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub delay_std_ms: Option<f64>,
    /// What is left.
    #[serde(flatten)]
    pub errors: Errors,
}

/// The constant rotations that were taken out, degrees.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Aligned {
    /// Of the nav axes ("the world").
    pub world_deg: f64,
    /// Of the body's axes.
    pub body_deg: f64,
    /// The part of the world's that turns about the vertical, positive where the estimate is turned clockwise.
    pub heading_deg: f64,
}

/// What a series of estimates amounts to.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Figures {
    /// How many estimates were judged.
    pub samples: u64,
    /// Errors at the times at which the estimates held: on the truth's own clock as given, with whatever delay they
    /// have, unless their own stamps or an echo tell it; on another clock with its offset taken out.
    #[serde(flatten)]
    pub errors: Errors,
    /// Errors with the delay taken out, where the estimates are judged as given and it could be found.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fitted: Option<Fitted>,
    /// Errors as the estimates arrived, where a delay was taken out of those above.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub as_arrived: Option<Errors>,
    /// How much later than it held an estimate came, the median where it is known of each.
    pub delay_ms: Option<f64>,
    /// How it is known.
    pub delay_known: DelayKnown,
    /// Why it is not.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub delay_doubt: Option<&'static str>,
    /// How much the estimates' own clock is ahead of the truth's, delay included, where it is another.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub clock_offset_s: Option<f64>,
    /// The standard error of that, ms.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub clock_std_ms: Option<f64>,
    /// Whether the estimates' clock is known without doubt.
    pub clock_certain: bool,
    /// Which part of the truth's time the estimates cover, from 0 to 1; gaps do not count.
    pub coverage: f64,
    /// The constant rotations that were taken out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub aligned: Option<Aligned>,
    /// The constant heading that was taken out, where that alone was asked for: that of [`Figures::aligned`].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub heading_offset_deg: Option<f64>,
    /// The mistake that explains a large error: `NED/ENU swapped`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub looks: Option<String>,
    /// What the root mean square would be without it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub looks_rms_deg: Option<f64>,
}

impl Figures {
    /// With every field that there can be, all of them 0: what a limit may name.
    pub fn shape() -> Figures {
        Figures {
            fitted: Some(Fitted { delay_ms: 0.0, delay_std_ms: Some(0.0), errors: Errors::default() }),
            as_arrived: Some(Errors::default()),
            delay_ms: Some(0.0),
            clock_offset_s: Some(0.0),
            clock_std_ms: Some(0.0),
            aligned: Some(Aligned::default()),
            heading_offset_deg: Some(0.0),
            looks_rms_deg: Some(0.0),
            ..Figures::default()
        }
    }
}

/// The sums that errors come from.
#[derive(Clone, Debug, Default)]
pub(super) struct Tally {
    pub count: u64,
    squares: [f64; 6],
    most: [f64; 6],
}

impl Tally {
    /// Takes one error in, rad: of the whole and of roll, pitch and yaw.
    pub fn add(&mut self, error: &AttitudeError, angles: [f64; 3]) {
        let [roll, pitch, yaw] = angles;
        self.count += 1;
        for (i, part) in
            [error.total, error.inclination, error.heading, roll, pitch, yaw].into_iter().enumerate()
        {
            self.squares[i] += part * part;
            self.most[i] = self.most[i].max(part.abs());
        }
    }

    /// What they amount to.
    pub fn errors(&self) -> Errors {
        let rms = |i: usize| libm::sqrt(self.squares[i] / self.count.max(1) as f64).to_degrees();
        let max = |i: usize| self.most[i].to_degrees();
        Errors {
            rms_deg: rms(0),
            max_deg: max(0),
            inclination_rms_deg: rms(1),
            inclination_max_deg: max(1),
            heading_rms_deg: rms(2),
            heading_max_deg: max(2),
            roll_rms_deg: rms(3),
            roll_max_deg: max(3),
            pitch_rms_deg: rms(4),
            pitch_max_deg: max(4),
            yaw_rms_deg: rms(5),
            yaw_max_deg: max(5),
        }
    }
}
