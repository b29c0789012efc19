//! What the page gets: messages in JSON, one `begin`, then `more`, and `end`.

use super::Paths;
use super::about::{About, Span};
use super::lateness::{Bins, Lateness, Point};
use super::strip::Strip;
use super::track::Fix;
use crate::geometry::{Attitude, Axes};
use crate::sensor::{SensorKind, Shape};
use crate::time::SimTime;
use serde::{Serialize, Serializer};

/// A number with seven significant digits, which is what a screen can show of it; nothing where it is not finite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Short(pub f64);

impl Serialize for Short {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let value = self.0;
        if !value.is_finite() {
            return serializer.serialize_none();
        }
        if value == 0.0 {
            return serializer.serialize_f64(0.0);
        }
        let digits = 6 - libm::floor(libm::log10(value.abs())) as i32;
        // A power of ten that is exact, above or below the line.
        let scale = libm::exp10(f64::from(digits.abs()));
        let rounded = match digits {
            0.. => libm::round(value * scale) / scale,
            _ => libm::round(value / scale) * scale,
        };
        serializer.serialize_f64(if rounded.is_finite() { rounded } else { value })
    }
}

/// Seconds, to the microsecond.
pub(super) fn seconds(t: SimTime) -> f64 {
    libm::round(t.0 as f64 / 1e3) / 1e6
}

/// What a column of readings is on the page: its name, its unit, and how it follows from SI units.
pub(super) struct Presented {
    pub name: &'static str,
    pub unit: &'static str,
    pub of: fn(f64) -> f64,
}

/// The columns of a kind as people like to see them.
pub(super) fn shown(kind: SensorKind) -> Vec<Presented> {
    let row = kind.row();
    let as_read: fn(f64) -> f64 = |value| value;
    match kind.shape() {
        Shape::Triad => {
            let column = |name| Presented { name, unit: row.shown.unit, of: row.shown.in_chart };
            ["x", "y", "z"].map(column).into()
        }
        Shape::Pressure => vec![Presented { name: "pressure", unit: "hPa", of: row.shown.in_chart }],
        Shape::Position => super::columns(kind)
            .iter()
            .map(|it| Presented { name: it.name, unit: it.unit, of: as_read })
            .collect(),
    }
}

#[derive(Serialize)]
pub(super) struct Begin<'a> {
    kind: &'static str,
    version: &'static str,
    command: &'a str,
    title: &'a str,
    axes: &'static str,
    duration_s: Option<f64>,
    speed: &'a serde_json::Value,
    reference: Option<&'a str>,
    sensors: Vec<BeginSensor<'a>>,
    estimators: &'a [String],
    links: &'a [String],
    timeline: Vec<BeginSpan<'a>>,
    thinned: Option<String>,
}

#[derive(Serialize)]
struct BeginSensor<'a> {
    name: &'a str,
    kind: &'static str,
    rate_hz: Option<f64>,
    has_truth: bool,
    columns: Vec<BeginColumn>,
}

#[derive(Serialize)]
struct BeginColumn {
    name: &'static str,
    unit: &'static str,
}

#[derive(Serialize)]
struct BeginSpan<'a> {
    row: &'a str,
    label: &'a str,
    start_s: f64,
    end_s: Option<f64>,
}

impl<'a> Begin<'a> {
    /// The first message; `thinned` says how what follows is thinned.
    pub(super) fn of(about: &'a About, thinned: Option<String>) -> Begin<'a> {
        let sensor = |it: &'a super::Shown| BeginSensor {
            name: &it.name,
            kind: it.kind.name(),
            rate_hz: it.rate_hz,
            has_truth: it.has_truth,
            columns: shown(it.kind).iter().map(|it| BeginColumn { name: it.name, unit: it.unit }).collect(),
        };
        let span = |it: &'a Span| BeginSpan {
            row: it.row,
            label: &it.label,
            start_s: seconds(it.start),
            end_s: it.end.map(seconds),
        };
        Begin {
            kind: "begin",
            version: env!("CARGO_PKG_VERSION"),
            command: about.command,
            title: &about.title,
            axes: match about.axes {
                Axes::NedFrd => Axes::NAMES[0],
                Axes::EnuFlu => Axes::NAMES[1],
            },
            duration_s: about.duration.map(seconds),
            speed: &about.speed,
            reference: about.reference,
            sensors: about.sensors.iter().map(sensor).collect(),
            estimators: &about.estimators,
            links: &about.links,
            timeline: about.timeline.iter().map(span).collect(),
            thinned,
        }
    }
}

