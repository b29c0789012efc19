//! `README.md`: everything a reader of the numbers would otherwise have to ask.

use super::conventions::{at_rest, conventions, triple};
use super::formats::FORMATS;
use super::kalibr;
use super::manifest::{self, FileEntry};
use super::reference::Quality;
use crate::geometry::Axes;
use crate::scene::Plan;
use crate::sensor::{SensorKind, SensorPlan, Shape};
use std::fmt::Write;

/// The whole text.
pub(super) fn text(plan: &Plan, files: &[FileEntry], quality: Option<&Quality>) -> String {
    let sections = [
        heading(plan),
        conventions_section(plan),
        field_section(plan),
        files_section(plan, files),
        quality.map_or(String::new(), reference_section),
        readings_section(plan),
        formats_section(files),
        loading_section(plan, files),
        matlab_section(plan.axes, files),
    ];
    sections.into_iter().filter(|section| !section.is_empty()).collect::<Vec<_>>().join("\n")
}

fn heading(plan: &Plan) -> String {
    let (name, axes, seed, version) = (&plan.name, plan.axes, plan.seed, env!("CARGO_PKG_VERSION"));
    format!(
        "# Dataset `{name}`

Simulated sensor readings with their exact truth, in the axes **{axes}**; seed {seed}, ratetable {version}.

**Level at rest the accelerometer reads `{}` m/s²** (specific force, acceleration minus gravity).

`scene.toml` is the whole input, every default and drawn value filled in: `ratetable generate scene.toml --out DIR`
gives these files again, byte for byte. `manifest.json` says the same as this page to programs, with checksums.
",
        at_rest(plan)
    )
}

fn conventions_section(plan: &Plan) -> String {
    let mut text = String::from("## Conventions\n\n");
    for (subject, meaning) in conventions(plan) {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "- {}: {meaning}", subject.replace('_', " "));
    }
    text
}

fn field_section(plan: &Plan) -> String {
    let field = plan.trajectory.field();
    let nav = triple(plan.axes.nav_out(field));
    let horizontal = libm::hypot(field.v.x, field.v.y);
    let mut text =
        format!("## Magnetic field\n\nIn nav axes `{nav}` uT, the same everywhere in this dataset. ");
    if horizontal > 0.0 {
        let declination = libm::atan2(field.v.y, field.v.x).to_degrees();
        let dip = libm::atan2(field.v.z, horizontal).to_degrees();
        let _ = writeln!(
            text,
            "Its declination is {declination:.4}° (east positive) and it dips {dip:.4}° below the horizon. The \
             attitudes of `truth.csv` are relative to **true** north: a filter that takes the magnetometer's \
             north for true north is off by the declination."
        );
    } else {
        text.push_str("It has no horizontal part, so it says nothing of heading.\n");
    }
    text
}

fn files_section(plan: &Plan, files: &[FileEntry]) -> String {
    let mut text = String::from("## Files\n\n| file | rows | columns |\n|---|---|---|\n");
    for file in files {
        let columns: Vec<_> = file.columns.iter().map(|column| column.name.as_str()).collect();
        let columns = if columns.is_empty() { "messages".into() } else { format!("`{}`", columns.join(",")) };
        let _ = writeln!(text, "| `{}` | {} | {columns} |", file.name, file.rows);
    }
    text.push_str(
        "
- `truth`: the exact attitude, angular rate, specific force and magnetic field, without any sensor's errors, at
  every time at which any sensor has a sample.
- a sensor's table: what it reads (`x`, `y`, `z`); the error-free reading (`true_`), sampled as the reading is; and
  the bias in effect (`bias_`). All in the scene's body axes, however the part is mounted.
- Numbers written as text are in the shortest form that reads back to the same double.
",
    );
    for kind in plan.sensors.iter().map(|sensor| sensor.kind) {
        if let Some(note) = kind.row().table.note {
            let _ = writeln!(text, "- `{kind}`: {note}");
        }
    }
    if kalibr::text(plan).is_some() {
        text.push_str("- `imu.yaml`: white noise and bias random walk of gyroscope and accelerometer as Kalibr takes them.\n");
    }
    for file in &plan.attached {
        let _ = writeln!(text, "- `{}`: a log that the scene's motion replays, as it was read.", file.name);
    }
    text
}

