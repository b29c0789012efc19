//! Resolution: a reading is a whole number of counts on the chip's axes, rounded half away from zero.

use super::mount::Mount;
use super::{Block, Kinds, SensorKind, Stage, Term, TermKind};
use crate::keys::{Key, KeyError, Takes, Values};
use crate::quantity::{self, Resolution};

pub(super) static KIND: TermKind = TermKind {
    name: "resolution",
    about: "rounds to whole counts, in chip axes",
    serves: Kinds::ALL,
    stage: Stage::Reading,
    needs: &[],
    keys: |sensor| {
        vec![Key {
            name: "resolution",
            takes: Takes::Resolution(sensor.units().resolution),
            default: None,
            about: "the size of a count (\"0.15 uT\"), counts per unit (\"16.4 LSB/(deg/s)\"), or bits over ± the range (\"16 bit\")",
        }]
    },
    build: |values, context| {
        Ok(converter(values, context.sensor)?.map(|converter| {
            Box::new(Quantise { lsb: converter.lsb, mount: context.mount }) as Box<dyn Term>
        }))
    },
};

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
    let Some(resolution) = values.resolution("resolution") else { return Ok(None) };
    let range = values.scalar("range");
    let lsb = match (resolution, range) {
        (Resolution::Step(lsb), _) => lsb.to_f64(),
        (Resolution::Bits(bits), Some(range)) => range / libm::exp2(f64::from(bits) - 1.0),
        (Resolution::Bits(_), None) => {
            let message = format!(
                "bits also need a `range`; or give the size of a count, such as \"1e-4 {}\"",
                sensor.unit()
            );
            return Err(KeyError::new("resolution", message));
        }
    };
    if let Some(range) = range.filter(|&range| lsb > range) {
        let (count, range) =
            (quantity::text_scalar(lsb, sensor.unit()), quantity::text_scalar(range, sensor.unit()));
        return Err(KeyError::new(
            "resolution",
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

struct Quantise {
    lsb: f64,
    mount: Mount,
}

impl Term for Quantise {
    #[inline(always)]
    fn apply(&mut self, block: &mut Block) {
        let (lsb, per_unit) = (self.lsb, 1.0 / self.lsb);
        // Rounding treats both signs alike.
        self.mount.on_chip(&mut block.reading, |column, _| {
            let beyond = |beyond: bool, x: &f64| beyond | (x.abs() >= SMALL * lsb);
            if column.iter().fold(false, beyond) {
                column.iter_mut().for_each(|x| *x = libm::round(*x * per_unit) * lsb);
            } else {
                column.iter_mut().for_each(|x| *x = round_small(*x * per_unit) * lsb);
            }
        });
    }
}

/// Below this many counts [`round_small`] rounds.
const SMALL: f64 = 2_251_799_813_685_248.0;

/// The nearest whole number, halves away from zero, of a number below 2⁵¹: without a call or a branch, so that several
/// samples are rounded at once.
#[inline(always)]
fn round_small(x: f64) -> f64 {
    /// 2⁵²: a sum with it has no digits behind the point.
    const NO_FRACTION: f64 = 4_503_599_627_370_496.0;
    let size = x.abs();
    let even = (size + NO_FRACTION) - NO_FRACTION;
    let half = if size - even >= 0.5 { 1.0 } else { 0.0 };
    (even + half).copysign(x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn many_at_once_are_rounded_as_one_alone(x in -SMALL..SMALL, k in -1_000_000i32..1_000_000) {
            prop_assert_eq!(round_small(x), libm::round(x));
            let half = f64::from(k) + 0.5;
            for x in [half, half.next_up(), half.next_down(), f64::from(k), x / SMALL] {
                prop_assert_eq!(round_small(x), libm::round(x), "{}", x);
            }
        }
    }
}