/// Since the message before; what is empty is left out.
#[derive(Default, Serialize)]
pub(super) struct More {
    pub kind: &'static str,
    pub t: Option<f64>,
    pub phase: &'static str,
    pub waiting: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub truth: Option<Attitudes>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub estimates: Vec<Of<Attitudes>>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub errors: Vec<Of<Errors>>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub readings: Vec<Of<Values>>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub rates: Vec<Of<Rates>>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub lateness: Vec<Of<Late>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub late_histogram: Option<LateHistogram>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub links: Vec<Of<Link>>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub notices: Vec<Notice>,
}

impl More {
    /// Attitudes that are known as they are.
    pub(super) fn of(about: &About, Paths { truth, told }: &Paths) -> More {
        let told = told.iter().enumerate();
        let attitudes = |path: &[(SimTime, Attitude, [f64; 2])]| {
            Attitudes::of(about.axes, path.iter().map(|&(t, attitude, _)| (t, attitude)))
        };
        let column = |path: &[(SimTime, Attitude, [f64; 2])], i: usize| {
            path.iter().map(|(_, _, errors)| Short(errors[i])).collect()
        };
        let errors = |path: &[(SimTime, Attitude, [f64; 2])]| Errors {
            t: path.iter().map(|(t, ..)| seconds(*t)).collect(),
            inclination_deg: column(path, 0),
            heading_deg: column(path, 1),
        };
        More {
            kind: "more",
            t: truth.last().map(|(t, _)| seconds(*t)),
            phase: "playing",
            truth: (!truth.is_empty()).then(|| Attitudes::of(about.axes, truth.iter().copied())),
            estimates: told.clone().map(|(of, path)| Of { of, what: attitudes(path) }).collect(),
            errors: told.map(|(of, path)| Of { of, what: errors(path) }).collect(),
            ..More::default()
        }
    }
}

/// Something of one of the sensors, estimators or links.
#[derive(Clone, Serialize)]
pub(super) struct Of<T> {
    pub of: usize,
    #[serde(flatten)]
    pub what: T,
}

#[derive(Serialize)]
pub(super) struct Attitudes {
    t: Vec<f64>,
    q: Vec<Short>,
}

impl Attitudes {
    /// Attitudes in these axes.
    pub(super) fn of(axes: Axes, fixes: impl IntoIterator<Item = (SimTime, Attitude)>) -> Attitudes {
        let mut it = Attitudes { t: Vec::new(), q: Vec::new() };
        for (t, attitude) in fixes {
            let q = axes.attitude_out(attitude);
            it.t.push(seconds(t));
            it.q.extend([q.w, q.x, q.y, q.z].map(Short));
        }
        it
    }
}

#[derive(Serialize)]
pub(super) struct Errors {
    t: Vec<f64>,
    inclination_deg: Vec<Short>,
    heading_deg: Vec<Short>,
}

impl Errors {
    /// Those of attitudes whose error is known; `None` where there are none.
    pub(super) fn of(fixes: &[Fix]) -> Option<Errors> {
        let known: Vec<_> = fixes.iter().filter_map(|fix| Some((fix.t, fix.error?))).collect();
        let deg = |of: fn(&crate::geometry::AttitudeError) -> f64| {
            known.iter().map(|(_, error)| Short(of(error).to_degrees())).collect()
        };
        (!known.is_empty()).then(|| Errors {
            t: known.iter().map(|(t, _)| seconds(*t)).collect(),
            inclination_deg: deg(|error| error.inclination),
            heading_deg: deg(|error| error.heading),
        })
    }
}

