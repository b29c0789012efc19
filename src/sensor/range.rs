//! Range: a reading beyond full scale stays at full scale and is flagged.

use super::mount::Mount;
use super::resolution::{self, Converter};
use super::{Block, Stage, Term, TermKind};
use crate::keys::{Key, Takes};
use crate::quantity::Sign;

pub(super) static KIND: TermKind = TermKind {
    name: "range",
    about: "clips to ± the range, in chip axes, and flags the sample",
    stage: Stage::Reading,
    keys: |sensor| {
        vec![Key {
            name: "range",
            takes: Takes::Scalar(sensor.units().reading.signed(Sign::Positive)),
            default: None,
            about: "full scale: readings are clipped to ± this on the chip's axes",
        }]
    },
    build: |values, context| {
        let Some(range) = values.scalar("range") else { return Ok(None) };
        let limits = match resolution::converter(values, context.sensor)? {
            Some(Converter { lsb, counts: Some((low, high)) }) => (low * lsb, high * lsb),
            _ => (-range, range),
        };
        let (low, high) = (limits.0.max(-range), limits.1.min(range));
        Ok(Some(Box::new(Clip { low, high, mount: context.mount })))
    },
};

struct Clip {
    low: f64,
    high: f64,
    mount: Mount,
}

impl Term for Clip {
    fn apply(&mut self, block: &mut Block) {
        let (low, high) = (self.low, self.high);
        let clipped = &mut block.clipped;
        self.mount.on_chip(&mut block.reading, |i, v| {
            let inside = v.map(|x| x.clamp(low, high));
            clipped[i] |= inside != v;
            inside
        });
    }
}
