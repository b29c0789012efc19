//! What is shown, as it is known before anything happens.

use crate::geometry::Axes;
use crate::sensor::{SensorKind, Shape};
use crate::time::SimTime;

/// What is shown: a scene that is played, or a stream that is listened to.
#[derive(Clone, Debug)]
pub struct About {
    /// The command that shows it: `run`, `timing`, `listen`.
    pub command: &'static str,
    /// The scene's name, or the link that is listened to.
    pub title: String,
    /// The axes in which vectors and attitudes are given.
    pub axes: Axes,
    /// How long the scene lasts, if it ends by itself.
    pub duration: Option<SimTime>,
    /// Each sensor, in the order of the plan or of its first sample.
    pub sensors: Vec<Shown>,
    /// Who tells an attitude, in the order of the links that they tell it on.
    pub estimators: Vec<String>,
    /// The links, as the user gave them.
    pub links: Vec<String>,
    /// What the scene holds, and when.
    pub timeline: Vec<Span>,
}

/// A sensor that is shown.
#[derive(Clone, Debug, PartialEq)]
pub struct Shown {
    /// Such as `gyro`, or `gyro-2` where a stream has several.
    pub name: String,
    /// What it senses.
    pub kind: SensorKind,
    /// Its rate, where the scene gives one, Hz.
    pub rate_hz: Option<f64>,
    /// Whether its error-free readings are known.
    pub has_truth: bool,
}

/// A part of the scene's timeline, from its start up to its end.
#[derive(Clone, Debug, PartialEq)]
pub struct Span {
    /// What it is a part of: `motion`, `force`, `fault`, `setting`.
    pub row: &'static str,
    /// Such as `rotate`, `gyro stuck`.
    pub label: String,
    /// When it begins.
    pub start: SimTime,
    /// When it ends; `None` where it does not.
    pub end: Option<SimTime>,
}

/// A value of a reading: its name and its unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Column {
    /// Such as `x`, `pressure`, `latitude`.
    pub name: &'static str,
    /// Such as `rad/s`.
    pub unit: &'static str,
}

/// The values of a fix: position, then velocity north, east and down.
const FIX: [Column; 6] = [
    Column { name: "latitude", unit: "deg" },
    Column { name: "longitude", unit: "deg" },
    Column { name: "altitude", unit: "m" },
    Column { name: "north", unit: "m/s" },
    Column { name: "east", unit: "m/s" },
    Column { name: "down", unit: "m/s" },
];

/// The values that a reading of this kind has in a [`Batch`](super::Batch), in SI units and degrees.
pub fn columns(kind: SensorKind) -> Vec<Column> {
    let unit = kind.unit();
    match kind.shape() {
        Shape::Triad => ["x", "y", "z"].map(|name| Column { name, unit }).to_vec(),
        Shape::Pressure => vec![Column { name: "pressure", unit }],
        Shape::Position => FIX.to_vec(),
    }
}
