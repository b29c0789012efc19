//! Non-linearity: the deviation of a reading from the best straight line.
//!
//! `reading += n·R·(4u³ − 3u)`, u = signal/R within ±1, on the chip's axes: the odd cubic whose best straight line
//! (least greatest deviation) is the signal itself and whose greatest deviation is n of full scale R, at ±R/2 and at
//! ±R (Chebyshev's T₃; "best-fit straight line" of datasheets, IEEE Std 528). Beyond full scale it stays n·R.

use super::converter::RANGE;
use super::mount::Mount;
use super::{Block, Kinds, Stage, Term, TermKind};
use crate::keys::{KeyError, Name};
use crate::quantity::Kind;
use glam::DVec3;

/// The greatest deviation from the best straight line, per axis, a ratio of full scale.
pub const NONLINEARITY: Name<DVec3> = Name::new("nonlinearity");

pub(super) static KIND: TermKind = TermKind {
    name: "nonlinearity",
    about: "an odd cubic deviation from the best straight line, in chip axes",
    serves: Kinds::TRIADS,
    stage: Stage::Signal,
    needs: &[],
    keys: |_| {
        vec![NONLINEARITY.per_axis(
            Kind::RATIO,
            "greatest deviation from the best straight line, of full scale: needs a `range`; on the chip's axes if its mount is oblique").or("0")]
    },
    build: |values, context| {
        let bend = values.get(NONLINEARITY).unwrap_or_default();
        if bend == DVec3::ZERO {
            return Ok(None);
        }
        let Some(range) = values.get(RANGE) else {
            let message = format!(
                "is a fraction of full scale, so it also needs a `range`, such as range = \"{}\"",
                context.sensor.units().reading.example()
            );
            return Err(KeyError::new(NONLINEARITY, message));
        };
        Ok(Some(Box::new(Bend { bend: bend * range, range, mount: context.mount })))
    },
};

struct Bend {
    /// The greatest deviation, in the reading's unit.
    bend: DVec3,
    range: f64,
    mount: Mount,
}

impl Term for Bend {
    #[inline(always)]
    fn apply(&mut self, block: &mut Block) {
        // An odd function does not care which way a chip axis points along the body's.
        if self.mount.is_right_angled() {
            for (axis, column) in block.reading.iter_mut().enumerate() {
                bend(column, self.bend[axis], self.range);
            }
        } else {
            let mut axis = 0;
            self.mount.on_chip(&mut block.reading, |column, _| {
                bend(column, self.bend[axis], self.range);
                axis += 1;
            });
        }
    }
}

#[inline(always)]
fn bend(column: &mut [f64], most: f64, range: f64) {
    let (inverse, cubic, linear) = (1.0 / range, 4.0 * most, -3.0 * most);
    for x in column {
        let u = (*x * inverse).clamp(-1.0, 1.0);
        *x += (cubic * (u * u) + linear) * u;
    }
}
