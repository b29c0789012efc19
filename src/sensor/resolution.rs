//! Resolution: a reading is a whole number of counts on the chip's axes, rounded half away from zero.

use super::converter::{RESOLUTION, converter};
use super::mount::Mount;
use super::{Block, Kinds, Stage, Term, TermKind};

pub(super) static KIND: TermKind = TermKind {
    name: "resolution",
    about: "rounds to whole counts, in chip axes",
    serves: Kinds::ALL,
    stage: Stage::Reading,
    needs: &[],
    keys: |sensor| {
        vec![RESOLUTION.resolution(
            sensor.units().resolution,
            "the size of a count (\"0.15 uT\"), counts per unit (\"16.4 LSB/(deg/s)\"), or bits over ± the range (\"16 bit\")",
        )]
    },
    build: |values, context| {
        Ok(converter(values, context.sensor)?.map(|converter| {
            Box::new(Quantise { lsb: converter.lsb, mount: context.mount }) as Box<dyn Term>
        }))
    },
};

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
