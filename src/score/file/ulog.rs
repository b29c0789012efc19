//! PX4's ULog: the topic `vehicle_attitude`, quaternion w first, body (FRD) to nav (NED), time in µs since boot.
//!
//! Format: docs.px4.io, "ULog File Format". It reads the first instance of the topic. The time is that of the
//! sample behind the estimate (`timestamp_sample`) if the log has it, else that of publication. Records without a
//! finite attitude are left out and counted.

use super::{FileError, Recorded, no_rotation};
use crate::geometry::Axes;
use crate::score::Packed;
use crate::table::{Rows, Series, TICKS, TimeUnit};
use glam::DQuat;
use px4_ulog::stream_parser::model::{Completeness, FlattenedFormat};
use px4_ulog::stream_parser::{DataMessage, Message, SimpleCallbackResult, read_file_with_simple_callback};
use std::collections::BTreeSet;
use std::path::Path;

const TOPIC: &str = "vehicle_attitude";

pub(super) fn read(path: &Path) -> Result<Recorded, FileError> {
    let content = |why: String| FileError::Content(format!("{}: {why}", path.display()));
    let name = path.to_str().ok_or_else(|| content("its name is not UTF-8; rename it".into()))?;
    let mut topics = BTreeSet::new();
    let (mut ticks, mut attitudes, mut not_finite) = (Vec::new(), Vec::new(), 0);
    let mut problem = None;
    let ended = read_file_with_simple_callback(name, &mut |message| {
        let Message::Data(data) = message else { return SimpleCallbackResult::KeepReading };
        let topic = data.flattened_format.message_name();
        if topic != TOPIC {
            if !topics.contains(topic) {
                topics.insert(topic.to_string());
            }
        } else if data.multi_id.value() == 0 {
            match row(data) {
                Ok((t, Some(attitude))) => {
                    ticks.push(i128::from(t) * TICKS);
                    attitudes.push(attitude);
                }
                Ok((_, None)) => not_finite += 1,
                Err(why) => problem = problem.take().or(Some(why)),
            }
        }
        SimpleCallbackResult::KeepReading
    });
    let ended = ended.map_err(|source| FileError::Io { path: path.to_path_buf(), source })?;
    if let Some(why) = problem {
        return Err(content(format!("{TOPIC}: {why}")));
    }
    if attitudes.is_empty() {
        if not_finite > 0 {
            return Err(content(format!("{TOPIC}: none of its {not_finite} records has a finite attitude")));
        }
        let there = topics.into_iter().collect::<Vec<_>>().join(", ");
        let there = if there.is_empty() { "none".into() } else { there };
        return Err(content(format!("has no topic {TOPIC} with an attitude in it; its topics are: {there}")));
    }
    let mut remarks = match ended {
        Completeness::Complete => Vec::new(),
        _ => vec![format!("the log is truncated: the {} attitudes before the end are read", attitudes.len())],
    };
    let rows = Rows::records(attitudes.len() + not_finite, not_finite);
    let series = Series::of_records(ticks, attitudes, TimeUnit::Us, rows);
    remarks.extend(series.rows.told());
    remarks.extend(series.remarks);
    Ok(Recorded {
        attitudes: series.values,
        times: series.times,
        time_name: "timestamp".into(),
        axes: Axes::NedFrd,
        others: Vec::new(),
        remarks,
        rows: series.rows,
    })
}

/// Time in µs and attitude of one record; `None` for an attitude that is not finite or all zero.
fn row(data: &DataMessage<'_>) -> Result<(u64, Option<Packed>), String> {
    let format = data.flattened_format;
    let bytes = data.data;
    let [w, x, y, z] = [0, 1, 2, 3].map(|i| float(format, bytes, &format!("q[{i}]")));
    let q = DQuat::from_xyzw(x?, y?, z?, w?);
    let sampled = micros(format, bytes, "timestamp_sample").filter(|&t| t > 0);
    let t =
        sampled.or_else(|| micros(format, bytes, "timestamp")).ok_or("its records have no `timestamp`")?;
    if i64::try_from(t).ok().and_then(|t| t.checked_mul(1000)).is_none() {
        return Err(format!("a timestamp of {t} µs is not a time since boot"));
    }
    if !q.is_finite() || q.length() < 1e-9 {
        return Ok((t, None));
    }
    match no_rotation(q) {
        None => Ok((t, Some(Packed::new(q.normalize())))),
        Some(why) => Err(format!("at {t} µs: {why}")),
    }
}

fn float(format: &FlattenedFormat, bytes: &[u8], name: &str) -> Result<f64, String> {
    let parser = format.get_field_parser::<f32>(name).map_err(|_| format!("has no `float {name}`"))?;
    let is_whole = bytes.len() >= usize::from(parser.offset()) + 4;
    if is_whole { Ok(f64::from(parser.parse(bytes))) } else { Err("a record is too short".into()) }
}

fn micros(format: &FlattenedFormat, bytes: &[u8], name: &str) -> Option<u64> {
    let parser = format.get_field_parser::<u64>(name).ok()?;
    (bytes.len() >= usize::from(parser.offset()) + 8).then(|| parser.parse(bytes))
}
