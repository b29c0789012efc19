//! What comes back on the links: decoded, set against the truth, kept.

use super::{Shared, Speed, Tap};
use crate::clock::{Clock, WallClock};
use crate::geometry::Attitude;
use crate::link::Receiver;
use crate::scene::Plan;
use crate::score::{AttitudeError, Scorer};
use crate::time::SimTime;
use crate::wire::Options;
use crate::wire::{
    Protocol,
    dialogue::{self, Said, Stamp},
};
use bytes::BytesMut;
use std::cell::RefCell;
use std::rc::Rc;
use std::sync::Arc;
use std::sync::atomic::Ordering;

/// Estimates of all links together.
#[derive(Default)]
pub(super) struct Heard {
    pub scorer: Scorer,
    pub estimates: Vec<(SimTime, Attitude)>,
    pub newest_deg: Option<f64>,
    /// Bytes that were no answer, by link.
    pub damaged: Vec<u64>,
}

/// Hands on what one link receives until the other side leaves.
pub(super) async fn tapped(mut receiver: Receiver, mut tap: Tap) {
    let mut buffer = BytesMut::with_capacity(4096);
    while matches!(receiver.recv(&mut buffer).await, Ok(1..)) {
        tap.0(&buffer);
        buffer.clear();
    }
}

/// What a listening task knows.
pub(super) struct Ear {
    pub plan: Arc<Plan>,
    pub shared: Arc<Shared>,
    pub clock: WallClock,
    pub speed: Speed,
    pub heard: Rc<RefCell<Heard>>,
}

impl Ear {
    /// Reads one link until the other side leaves; what has no meaning here is read all the same, so that nothing
    /// stands in the other side's way.
    pub(super) async fn listen(
        self,
        link: usize,
        protocol: Protocol,
        options: Options,
        mut receiver: Receiver,
    ) {
        let mut dialogue = dialogue::dialogue(protocol, options.controller);
        let mut buffer = BytesMut::with_capacity(4096);
        loop {
            buffer.clear();
            match receiver.recv(&mut buffer).await {
                Ok(0) | Err(_) => return,
                Ok(_) => {}
            }
            let Some(dialogue) = &mut dialogue else { continue };
            let now = self.clock.now();
            let mut heard = self.heard.borrow_mut();
            dialogue.hear(&buffer, now, &mut |said| {
                let Said::Estimate(dialogue::Estimate { stamp: Stamp::Sample(t), attitude }) = said else {
                    return;
                };
                let truth = self.plan.trajectory.at(t).attitude;
                let error = AttitudeError::between(truth, attitude);
                heard.scorer.add(error, self.delay_ms(now, t));
                heard.newest_deg = Some(error.total.to_degrees());
                heard.estimates.push((t, attitude));
            });
            heard.damaged[link] = dialogue.damaged();
        }
    }

    /// From when the sample was due to now, in real time.
    fn delay_ms(&self, now: i64, t: SimTime) -> Option<f64> {
        let stretched_at = self.shared.stretched_at_ns.load(Ordering::Relaxed);
        let start = self.shared.start_ns.load(Ordering::Relaxed);
        if t.0 < stretched_at {
            // Due by an earlier start than this one.
            return None;
        }
        match self.speed {
            Speed::Times(times) if start >= 0 => Some((now - start) as f64 / 1e6 - t.0 as f64 / 1e6 / times),
            _ => None,
        }
    }
}
