//! Text: a TUM trajectory, which has no header, and any other table, whose columns are found by their names.

use super::{FileError, Recorded, no_rotation, timed};
use crate::geometry::{Attitude, Axes, Euler};
use glam::DQuat;

/// Names of the columns of a quaternion, w first.
const QUATERNIONS: [[&str; 4]; 5] = [
    ["qw", "qx", "qy", "qz"],
    ["q_w", "q_x", "q_y", "q_z"],
    ["q0", "q1", "q2", "q3"],
    ["q[0]", "q[1]", "q[2]", "q[3]"],
    ["w", "x", "y", "z"],
];
/// Names of Euler angles, and how many rad their unit is.
const EULERS: [([&str; 3], f64); 2] = [
    (["roll_rad", "pitch_rad", "yaw_rad"], 1.0),
    (["roll_deg", "pitch_deg", "yaw_deg"], std::f64::consts::PI / 180.0),
];
/// Names of a time, before its unit.
const TIMES: [&str; 3] = ["t", "time", "timestamp"];
/// Units of time and how many ns they are.
const UNITS: [(&str, f64); 4] = [("ns", 1.0), ("us", 1e3), ("ms", 1e6), ("s", 1e9)];
/// A trajectory's columns, and those of its quaternion.
const TUM_COLUMNS: usize = 8;
const TUM: [usize; 4] = [7, 4, 5, 6];
/// As many mistakes are listed.
const LISTED: usize = 5;

/// Where the attitude is in a row.
#[derive(Clone, Copy)]
enum Attitudes {
    /// Columns of w, x, y, z.
    Quaternion([usize; 4]),
    /// Columns of roll, pitch, yaw, and their unit in rad.
    Euler([usize; 3], f64),
}

/// What the columns of a table are.
struct Columns {
    names: Vec<String>,
    /// Whether it is a trajectory, whose columns have no names.
    is_tum: bool,
    time: usize,
    /// How many ns the unit of time is, where the name says so.
    unit: Option<f64>,
    attitudes: Attitudes,
}

/// One row as numbers, with its line.
struct Row {
    line: usize,
    values: Vec<f64>,
}

pub(super) fn read(name: &str, text: &str, axes: Axes) -> Result<Recorded, FileError> {
    let text = text.trim_start_matches('\u{feff}');
    let lines = text.lines().enumerate().map(|(i, line)| (i + 1, line.trim()));
    let mut lines = lines.filter(|(_, line)| !line.is_empty());
    let mut comment = None;
    let first = loop {
        match lines.next() {
            Some((_, text)) if text.starts_with('#') => comment = Some(text.trim_start_matches('#')),
            first => break first,
        }
    };
    let Some((first, top)) = first else {
        return Err(FileError::Content(format!("{name} is empty")));
    };
    let separator = [',', ';', '\t'].into_iter().find(|separator| top.contains(*separator));
    let cells = |line: &str| -> Vec<String> {
        match separator {
            Some(separator) => {
                line.split(separator).map(|cell| cell.trim().trim_matches('"').to_string()).collect()
            }
            None => line.split_whitespace().map(String::from).collect(),
        }
    };
    let top_cells = cells(top);
    let is_row = top_cells.iter().all(|cell| cell.parse::<f64>().is_ok());
    let columns = if is_row { of_rows(top_cells, comment.map(cells)) } else { of_header(top_cells) };
    let Columns { names, is_tum, time, unit, attitudes } =
        columns.map_err(|why| FileError::Content(format!("{name}:{first}: {why}")))?;
    let first = is_row.then_some((first, top));
    let lines = first.into_iter().chain(lines.filter(|(_, line)| !line.starts_with('#')));
    let mut mistakes = Vec::new();
    let mut rows = Vec::new();
    for (line, text) in lines {
        match row(line, &cells(text), &names, is_tum, time, attitudes) {
            Ok(row) => rows.push(row),
            Err(why) => mistakes.push(format!("{name}:{line}: {why}")),
        }
    }
    let mut remarks = Vec::new();
    let unit = unit.unwrap_or_else(|| {
        let (word, unit) = guess(&rows, time);
        remarks.push(format!("its column `{}` is read as {word}", names[time]));
        unit
    });
    let estimates = estimates(name, &rows, time, unit, attitudes, axes, &mut mistakes);
    if !mistakes.is_empty() {
        return Err(FileError::Content(listed(mistakes)));
    }
    if estimates.is_empty() {
        return Err(FileError::Content(format!("{name} has a header and no rows")));
    }
    let others = match attitudes {
        Attitudes::Euler(_, 1.0) => {
            let degrees = |row: &Row| attitude(row, scaled(attitudes), axes);
            vec![("in degrees read as radians", rows.iter().map(degrees).collect())]
        }
        _ => Vec::new(),
    };
    Ok(Recorded { estimates, axes, others, remarks })
}