#[derive(Serialize)]
pub(super) struct Values {
    t: Vec<f64>,
    low: Vec<Vec<Short>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    high: Option<Vec<Vec<Short>>>,
    #[serde(rename = "true", skip_serializing_if = "Vec::is_empty")]
    truth: Vec<Vec<Short>>,
}

impl Values {
    /// A strip in the units that its kind is shown in.
    pub(super) fn of(kind: SensorKind, strip: &Strip) -> Values {
        let columns = shown(kind);
        let scaled = |values: &[Vec<f64>]| -> Vec<Vec<Short>> {
            let pairs = values.iter().zip(&columns);
            pairs
                .map(|(column, shown)| column.iter().map(|value| Short((shown.of)(*value))).collect())
                .collect()
        };
        Values {
            t: strip.t.iter().map(|t| seconds(*t)).collect(),
            low: scaled(&strip.low),
            high: strip.is_thinned().then(|| scaled(&strip.high)),
            truth: scaled(&strip.truth),
        }
    }
}

#[derive(Serialize)]
pub(super) struct Rates {
    t: Vec<f64>,
    hz: Vec<Option<Short>>,
}

impl Rates {
    /// From times and rates.
    pub(super) fn of(points: impl IntoIterator<Item = (SimTime, Option<f64>)>) -> Rates {
        let (t, hz) = points.into_iter().map(|(t, hz)| (seconds(t), hz.map(Short))).unzip();
        Rates { t, hz }
    }
}

#[derive(Serialize)]
pub(super) struct Late {
    t: Vec<f64>,
    p50_us: Vec<Short>,
    p99_us: Vec<Short>,
    max_us: Vec<Short>,
}

impl Late {
    /// From points.
    pub(super) fn of(points: &[Point]) -> Late {
        let us = |of: fn(&Point) -> f64| points.iter().map(|point| Short(of(point))).collect();
        Late {
            t: points.iter().map(|point| seconds(point.t)).collect(),
            p50_us: us(|point| point.p50_us),
            p99_us: us(|point| point.p99_us),
            max_us: us(|point| point.max_us),
        }
    }
}

#[derive(Serialize)]
pub(super) struct LateHistogram {
    edges_us: Vec<Short>,
    counts: Vec<Of<Counts>>,
}

#[derive(Serialize)]
struct Counts {
    n: Vec<u64>,
}

impl LateHistogram {
    /// Of every sensor that was sent; `None` where none was.
    pub(super) fn of(sensors: &[Lateness]) -> Option<LateHistogram> {
        let counts = sensors.iter().enumerate().filter(|(_, it)| it.all.count() > 0);
        let counts: Vec<_> =
            counts.map(|(of, it)| Of { of, what: Counts { n: it.all.counts().to_vec() } }).collect();
        let edges_us = || Bins::edges_us().into_iter().map(Short).collect();
        (!counts.is_empty()).then(|| LateHistogram { edges_us: edges_us(), counts })
    }
}

/// A link's counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Link {
    /// Packets that it took, or that came over it.
    pub packets: u64,
    /// Bytes in them.
    pub bytes: u64,
    /// Packets that it did not take, or that were lost on it.
    pub dropped: u64,
    /// Packets that wait for it.
    pub queued: Option<u64>,
    /// Bytes that came back.
    pub received_bytes: Option<u64>,
    /// Damaged packets that came.
    pub damaged: Option<u64>,
}

/// Something that the user should know, and when it was told.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Notice {
    /// Scene time, s; `None` before the scene.
    pub t: Option<f64>,
    /// What it says.
    pub text: String,
}
