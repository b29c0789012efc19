//! Limits on a report's fields: `sensors.gyro.late_us.p99<200`.

use serde_json::Value;
use std::fmt;
use std::str::FromStr;

/// A bound on one field.
#[derive(Clone, Debug, PartialEq)]
pub struct Limit {
    field: String,
    bound: Bound,
    value: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Bound {
    Below,
    AtMost,
    Above,
    AtLeast,
}

/// Longer spellings first, so that `<=` does not parse as `<`.
const BOUNDS: [(&str, Bound, &str); 4] = [
    ("<=", Bound::AtMost, ">"),
    (">=", Bound::AtLeast, "<"),
    ("<", Bound::Below, ">="),
    (">", Bound::Above, "<="),
];

/// A limit that does not parse, or whose field does not exist.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{0}")]
pub struct LimitError(String);

impl FromStr for Limit {
    type Err = LimitError;

    fn from_str(text: &str) -> Result<Limit, LimitError> {
        let found =
            BOUNDS.iter().find_map(|&(sign, bound, _)| text.split_once(sign).map(|parts| (parts, bound)));
        let Some(((field, value), bound)) = found else {
            return Err(LimitError(format!(
                "`{text}` is not a limit: write FIELD<VALUE, such as 'sensors.gyro.late_us.p99<200'"
            )));
        };
        match value.trim().parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(Limit { field: field.trim().to_string(), bound, value }),
            _ => Err(LimitError(format!(
                "`{text}`: `{}` is not a number; a limit's value is a bare number in the field's own unit",
                value.trim()
            ))),
        }
    }
}

impl fmt::Display for Limit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let sign = BOUNDS.iter().find(|(_, bound, _)| *bound == self.bound).map_or("", |(sign, ..)| sign);
        write!(f, "{}{sign}{}", self.field, self.value)
    }
}

impl Limit {
    /// Checks before a run that a report of this shape has the field.
    ///
    /// # Errors
    /// There is no such field; names the existing ones.
    pub fn check(&self, shape: &Value) -> Result<(), LimitError> {
        match self.find(shape)? {
            Value::Number(_) | Value::Null => Ok(()),
            other => Err(LimitError(format!("`{}` is not a number but {}", self.field, kind(other)))),
        }
    }

    /// Whether its field is `name` or something inside it.
    pub fn is_of(&self, name: &str) -> bool {
        self.field.split('.').next() == Some(name)
    }

    /// `None` if the report keeps the limit, else the violation: `sensors.gyro.late_us.p99 = 312 > 200`.
    pub fn broken(&self, report: &Value) -> Option<String> {
        let value = match self.find(report) {
            Ok(value) => value.as_f64(),
            Err(_) => None,
        };
        let Some(value) = value else {
            return Some(format!("{} is not known after this run (limit {self})", self.field));
        };
        let kept = match self.bound {
            Bound::Below => value < self.value,
            Bound::AtMost => value <= self.value,
            Bound::Above => value > self.value,
            Bound::AtLeast => value >= self.value,
        };
        let against =
            BOUNDS.iter().find(|(_, bound, _)| *bound == self.bound).map_or("", |(_, _, sign)| sign);
        (!kept).then(|| format!("{} = {} {against} {}", self.field, super::number(value), self.value))
    }

    /// The field by its dotted name; entries of an array by their `name`, or else by number.
    fn find<'v>(&self, report: &'v Value) -> Result<&'v Value, LimitError> {
        let mut value = report;
        for step in self.field.split('.') {
            let (next, names) = match value {
                Value::Object(map) => (map.get(step), map.keys().cloned().collect::<Vec<_>>()),
                Value::Array(items) => {
                    let named =
                        items.iter().find(|item| item.get("name").and_then(Value::as_str) == Some(step));
                    let numbered = step.parse::<usize>().ok().and_then(|i| items.get(i));
                    let names = items.iter().filter_map(|item| item.get("name")?.as_str().map(String::from));
                    (named.or(numbered), names.collect())
                }
                _ => (None, Vec::new()),
            };
            value = next.ok_or_else(|| {
                let instead = if names.is_empty() { "nothing below it".into() } else { names.join(", ") };
                LimitError(format!(
                    "`{}` is not a field of the report: `{step}` does not exist; {instead}",
                    self.field
                ))
            })?;
        }
        Ok(value)
    }
}

fn kind(value: &Value) -> &'static str {
    match value {
        Value::Bool(_) => "true or false",
        Value::String(_) => "a text",
        Value::Array(_) => "a list: name one of its entries",
        _ => "a group: name one of its fields",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn report() -> Value {
        json!({ "sensors": [{ "name": "gyro", "late_us": { "p99": 312.0 } }], "attitude": null, "links": [{ "dropped": 0 }] })
    }

    #[test]
    fn a_limit_is_kept_or_says_how_it_is_broken() {
        for (text, broken) in [
            ("sensors.gyro.late_us.p99<400", None),
            ("sensors.gyro.late_us.p99<200", Some("sensors.gyro.late_us.p99 = 312 >= 200")),
            ("sensors.gyro.late_us.p99 <= 312", None),
            ("sensors.gyro.late_us.p99>312", Some("sensors.gyro.late_us.p99 = 312 <= 312")),
            ("sensors.0.late_us.p99>=312", None),
            ("links.0.dropped<1", None),
            ("attitude<1", Some("attitude is not known after this run (limit attitude<1)")),
        ] {
            let limit: Limit = text.parse().unwrap();
            assert_eq!(limit.broken(&report()).as_deref(), broken, "{text}");
        }
    }

    #[test]
    fn mistakes_say_what_would_be_right() {
        for (text, says) in [
            ("p99=3", "FIELD<VALUE"),
            ("p99<fast", "`fast` is not a number"),
            ("x<", "is not a number"),
            ("x<nan", "not a number"),
        ] {
            assert!(text.parse::<Limit>().unwrap_err().to_string().contains(says), "{text}");
        }
        for (text, says) in [
            ("sensors.gyro.late.p99<1", "`late` does not exist; name, late_us"),
            ("sensors.mag.late_us.p99<1", "`mag` does not exist; gyro"),
            ("sensors<1", "a list"),
            ("sensors.gyro.late_us<1", "a group"),
        ] {
            let limit: Limit = text.parse().unwrap();
            let message = limit.check(&report()).unwrap_err().to_string();
            assert!(message.contains(says), "{text}: {message}");
        }
    }
}