/// The same angles, were they in degrees.
fn scaled(attitudes: Attitudes) -> Attitudes {
    match attitudes {
        Attitudes::Euler(columns, unit) => Attitudes::Euler(columns, unit.to_radians()),
        other => other,
    }
}

/// By a first line of names.
fn of_header(names: Vec<String>) -> Result<Columns, String> {
    let (time, unit, attitudes) = find(&names)?;
    Ok(Columns { names, is_tum: false, time, unit, attitudes })
}

/// Where the first line is a row: by the comment above it if that has the names, as NumPy writes them; else eight
/// columns are a trajectory.
fn of_rows(row: Vec<String>, above: Option<Vec<String>>) -> Result<Columns, String> {
    let above = above.filter(|above| above.len() == row.len());
    let named = above.and_then(|above| of_header(above).ok());
    match named {
        Some(columns) if !matches!(columns.attitudes, Attitudes::Quaternion(TUM)) => Ok(columns),
        _ if row.len() == TUM_COLUMNS => Ok(Columns {
            names: row,
            is_tum: true,
            time: 0,
            unit: Some(1e9),
            attitudes: Attitudes::Quaternion(TUM),
        }),
        Some(columns) => Ok(columns),
        None => Err(
            "is a row of numbers and not the header that a table begins with: t_s, qw, qx, qy, qz, or roll_deg, pitch_deg, yaw_deg"
                .into(),
        ),
    }
}

/// The columns of a header: time, how many ns its unit is where it says so, and attitude.
fn find(names: &[String]) -> Result<(usize, Option<f64>, Attitudes), String> {
    let place = |wanted: &str| names.iter().position(|name| name.eq_ignore_ascii_case(wanted));
    let with_unit =
        TIMES.iter().flat_map(|time| UNITS.map(|(word, ns)| (format!("{time}_{word}"), Some(ns))));
    let bare = TIMES.iter().map(|time| (time.to_string(), None));
    let time = with_unit.chain(bare).find_map(|(name, ns)| Some((place(&name)?, ns)));
    let quaternion = QUATERNIONS.iter().find_map(|set| {
        let [w, x, y, z] = set.map(place);
        Some(Attitudes::Quaternion([w?, x?, y?, z?]))
    });
    let euler = || {
        EULERS.iter().find_map(|(set, unit)| {
            let [roll, pitch, yaw] = set.map(place);
            Some(Attitudes::Euler([roll?, pitch?, yaw?], *unit))
        })
    };
    let attitude = quaternion.or_else(euler);
    let has = names.join(", ");
    match (time, attitude) {
        (Some((time, ns)), Some(attitude)) => Ok((time, ns, attitude)),
        (_, None) if ["roll", "pitch", "yaw"].iter().all(|name| place(name).is_some()) => {
            Err("roll, pitch and yaw have no unit: call them roll_deg, pitch_deg, yaw_deg or roll_rad, …"
                .into())
        }
        (Some(_), None) => Err(format!(
            "has no attitude: qw, qx, qy, qz or roll_deg, pitch_deg, yaw_deg (or …_rad); its columns are {has}"
        )),
        (None, Some(_)) => {
            Err(format!("has no time: t_ns, t_us, t_ms, t_s, time or timestamp; its columns are {has}"))
        }
        (None, None) => Err(format!(
            "has neither time nor attitude: t_ns or t_s, and qw, qx, qy, qz or roll_deg, pitch_deg, yaw_deg; \
             its columns are {has}"
        )),
    }
}