fn reference_section(quality: &Quality) -> String {
    let Quality { from, method, rate_hz, chosen, error_deg, norm_error } = quality;
    let why = chosen.as_ref().map_or(String::new(), |why| format!(" Method and rate were chosen: {why}."));
    let how = match *from {
        "gyro" => format!(
            "integrated by the method `{method}` from an error-free gyroscope of {rate_hz} Hz from t = 0 (a method of \
             several increments a step has a row a step)"
        ),
        _ => format!(
            "computed (`{method}`) from an error-free accelerometer and magnetometer, external forces and the \
             motion's own acceleration excluded, at the accelerometer's rate from t = 0"
        ),
    };
    format!(
        "## Reference

`reference.csv` is attitude as a program without the truth would compute it: {how}.{why} It is normalised, in the same
axes and conventions as `truth.csv`. **`truth.csv` is exact**: judge estimates by it.

Against the truth the reference is off by {:.3e}° RMS, {:.3e}° at most, {:.3e}° at the end; before normalising, its norm
is off 1 by {norm_error:.3e} at the end.
",
        error_deg.rms, error_deg.max, error_deg.last
    )
}

fn readings_section(plan: &Plan) -> String {
    let mut text = String::from("## Sensors\n\n");
    for sensor in &plan.sensors {
        let _ = writeln!(text, "- {}", describe(sensor));
    }
    if plan.drawn.is_empty() {
        text.push_str("\nNo value of the scene was drawn at random besides the noise itself.\n");
    } else {
        text.push_str("\nDrawn once for this run:\n\n");
        for drawn in &plan.drawn {
            let _ = writeln!(text, "- `{}` = {}", drawn.key, drawn.value);
        }
    }
    text
}

fn describe(sensor: &SensorPlan) -> String {
    let sampling = match manifest::sampling_name(sensor.sampling) {
        "average" => "averaged: each sample is the mean over the interval that ends at its time",
        _ => "point: each sample is the value at its time",
    };
    let part = sensor.part.map_or(String::new(), |part| format!(", values of the part {part}"));
    format!("{}: {}, sampling {sampling}{part}", sensor.kind, sensor.rate)
}

fn has(files: &[FileEntry], format: &str) -> bool {
    files.iter().any(|file| file.format == format)
}

/// What the formats besides CSV hold.
fn formats_section(files: &[FileEntry]) -> String {
    let others = FORMATS.iter().filter(|format| format.name != "csv" && has(files, format.name));
    let lines: Vec<_> = others.map(|format| format!("- {}: {}\n", format.name, format.about)).collect();
    if lines.is_empty() {
        return String::new();
    }
    let has_seconds = |file: &FileEntry| file.columns.iter().any(|column| column.name == "t_s");
    let seconds = match files.iter().any(has_seconds) {
        true => "Besides CSV a table has `t_s` behind `t_ns`: the time in seconds.\n",
        false => "",
    };
    format!("## Formats\n\n{}\n{seconds}", lines.concat())
}

