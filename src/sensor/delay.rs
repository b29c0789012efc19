//! Transport delay: what is available at a tick was sensed `delay` earlier, exactly, whatever part of a tick that is;
//! before the start it is what was true at the start. It concerns what is true, not the biases and the noise, whose
//! statistics know no time.

use super::{Block, Column, Kinds, Stage, Term, TermKind};
use crate::keys::{Name, Values};
use crate::time::SimTime;

const DELAY: Name<SimTime> = Name::new("delay");

pub(super) static KIND: TermKind = TermKind {
    name: "delay",
    about: "the reading available at a tick was sensed earlier",
    serves: Kinds::ALL,
    stage: Stage::Signal,
    needs: &[Column::Late],
    keys: |_| vec![DELAY.duration("from sensing until the reading is available").or("0 s")],
    build: |values, _| Ok((delay(values) > SimTime::ZERO).then(|| Box::new(Delay) as Box<dyn Term>)),
};

/// How long before its tick a sample is sensed.
pub fn delay(values: &Values) -> SimTime {
    values.get(DELAY).unwrap_or_default()
}

struct Delay;

impl Term for Delay {
    #[inline(always)]
    fn apply(&mut self, block: &mut Block) {
        block.sense_late();
    }
}
