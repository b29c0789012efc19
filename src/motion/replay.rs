//! Replays a recorded log of attitude or angular rate.
//!
//! An attitude log matches exactly at its rows, with continuous angular rate and angular acceleration between them
//! ([`attitude`]). A rate log is interpolated smoothly and integrated ([`rate`]). Missing rows, jumps ([`survey`])
//! and skipped rows are reported. The log is in the scene's axes. Its first row is the motion's start; after its
//! last row the vehicle holds.

mod attitude;
mod columns;
mod grid;
mod log;
mod rate;
mod survey;

use super::{Built, Context, MotionKind};
use crate::geometry::{Attitude, Axes, Euler};
use crate::keys::{Columns, KeyError, Name, Text, Values};
use crate::quantity::Kind;
use crate::table::Table;
use attitude::AttitudeLog;
use columns::Turns;
use glam::{DQuat, DVec3};
use log::Log;
use rate::RateLog;

const FILE: Name<Text> = Name::new("file");
const TIME: Name<Columns> = Name::new("time");
const RATE: Name<f64> = Name::new("rate");
const QUATERNION: Name<Columns> = Name::new("quaternion");
const EULER: Name<Columns> = Name::new("euler");
const ANGULAR_RATE: Name<Columns> = Name::new("angular_rate");
const ALIGN: Name<&str> = Name::new("align");

pub(super) static KIND: MotionKind = MotionKind {
    name: "replay",
    about: "plays a recorded log of attitude or angular rate, in the scene's axes",
    keys: &[
        FILE.file(
            "the log: columns under a header, separated by commas, semicolons, tabs or spaces, or a TUM trajectory; lines that start with # are comments",
        ),
        TIME.columns(
            1,
            Some(Kind::TIME),
            "its time column by name or by number from 1 (default: t_ns, t_s, time, timestamp, …)",
        ),
        RATE.scalar(Kind::RATE, "or instead the row rate, for a log without a time column"),
        QUATERNION.columns(
            4,
            None,
            "its attitude columns, w first, body to nav (default: qw, qx, qy, qz, q_RS_w, …, q[0], …)",
        ),
        EULER.columns(
            3,
            Some(Kind::ANGLE),
            "or instead roll, pitch, yaw (default: roll_rad, …, roll [deg], …)",
        ),
        ANGULAR_RATE.columns(
            3,
            Some(Kind::ANGULAR_RATE),
            "or instead angular rate about body x, y, z (default: wx_rad_s, …, x_rad_s, …, w_RS_S_x [rad s^-1], …)",
        ),
        ALIGN.word(
            &["none", "start"],
            "whether an attitude log plays as logged, or is rotated as a whole to start at the vehicle's attitude",
        ),
    ],
    has_length: true,
    build,
};

/// An attitude log that starts closer than this (rad) to the vehicle's attitude starts exactly there.
const AGREE: f64 = 1e-6;

fn build(values: &Values, context: &Context) -> Built {
    let Some(file) = values.get(FILE) else {
        return Err(KeyError::new("kind", "`replay` needs a `file`, such as file = \"log.csv\""));
    };
    let table = Table::open(&file.name, file.contents.as_bytes()).map_err(columns::at(FILE))?;
    let mut warnings = Vec::new();
    let when = columns::when(&table, values)?;
    let turns = columns::turns(&table, values, &mut warnings)?;
    let is_zero = |q: &[f64; 4]| quaternion(*q).length() < 1e-9;
    match turns {
        Turns::Quaternion(columns) => {
            let log = Log::read(table, &when, (columns, 1.0), is_zero)?;
            attitudes(log, context, values, warnings, quaternion)
        }
        Turns::Euler(columns, unit) => {
            let log = Log::read(table, &when, (columns, unit), |_| false)?;
            attitudes(log, context, values, warnings, euler)
        }
        Turns::Rate(columns, unit) => {
            rates(Log::read(table, &when, (columns, unit), |_| false)?, context, warnings)
        }
    }
}

