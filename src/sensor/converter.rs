//! A chip's converter: its full scale and the size of its counts, on which both range and resolution depend.

use super::SensorKind;
use crate::keys::{KeyError, Name, Values};
use crate::quantity::{self, Resolution};

/// Full scale on the chip's axes, in the reading's unit.
pub const RANGE: Name<f64> = Name::new("range");
/// The size of a count, or the number of bits.
pub(super) const RESOLUTION: Name<Resolution> = Name::new("resolution");

/// What turns a reading to counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Converter {
    /// The size of one count.
    pub lsb: f64,
    /// The least and greatest count, where the range tells how many bits there are.
    pub counts: Option<(f64, f64)>,
}

/// The size of one count in the reading's unit, if the plan's readings come in counts.
pub fn lsb(values: &Values, sensor: SensorKind) -> Option<f64> {
    converter(values, sensor).ok().flatten().map(|converter| converter.lsb)
}

pub(super) fn converter(values: &Values, sensor: SensorKind) -> Result<Option<Converter>, KeyError> {
    let Some(resolution) = values.get(RESOLUTION) else { return Ok(None) };
    let range = values.get(RANGE);
    let lsb = match (resolution, range) {
        (Resolution::Step(lsb), _) => lsb.to_f64(),
        (Resolution::Bits(bits), Some(range)) => range / libm::exp2(f64::from(bits) - 1.0),
        (Resolution::Bits(_), None) => {
            let message = format!(
                "bits also need a `range`; or give the size of a count, such as \"1e-4 {}\"",
                sensor.unit()
            );
            return Err(KeyError::new(RESOLUTION, message));
        }
    };
    if let Some(range) = range.filter(|&range| lsb > range) {
        let (count, range) =
            (quantity::text_scalar(lsb, sensor.unit()), quantity::text_scalar(range, sensor.unit()));
        return Err(KeyError::new(
            RESOLUTION,
            format!("one count, {count}, is more than the whole range of ±{range}"),
        ));
    }
    Ok(Some(Converter { lsb, counts: range.and_then(|range| two_complement(range / lsb)) }))
}

/// The limits of a two's-complement converter whose full scale is this many counts: a part's sheet gives 2000 °/s
/// at 16.4 LSB/(°/s), which is 32 800, and means 16 bits. `None` if no power of two is within 1 %.
fn two_complement(full_scale: f64) -> Option<(f64, f64)> {
    let counts = libm::exp2(libm::round(libm::log2(full_scale)));
    ((full_scale / counts - 1.0).abs() < 0.01).then_some((-counts, counts - 1.0))
}

/// The least and greatest reading on a chip's axis, in the reading's unit; `None` where nothing clips.
///
/// # Errors
/// A resolution that cannot be.
pub fn limits(values: &Values, sensor: SensorKind) -> Result<Option<(f64, f64)>, KeyError> {
    let Some(range) = values.get(RANGE) else { return Ok(None) };
    let limits = match converter(values, sensor)? {
        Some(Converter { lsb, counts: Some((low, high)) }) => (low * lsb, high * lsb),
        _ => (-range, range),
    };
    Ok(Some((limits.0.max(-range), limits.1.min(range))))
}
