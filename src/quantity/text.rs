//! Values back to text, in the shortest form that reads back to the same bits.

use super::parse::{self, quantity};
use super::unit::Scale;
use super::{QuantityError, Values};
use crate::double::Double;

/// Writes `value`, which is in inside units, in `unit`: 0.3490658503988659 in `deg/s` is
/// `20 deg/s`.
///
/// [`Kind::scalar`](super::Kind::scalar) reads the text back to an `f64` of the same bits. Where
/// no decimal in that unit does so (at the far ends of `f64`), the inside unit is used; a unit
/// that is not known is written as it is, with the value as it is. An infinity or a NaN is
/// written, but nothing reads it.
pub fn text_scalar(value: f64, unit: &str) -> String {
    written(&[value], unit, |numbers| numbers.join(""))
}

/// Writes a vector as [`text_scalar`] does a number: `[0, 0, 20] deg/s`.
pub fn text_vector(values: [f64; 3], unit: &str) -> String {
    written(&values, unit, |numbers| format!("[{}]", numbers.join(", ")))
}

fn written(values: &[f64], unit: &str, join: impl Fn(Vec<String>) -> String) -> String {
    let plain = |unit: &str| {
        let numbers = join(values.iter().map(|value| shortest(*value)).collect());
        format!("{numbers} {unit}").trim_end().to_owned()
    };
    let Ok(scale) = parse::unit(unit, None) else {
        return plain(unit);
    };
    if scale.factor == Double::ONE {
        return plain(unit);
    }
    let converted: Option<Vec<_>> = values.iter().map(|value| converted(*value, scale, unit)).collect();
    match converted {
        Some(numbers) => format!("{} {unit}", join(numbers)),
        None => plain(&scale.dimension.to_string()),
    }
}

/// The shortest decimal of an `f64`, without a `.0`.
fn shortest(value: f64) -> String {
    let text = format!("{value:?}");
    match text.strip_suffix(".0") {
        Some(whole) => whole.to_owned(),
        None => text,
    }
}

/// The shortest decimal that reads back to `value` in a unit that is not the inside one.
fn converted(value: f64, scale: Scale, unit: &str) -> Option<String> {
    if value == 0.0 {
        return Some(shortest(value));
    }
    // Twenty digits, from which shorter ones are rounded.
    let number = (Double::from(value) / scale.factor).abs();
    let power = libm::floor(libm::log10(number.hi)) as i32 - 19;
    let digits = number * Double::from_decimal(&format!("1e{}", -power))?;
    if !(digits.is_finite() && digits.hi > 1e17) {
        return None;
    }
    let digits = digits.hi as i128 + digits.lo as i128;
    let sign = if value < 0.0 { "-" } else { "" };
    let same = |text: &String| reads_back(&format!("{text} {unit}"), value);
    (0..20)
        .rev()
        .map(|dropped| {
            let tens = 10_i128.pow(dropped);
            let rounded = (digits + tens / 2) / tens;
            format!("{sign}{}", decimal(rounded, power + dropped as i32))
        })
        .find(same)
}

fn reads_back(text: &str, value: f64) -> bool {
    let read = |text| -> Result<bool, QuantityError> {
        let Values::Scalar(read) = quantity(text, None)?.values else {
            return Ok(false);
        };
        Ok(read.to_f64().to_bits() == value.to_bits())
    };
    read(text).unwrap_or(false)
}

/// `digits · 10^power` without needless zeros, with an exponent only where it is shorter to read.
fn decimal(digits: i128, power: i32) -> String {
    let digits = digits.to_string();
    let trimmed = digits.trim_end_matches('0');
    let power = power + (digits.len() - trimmed.len()) as i32;
    let point = trimmed.len() as i32 + power;
    match point {
        _ if !(-4..=16).contains(&point) => {
            let (first, rest) = trimmed.split_at(1);
            let dot = if rest.is_empty() { "" } else { "." };
            format!("{first}{dot}{rest}e{}", point - 1)
        }
        ..=0 => format!("0.{}{trimmed}", "0".repeat(point.unsigned_abs() as usize)),
        _ if power >= 0 => format!("{trimmed}{}", "0".repeat(power as usize)),
        _ => {
            let (whole, fraction) = trimmed.split_at(point as usize);
            format!("{whole}.{fraction}")
        }
    }
}
