//! Finds the columns of a log: those that the scene names, else those with known names.

use super::{ANGULAR_RATE, EULER, FILE, QUATERNION, RATE, TIME};
use crate::keys::{Columns, KeyError, Name, Values};
use crate::table::{Attitudes, Choice, Clock, Set, Table, TableError, TimeColumn};
use crate::time::Rate;
use std::io::BufRead;

/// The columns of a log, with the factor from their unit to ours.
pub(super) enum Turns {
    /// Quaternions, w first.
    Quaternion([usize; 4]),
    /// Roll, pitch and yaw, rad.
    Euler([usize; 3], f64),
    /// Rates about body x, y and z, rad/s.
    Rate([usize; 3], f64),
}

/// The times of a log's rows.
pub(super) struct When {
    pub clock: Clock,
    /// The unit that the scene gives for the time column, in ns.
    pub ns: Option<i64>,
}

/// The keys for columns; at most one may be given.
const TURNS: [Name<Columns>; 3] = [QUATERNION, EULER, ANGULAR_RATE];

pub(super) fn at<T: ?Sized>(key: Name<T>) -> impl Fn(TableError) -> KeyError {
    move |error| KeyError::new(key, error.in_short())
}

/// The column of time, or the rate.
pub(super) fn when<R: BufRead>(table: &Table<R>, values: &Values) -> Result<When, KeyError> {
    if let Some(hz) = values.get(RATE) {
        if values.has(TIME) {
            return Err(KeyError::new(RATE, "is given with `time`: keep only one"));
        }
        // Accurate to a billionth of a hertz.
        let rate =
            (hz.is_finite() && hz * 1e9 < 1e18).then(|| Rate::new((hz * 1e9).round() as u64, 1_000_000_000));
        let rate =
            rate.flatten().ok_or_else(|| KeyError::new(RATE, "takes a rate above 0, such as \"200 Hz\""))?;
        return Ok(When { clock: Clock::Rate(rate), ns: None });
    }
    if let Some((names, unit)) = values.get(TIME) {
        let ns = (unit * 1e9).round();
        if ns < 1.0 {
            return Err(KeyError::new(TIME, "takes a unit of a nanosecond or more, such as \"ns\""));
        }
        let [column] = picks(table, TIME, names)?;
        let time = TimeColumn { column, fine: None, unit: None };
        return Ok(When { clock: Clock::Column { time, assumed: None }, ns: Some(ns as i64) });
    }
    let clock = table.clock(&Choice::default()).map_err(at(FILE))?;
    clock.map(|clock| When { clock, ns: None }).ok_or_else(|| {
        lacking(
            table,
            "has no recognised time column (t_ns, t_us, t_ms, t_s, time, timestamp): add time = { column = \"…\", unit = \"s\" }, or rate = \"200 Hz\" for a log without times",
        )
    })
}

/// The columns of attitude or angular rate, with warnings about them.
pub(super) fn turns<R: BufRead>(
    table: &Table<R>,
    values: &Values,
    warnings: &mut Vec<String>,
) -> Result<Turns, KeyError> {
    let given: Vec<_> = TURNS.into_iter().filter(|key| values.has(*key)).collect();
    if let [first, second, ..] = given[..] {
        return Err(KeyError::new(second, format!("is given with `{}`: keep only one", first.name())));
    }
    if let Some((names, _)) = values.get(QUATERNION) {
        return Ok(Turns::Quaternion(picks(table, QUATERNION, names)?));
    }
    if let Some((names, unit)) = values.get(EULER) {
        return Ok(Turns::Euler(picks(table, EULER, names)?, unit));
    }
    if let Some((names, unit)) = values.get(ANGULAR_RATE) {
        return Ok(Turns::Rate(picks(table, ANGULAR_RATE, names)?, unit));
    }
    let rates = table.angular_rate();
    let attitude = table.attitude(&Choice::default()).map_err(at(FILE))?;
    match (attitude, rates) {
        (Some(Attitudes::Quaternion(set)), _) => {
            tell(table, &set, warnings);
            Ok(Turns::Quaternion(set.columns))
        }
        (Some(Attitudes::Euler(set)), rates) if set.unit.is_some() || rates.is_none() => {
            Ok(Turns::Euler(set.columns, known(table, &set, EULER, "deg", warnings)?))
        }
        (_, Some(set)) => Ok(Turns::Rate(set.columns, known(table, &set, ANGULAR_RATE, "rad/s", warnings)?)),
        _ => Err(lacking(
            table,
            "has no recognised attitude or angular rate (qw, qx, qy, qz, …): name its columns, such as euler = { columns = [\"roll\", \"pitch\", \"yaw\"], unit = \"deg\" }",
        )),
    }
}

/// The unit of columns with known names, with warnings about them.
fn known<R: BufRead>(
    table: &Table<R>,
    set: &Set<3>,
    key: Name<Columns>,
    example: &str,
    warnings: &mut Vec<String>,
) -> Result<f64, KeyError> {
    tell(table, set, warnings);
    let names = set.columns.map(|column| table.called(column));
    if let Some(why) = set.by_kind {
        warnings.push(format!(
            "{}: {} have no unit; {why}, so these are read",
            table.place(),
            names.join(", ")
        ));
    }
    set.unit.ok_or_else(|| {
        let message = format!(
            "{}: {} have no unit: add {} = {{ columns = {names:?}, unit = \"{example}\" }}",
            table.place(),
            names.join(", "),
            key.name()
        );
        KeyError::new(FILE, message)
    })
}

fn tell<R: BufRead, const N: usize>(table: &Table<R>, set: &Set<N>, warnings: &mut Vec<String>) {
    if !set.others.is_empty() {
        let (first, others) = (table.called(set.columns[0]), set.others.join(", "));
        warnings.push(format!("{}: the columns of `{first}` are read, not those of {others}", table.place()));
    }
}

/// Why no columns were found.
fn lacking<R: BufRead>(table: &Table<R>, what: &str) -> KeyError {
    let (place, told) = (table.place(), table.told());
    let file = place.rsplit_once(':').map_or(place.as_str(), |(file, _)| file);
    let message = match table.kind() {
        Some(kind) => {
            kind.refusal(file, "`replay` does not read: it reads tables with a header and TUM trajectories")
        }
        None if table.is_headed() => format!("{file} {what}; {told}"),
        None => format!(
            "{place} holds numbers, but the line before the first row names the columns, such as t_ns,qw,qx,qy,qz; or give them by number, such as quaternion = [\"2\", \"3\", \"4\", \"5\"] with time = {{ column = \"1\", unit = \"s\" }} or a rate"
        ),
    };
    KeyError::new(FILE, message)
}

/// The indices of columns that the scene names.
fn picks<R: BufRead, const N: usize>(
    table: &Table<R>,
    key: Name<Columns>,
    names: &[String],
) -> Result<[usize; N], KeyError> {
    let names = <&[String; N]>::try_from(names);
    let names = names.map_err(|_| KeyError::new(key, format!("takes {N} columns")))?;
    table.picks(names).map_err(at(key))
}
