//! Text files: a TUM trajectory, which has no header, and any other table, with columns found by name.

use super::{FileError, READER, Reading, Recorded, no_rotation};
use crate::geometry::{Axes, Euler};
use crate::score::Packed;
use crate::table::{Attitudes, Choice, Clock, Flaw, Series, Set, Table, Wanted};
use glam::DQuat;
use std::io::BufRead;

pub(super) fn read<R: BufRead>(name: &str, reader: R, reading: &Reading) -> Result<Recorded, FileError> {
    let table = Table::open(name, reader)?;
    let choice = choice(&table, &reading.columns)?;
    let (clock, attitudes) = match (table.clock(&choice)?, table.attitude(&choice)?) {
        (Some(clock), Some(attitudes)) => (clock, attitudes),
        (clock, attitudes) => return Err(lacking(&table, clock.is_some(), attitudes.is_some())),
    };
    let time_name = match clock {
        Clock::Column { time, .. } => table.called(time.column),
        Clock::Rate(_) => "rate".into(),
    };
    let axes = reading.axes;
    let mut remarks = Vec::new();
    match attitudes {
        Attitudes::Quaternion(set) => {
            tell_others(&table, &set, &mut remarks);
            let make = |[w, x, y, z]: &[f64; 4]| match DQuat::from_xyzw(*x, *y, *z, *w) {
                q if q.length() < 1e-9 => Err(Flaw::Zero),
                q => match no_rotation(q) {
                    None => Ok(Packed::new(axes.attitude_in(q.normalize()).q)),
                    Some(why) => Err(Flaw::Wrong(why)),
                },
            };
            let series = table.read(&Wanted::new(clock, set.columns), make)?;
            let recorded = recorded(name, series, remarks)?;
            Ok(Recorded { time_name, axes, ..recorded })
        }
        Attitudes::Euler(set) => {
            let unit = unit_of_angles(&table, &set, &mut remarks)?;
            tell_others(&table, &set, &mut remarks);
            let mut series = table.read(&Wanted::new(clock, set.columns), |angles| Ok(*angles))?;
            let angles = std::mem::take(&mut series.values);
            let all = |unit: f64| angles.iter().map(|angles| euler(angles, unit, axes)).collect::<Vec<_>>();
            let others = match unit {
                1.0 => vec![("in degrees read as radians", all(1f64.to_radians()))],
                _ => Vec::new(),
            };
            let series = series.with(all(unit));
            let recorded = recorded(name, series, remarks)?;
            Ok(Recorded { time_name, axes, others, ..recorded })
        }
    }
}

/// Makes the result from a series; its axes are not set yet.
fn recorded(name: &str, series: Series<Packed>, mut remarks: Vec<String>) -> Result<Recorded, FileError> {
    let told = series.rows.told();
    if series.values.is_empty() {
        return Err(FileError::Content(match told {
            Some(told) => format!("{name} has no usable row: {told}"),
            None => format!("{name} has a header and no rows"),
        }));
    }
    remarks.extend(told);
    remarks.extend(series.remarks);
    if let Some(first) = series.times.breaks.first() {
        let more = series.times.breaks.len() - 1;
        let more = if more > 0 { format!(" (and {more} more times)") } else { String::new() };
        let line = series.lines[*first];
        remarks.push(format!("its clock steps back at line {line} and continues from there{more}"));
    }
    Ok(Recorded {
        attitudes: series.values,
        times: series.times,
        time_name: String::new(),
        axes: Axes::default(),
        others: Vec::new(),
        remarks,
        rows: series.rows,
    })
}

fn euler([roll, pitch, yaw]: &[f64; 3], unit: f64, axes: Axes) -> Packed {
    let angles = Euler { roll: roll * unit, pitch: pitch * unit, yaw: yaw * unit };
    Packed::new(axes.attitude_in(angles.to_quat().normalize()).q)
}

/// The part of the user's choice that applies to this table: columns with these names, and all of it if the table's
/// own names identify nothing.
fn choice<R: BufRead>(table: &Table<R>, given: &Choice) -> Result<Choice, FileError> {
    let own = Choice::default();
    let has = |names: &[String]| names.iter().all(|name| table.has(name));
    let knows_time = table.clock(&own)?.is_some();
    let knows_attitude = table.attitude(&own)?.is_some();
    let time = given.time.clone().filter(|name| !knows_time || has(std::slice::from_ref(name)));
    Ok(Choice {
        rate: given.rate.filter(|_| !knows_time && time.is_none()),
        time_unit: given.time_unit.filter(|_| time.is_some()),
        time,
        quaternion: given.quaternion.clone().filter(|names| !knows_attitude || has(names)),
        euler: given.euler.clone().filter(|(names, _)| !knows_attitude || has(names)),
    })
}

/// The size of the unit of angles, rad.
fn unit_of_angles<R>(table: &Table<R>, set: &Set<3>, remarks: &mut Vec<String>) -> Result<f64, FileError>
where
    R: BufRead,
{
    if let Some((what, unit)) = set.by_kind.zip(set.unit) {
        let unit = if unit == 1.0 { "rad" } else { "deg" };
        remarks.push(format!("its angles are read as {unit}: {what}"));
    }
    let [roll, pitch, yaw] = set.columns.map(|column| table.called(column));
    set.unit.ok_or_else(|| {
        FileError::Content(format!(
            "{}: {roll}, {pitch} and {yaw} have no unit: call them roll_deg, pitch_deg, yaw_deg or roll_rad, …, or write --euler {roll},{pitch},{yaw}:deg",
            table.place()
        ))
    })
}

/// Reports that other columns were possible.
fn tell_others<R: BufRead, const N: usize>(table: &Table<R>, set: &Set<N>, remarks: &mut Vec<String>) {
    if !set.others.is_empty() {
        let (first, others) = (table.called(set.columns[0]), set.others.join(", "));
        remarks
            .push(format!("its attitude is read from the columns of `{first}`, not from those of {others}"));
    }
}

/// What a table lacks, and how to name the columns.
fn lacking<R: BufRead>(table: &Table<R>, has_time: bool, has_attitude: bool) -> FileError {
    if let Some(kind) = table.kind() {
        let name = table.place();
        let name = name.rsplit_once(':').map_or(name.as_str(), |(name, _)| name);
        return FileError::Content(kind.refusal(name, READER));
    }
    let (place, told) = (table.place(), table.told());
    let choose = "or choose them by name or number from 1 with --time and --quaternion or --euler";
    FileError::Content(match (has_time, has_attitude) {
        _ if !table.is_headed() => format!(
            "{place}: is a row of numbers, not the header that a table starts with: t_s, qw, qx, qy, qz, or roll_deg, pitch_deg, yaw_deg; write one, {choose}"
        ),
        (true, _) => format!(
            "{place}: has no attitude: qw, qx, qy, qz or roll_deg, pitch_deg, yaw_deg (or …_rad); {told}; choose some by name or number from 1 with --quaternion or --euler"
        ),
        (false, true) => format!(
            "{place}: has no time: t_ns, t_us, t_ms, t_s, time or timestamp; {told}; choose one by name or number from 1 with --time, or give --rate"
        ),
        (false, false) => format!(
            "{place}: has neither time nor attitude: t_ns or t_s, and qw, qx, qy, qz or roll_deg, pitch_deg, yaw_deg; {told}; {choose}"
        ),
    })
}
