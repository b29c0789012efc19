//! Units as headers spell them: in brackets behind a name, or at its end.

use super::TimeUnit;
use std::f64::consts::PI;

/// What the numbers of a column are counted in.
#[derive(Clone, Debug, PartialEq)]
pub enum Unit {
    /// A time.
    Time(TimeUnit),
    /// An angle, of which one is so many rad.
    Angle(f64),
    /// An angular rate, of which one is so many rad/s.
    Rate(f64),
    /// A length, of which one is so many m.
    Length(f64),
    /// A number without a unit, as `[]` says of a quaternion.
    One,
    /// Another, in the header's words.
    Other(String),
}

const DEG: f64 = PI / 180.0;

/// A unit by itself: what stands in brackets, or in a row of units.
pub(super) fn unit(text: &str) -> Unit {
    let known = known(text);
    known.unwrap_or_else(|| Unit::Other(text.trim().to_string()))
}

/// The same, of words that are known.
pub(super) fn known(text: &str) -> Option<Unit> {
    let spelled: String =
        text.chars().filter(|c| !c.is_whitespace() && !"*·^".contains(*c)).collect::<String>().to_lowercase();
    Some(match spelled.as_str() {
        "" | "-" | "1" => Unit::One,
        "s" | "sec" | "secs" | "second" | "seconds" => Unit::Time(TimeUnit::S),
        "ms" | "msec" | "msecs" | "millis" | "millisecond" | "milliseconds" => Unit::Time(TimeUnit::Ms),
        "us" | "µs" | "μs" | "usec" | "usecs" | "micros" | "microsecond" | "microseconds" => {
            Unit::Time(TimeUnit::Us)
        }
        "ns" | "nsec" | "nsecs" | "nanos" | "nanosec" | "nanosecs" | "nanosecond" | "nanoseconds" => {
            Unit::Time(TimeUnit::Ns)
        }
        "rad" | "rads" | "radian" | "radians" => Unit::Angle(1.0),
        "deg" | "degs" | "degree" | "degrees" | "°" | "º" => Unit::Angle(DEG),
        "rad/s" | "rads-1" | "rads⁻¹" | "rad_s" | "rad/sec" | "radps" | "rad_per_s" | "rad.s-1"
        | "radian/s" | "radians/s" | "rads/s" => Unit::Rate(1.0),
        "deg/s" | "degs-1" | "degs⁻¹" | "deg_s" | "deg/sec" | "degps" | "dps" | "deg_per_s" | "°/s"
        | "º/s" | "degree/s" | "degrees/s" => Unit::Rate(DEG),
        "m" | "meter" | "meters" | "metre" | "metres" => Unit::Length(1.0),
        "mm" => Unit::Length(1e-3),
        "cm" => Unit::Length(1e-2),
        "km" => Unit::Length(1e3),
        "m/s" | "ms-1" | "m_s" | "m/s2" | "ms-2" | "m_s2" | "ut" | "pa" | "hpa" | "v" | "a" | "hz" | "g"
        | "degc" | "°c" | "flags" | "%" => Unit::Other(text.trim().to_string()),
        _ => return None,
    })
}

/// Ends of names that are units, the longer before those that they end in.
const ENDS: [&str; 37] = [
    "rad_per_s",
    "deg_per_s",
    "rad_s2",
    "rad_s",
    "deg_s",
    "m_s2",
    "m_s",
    "degrees",
    "radians",
    "degree",
    "radian",
    "degc",
    "degs",
    "rads",
    "deg",
    "rad",
    "dps",
    "nanoseconds",
    "microseconds",
    "milliseconds",
    "seconds",
    "nanosec",
    "nsecs",
    "nsec",
    "usec",
    "msec",
    "secs",
    "sec",
    "ns",
    "us",
    "ms",
    "s",
    "mm",
    "cm",
    "km",
    "m",
    "pa",
];

/// A name in lower case and without its unit, if it ends in one: `wx_rad_s` is `wx` in rad/s. The one component that
/// may follow a unit stays: `gyro_rad_0` is `gyro_0` in rad.
pub(super) fn strip(base: &str) -> (String, Option<Unit>) {
    if let Some((before, component)) = base.rsplit_once('_')
        && matches!(component, "x" | "y" | "z" | "w" | "0" | "1" | "2" | "3")
        && let Some((name, end)) = split(before)
        // In `w_RS_S_x` the S is a frame.
        && end.len() > 2
    {
        return (format!("{name}_{component}"), Some(unit(end)));
    }
    match split(base) {
        Some((name, end)) => (name.to_string(), Some(unit(end))),
        None => (base.to_string(), None),
    }
}

fn split(base: &str) -> Option<(&str, &'static str)> {
    ENDS.iter().find_map(|end| {
        let name = base.strip_suffix(end)?.strip_suffix('_')?;
        (!name.is_empty()).then_some((name, *end))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_unit_is_read_in_each_of_its_spellings() {
        for (text, expected) in [
            ("ns", Unit::Time(TimeUnit::Ns)),
            ("usec", Unit::Time(TimeUnit::Us)),
            ("µs", Unit::Time(TimeUnit::Us)),
            ("Seconds", Unit::Time(TimeUnit::S)),
            ("rad s^-1", Unit::Rate(1.0)),
            ("rad/s", Unit::Rate(1.0)),
            ("deg/s", Unit::Rate(DEG)),
            ("Degrees", Unit::Angle(DEG)),
            ("°", Unit::Angle(DEG)),
            ("", Unit::One),
            ("m", Unit::Length(1.0)),
            ("m s^-2", Unit::Other("m s^-2".into())),
            ("furlong", Unit::Other("furlong".into())),
        ] {
            assert_eq!(unit(text), expected, "{text}");
        }
    }

    #[test]
    fn a_name_is_parted_from_the_unit_at_its_end() {
        for (name, base, unit) in [
            ("wx_rad_s", "wx", Some(Unit::Rate(1.0))),
            ("roll_deg", "roll", Some(Unit::Angle(DEG))),
            ("t_ns", "t", Some(Unit::Time(TimeUnit::Ns))),
            ("gyro_rad_0", "gyro_0", Some(Unit::Angle(1.0))),
            ("vn_m_s", "vn", Some(Unit::Other("m_s".into()))),
            ("q_rs_w", "q_rs_w", None),
            ("w_rs_s_x", "w_rs_s_x", None),
            ("qw", "qw", None),
            ("ms", "ms", None),
        ] {
            assert_eq!(strip(name), (base.to_string(), unit), "{name}");
        }
    }
}
