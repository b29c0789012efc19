//! The tables of a dataset: their columns, and a row of each in the scene's axes.

use crate::geometry::{Attitude, Axes, Body, Euler, Vector};
use crate::motion::Truth;
use crate::scene::Plan;
use crate::sensor::{Fix, Measured, Measurement, Reading, SensorKind, Shape};

/// A column: its name, which ends in its unit, and the unit by itself.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Column {
    /// Such as `wx_rad_s`.
    pub name: String,
    /// Such as `rad/s`; `1` where there is none.
    pub unit: &'static str,
}

/// A table: `t_ns`, a whole number, then columns of doubles.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Table {
    /// The stem of its file's name.
    pub name: &'static str,
    /// Its columns, `t_ns` first.
    pub columns: Vec<Column>,
}

/// The index of the truth's table; the sensors' follow in the plan's order.
pub(super) const TRUTH: usize = 0;

const QUATERNION: [(&str, &str); 4] = [("qw", "1"), ("qx", "1"), ("qy", "1"), ("qz", "1")];
/// Of a pressure; what follows from it comes before the temperature.
const PRESSURE: [(&str, &str); 3] = [("pressure_pa", "Pa"), ("true_pressure_pa", "Pa"), ("bias_pa", "Pa")];
const TEMPERATURE: (&str, &str) = ("temperature_degc", "degC");
/// A receiver's fix: position, then velocity north, east and down, whatever the scene's axes.
const FIX: [(&str, &str); 6] = [
    ("lat_deg", "deg"),
    ("lon_deg", "deg"),
    ("alt_m", "m"),
    ("vn_m_s", "m/s"),
    ("ve_m_s", "m/s"),
    ("vd_m_s", "m/s"),
];
const EULER: [(&str, &str); 3] = [("roll_rad", "rad"), ("pitch_rad", "rad"), ("yaw_rad", "rad")];

/// The tables of a plan, the reference behind the sensors where there is one, the estimate's last where there is one.
pub(super) fn of(plan: &Plan, estimate: bool) -> Vec<Table> {
    let mut tables = vec![truth_table()];
    tables.extend(plan.sensors.iter().map(|sensor| sensor_table(sensor.kind)));
    if plan.reference.is_some() {
        tables.push(table("reference", QUATERNION.map(column).into_iter().chain(EULER.map(column))));
    }
    if estimate {
        tables.push(table("estimate", QUATERNION.map(column)));
    }
    tables
}

fn truth_table() -> Table {
    let sensed = [("w", SensorKind::Gyro), ("f", SensorKind::Accel), ("m", SensorKind::Mag)];
    let sensed = sensed.into_iter().flat_map(|(letter, kind)| triple(letter, kind));
    table("truth", QUATERNION.map(column).into_iter().chain(EULER.map(column)).chain(sensed))
}

fn sensor_table(kind: SensorKind) -> Table {
    let columns: Vec<Column> = match kind.shape() {
        Shape::Pressure => {
            let derived = kind.row().table.derived.iter().map(|derived| (derived.column, derived.unit));
            PRESSURE.into_iter().chain(derived).chain([TEMPERATURE]).map(column).collect()
        }
        Shape::Position => ["", "true_"]
            .into_iter()
            .flat_map(|prefix| FIX.map(|(of, unit)| Column { name: format!("{prefix}{of}"), unit }))
            .collect(),
        Shape::Triad => ["", "true_", "bias_"].into_iter().flat_map(|prefix| triple(prefix, kind)).collect(),
    };
    table(kind.name(), columns)
}

fn table(name: &'static str, columns: impl IntoIterator<Item = Column>) -> Table {
    Table { name, columns: std::iter::once(column(("t_ns", "ns"))).chain(columns).collect() }
}

fn column((name, unit): (&str, &'static str)) -> Column {
    Column { name: name.to_string(), unit }
}

fn triple(prefix: &str, kind: SensorKind) -> [Column; 3] {
    ["x", "y", "z"]
        .map(|axis| Column { name: format!("{prefix}{axis}_{}", kind.column_unit()), unit: kind.unit() })
}

/// A row of the truth after `t_ns`.
pub(super) fn truth(axes: Axes, truth: &Truth) -> [f64; 16] {
    let q = axes.attitude_out(truth.attitude);
    let Euler { roll, pitch, yaw } = Euler::from_quat(q);
    let vector = |v| axes.body_out(v).to_array();
    let ([wx, wy, wz], [fx, fy, fz], [mx, my, mz]) =
        (vector(truth.rate), vector(truth.force), vector(truth.field));
    [q.w, q.x, q.y, q.z, roll, pitch, yaw, wx, wy, wz, fx, fy, fz, mx, my, mz]
}

/// A row of the reference after `t_ns`.
pub(super) fn reference(axes: Axes, attitude: Attitude) -> [f64; 7] {
    let q = axes.attitude_out(attitude);
    let Euler { roll, pitch, yaw } = Euler::from_quat(q);
    [q.w, q.x, q.y, q.z, roll, pitch, yaw]
}

/// A row of a sensor after `t_ns`: as many numbers as its table has columns.
pub(super) struct Row {
    values: [f64; 12],
    len: usize,
}

impl Row {
    fn of(numbers: impl IntoIterator<Item = f64>) -> Row {
        let mut row = Row { values: [0.0; 12], len: 0 };
        for number in numbers {
            row.values[row.len] = number;
            row.len += 1;
        }
        row
    }

    /// Its numbers.
    pub fn values(&self) -> &[f64] {
        &self.values[..self.len]
    }
}

/// A row of a sensor after `t_ns`.
pub(super) fn reading(axes: Axes, reading: &Reading) -> Row {
    match &reading.measurement {
        Measurement::Triad(Measured { value, truth, bias }) => {
            let [[x, y, z], [tx, ty, tz], [bx, by, bz]] =
                [value, truth, bias].map(|v: &Vector<Body>| axes.body_out(*v).to_array());
            Row { values: [x, y, z, tx, ty, tz, bx, by, bz, 0.0, 0.0, 0.0], len: 9 }
        }
        Measurement::Pressure(Measured { value, truth, bias }) => {
            let derived = reading.kind.row().table.derived.as_ref().map(|derived| (derived.of)(*value));
            Row::of([*value, *truth, *bias].into_iter().chain(derived).chain([reading.temperature]))
        }
        Measurement::Position(position) => {
            Row::of([position.fix, position.true_fix].map(fix).into_iter().flatten())
        }
    }
}

fn fix(Fix { position, velocity }: Fix) -> [f64; 6] {
    let [vn, ve, vd] = velocity.v.to_array();
    [position.latitude.to_degrees(), position.longitude.to_degrees(), position.altitude, vn, ve, vd]
}

/// A row of the estimate after `t_ns`.
pub(super) fn quaternion(axes: Axes, attitude: Attitude) -> [f64; 4] {
    let q = axes.attitude_out(attitude);
    [q.w, q.x, q.y, q.z]
}
