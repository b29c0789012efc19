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
            column.iter_mut().for_each(|x| *x = round(*x * per_unit) * lsb);
        });
    }
}

/// The nearest whole number, halves away from zero, without a branch or a comparison, so that several samples are
/// rounded at once: what is added is the greatest number below a half, which takes a half itself to the next whole
/// number and nothing below it.
#[inline(always)]
fn round(x: f64) -> f64 {
    (x + 0.499_999_999_999_999_94_f64.copysign(x)).trunc()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn many_at_once_are_rounded_as_one_alone(x in -1e16..1e16, k in -1_000_000i32..1_000_000) {
            prop_assert_eq!(round(x), libm::round(x));
            let half = f64::from(k) + 0.5;
            for x in [half, half.next_up(), half.next_down(), f64::from(k), x * 1e-16, x * 1e-10, x * 1e280] {
                prop_assert_eq!(round(x), libm::round(x), "{}", x);
            }
        }
    }

    #[test]
    fn halves_go_away_from_zero_up_to_where_a_double_has_none() {
        let half = 0.5f64;
        let last = 4_503_599_627_370_495.5;
        for x in
            [half, half.next_down(), half.next_up(), last, f64::from_bits(last.to_bits() - 1), 9e15, f64::MAX]
        {
            for x in [x, -x] {
                assert_eq!(round(x), libm::round(x), "{x}");
            }
        }
        assert!(round(f64::NAN).is_nan() && round(f64::NEG_INFINITY) == f64::NEG_INFINITY);
    }
}