/// From a row to a quaternion of any length.
type ToQuat<const N: usize> = fn([f64; N]) -> DQuat;

fn quaternion([w, x, y, z]: [f64; 4]) -> DQuat {
    DQuat::from_xyzw(x, y, z, w)
}

fn euler([roll, pitch, yaw]: [f64; 3]) -> DQuat {
    Euler { roll, pitch, yaw }.to_quat()
}

fn attitudes<const N: usize>(
    log: Log<N>,
    context: &Context,
    values: &Values,
    mut warnings: Vec<String>,
    to_quat: ToQuat<N>,
) -> Built {
    warnings.extend_from_slice(&log.warnings);
    let mut knots = unit_quaternions(&log, context.axes, to_quat, &mut warnings)?;
    let first = Attitude::from_quat(knots[0]);
    let aligned = values.get(ALIGN) == Some("start");
    let apart = first.angle_to(context.start);
    if aligned {
        let turn = context.start.q * first.q.conjugate();
        knots.iter_mut().for_each(|q| *q = (turn * *q).normalize());
    } else if !context.anywhere && apart > AGREE {
        let q = context.axes.attitude_out(first);
        return Err(KeyError::new(
            FILE,
            format!(
                "{} starts {:.6} deg from the vehicle's attitude: set [start] quaternion = [{}, {}, {}, {}], or add align = \"start\" to rotate the log",
                log.place(0),
                apart.to_degrees(),
                q.w,
                q.x,
                q.y,
                q.z
            ),
        ));
    }
    // Choose the sign of each attitude so that it is continuous in time, starting from the vehicle's.
    let mut last = if context.anywhere && !aligned { knots[0] } else { context.start.q };
    for q in &mut knots {
        *q = if q.dot(last) < 0.0 { -*q } else { *q };
        last = *q;
    }
    warnings.extend(survey::gaps(&log));
    warnings.extend(survey::attitude_jumps(&log, &knots));
    Ok(Box::new(AttitudeLog::new(log.grid, &knots, !aligned, warnings)))
}

/// Every row's attitude in the program's own axes, of unit length.
fn unit_quaternions<const N: usize>(
    log: &Log<N>,
    axes: Axes,
    to_quat: ToQuat<N>,
    warnings: &mut Vec<String>,
) -> Result<Vec<DQuat>, KeyError> {
    let (mut null, mut odd) = (Vec::new(), Vec::new());
    let mut knots = Vec::with_capacity(log.rows.len());
    for (row, values) in log.rows.iter().enumerate() {
        let q = to_quat(*values);
        let length = q.length();
        if length < 1e-6 {
            null.push(format!("{}: a quaternion of length {length} is not an attitude", log.place(row)));
        } else if (length - 1.0).abs() > 1e-3 {
            odd.push(format!(
                "{}: the quaternion has length {length:.4}, not 1; it is normalised",
                log.place(row)
            ));
        }
        knots.push(axes.attitude_in(q / length).q.normalize());
    }
    warnings.extend(survey::some_of(odd));
    match log::first_of(null) {
        Some(message) => Err(KeyError::new(FILE, message)),
        None => Ok(knots),
    }
}

fn rates(log: Log<3>, context: &Context, mut warnings: Vec<String>) -> Built {
    let rates: Vec<DVec3> =
        log.rows.iter().map(|row| context.axes.body_in(DVec3::from_array(*row)).v).collect();
    warnings.extend_from_slice(&log.warnings);
    warnings.extend(survey::gaps(&log));
    warnings.extend(survey::rate_jumps(&log, &rates));
    let place = log.place(0);
    match RateLog::new(log.grid, &rates, warnings) {
        Some(motion) => Ok(Box::new(motion)),
        None => Err(KeyError::new(
            FILE,
            format!(
                "{place} and on: this log is too long or turns too fast to solve exactly (four million steps): cut it into several"
            ),
        )),
    }
}

#[cfg(test)]
mod tests;