fn loading_section(plan: &Plan, files: &[FileEntry]) -> String {
    let load = match (has(files, "csv"), has(files, "npy")) {
        (true, _) => "np.genfromtxt(name + \".csv\", delimiter=\",\", names=True)",
        (_, true) => "np.load(name + \".npy\")",
        _ => return String::new(),
    };
    let mut text = format!(
        "## Loading

Python with numpy:

```python
import numpy as np

def load(name):
    return {load}

def xyz(table):
    return np.column_stack([table[c] for c in table.dtype.names if c[:2] in (\"x_\", \"y_\", \"z_\")])

truth = load(\"truth\")
q = np.column_stack([truth[c] for c in (\"qw\", \"qx\", \"qy\", \"qz\")])
"
    );
    for kind in plan.sensors.iter().map(|sensor| sensor.kind) {
        let readings = match kind.shape() {
            Shape::Pressure => format!("{kind}[\"pressure_pa\"]"),
            Shape::Position => format!("{kind}[\"lat_deg\"], {kind}[\"lon_deg\"], {kind}[\"alt_m\"]"),
            Shape::Triad => format!("xyz({kind})"),
        };
        let _ = writeln!(text, "{kind} = load(\"{kind}\")    # times {kind}[\"t_ns\"], readings {readings}");
    }
    text.push_str("```\n");
    text.push_str(&ahrs(plan));
    text
}

/// For a scene with all three sensors, a filter of the Python package `ahrs` on the numbers loaded above.
fn ahrs(plan: &Plan) -> String {
    let [Some(gyro), Some(_), Some(_)] =
        SensorKind::TRIADS.map(|kind| plan.sensors.iter().find(|sensor| sensor.kind == kind))
    else {
        return String::new();
    };
    let rate = gyro.rate.as_hz();
    // Which filter of the package takes and gives which axes is not in its manual; these two were tried.
    let (filter, sign, note) = match plan.axes {
        Axes::EnuFlu => ("Mahony", "", ""),
        Axes::NedFrd => {
            ("Madgwick", "-", " Like MATLAB it wants the\naccelerometer's other sign in North-East-Down.")
        }
    };
    format!(
        "
The Python package `ahrs` (0.4), continuing. Accelerometer and magnetometer hold their latest sample at the
gyroscope's times; the estimate is in this dataset's axes, its heading relative to magnetic north.{note}

```python
from ahrs.filters import {filter}

def held(table):
    index = np.searchsorted(table[\"t_ns\"], gyro[\"t_ns\"], side=\"right\") - 1
    return xyz(table)[np.maximum(index, 0)]

estimate = {filter}(gyr=xyz(gyro), acc={sign}held(accel), mag=held(mag), frequency={rate:?}).Q
```
"
    )
}

fn matlab_section(axes: Axes, files: &[FileEntry]) -> String {
    let load = match (has(files, "csv"), has(files, "mat")) {
        (true, _) => {
            "gyro = readtable('gyro.csv');  gyr = gyro{:, 2:4};  t = gyro.t_ns * 1e-9;
accel = readtable('accel.csv'); acc = accel{:, 2:4};
magnetometer = readtable('mag.csv'); mag = magnetometer{:, 2:4};
truth = readtable('truth.csv'); q = quaternion(truth{:, 2:5});   % rotatepoint(q, v) takes body vectors to nav"
        }
        (_, true) => {
            "gyro = load('gyro.mat');  gyr = [gyro.x_rad_s gyro.y_rad_s gyro.z_rad_s];  t = gyro.t_s;
accel = load('accel.mat'); acc = [accel.x_m_s2 accel.y_m_s2 accel.z_m_s2];
magnetometer = load('mag.mat'); mag = [magnetometer.x_ut magnetometer.y_ut magnetometer.z_ut];
truth = load('truth.mat'); q = quaternion(truth.qw, truth.qx, truth.qy, truth.qz);   % rotatepoint(q, v): body to nav"
        }
        _ => return String::new(),
    };
    let turn = match axes {
        Axes::NedFrd => "accNED = -acc;                        % the whole accelerometer changes its sign",
        Axes::EnuFlu => {
            "gyrNED = gyr .* [1 -1 -1];            % Forward-Left-Up to Forward-Right-Down
magNED = mag .* [1 -1 -1];
accNED = -(acc .* [1 -1 -1]);         % the same turn, then the whole accelerometer changes its sign"
        }
    };
    format!(
        "MATLAB (a sensor that the scene lacks has no file):

```matlab
{load}
```

MATLAB's `imuSensor` in NED, and the filters made for it, report gravity minus acceleration: +9.81 at rest, the
opposite sign of specific force. To convert, negate the whole accelerometer:

```matlab
{turn}
```
"
    )
}
