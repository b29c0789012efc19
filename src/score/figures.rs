//! Summary figures of a series of estimates.

use super::AttitudeError;
use serde::Serialize;

/// How the delay was determined.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum DelayKnown {
    /// From the echo of a sample's time.
    Echoed,
    /// From the best agreement of the motion.
    Estimated,
    /// Given by the user.
    Given,
    /// Not determined.
    #[default]
    Unknown,
}

/// Errors of a series of estimates, degrees: root mean squares and the largest.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Errors {
    /// Root mean square of the total error.
    pub rms_deg: f64,
    /// The largest total error.
    pub max_deg: f64,
    /// Root mean square of the tilt.
    pub inclination_rms_deg: f64,
    /// The largest tilt.
    pub inclination_max_deg: f64,
    /// Root mean square of the turn about the vertical.
    pub heading_rms_deg: f64,
    /// The largest turn about the vertical.
    pub heading_max_deg: f64,
    /// Root mean square of the difference in roll (Euler angles in the estimate's own axes).
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

/// Errors after a delay is removed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Fitted {
    /// The delay, ms; positive where the estimate is late.
    pub delay_ms: f64,
    /// Its standard error, ms, if it was found and not given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub delay_std_ms: Option<f64>,
    /// The remaining errors.
    #[serde(flatten)]
    pub errors: Errors,
}

/// The constant rotations that were removed, degrees.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Aligned {
    /// Of the nav axes ("the world").
    pub world_deg: f64,
    /// Of the body's axes.
    pub body_deg: f64,
    /// The part of the world's that turns about the vertical, positive where the estimate is turned clockwise.
    pub heading_deg: f64,
}

/// The summary of a series of estimates.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Figures {
    /// The number of judged estimates.
    pub samples: u64,
    /// Errors at the times when the estimates held. On the truth's own clock the times are as given, and any delay
    /// stays in unless stamps or an echo show it; on another clock its offset is removed.
    #[serde(flatten)]
    pub errors: Errors,
    /// Errors with the delay removed, if the estimates are judged as given and a delay was found.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fitted: Option<Fitted>,
    /// Errors as the estimates arrived, if a delay was removed from those above.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub as_arrived: Option<Errors>,
    /// How much later than it held an estimate arrived; the median if known for each.
    pub delay_ms: Option<f64>,
    /// How the delay was determined.
    pub delay_known: DelayKnown,
    /// Why it was not.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub delay_doubt: Option<&'static str>,
    /// How far the estimates' own clock is ahead of the truth's, delay included, if it is a different one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub clock_offset_s: Option<f64>,
    /// The standard error of the offset, ms.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub clock_std_ms: Option<f64>,
    /// Whether the estimates' clock is known without doubt.
    pub clock_certain: bool,
    /// The share of the truth's time that the estimates cover, from 0 to 1; gaps do not count.
    pub coverage: f64,
    /// When the first judged estimate held, s of the truth's time.
    pub from_s: f64,
    /// When the last one held, s of the truth's time.
    pub to_s: f64,
    /// The constant rotations that were removed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub aligned: Option<Aligned>,
    /// The constant heading that was removed, if only that was requested: the one in [`Figures::aligned`].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub heading_offset_deg: Option<f64>,
    /// The mistake that explains a large error: `NED/ENU swapped`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub looks: Option<String>,
    /// The root mean square without this mistake.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub looks_rms_deg: Option<f64>,
}

impl Figures {
    /// Figures with every possible field, all 0: what a limit may name.
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

/// The sums behind the errors.
#[derive(Clone, Debug, Default)]
pub(super) struct Tally {
    pub count: u64,
    squares: [f64; 6],
    most: [f64; 6],
}

impl Tally {
    /// Adds one error, rad: the total one and those of roll, pitch and yaw.
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

    /// The errors from the sums.
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
