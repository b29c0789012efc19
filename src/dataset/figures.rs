//! The four figures of the paper as plain series: three sensors with their truth, and the reference angles.
//!
//! However long a scene is, a line keeps a few thousand points: of every stretch of time as wide as a part of a pixel
//! its first, its last, its least and its greatest, which draw as all of them would.

use super::table;
use crate::geometry::Axes;
use crate::player::Moment;
use crate::scene::Plan;
use crate::sensor::{Measured, Measurement, Position, SensorKind, Shown};
use crate::time::SimTime;
use std::borrow::Cow;

/// Stretches of time that a line is kept by: twice the pixels of a chart's width.
const STRETCHES: i64 = 2000;

/// One figure, against time in seconds.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// Its file's name, without an extension.
    pub file_stem: &'static str,
    /// What it shows.
    pub title: &'static str,
    /// The quantity and unit of its vertical axis.
    pub y_label: &'static str,
    /// Its lines.
    pub series: Vec<Series>,
    /// Whether ±180 are the same value, so that a jump between them is no line.
    pub wraps: bool,
}

/// One line of a figure.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// Such as `x`.
    pub label: Cow<'static, str>,
    /// Time in s and value in the figure's unit: every sample of a short scene, of a long one those that show. Where
    /// samples are missing there is a NaN.
    pub points: Vec<(f64, f64)>,
    /// Whether it is free of errors.
    pub is_truth: bool,
}

/// Gathers the figures of a plan that is played once, in the scene's axes: one for each sensor that it has (gyroscope
/// in deg/s, accelerometer in m/s², magnetometer in µT, barometer in hPa, GPS in m north, east and down of the start;
/// the readings and the true ones), then the reference roll, pitch and yaw in degrees.
#[derive(Debug)]
pub struct Figures {
    axes: Axes,
    /// How long a stretch is, ns.
    width: i64,
    figures: Vec<Figure>,
    /// For each figure and line, the stretch at hand.
    stretches: Vec<Vec<Stretch>>,
    /// For each figure, the longest step that is no gap, ns, and when its newest point was.
    steps: Vec<(i64, Option<SimTime>)>,
}

/// Samples further apart than so many of their intervals leave a gap.
const GAP: f64 = 2.5;

impl Figures {
    /// Of a plan played from 0 up to `end`, with nothing in them yet.
    pub fn new(plan: &Plan, end: SimTime) -> Figures {
        let mut figures: Vec<_> = plan.sensors.iter().map(|sensor| of_sensor(sensor.kind)).collect();
        figures.push(of_angles());
        let empty = |figure: &Figure| vec![Stretch::default(); figure.series.len()];
        let stretches = figures.iter().map(empty).collect();
        let step = |hz: f64| ((GAP * 1e9 / hz) as i64, None);
        let steps = plan.sensors.iter().map(|sensor| step(sensor.rate.as_hz())).chain([(i64::MAX, None)]);
        Figures {
            axes: plan.axes,
            width: (end.0 / STRETCHES).max(1),
            steps: steps.collect(),
            figures,
            stretches,
        }
    }

    /// Takes in what is due at one time; times go forward.
    pub fn add(&mut self, moment: &Moment<'_>) {
        let truth = table::truth(self.axes, moment.truth);
        self.put(self.figures.len() - 1, moment.t, &truth[4..7], f64::to_degrees);
        for reading in moment.readings {
            let in_unit = reading.kind.row().shown.in_chart;
            match &reading.measurement {
                Measurement::Triad(_) => {
                    let row = table::reading(self.axes, reading);
                    self.put(reading.sensor, moment.t, &row.values()[..6], in_unit);
                }
                Measurement::Pressure(Measured { value, truth, .. }) => {
                    self.put(reading.sensor, moment.t, &[*value, *truth], in_unit);
                }
                Measurement::Position(Position { displacement: Measured { value, truth, .. }, .. }) => {
                    let values = [value.v, truth.v].map(|v| v.to_array()).concat();
                    self.put(reading.sensor, moment.t, &values, in_unit);
                }
            }
        }
    }

    fn put(&mut self, figure: usize, t: SimTime, values: &[f64], in_unit: fn(f64) -> f64) {
        let index = t.0 / self.width;
        let (longest, newest) = &mut self.steps[figure];
        let is_gap = newest.replace(t).is_some_and(|newest| (t - newest).0 > *longest);
        let lines = self.figures[figure].series.iter_mut().zip(&mut self.stretches[figure]);
        for ((series, stretch), value) in lines.zip(values) {
            if stretch.index != index || is_gap {
                stretch.flush(&mut series.points);
                stretch.index = index;
            }
            if is_gap {
                series.points.push((t.seconds(), f64::NAN));
            }
            stretch.add((t.seconds(), in_unit(*value)));
        }
    }

    /// What was gathered.
    pub fn done(mut self) -> Vec<Figure> {
        for (figure, stretches) in self.figures.iter_mut().zip(&mut self.stretches) {
            for (series, stretch) in figure.series.iter_mut().zip(stretches) {
                stretch.flush(&mut series.points);
            }
        }
        self.figures
    }
}

/// The points of one stretch of time that show: no more than four.
#[derive(Clone, Debug, Default)]
struct Stretch {
    index: i64,
    /// In order of time.
    points: Vec<(f64, f64)>,
}

impl Stretch {
    fn add(&mut self, point: (f64, f64)) {
        self.points.push(point);
        if self.points.len() > 4 {
            let by = |&a: &usize, &b: &usize| self.points[a].1.total_cmp(&self.points[b].1);
            let ends = [(0..5).min_by(by), (0..5).max_by(by)];
            // Between the first and the last are three, and two of them at most are an end.
            self.points.remove((1..4).find(|&i| !ends.contains(&Some(i))).unwrap_or(1));
        }
    }

    fn flush(&mut self, points: &mut Vec<(f64, f64)>) {
        points.append(&mut self.points);
    }
}

fn of_sensor(kind: SensorKind) -> Figure {
    let Shown { title, label, .. } = &kind.row().shown;
    let read = kind.axes().iter().map(|axis| line((*axis).into(), false));
    let truth = kind.axes().iter().map(|axis| line(format!("true {axis}").into(), true));
    let series = read.chain(truth).collect();
    Figure { file_stem: kind.name(), title, y_label: label, series, wraps: false }
}

fn of_angles() -> Figure {
    let series = ["roll", "pitch", "yaw"].map(|label| line(label.into(), true)).into();
    Figure { file_stem: "angles", title: "Reference angles", y_label: "angle (deg)", series, wraps: true }
}

fn line(label: Cow<'static, str>, is_truth: bool) -> Series {
    Series { label, points: Vec::new(), is_truth }
}
