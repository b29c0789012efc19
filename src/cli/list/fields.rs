//! Fields of reports, as `--limit` names them.

use super::{List, Refusal};
use crate::cli::{listen, score};
use crate::report::TimingReport;
use crate::scene::{Destination, Output, Plan};
use crate::sensor::SensorKind;
use crate::session::Job;
use serde_json::Value;
use std::sync::Arc;

/// Every number of each report, with its unit.
pub fn list() -> Result<List, Refusal> {
    // Any plan with three sensors and a fault will do: fields go by the report's shape.
    let plan = Plan::load("still", &[])?;
    let to: Destination = "mpu@pty".parse().map_err(Refusal)?;
    let run = Job::new(Arc::new(plan), vec![Output::to(to.clone())]).shape();
    let timing = serde_json::to_value(TimingReport::shape(run.clone()))?;
    let run = serde_json::to_value(run)?;
    let listen = serde_json::to_value(listen::shape(&to))?;
    let score = serde_json::json!({ "estimates": [serde_json::to_value(score::shape("estimate"))?] });
    let played = format!("NAME of sensors: {}; of links their number, from 0", SensorKind::names());
    let reports = [
        ("run", run, &*played),
        ("timing", timing, &*played),
        ("listen", listen, "NAME of sensors: gyro, accel, …, a second one gyro-2; of links 0"),
        ("score", score, "NAME: the estimate's; without `estimates.NAME.` a limit applies to every estimate"),
    ];
    Ok(List::of_lines(reports.into_iter().map(|(name, report, about)| {
        let mut lines = format!("{name} --limit 'FIELD<VALUE' (also <=, >, >=); {about}\n");
        for field in numbers("", &report) {
            let unit = unit(&field).map_or(String::new(), |unit| format!(": {unit}"));
            lines += &format!("  {field}{unit}\n");
        }
        (vec![name.to_string()], lines)
    })))
}

/// The paths of everything that is a number, or is one in some runs.
fn numbers(path: &str, value: &Value) -> Vec<String> {
    let below = |key: &str| if path.is_empty() { key.to_string() } else { format!("{path}.{key}") };
    match value {
        Value::Number(_) | Value::Null if !path.is_empty() => vec![path.to_string()],
        Value::Object(map) => map.iter().flat_map(|(key, value)| numbers(&below(key), value)).collect(),
        Value::Array(items) => {
            let first = items.iter().take(1);
            first.filter(|item| item.is_object()).flat_map(|item| numbers(&below("NAME"), item)).collect()
        }
        _ => Vec::new(),
    }
}

/// The unit that a name, or one above it, ends in.
fn unit(field: &str) -> Option<&'static str> {
    const UNITS: [(&str, &str); 9] = [
        ("_us", "µs"),
        ("_ms", "ms"),
        ("_s", "s"),
        ("_hz", "Hz"),
        ("_deg", "deg"),
        ("_ppm", "parts in a million"),
        ("_per_s", "a second"),
        ("_share", "a part of 1"),
        ("bytes", "bytes"),
    ];
    let of = |step: &str| UNITS.iter().rev().find(|(end, _)| step.ends_with(end)).map(|(_, unit)| *unit);
    field.split('.').rev().find_map(of)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_field_that_is_listed_is_one_that_a_limit_may_name() {
        let plan = Plan::load("still", &[]).unwrap();
        let output = Output::to("mpu@pty".parse().unwrap());
        let report = serde_json::to_value(Job::new(Arc::new(plan), vec![output]).shape()).unwrap();
        let fields = numbers("", &report);
        assert!(fields.len() > 40, "{fields:?}");
        for field in fields {
            let named = field.replace("sensors.NAME", "sensors.gyro").replace("links.NAME", "links.0");
            let limit: crate::report::Limit = format!("{named}<1").parse().unwrap();
            assert_eq!(limit.check(&report).err(), None, "{field}");
        }
    }

    #[test]
    fn a_field_has_the_unit_that_its_name_says() {
        for (field, expected) in [
            ("sensors.NAME.late_us.p99", Some("µs")),
            ("sensors.NAME.rate_hz", Some("Hz")),
            ("attitude.rms_deg", Some("deg")),
            ("links.NAME.bytes_per_s", Some("a second")),
            ("duration_s", Some("s")),
            ("sensors.NAME.dropped", None),
        ] {
            assert_eq!(unit(field), expected, "{field}");
        }
    }
}
