//! What is shown, as it is known before anything happens.

use crate::geometry::Axes;
use crate::motion::Push;
use crate::report::number;
use crate::scene::{OutputFault, Plan};
use crate::sensor::{SensorKind, SensorPlan, Shape};
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
    /// Scene seconds a second, or `max`; null where there is no such thing.
    pub speed: serde_json::Value,
    /// What an attitude is compared with: `truth`, or a `reference`; `None` where nothing is known.
    pub reference: Option<&'static str>,
    /// Each sensor, in the order of the plan or of its first sample.
    pub sensors: Vec<Shown>,
    /// Who tells an attitude, in the order of the links that they tell it on.
    pub estimators: Vec<String>,
    /// The links, as the user gave them.
    pub links: Vec<String>,
    /// The gyroscope and the accelerometer that tick together, if there are such.
    pub together: Option<(usize, usize)>,
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

impl About {
    /// Data that are shown by themselves, in the program's own axes.
    pub fn of_data(command: &'static str, title: String) -> About {
        About {
            command,
            title,
            axes: Axes::NedFrd,
            duration: None,
            speed: serde_json::Value::Null,
            reference: None,
            sensors: Vec::new(),
            estimators: Vec::new(),
            links: Vec::new(),
            together: None,
            timeline: Vec::new(),
        }
    }

    /// A scene that is played up to `end` to these links, by this command.
    pub fn scene(command: &'static str, plan: &Plan, end: SimTime, links: Vec<String>) -> About {
        let sensor = |it: &SensorPlan| Shown {
            name: it.kind.name().into(),
            kind: it.kind,
            rate_hz: Some(it.rate.as_hz()),
            has_truth: true,
        };
        About {
            axes: plan.axes,
            duration: (end < SimTime::FOREVER).then_some(end),
            reference: Some("truth"),
            sensors: plan.sensors.iter().map(sensor).collect(),
            estimators: links.clone(),
            links,
            together: together(plan),
            timeline: timeline(plan),
            ..About::of_data(command, plan.name.clone())
        }
    }
}

/// The gyroscope and the accelerometer of a scene, where they have the same ticks.
fn together(plan: &Plan) -> Option<(usize, usize)> {
    let find = |kind| plan.sensors.iter().position(|sensor| sensor.kind == kind);
    let (gyro, accel) = (find(SensorKind::Gyro)?, find(SensorKind::Accel)?);
    let sensors = &plan.sensors;
    sensors[gyro].ticks_with(&sensors[accel]).then_some((gyro, accel))
}

/// Motions, forces, faults and settings of a scene, in order of time.
fn timeline(plan: &Plan) -> Vec<Span> {
    let until = |end: SimTime| (end < SimTime::FOREVER).then_some(end);
    let mut spans = motions(plan);
    for force in plan.trajectory.forces() {
        let strength = match force.push {
            Push::Body(push) => push.v.length(),
            Push::Nav(push) => push.v.length(),
        };
        let label = format!("{} m/s²", number(strength));
        spans.push(Span { row: "force", label, start: force.start, end: until(force.end) });
    }
    for sensor in &plan.sensors {
        for fault in &sensor.faults {
            let label = format!("{} {}", sensor.kind, fault.kind.name());
            spans.push(Span { row: "fault", label, start: fault.start, end: until(fault.end) });
        }
        for setting in &sensor.settings {
            let rate = setting.rate.map_or("off".into(), |rate| rate.to_string());
            let label = format!("{} {rate}", sensor.kind);
            spans.push(Span { row: "setting", label, start: setting.start, end: Some(setting.start) });
        }
    }
    for fault in plan.output_faults.iter().map(OutputFault::fault) {
        let label = format!("packets {}", fault.kind.name());
        spans.push(Span { row: "fault", label, start: fault.start, end: until(fault.end) });
    }
    spans
}

/// The motions by the names that the scene gives them.
fn motions(plan: &Plan) -> Vec<Span> {
    let scene = plan.resolved.parse::<toml::Table>().unwrap_or_default();
    let written = scene.get("motion").and_then(|it| it.as_array()).cloned().unwrap_or_default();
    let name = |i: usize| Some(written.get(i)?.get("kind")?.as_str()?.to_string());
    let starts: Vec<_> = plan.trajectory.starts().collect();
    let ends = starts.iter().skip(1).copied().chain([plan.trajectory.moving_until()]);
    let pairs = starts.iter().zip(ends).enumerate();
    let span = |(i, (start, end)): (usize, (&SimTime, SimTime))| Span {
        row: "motion",
        label: name(i).unwrap_or_else(|| "motion".into()),
        start: *start,
        end: Some(end),
    };
    pairs.map(span).collect()
}