fn row(
    line: usize,
    cells: &[String],
    names: &[String],
    is_tum: bool,
    time: usize,
    attitudes: Attitudes,
) -> Result<Row, String> {
    if cells.len() != names.len() {
        return Err(format!("the row has {} columns, the first {}", cells.len(), names.len()));
    }
    let wanted: Vec<usize> = match attitudes {
        Attitudes::Quaternion(columns) => columns.into_iter().chain([time]).collect(),
        Attitudes::Euler(columns, _) => columns.into_iter().chain([time]).collect(),
    };
    let mut values = vec![0.0; cells.len()];
    for column in wanted {
        let number = cells[column].parse::<f64>().ok().filter(|number| number.is_finite());
        let place =
            if is_tum { format!("column {}", column + 1) } else { format!("column {}", names[column]) };
        values[column] = number.ok_or_else(|| format!("{place}: `{}` is no number", cells[column]))?;
    }
    Ok(Row { line, values })
}

/// What a time without a unit is in: seconds if it has a fraction, else by how far apart rows are.
fn guess(rows: &[Row], time: usize) -> (&'static str, f64) {
    let times: Vec<f64> = rows.iter().map(|row| row.values[time]).collect();
    let mut steps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
    steps.sort_unstable_by(f64::total_cmp);
    let step = steps.get(steps.len() / 2).copied().unwrap_or(0.0);
    match step {
        _ if times.iter().any(|t| t.fract() != 0.0) => ("s", 1e9),
        50_000.0.. => ("ns", 1.0),
        50.0.. => ("µs", 1e3),
        2.0.. => ("ms", 1e6),
        _ => ("s", 1e9),
    }
}

fn attitude(row: &Row, attitudes: Attitudes, axes: Axes) -> Attitude {
    axes.attitude_in(quaternion(row, attitudes).normalize())
}

fn quaternion(row: &Row, attitudes: Attitudes) -> DQuat {
    match attitudes {
        Attitudes::Quaternion(columns) => {
            let [w, x, y, z] = columns.map(|column| row.values[column]);
            DQuat::from_xyzw(x, y, z, w)
        }
        Attitudes::Euler(columns, unit) => {
            let [roll, pitch, yaw] = columns.map(|column| row.values[column] * unit);
            Euler { roll, pitch, yaw }.to_quat()
        }
    }
}

fn estimates(
    name: &str,
    rows: &[Row],
    time: usize,
    unit: f64,
    attitudes: Attitudes,
    axes: Axes,
    mistakes: &mut Vec<String>,
) -> Vec<super::Timed> {
    let mut last = f64::NEG_INFINITY;
    let mut estimates = Vec::with_capacity(rows.len());
    for row in rows {
        let t = row.values[time];
        let out_of_order =
            (t < last).then(|| format!("its time {t} is before {last}, that of the row before"));
        last = last.max(t);
        let wrong = no_rotation(quaternion(row, attitudes)).or(out_of_order);
        mistakes.extend(wrong.map(|why| format!("{name}:{}: {why}", row.line)));
        estimates.push(timed(libm::round(t * unit) as i64, attitude(row, attitudes, axes)));
    }
    estimates
}

/// Every mistake a line, of very many the first.
fn listed(mut mistakes: Vec<String>) -> String {
    let more = mistakes.len().saturating_sub(LISTED);
    mistakes.truncate(LISTED);
    if more > 0 {
        mistakes.push(format!("and {more} more rows"));
    }
    mistakes.join("\n")
}
