//! Range: a reading beyond full scale stays at full scale and is flagged.

use super::converter::{RANGE, limits};
use super::mount::Mount;
use super::{Block, Kinds, Stage, Term, TermKind};
use crate::quantity::Sign;

pub(super) static KIND: TermKind = TermKind {
    name: "range",
    about: "clips to ± the range, in chip axes, and flags the sample",
    serves: Kinds::BY_COMPONENT,
    stage: Stage::Reading,
    needs: &[],
    keys: |sensor| {
        vec![RANGE.scalar(
            sensor.units().reading.signed(Sign::Positive),
            "full scale: readings are clipped to ± this on the chip's axes",
        )]
    },
    build: |values, context| {
        let clip = |(low, high)| Box::new(Clip { low, high, mount: context.mount }) as Box<dyn Term>;
        Ok(limits(values, context.sensor)?.map(clip))
    },
};

struct Clip {
    low: f64,
    high: f64,
    mount: Mount,
}

impl Term for Clip {
    #[inline(always)]
    fn apply(&mut self, block: &mut Block) {
        let clipped = &mut block.clipped;
        self.mount.on_chip(&mut block.reading, |column, sign| {
            let (low, high) = if sign < 0.0 { (-self.high, -self.low) } else { (self.low, self.high) };
            // Almost always nothing is beyond, and that is seen without a branch a sample.
            if column.iter().fold(false, |beyond, &x| beyond | (x < low) | (x > high)) {
                for (x, clipped) in column.iter_mut().zip(&mut *clipped) {
                    let inside = x.clamp(low, high);
                    *clipped |= inside != *x;
                    *x = inside;
                }
            }
        });
    }
}
