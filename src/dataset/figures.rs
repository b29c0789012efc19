//! The four figures of the paper as plain series: three sensors with their truth, and the reference angles.

use super::table;
use crate::player::{self, Player};
use crate::scene::Plan;
use crate::sensor::SensorKind;
use crate::time::SimTime;
use std::convert::Infallible;

/// One figure, against time in seconds.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// What its file is to be called, without an ending.
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
    pub label: &'static str,
    /// Time in s and value in the figure's unit, every sample.
    pub points: Vec<(f64, f64)>,
    /// Whether it is free of errors.
    pub is_truth: bool,
}

/// Plays `plan` from 0 up to, not including, `end` and gathers its figures, in the scene's axes: one for each sensor
/// that it has (gyroscope in deg/s, accelerometer in m/s², magnetometer in µT, barometer in hPa, GPS in m north, east
/// and down of the start; the readings and the true ones), then the reference roll, pitch and yaw in degrees.
pub fn figures(plan: &Plan, end: SimTime) -> Vec<Figure> {
    let mut figures: Vec<_> = plan.sensors.iter().map(|sensor| of_sensor(sensor.kind)).collect();
    let mut angles = of_angles();
    let Ok(()) = Player::new(plan, end, player::BLOCK).play(|moment| {
        let t = moment.t.seconds();
        let truth = table::truth(plan.axes, moment.truth);
        angles.add(t, &truth[4..7], f64::to_degrees);
        for reading in moment.readings {
            let in_unit = match reading.kind {
                SensorKind::Gyro => f64::to_degrees,
                SensorKind::Baro => |pascals| pascals / 100.0,
                _ => |value| value,
            };
            let values = match reading.kind {
                SensorKind::Baro => vec![reading.value.v.x, reading.truth.v.x],
                SensorKind::Gps => [reading.value, reading.truth].map(|v| v.v.to_array()).concat(),
                _ => table::reading(plan.axes, reading).values()[..6].to_vec(),
            };
            figures[reading.sensor].add(t, &values, in_unit);
        }
        Ok::<(), Infallible>(())
    });
    figures.push(angles);
    figures
}

impl Figure {
    fn add(&mut self, t: f64, values: &[f64], in_unit: fn(f64) -> f64) {
        for (series, value) in self.series.iter_mut().zip(values) {
            series.points.push((t, in_unit(*value)));
        }
    }
}

fn of_sensor(kind: SensorKind) -> Figure {
    let (title, y_label) = match kind {
        SensorKind::Gyro => ("Gyroscope", "angular rate (deg/s)"),
        SensorKind::Accel => ("Accelerometer", "specific force (m/s²)"),
        SensorKind::Mag => ("Magnetometer", "magnetic field (µT)"),
        SensorKind::Baro => ("Barometer", "pressure (hPa)"),
        SensorKind::Gps => ("GPS position from the start", "displacement (m)"),
    };
    let (read, truth): (&[_], &[_]) = match kind {
        SensorKind::Baro => (&["pressure"], &["true pressure"]),
        SensorKind::Gps => (&["north", "east", "down"], &["true north", "true east", "true down"]),
        _ => (&["x", "y", "z"], &["true x", "true y", "true z"]),
    };
    let read = read.iter().map(|label| line(label, false));
    let series = read.chain(truth.iter().map(|label| line(label, true))).collect();
    Figure { file_stem: kind.name(), title, y_label, series, wraps: false }
}

fn of_angles() -> Figure {
    let series = ["roll", "pitch", "yaw"].map(|label| line(label, true)).into();
    Figure { file_stem: "angles", title: "Reference angles", y_label: "angle (deg)", series, wraps: true }
}

fn line(label: &'static str, is_truth: bool) -> Series {
    Series { label, points: Vec::new(), is_truth }
}
